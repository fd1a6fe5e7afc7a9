!> Stand-in for the part of pFUnit 4.14 that our tests use; see README.md.
!>
!> `preprocessor` turns each assertion of a `.pf` file into one call of `funit_assert` whose first two arguments
!> pass through `funit_value`: it keeps their rank and shape, and makes numbers and logicals one type.
module funit
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use, intrinsic :: iso_fortran_env, only: int32, int64, output_unit, real32, real64
  implicit none
  private
  public :: funit_assert, funit_assert_raised, funit_runner, funit_value
  public :: anyExceptions, throw, KEEP_ALL, TRIM_ALL

  !> Value of an integer, real or logical in a comparison.
  type :: value_type
    private
    integer :: sort = 0
    integer(int64) :: whole = 0_int64
    real(real64) :: real = 0.0_real64
  end type value_type
  integer, parameter :: sort_integer = 1, sort_real = 2, sort_logical = 3

  interface funit_value
    module procedure :: value_of_int32, value_of_int64, value_of_real32, value_of_real64, value_of_logical
    module procedure :: same_string, same_strings, same_table
  end interface funit_value

  !> Assert that `expected relation actual` holds in every element; a scalar `expected` applies to all elements.
  interface funit_assert
    module procedure :: assert_values, assert_near, assert_near_single, assert_strings
  end interface funit_assert

  !> Are blanks at both ends of strings compared? As in pFUnit, only on request.
  type :: whitespace_option
    private
    logical :: trimmed = .true.
  end type whitespace_option
  type(whitespace_option), parameter :: TRIM_ALL = whitespace_option(.true.), KEEP_ALL = whitespace_option(.false.)

  !> A failed assertion, or an exception of the code under test; then line 0.
  type :: exception
    integer :: line = 0
    character(len=:), allocatable :: message
  end type exception

  !> Exceptions not yet caught: shared by assertions and runner.
  type(exception), allocatable :: pending(:)

  !> Runs the tests of one file and counts.
  type :: funit_runner
    private
    character(len=:), allocatable :: file
    integer :: tests = 0, failures = 0
  contains
    procedure :: start
    procedure :: run
    procedure :: finish
  end type funit_runner

  abstract interface
    subroutine procedure_without_arguments()
    end subroutine procedure_without_arguments
  end interface

contains

  elemental type(value_type) function value_of_int32(number) result(value)
    integer(int32), intent(in) :: number
    value = value_type(sort_integer, int(number, int64), real(number, real64))
  end function value_of_int32

  elemental type(value_type) function value_of_int64(number) result(value)
    integer(int64), intent(in) :: number
    value = value_type(sort_integer, number, real(number, real64))
  end function value_of_int64

  elemental type(value_type) function value_of_real32(number) result(value)
    real(real32), intent(in) :: number
    value = value_type(sort_real, 0_int64, real(number, real64))
  end function value_of_real32

  elemental type(value_type) function value_of_real64(number) result(value)
    real(real64), intent(in) :: number
    value = value_type(sort_real, 0_int64, number)
  end function value_of_real64

  elemental type(value_type) function value_of_logical(truth) result(value)
    logical, intent(in) :: truth
    value = value_type(sort_logical, merge(1_int64, 0_int64, truth), 0.0_real64)
  end function value_of_logical

  ! One for each rank: an elemental function of strings crashes gfortran 12.
  pure function same_string(string) result(same)
    character(len=*), intent(in) :: string
    character(len=len(string)) :: same
    same = string
  end function same_string

  pure function same_strings(strings) result(same)
    character(len=*), intent(in) :: strings(:)
    character(len=len(strings)) :: same(size(strings))
    same = strings
  end function same_strings

  pure function same_table(strings) result(same)
    character(len=*), intent(in) :: strings(:, :)
    character(len=len(strings)) :: same(size(strings, 1), size(strings, 2))
    same = strings
  end function same_table

  subroutine assert_values(relation, expected, actual, message, line)
    character(len=*), intent(in) :: relation
    type(value_type), intent(in) :: expected(..), actual(..)
    character(len=*), intent(in), optional :: message
    integer, intent(in) :: line

    call assert_near(relation, expected, actual, 0.0_real64, message, line)
  end subroutine assert_values

  subroutine assert_near_single(relation, expected, actual, tolerance, message, line)
    character(len=*), intent(in) :: relation
    type(value_type), intent(in) :: expected(..), actual(..)
    real(real32), intent(in) :: tolerance
    character(len=*), intent(in), optional :: message
    integer, intent(in) :: line

    call assert_near(relation, expected, actual, real(tolerance, real64), message, line)
  end subroutine assert_near_single

  subroutine assert_near(relation, expected, actual, tolerance, message, line)
    character(len=*), intent(in) :: relation   !! ==, <, <=, > or >=
    type(value_type), intent(in) :: expected(..), actual(..)
    real(real64), intent(in) :: tolerance      !! absolute; for reals under ==
    character(len=*), intent(in), optional :: message
    integer, intent(in) :: line
    type(value_type), allocatable :: left(:), right(:)
    integer :: i, k

    if (shapes_differ(max(shape(expected), 0), max(shape(actual), 0), message, line)) return
    left = list_of_values(expected)
    right = list_of_values(actual)
    do i = 1, size(right)
      k = min(i, size(left))
      if (holds(left(k), relation, right(i), tolerance)) cycle
      call fail(relation, text_of(left(k)), text_of(right(i)), difference_text(left(k), right(i)), &
                place_of(i, shape(actual)), message, line)
      return
    end do
  end subroutine assert_near

  subroutine assert_strings(relation, expected, actual, message, line, whitespace)
    character(len=*), intent(in) :: relation
    character(len=*), intent(in) :: expected(..), actual(..)
    character(len=*), intent(in), optional :: message
    integer, intent(in) :: line
    type(whitespace_option), intent(in), optional :: whitespace
    character(len=len(expected)), allocatable :: left(:)
    character(len=len(actual)), allocatable :: right(:)
    type(whitespace_option) :: option
    integer :: i, k

    if (present(whitespace)) option = whitespace
    if (shapes_differ(max(shape(expected), 0), max(shape(actual), 0), message, line)) return
    allocate (left, source=list_of_strings(expected))
    allocate (right, source=list_of_strings(actual))
    do i = 1, size(right)
      k = min(i, size(left))
      if (option%trimmed) then
        left(k) = adjustl(left(k))
        right(i) = adjustl(right(i))
      end if
      if (left(k) == right(i) .and. (option%trimmed .or. len(left) == len(right))) cycle
      call fail(relation, quoted(left(k), option), quoted(right(i), option), '', place_of(i, shape(actual)), message, line)
      return
    end do
  end subroutine assert_strings

  !> Assert that the code under test has thrown (with exactly this message, if given), and catch it.
  subroutine funit_assert_raised(message, line)
    character(len=*), intent(in), optional :: message
    integer, intent(in) :: line
    integer :: i

    if (.not. allocated(pending)) allocate (pending(0))
    do i = 1, size(pending)
      if (present(message)) then
        if (pending(i)%message /= message) cycle
      end if
      pending = [pending(:i - 1), pending(i + 1:)]
      return
    end do
    call throw('nothing thrown', line)
    if (present(message)) pending(size(pending))%message = 'nothing thrown with message "'//message//'"'
  end subroutine funit_assert_raised

  !> Report a failure; test doubles of the code under test use it too.
  subroutine throw(message, line)
    character(len=*), intent(in) :: message
    integer, intent(in), optional :: line
    type(exception) :: new

    if (present(line)) new%line = line
    new%message = message
    if (.not. allocated(pending)) allocate (pending(0))
    pending = [pending, new]
  end subroutine throw

  !> Is there an exception that has not been caught?
  logical function anyExceptions()
    anyExceptions = allocated(pending)
    if (anyExceptions) anyExceptions = size(pending) > 0
  end function anyExceptions

  subroutine start(self, file)
    class(funit_runner), intent(out) :: self
    character(len=*), intent(in) :: file   !! the .pf file, as shown in messages
    self%file = file
  end subroutine start

  !> Run one test between `before` and `after`; an exception that is not caught makes it fail.
  subroutine run(self, name, test, before, after)
    class(funit_runner), intent(inout) :: self
    character(len=*), intent(in) :: name
    procedure(procedure_without_arguments) :: test
    procedure(procedure_without_arguments), optional :: before, after
    integer :: i

    allocate (pending(0))
    if (present(before)) call before()
    if (.not. anyExceptions()) call test()
    if (present(after)) call after()
    self%tests = self%tests + 1
    if (anyExceptions()) self%failures = self%failures + 1
    do i = 1, size(pending)
      write (output_unit, '(2a,i0,4a)') self%file, ':', pending(i)%line, ': ', name, ': ', pending(i)%message
    end do
    deallocate (pending)
  end subroutine run

  !> Print the summary; end with status 1 unless all tests have passed.
  subroutine finish(self)
    class(funit_runner), intent(in) :: self

    write (output_unit, '(2a,i0,a,i0,a)') self%file, ': ', self%tests, ' tests, ', self%failures, ' failed'
    if (self%failures > 0 .or. self%tests == 0) stop 1
  end subroutine finish

  !> Does `expected relation actual` hold? Never for a NaN, nor between a logical and a number.
  elemental logical function holds(expected, relation, actual, tolerance)
    type(value_type), intent(in) :: expected, actual
    character(len=*), intent(in) :: relation
    real(real64), intent(in) :: tolerance
    integer :: order

    holds = .false.
    if (ieee_is_nan(expected%real) .or. ieee_is_nan(actual%real) .or. ieee_is_nan(tolerance)) return
    if (actual%sort == sort_real .and. expected%sort /= sort_logical) then
      order = merge(-1, merge(0, 1, expected%real == actual%real), expected%real < actual%real)
      if (order /= 0 .and. relation == '==') order = merge(0, order, abs(actual%real - expected%real) <= tolerance)
    else if (actual%sort == expected%sort) then
      order = merge(-1, merge(0, 1, expected%whole == actual%whole), expected%whole < actual%whole)
    else
      return
    end if
    select case (relation)
    case ('==')
      holds = order == 0
    case ('<')
      holds = order < 0
    case ('<=')
      holds = order <= 0
    case ('>')
      holds = order > 0
    case ('>=')
      holds = order >= 0
    end select
  end function holds

  !> Throw, and return true, unless the shapes are equal or `expected` is a scalar.
  logical function shapes_differ(expected, actual, message, line)
    integer, intent(in) :: expected(:), actual(:)
    character(len=*), intent(in), optional :: message
    integer, intent(in) :: line

    shapes_differ = size(expected) > 0 .and. size(expected) /= size(actual)
    if (size(expected) == size(actual)) shapes_differ = any(expected /= actual)
    if (shapes_differ) call fail('==', 'shape '//list_text(expected), 'shape '//list_text(actual), '', '', message, line)
  end function shapes_differ

  subroutine fail(relation, expected, actual, difference, place, message, line)
    character(len=*), intent(in) :: relation, expected, actual, difference, place
    character(len=*), intent(in), optional :: message
    integer, intent(in) :: line
    character(len=:), allocatable :: text

    text = 'expected '//relation//' actual fails'//place
    if (present(message)) text = trim(message)//': '//text
    text = text//new_line('')//'  expected   '//expected//new_line('')//'  actual     '//actual
    if (difference /= '') text = text//new_line('')//'  difference '//difference
    call throw(text, line)
  end subroutine fail

  function list_of_values(array) result(list)
    type(value_type), intent(in) :: array(..)
    type(value_type), allocatable :: list(:)

    select rank (array)
    rank (0)
      list = [array]
    rank (1)
      list = array
    rank (2)
      list = reshape(array, [size(array)])
    rank (*)   ! gfortran 12 gives an empty temporary this shape
      allocate (list(0))
    rank default
      error stop 'funit: an argument of rank 3 or more'
    end select
  end function list_of_values

  function list_of_strings(array) result(list)
    character(len=*), intent(in) :: array(..)
    character(len=len(array)), allocatable :: list(:)

    select rank (array)
    rank (0)
      list = [array]
    rank (1)
      list = array
    rank (2)
      list = reshape(array, [size(array)])
    rank (*)
      allocate (list(0))
    rank default
      error stop 'funit: an argument of rank 3 or more'
    end select
  end function list_of_strings

  !> ` at (2, 3)` for element `i` of an array; empty for a scalar.
  pure function place_of(i, extents) result(text)
    integer, intent(in) :: i, extents(:)
    character(len=:), allocatable :: text

    select case (size(extents))
    case (0)
      text = ''
    case (1)
      text = ' at '//list_text([i])
    case default
      text = ' at '//list_text([1 + mod(i - 1, extents(1)), 1 + (i - 1)/extents(1)])
    end select
  end function place_of

  pure function list_text(list) result(text)
    integer, intent(in) :: list(:)
    character(len=:), allocatable :: text
    character(len=64) :: buffer

    write (buffer, '("(",*(i0,:,", "))') list
    text = trim(buffer)//')'
  end function list_text

  pure function quoted(string, option) result(text)
    character(len=*), intent(in) :: string
    type(whitespace_option), intent(in) :: option
    character(len=:), allocatable :: text

    text = '"'//string//'"'
    if (option%trimmed) text = '"'//trim(string)//'"'
  end function quoted

  pure function difference_text(expected, actual) result(text)
    type(value_type), intent(in) :: expected, actual
    character(len=:), allocatable :: text

    text = ''
    if (expected%sort == sort_logical .or. actual%sort == sort_logical) return
    if (actual%sort == sort_real) then
      text = text_of(value_type(sort_real, 0_int64, actual%real - expected%real))
    else
      text = text_of(value_type(sort_integer, actual%whole - expected%whole, 0.0_real64))
    end if
  end function difference_text

  pure function text_of(value) result(text)
    type(value_type), intent(in) :: value
    character(len=:), allocatable :: text
    character(len=32) :: buffer

    select case (value%sort)
    case (sort_integer)
      write (buffer, '(i0)') value%whole
    case (sort_real)
      write (buffer, '(es24.16e3)') value%real
    case default
      buffer = merge('true ', 'false', value%whole == 1_int64)
    end select
    text = trim(adjustl(buffer))
  end function text_of
end module funit
