!> Streams, start and end of the process. Fortran's WRITE does not report write errors; the system calls do.
module epcont_app_process
  use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_f_pointer, c_funloc, c_funptr, c_int, c_loc, &
      c_long, c_null_char, c_ptr, c_short, c_size_t
  use epcont_base_error, only: status_internal, status_usage
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: newline, text_of
  use epcont_base_version, only: program_name
  use epcont_system_memory, only: has_memory
  use epcont_system_threads, only: stated_threads
  implicit none
  private
  public :: print_text, print_error, terminal_columns
  public :: prepare_start, watch_exit, c_exit

  integer(c_int), parameter :: standard_output = 1, standard_error = 2

  !> Window size, as Linux returns it.
  type, bind(c) :: window_type
    integer(c_short) :: rows, columns, width, height
  end type window_type

  !> Memory that OpenBLAS maps for each thread before the main program begins, and memory of the program
  !! beside it [bytes].
  integer(i8), parameter :: memory_of_blas = 134217728_i8, memory_beside = 32000000_i8
  integer(c_int), parameter :: processors_online = 84   !! `sysconf` of Linux
  !> `getrlimit` of Linux, and twice the stack of the deepest run [bytes].
  integer(c_int), parameter :: stack_size = 3
  integer(c_long), parameter :: least_stack = 262144_c_long

  interface
    integer(c_size_t) function c_write(descriptor, text, length) bind(c, name='write')
      import
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: text(*)
      integer(c_size_t), value :: length
    end function c_write
    integer(c_int) function c_ioctl(descriptor, request, window) bind(c, name='ioctl')
      import
      integer(c_int), value :: descriptor
      integer(c_long), value :: request
      type(window_type), intent(out) :: window
    end function c_ioctl
    integer(c_int) function c_sigignore(signal) bind(c, name='sigignore')
      import
      integer(c_int), value :: signal
    end function c_sigignore
    integer(c_int) function c_on_exit(handler, argument) bind(c, name='on_exit')
      import
      type(c_funptr), value :: handler
      type(c_ptr), value :: argument
    end function c_on_exit
    !> End the program regularly.
    subroutine c_exit(status) bind(c, name='exit')
      import
      integer(c_int), value :: status   !! of the program
    end subroutine c_exit
    subroutine c_exit_now(status) bind(c, name='_exit')
      import
      integer(c_int), value :: status
    end subroutine c_exit_now
    integer(c_int) function c_setenv(name, value, replace) bind(c, name='setenv')
      import
      character(kind=c_char), intent(in) :: name(*), value(*)
      integer(c_int), value :: replace
    end function c_setenv
    integer(c_long) function c_sysconf(name) bind(c, name='sysconf')
      import
      integer(c_int), value :: name
    end function c_sysconf
    integer(c_int) function c_getrlimit(resource, limit) bind(c, name='getrlimit')
      import
      integer(c_int), value :: resource
      integer(c_long), intent(out) :: limit(2)   !! current and largest limit; negative: unlimited
    end function c_getrlimit
  end interface

contains

  !> Print text on standard output at once, with a newline at its end.
  subroutine print_text(text, status)
    character(len=*), intent(in) :: text   !! one line or many
    integer, intent(inout) :: status   !! if writing fails, at least the status of file errors
    integer :: last

    last = len(text)
    if (last > 0) last = last - merge(1, 0, text(last:) == newline)
    if (is_written(standard_output, text(:last)//newline)) return
    if (status < status_usage) call print_error(program_name//': standard output cannot be written'//newline)
    status = max(status, status_usage)
  end subroutine print_text

  !> Print text on standard error, at once and unchanged. Write errors are ignored.
  subroutine print_error(text)
    character(len=*), intent(in) :: text   !! with its newlines
    logical :: ignored

    ignored = is_written(standard_error, text)
  end subroutine print_error

  !> Write text; a pipe may take it in parts.
  logical function is_written(descriptor, text)
    integer(c_int), intent(in) :: descriptor
    character(len=*), intent(in) :: text
    integer(c_size_t) :: done, part

    done = 0
    do while (done < len(text))
      part = c_write(descriptor, text(done + 1:), len(text, kind=c_size_t) - done)
      if (part <= 0) exit
      done = done + part
    end do
    is_written = done == len(text)
  end function is_written

  !> Columns of the terminal on standard error, 80 if unknown; 0 if it is not a terminal.
  integer function terminal_columns() result(columns)
    integer(c_long), parameter :: window_size = 21523_c_long   !! TIOCGWINSZ of Linux
    integer, parameter :: usual = 80
    type(window_type) :: window

    columns = 0
    if (c_ioctl(standard_error, window_size, window) /= 0) return
    columns = window%columns
    if (columns <= 0) columns = usual
  end function terminal_columns

  !> Set defaults of the environment (one thread; waiting threads release their core) and check memory and
  !! stack. Without memory for each thread (at most one for each processor), OpenBLAS waits forever; with a
  !! small stack, a signal ends the run. The Fortran runtime has not started, so READ and WRITE are not
  !! available.
  subroutine prepare_start() bind(c, name='epcont_prepare_start')
    integer(c_int) :: ignored
    integer(c_long) :: stack(2)
    integer(i8) :: threads, wanted

    ignored = c_setenv('OMP_NUM_THREADS'//c_null_char, '1'//c_null_char, 0_c_int)
    ignored = c_setenv('OMP_WAIT_POLICY'//c_null_char, 'PASSIVE'//c_null_char, 0_c_int)
    threads = max(1_c_long, min(int(stated_threads(), c_long), c_sysconf(processors_online)))
    wanted = threads*memory_of_blas + memory_beside
    if (.not. has_memory(wanted)) call stop_now(status_usage, &
      'OpenBLAS needs '//text_of(wanted/1000000)//' MB of memory, but less is free or allowed: '// &
      'raise ulimit -v or lower OMP_NUM_THREADS')
    if (c_getrlimit(stack_size, stack) /= 0) return
    if (stack(1) >= 0 .and. stack(1) < least_stack) call stop_now(status_usage, &
      'the stack is limited to '//text_of(stack(1)/1024_i8)//' kB: raise ulimit -s to at least '// &
      text_of(least_stack/1024_i8)//' kB')
  end subroutine prepare_start

  !> Make sure that the exit status is epcont's own: that of `c_exit`, or that of the fault. The Fortran
  !! runtime and OpenBLAS use other statuses, which could mean a valid answer here. A closed pipe, or a file
  !! above the size limit, is a write error.
  subroutine watch_exit(ended)
    !> lives as long as the program; true if `c_exit` was called
    logical(c_bool), target, intent(in) :: ended
    integer(c_int), parameter :: broken_pipe = 13, file_size = 25
    integer(c_int) :: ignored

    ignored = c_sigignore(broken_pipe)
    ignored = c_sigignore(file_size)
    ignored = c_on_exit(c_funloc(judge_exit), c_loc(ended))
  end subroutine watch_exit

  !> Handler of `exit`. The Fortran runtime and OpenBLAS use status 1 if an allocation fails.
  subroutine judge_exit(status, ended) bind(c)
    integer(c_int), value :: status
    type(c_ptr), value :: ended
    logical(c_bool), pointer :: in_order

    call c_f_pointer(ended, in_order)
    if (in_order) return
    if (status == 1) call stop_now(status_usage, &
      'not enough memory is free or allowed: raise ulimit -v, ulimit -s or OMP_STACKSIZE')
    call stop_now(status_internal, 'internal error: please report it with the deck')
  end subroutine judge_exit

  !> End the program at once with a message.
  subroutine stop_now(status, message)
    integer, intent(in) :: status            !! of the program
    character(len=*), intent(in) :: message   !! one line

    call print_error(program_name//': '//message//newline)
    call c_exit_now(int(status, c_int))
  end subroutine stop_now
end module epcont_app_process
