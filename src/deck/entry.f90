!> Catalogue entries of cards and of their fields.
module epcont_deck_entry
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  implicit none
  private
  public :: field_entry, card_entry, listed, new_field, number_of

  !> Kinds of fields.
  integer, parameter, public :: &
    kind_blank = 0, kind_integer = 1, kind_real = 2, kind_components = 3, kind_word = 4, kind_any = 5
  !> The largest id.
  integer, parameter, public :: largest_id = 99999999
  !> Data fields on one line: fields 2 to 9, then 12 to 19, and so on.
  integer, parameter, public :: fields_a_line = 8

  !> Magnitudes of numbers that have an effect. They are at most `farthest`. Numbers that may not be zero are
  !! at least `least_divisor`. Loads of a model (force, pressure, prescribed displacement, gap) are zero or at
  !! least `least_cause`. So the work of the loads is a finite number, although it is a square of loads over
  !! stiffnesses, areas and lengths of `farthest`, or the rounding left by cancelling loads.
  real(wp), parameter, public :: farthest = 1.0e30_wp, least_divisor = 1.0e-30_wp, least_cause = 1.0e-60_wp

  !> A field of a card, or a PARAM, as made by `new_field`.
  type :: field_entry
    character(len=8) :: name = ''
    integer :: kind = kind_blank       !! default: must be blank
    character(len=180) :: meaning = ''
    character(len=8) :: unit = ''
    logical :: used = .true.           !! false: ignored, that is, accepted without effect
    real(wp) :: heard_to = huge(1.0_wp)   !! larger values are ignored too
    logical :: required = .false.      !! a blank field is an error
    integer :: with(2) = 0             !! required if the previous (-1) or next (1) field is filled
    integer :: same_as = 0             !! a blank field has the value of the previous field (-1)
    real(wp) :: default = 0.0_wp       !! value of a blank field
    logical :: has_default = .false.   !! false: a blank has a meaning of its own
    real(wp) :: lowest = -huge(1.0_wp), highest = huge(1.0_wp)
    logical :: above_lowest = .false., below_highest = .false.  !! the limit itself is out of range
    real(wp) :: least = 0.0_wp           !! smallest magnitude, except zero, of a number that has an effect
    logical :: point_optional = .false.  !! the decimal point may be missing
    character(len=40) :: choices = ''    !! allowed words, separated by blanks; blank: any word
    character(len=60) :: reason = ''     !! why other values are out of range
    integer :: times = 1                 !! number of such fields in a row
  contains
    procedure :: allowed
  end type field_entry

  !> A card: its fields, and a list of ids or records that may follow them.
  type :: card_entry
    character(len=8) :: name = ''
    character(len=:), allocatable :: meaning
    type(field_entry), allocatable :: field(:)   !! in their order [slots]
    integer :: list_slot = huge(1)   !! first slot of the list; beyond all slots if there is no list
    logical :: has_ranges = .false.              !! the list may contain `G1 THRU G2`
    logical :: has_steps = .false.               !! ranges may decrease, or have a step (`BY`)
    character(len=:), allocatable :: list_name, list_meaning   !! name and meaning of a list of ids
    !> Fields of a record such as `X1 Y1 X2 Y2 ..`, and the word after the last record
    type(field_entry), allocatable :: record(:)
    character(len=4) :: end_word = ''            !! blank: the list ends with the card
    integer :: records_a_line = 0   !! records on a line; 0: records may continue on the next line
  contains
    procedure :: field_name
    procedure :: field_text
    procedure :: record_slot
  end type card_entry

contains

  !> Position of the n-th data field in a card. Positions 10, 11, 20, 21, ... hold continuation marks.
  elemental integer function number_of(slot)
    integer, intent(in) :: slot

    number_of = 10*((slot - 1)/fields_a_line) + mod(slot - 1, fields_a_line) + 2
  end function number_of

  !> Name of the field in a slot; empty if it has no name.
  pure function field_name(self, slot) result(name)
    class(card_entry), intent(in) :: self
    integer, intent(in) :: slot
    character(len=:), allocatable :: name
    integer :: k, r

    name = ''
    k = slot - self%list_slot
    if (k >= 0 .and. allocated(self%record)) then
      r = 1
      do while (self%record_slot(r + 1) <= slot)
        r = r + 1
      end do
      k = slot - self%record_slot(r) + 1
      if (k <= size(self%record)) name = trim(self%record(k)%name)//text_of(r)
    else if (k >= 0) then
      name = self%list_name//text_of(k + 1)
    else if (slot <= size(self%field)) then
      name = trim(self%field(slot)%name)
    end if
  end function field_name

  !> First slot of a record of the list.
  pure integer function record_slot(self, record) result(slot)
    class(card_entry), intent(in) :: self
    integer, intent(in) :: record   !! number of the record, from 1

    associate (fields => size(self%record), n => self%records_a_line)
      slot = self%list_slot + (record - 1)*fields
      if (n > 0) slot = self%list_slot + (record - 1)/n*fields_a_line + mod(record - 1, n)*fields
    end associate
  end function record_slot

  !> Name of the field in a slot for messages: `field 4 (X1)`.
  pure function field_text(self, slot) result(text)
    class(card_entry), intent(in) :: self
    integer, intent(in) :: slot
    character(len=:), allocatable :: text

    text = 'field '//text_of(number_of(slot))
    if (len(self%field_name(slot)) > 0) text = text//' ('//self%field_name(slot)//')'
  end function field_text

  !> Read a field from its line in the catalogue: `name; contents; meaning [unit] | reason`. Contents are an
  !! `id` (at least 1), a `system` (0 or an id), a `whole` number, a `real`, `digits` (directions 1 to 6), a
  !! `word` (one of the listed words, if there are any), `any`, or `blank`. Attributes follow in any order:
  !! limits (`from=`, `to=`, or `below=`); `positive`; `only_zero` (0 or
  !! blank); `cause` (a load of the model); `ignored` (checked only; also above `heard_to=`);
  !! `point_optional`. A blank means `zero`, `default=`, or the value of the
  !! previous field (`as_last`). A blank is allowed for ids and digits if they are `optional` or their
  !! neighbour (`with_next`, `with_last`) is blank, and for numbers unless they are `needed`. `times=` repeats
  !! the field. The catalogue itself reads `each`.
  type(field_entry) function new_field(line) result(field)
    character(len=*), intent(in) :: line   !! line of the catalogue
    character(len=48) :: form   ! words that are still to be read
    character(len=len(line)) :: rest
    character(len=:), allocatable :: word
    integer :: behind, first, second
    logical :: may_be_blank

    first = index(line, ';')
    second = first + index(line(first + 1:), ';')
    field%name = adjustl(line(:first - 1))
    form = adjustl(line(first + 1:second - 1))
    rest = adjustl(line(second + 1:))
    behind = index(rest, '|')
    if (behind > 0) field%reason = adjustl(rest(behind + 1:))
    behind = index(rest, '[')
    if (behind > 0) field%unit = rest(behind + 1:index(rest, ']') - 1)
    field%meaning = rest(:scan(rest//'|', '[|') - 1)
    may_be_blank = .true.
    do while (form /= '')
      word = form(:index(form, ' ') - 1)
      form = adjustl(form(len(word) + 1:))
      call take_word()
    end do
    field%required = field%required .or. .not. (may_be_blank .or. any(field%with /= 0))

  contains

    !> Apply one word of the attributes.
    subroutine take_word()
      integer :: equals
      real(wp) :: number   ! number after the word

      equals = index(word//'=', '=')
      if (equals < len(word)) read (word(equals + 1:), *) number
      select case (word(:equals - 1))
      case ('id', 'system')
        field%kind = kind_integer
        field%lowest = merge(1.0_wp, 0.0_wp, word == 'id')
        field%highest = largest_id
        may_be_blank = word /= 'id'
      case ('whole')
        field%kind = kind_integer
      case ('real')
        field%kind = kind_real
      case ('digits')
        field%kind = kind_components
        may_be_blank = .false.
      case ('any')
        field%kind = kind_any
      case ('word')
        field%kind = kind_word
        field%choices = form(:len(field%choices))
        field%required = .true.
        form = ''
      case ('from')
        field%lowest = number
      case ('to', 'below')
        field%highest = number
        field%below_highest = word(:equals - 1) == 'below'
      case ('times')
        field%times = nint(number)
      case ('default')
        field%default = number
        field%has_default = .true.
      case ('positive')
        field%lowest = 0.0_wp
        field%above_lowest = .true.
        field%least = least_divisor
      case ('only_zero')
        field%lowest = 0.0_wp
        field%highest = 0.0_wp
        field%has_default = .true.
      case ('zero')
        field%has_default = .true.
      case ('cause')
        field%least = least_cause
      case ('ignored')
        field%used = .false.
      case ('heard_to')
        field%heard_to = number
      case ('point_optional')
        field%point_optional = .true.
      case ('as_last')
        field%same_as = -1
      case ('with_next')
        field%with(2) = 1
      case ('with_last')
        field%with(1) = -1
      case ('needed')
        field%required = .true.
      case ('optional')
        may_be_blank = .true.
      end select
    end subroutine take_word
  end function new_field

  !> Allowed values in words: `a real above 0.0`.
  pure function allowed(self) result(text)
    class(field_entry), intent(in) :: self
    character(len=:), allocatable :: text

    select case (self%kind)
    case (kind_integer)
      text = 'a whole number from '//text_of(nint(self%lowest))//' to '//text_of(nint(self%highest))
      if (self%lowest >= self%highest) text = text_of(nint(self%lowest))//' or blank'
    case (kind_real)
      text = real_range(self)
    case (kind_components)
      text = 'digits from 1 to 6, each at most once'
    case (kind_word)
      text = listed(trim(self%choices))
      if (text == '') text = 'a word of at most 8 characters, first a letter'
    case default
      text = 'anything'
    end select
    if (self%reason /= '') text = text//': '//trim(self%reason)
  end function allowed

  pure function real_range(self) result(text)
    type(field_entry), intent(in) :: self
    character(len=:), allocatable :: text
    logical :: lower, upper

    lower = self%lowest > -huge(1.0_wp)
    upper = self%highest < huge(1.0_wp)
    if (.not. (lower .or. upper)) then
      text = 'a real such as 1.5, 1.5E-3 or 1.5-3'
    else if (self%lowest >= self%highest) then
      text = short_real(self%lowest)//' or blank'
    else
      text = 'a real'
      if (lower) text = text//trim(merge(' above', ' from ', self%above_lowest))//' '//short_real(self%lowest)
      if (upper) &
        text = text//trim(merge(' to below', ' to      ', self%below_highest))//' '//short_real(self%highest)
    end if
  end function real_range

  !> Join words: `AUTO, CONRY or JOINED`.
  pure function listed(words) result(text)
    character(len=*), intent(in) :: words
    character(len=:), allocatable :: text
    integer :: at

    at = index(words, ' ', back=.true.)
    text = words
    if (at > 0) text = words(:at - 1)//' or '//words(at + 1:)
    do at = at - 1, 1, -1
      if (words(at:at) == ' ') text = text(:at - 1)//','//text(at:)
    end do
  end function listed
end module epcont_deck_entry
