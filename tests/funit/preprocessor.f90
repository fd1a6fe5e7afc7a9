!> `preprocessor test.pf test.f90`: turn a test module in the language of pFUnit into a Fortran module and a main
!> program that runs its tests.
!>
!> Each line becomes exactly one line, so that one line marker at the top makes the compiler's messages point at
!> the .pf file. An error is reported as `file:line: text`, and then nothing is written.
program preprocessor
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none
  integer, parameter :: columns = 132   ! of a line of Fortran
  character(len=1000) :: pf_path, f90_path, buffer
  character(len=:), allocatable :: line, output, tests, before, after, awaited, module_name
  integer :: number, unit, status

  call get_command_argument(1, pf_path)
  call get_command_argument(2, f90_path)
  output = '# 1 "'//trim(pf_path)//'"'//new_line('')
  tests = ''
  before = ''
  after = ''
  awaited = ''
  module_name = ''
  number = 0
  open (newunit=unit, file=trim(pf_path), status='old', action='read', iostat=status)
  if (status /= 0) call fault('cannot be read')
  do
    read (unit, '(a)', iostat=status) buffer
    if (status /= 0) exit
    number = number + 1
    line = trim(buffer)
    if (index(adjustl(line), '@') == 1) then
      call translate(trim(adjustl(line)))
    else if (len(line) > columns) then
      call fault(too_long('the line', len(line)))
    else if (awaited /= '' .or. module_name == '') then
      call look_for_name(trim(adjustl(line)))
    end if
    output = output//line//new_line('')
  end do
  close (unit)
  if (awaited /= '') call fault(awaited//' without a subroutine below it')
  if (tests == '') call fault('no @test')
  if (lower(module_name) /= lower(base_name(trim(pf_path)))) call fault('the module is not named after the file')
  open (newunit=unit, file=trim(f90_path), action='write', status='replace')
  write (unit, '(a)') output//main_program()
  close (unit)

contains

  !> Replace an annotation by Fortran.
  subroutine translate(annotation)
    character(len=*), intent(in) :: annotation   !! without blanks at either end
    character(len=:), allocatable :: name, arguments
    integer :: i

    i = scan(annotation//'(', '( ')
    name = annotation(:i - 1)
    arguments = trim(adjustl(annotation(i:)))
    if (awaited /= '') call fault(awaited//' without a subroutine below it')
    select case (lower(name))
    case ('@test', '@before', '@after')
      if (arguments /= '') call fault(name//' stands alone on its line')
      awaited = lower(name)
      line = ''
      return
    end select
    i = len(arguments)
    if (i == 0) then
      call fault(name//' is no annotation, or lacks its arguments')
    else if (arguments(1:1) /= '(' .or. arguments(i:i) /= ')') then
      call fault(name//' does not end with its closing parenthesis on this line')
    end if
    line = assertion(name, arguments(2:i - 1))//'; if (anyExceptions()) return'
    i = len(pfunit_line(name, arguments(2:i - 1)))
    if (i > columns) call fault(too_long(name//', as pFUnit writes it,', i))
  end subroutine translate

  !> First line of pFUnit 4.14's code for an assertion; the location follows on separate lines.
  pure function pfunit_line(name, arguments) result(first_line)
    character(len=*), intent(in) :: name, arguments
    character(len=:), allocatable :: first_line

    first_line = '  call '//name(2:)//'('//arguments
    if (arguments /= '') first_line = first_line//', '
    first_line = first_line//'&'
  end function pfunit_line

  function too_long(what, length) result(text)
    character(len=*), intent(in) :: what
    integer, intent(in) :: length
    character(len=:), allocatable :: text
    character(len=60) :: numbers

    write (numbers, '(a,i0,a,i0)') ' takes ', length, ' columns; a line of Fortran has ', columns
    text = what//trim(numbers)
  end function too_long

  !> The call for an assertion.
  function assertion(name, arguments) result(statement)
    character(len=*), intent(in) :: name, arguments
    character(len=:), allocatable :: statement
    character(len=12) :: place

    write (place, '(a,i0,a)') 'line=', number, ')'
    select case (lower(name))
    case ('@assertequal', '@assertequivalent')
      statement = comparison(name, '==', arguments)
    case ('@assertlessthan')
      statement = comparison(name, '<', arguments)
    case ('@assertlessthanorequal')
      statement = comparison(name, '<=', arguments)
    case ('@assertgreaterthan')
      statement = comparison(name, '>', arguments)
    case ('@assertgreaterthanorequal')
      statement = comparison(name, '>=', arguments)
    case ('@asserttrue')
      statement = comparison(name, '==', '.true., '//arguments)
    case ('@assertfalse')
      statement = comparison(name, '==', '.false., '//arguments)
    case ('@assertexceptionraised')
      statement = 'call funit_assert_raised('//arguments//repeat(', ', merge(1, 0, arguments /= ''))
    case default
      call fault(name//' is no annotation')
    end select
    statement = statement//trim(place)
  end function assertion

  function comparison(name, relation, arguments) result(statement)
    character(len=*), intent(in) :: name, relation, arguments
    character(len=:), allocatable :: statement
    integer :: first, second

    first = argument_end(arguments, 1)
    second = argument_end(arguments, first + 2)
    if (arguments(:first) == '' .or. arguments(first + 2:second) == '') call fault(name//' lacks an argument')
    statement = "call funit_assert('"//relation//"', funit_value("//arguments(:first)//'), funit_value(' &
                //arguments(first + 2:second)//')'//arguments(second + 1:)//', '
  end function comparison

  !> End of the argument that begins at `start`: before a comma outside parentheses and strings.
  pure integer function argument_end(text, start)
    character(len=*), intent(in) :: text
    integer, intent(in) :: start
    character(len=1) :: quote
    integer :: depth

    depth = 0
    quote = ' '
    do argument_end = start, len(text)
      associate (c => text(argument_end:argument_end))
        if (quote /= ' ') then
          if (c == quote) quote = ' '
        else if (scan(c, '''"') == 1) then
          quote = c
        else if (scan(c, '([') == 1) then
          depth = depth + 1
        else if (scan(c, ')]') == 1) then
          depth = depth - 1
        else if (c == ',' .and. depth == 0) then
          exit
        end if
      end associate
    end do
    argument_end = argument_end - 1
  end function argument_end

  !> Note the module's name, or the subroutine below an annotation.
  subroutine look_for_name(text)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: name

    if (index(lower(text), 'module ') == 1) then
      module_name = leading_name(text(8:))
    else if (awaited /= '' .and. index(lower(text), 'subroutine ') == 1) then
      name = leading_name(text(12:))
      select case (awaited)
      case ('@test')
        tests = tests//"  call funit_tests%run('"//name//"', "//name//'{})'//new_line('')
      case ('@before')
        before = ', before='//name
      case ('@after')
        after = ', after='//name
      end select
      awaited = ''
    else if (awaited /= '' .and. text /= '' .and. index(text, '!') /= 1) then
      call fault(awaited//' without a subroutine below it')
    end if
  end subroutine look_for_name

  function main_program() result(text)
    character(len=:), allocatable :: text
    character(len=*), parameter :: nl = new_line('')
    integer :: i

    text = 'program funit_main'//nl//'  use funit, only: funit_runner'//nl//'  use '//module_name//nl &
           //'  implicit none'//nl//'  type(funit_runner) :: funit_tests'//nl &
           //"  call funit_tests%start('"//trim(pf_path)//"')"//nl
    do
      i = index(tests, '{}')
      if (i == 0) exit
      tests = tests(:i - 1)//before//after//tests(i + 2:)
    end do
    text = text//tests//'  call funit_tests%finish()'//nl//'end program funit_main'
  end function main_program

  pure function leading_name(text) result(name)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: name

    name = adjustl(text)
    name = name(:verify(lower(name)//' ', 'abcdefghijklmnopqrstuvwxyz0123456789_') - 1)
  end function leading_name

  pure function base_name(path) result(name)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: name

    name = path(index(path, '/', back=.true.) + 1:)
    name = name(:index(name//'.', '.') - 1)
  end function base_name

  pure function lower(text) result(small)
    character(len=*), intent(in) :: text
    character(len=len(text)) :: small
    integer :: i

    small = text
    do i = 1, len(text)
      if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') small(i:i) = achar(iachar(text(i:i)) + 32)
    end do
  end function lower

  subroutine fault(what)
    character(len=*), intent(in) :: what

    write (error_unit, '(2a,i0,2a)') trim(pf_path), ':', number, ': ', what
    stop 1
  end subroutine fault
end program preprocessor
