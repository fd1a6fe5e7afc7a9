!> epcont: elastoplastic contact of plane and axisymmetric bodies. Only this program sets the
!> exit status.
program epcont_main
  use, intrinsic :: iso_c_binding, only: c_bool, c_int
  use epcont_app_arguments, only: arguments_type, command_line, read_arguments
  use epcont_app_driver, only: run_deck
  use epcont_app_help, only: help_text, man_page
  use epcont_app_process, only: c_exit, print_error, print_text, watch_exit
  use epcont_base_error, only: error_type, raise, status_usage, status_valid
  use epcont_base_text, only: newline, shown, text_of
  use epcont_base_version, only: program_name, program_version
  use epcont_deck_manual, only: manual
  use epcont_report_file, only: make_directory
  use epcont_system_memory, only: has_memory, memory_of_libraries, prepare_heap
  use epcont_system_threads, only: one_thread, use_threads
  implicit none
  logical(c_bool), target :: ended = .false.
  integer :: status

  call watch_exit(ended)
  call prepare_heap()
  call use_threads(one_thread)
  call run()
  ended = .true.
  call c_exit(int(status, c_int))

contains

  !> Do what the command line asks for. With several decks, the exit status is the largest.
  subroutine run()
    type(arguments_type) :: arguments
    type(error_type), allocatable :: error
    character(len=:), allocatable :: cards
    integer :: i, one

    status = status_valid
    call read_arguments(command_line(), arguments, error)
    if (.not. allocated(error) .and. .not. has_memory(memory_of_libraries)) &
      call raise(error, status_usage, 'every deck needs '//text_of(int(memory_of_libraries/1000000))// &
                 ' MB of memory, but less is free or allowed: raise ulimit -v')
    if (allocated(error)) then
      call refuse(error%message)
    else if (arguments%asks('--help')) then
      call print_text(help_text(), status)
    else if (arguments%asks('--man')) then
      call print_text(man_page(), status)
    else if (arguments%asks('--version')) then
      call print_text(program_name//' '//program_version, status)
    else if (arguments%asks('--cards')) then
      cards = manual(arguments%card)
      if (cards /= '') call print_text(cards, status)
      if (cards == '') call refuse(arguments%card//': no such card; epcont --cards lists them')
    else
      if (len(arguments%directory) > 0) call make_directory(arguments%directory)
      do i = 1, size(arguments%deck)
        call run_deck(arguments%deck(i)%text, arguments, one)
        status = max(status, one)
      end do
    end if
  end subroutine run

  !> Report a fault of the command line.
  subroutine refuse(message)
    character(len=*), intent(in) :: message

    call print_error(program_name//': '//shown(message)//newline)
    status = status_usage
  end subroutine refuse
end program epcont_main
