!> epcont: contact of plane bodies and rings, from card decks. The only place that sets the exit status.
program epcont
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
  use epcont_app_arguments, only: arguments_type, help_text, read_arguments
  use epcont_app_driver, only: run_deck
  use epcont_base_large_pages, only: prepare_heap
  use epcont_base_one_thread, only: use_one_thread
  use epcont_base_error, only: error_type, status_usage, status_valid
  use epcont_base_version, only: program_name, program_version
  use epcont_deck_manual, only: manual
  use epcont_report_file, only: make_directory
  implicit none
  interface
    subroutine c_exit(status) bind(c, name='exit')
      import :: c_int
      integer(c_int), value :: status
    end subroutine c_exit
  end interface
  integer :: status

  call prepare_heap()
  call use_one_thread()
  call run(status)
  flush (output_unit)
  flush (error_unit)
  call c_exit(int(status, c_int))

contains

  !> All decks; the largest status counts.
  subroutine run(worst)
    integer, intent(out) :: worst
    type(arguments_type) :: arguments
    type(error_type), allocatable :: error
    character(len=:), allocatable :: text
    logical :: found
    integer :: i, one

    worst = status_valid
    call read_arguments(arguments, error)
    if (allocated(error)) then
      write (error_unit, '(a)') program_name//': '//error%message
      worst = error%status
    else if (arguments%help) then
      write (output_unit, '(a)', advance='no') help_text()
    else if (arguments%version) then
      write (output_unit, '(a)') program_name//' '//program_version
    else if (arguments%cards) then
      text = manual(arguments%card, found)
      if (.not. found) worst = status_usage
      write (merge(output_unit, error_unit, found), '(a)', advance='no') text
    else
      if (len(arguments%directory) > 0) call make_directory(arguments%directory)
      do i = 1, size(arguments%deck)
        call run_deck(arguments%deck(i)%text, arguments, one)
        worst = max(worst, one)
      end do
    end if
  end subroutine run
end program epcont
