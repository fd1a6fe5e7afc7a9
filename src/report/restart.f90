!> The file DECK.restart: the end of the last load case of a deck (PARAM SAVE), from which another deck of the
!> same model continues (RESTART).
!>
!> It has reals in the format of the machine: a head, then the values of an archive.
module epcont_report_restart
  use epcont_base_archive, only: archive, checksum
  use epcont_base_error, only: error_type, raise, status_no_answer
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: shown
  use epcont_model_marks, only: marks_of, part_name
  use epcont_report_file, only: text_file
  use epcont_report_run, only: run_results
  implicit none
  private
  public :: restore_end, save_end

  !> Head of the file: the bytes `epcontRS`, version of the format, checksum of the values.
  integer, parameter :: head = 3
  real(wp), parameter :: magic = transfer('epcontRS', 1.0_wp), version = 3.0_wp

contains

  !> Write the end of the last load case.
  subroutine save_end(path, run, error)
    character(len=*), intent(in) :: path                  !! of the file
    type(run_results), intent(inout) :: run               !! after its last load case
    type(error_type), allocatable, intent(out) :: error   !! there is no end, or the file cannot be written
    type(archive) :: saved
    type(text_file) :: file
    real(wp), allocatable :: values(:)

    if (.not. run%has_end()) then
      call raise(error, status_no_answer, path// &
                 ': not written: the last load case did not reach its end, or nothing can yield or slip')
      return
    end if
    values = [real(run%deck%subcase(run%case)%id, wp), marks_of(run%model)]
    call saved%pass(values)
    call run%pass_ends(saved)
    associate (all => saved%value(:saved%used))
      values = [magic, version, checksum(all), all]
    end associate
    call file%characters(transfer(values, repeat(' ', 8*size(values))))
    call file%write_to(path, error)
  end subroutine save_end

  !> Let the first load case start from the saved end that the deck names. An error is added to its faults.
  subroutine restore_end(run)
    type(run_results), intent(inout) :: run   !! before its first load case
    character(len=*), parameter :: file = 'give the DECK.restart that PARAM SAVE YES writes'
    character(len=:), allocatable :: path
    type(archive) :: saved
    real(wp), allocatable :: values(:)
    integer :: k

    path = run%deck%restart
    associate (deck => run%deck%source%files(1)%name)
      if (path(1:1) /= '/') path = deck(:index(deck, '/', back=.true.))//path
    end associate
    call read_values(path, values)
    if (.not. allocated(values)) then
      call refuse(' cannot be read', file//', relative to the folder of this deck')
    else if (size(values) < head) then
      call refuse(' is not a restart file', file)
    else if (any(values(:2) /= [magic, version])) then
      call refuse(' is not a restart file of this version of epcont', file)
    else if (values(3) /= checksum(values(head + 1:))) then
      call refuse(' is incomplete or damaged', 'run the deck that has saved it again')
    else
      saved%value = values(head + 1:)
      saved%reading = .true.
      call saved%pass(values)
      run%from_subcase = nint(values(1))
      k = findloc(values(2:) == marks_of(run%model), .false., dim=1)
      if (k > 0) call refuse(' is the end of another model: '//trim(part_name(k))//' differ', &
        'use the same '//trim(part_name(k))//' in both decks')
      if (k == 0) call run%pass_ends(saved)
    end if

  contains

    !> Report why the file cannot be used.
    subroutine refuse(what, remedy)
      character(len=*), intent(in) :: what, remedy

      call run%faults%add_error(run%deck%restart_place, 'RESTART: '//shown(path)//what, remedy)
    end subroutine refuse
  end subroutine restore_end

  !> Read a file of reals; not allocated if it cannot be read.
  subroutine read_values(path, values)
    character(len=*), intent(in) :: path
    real(wp), allocatable, intent(out) :: values(:)
    integer(i8) :: bytes
    integer :: status, unit

    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', &
          iostat=status)
    if (status /= 0) return
    inquire (unit=unit, size=bytes)
    allocate (values(max(0_i8, bytes)/8))
    read (unit, iostat=status) values
    close (unit)
    if (status /= 0) deallocate (values)
  end subroutine read_values
end module epcont_report_restart
