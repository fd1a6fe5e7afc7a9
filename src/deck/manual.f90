!> Print the manual of the cards from the catalogue with which the reader checks them.
module epcont_deck_manual
  use epcont_base_text, only: newline, text_of, upper
  use epcont_deck_card_kinds, only: card_kinds, card_param
  use epcont_deck_catalogue, only: catalogue, parameters
  use epcont_deck_entry, only: card_entry, field_entry, fields_a_line, kind_any, kind_blank, kind_real, &
      number_of
  implicit none
  private
  public :: manual

  !> Contents of fields, by their kinds.
  character(len=7), parameter :: kind_name(5) = ['integer', 'real   ', 'digits ', 'word   ', 'any    ']

contains

  !> One line for each card, or all about the card `name`; empty if there is no such card. Each line ends with
  !! a newline.
  function manual(name) result(text)
    character(len=*), intent(in) :: name  !! blank for all cards
    character(len=:), allocatable :: text
    type(card_entry) :: entry(card_kinds)
    integer :: k

    entry = catalogue()
    text = ''
    do k = 1, card_kinds
      if (name == '') then
        text = text//entry(k)%name//'  '//entry(k)%meaning//newline
      else if (entry(k)%name == upper(name)) then
        text = card_text(entry(k))
        if (k == card_param) text = text//parameter_text()
      end if
    end do
  end function manual

  !> Describe one card.
  function card_text(entry) result(text)
    type(card_entry), intent(in) :: entry
    character(len=:), allocatable :: text
    type(field_entry), allocatable :: field(:)
    integer :: k, slot

    text = trim(entry%name)//': '//entry%meaning//newline//newline// &
           'use: used; ignored (checked, no effect); blank (must be blank)'//newline//newline// &
           'field  columns  name     kind     default  use      meaning [unit], range'//newline
    field = entry%field
    if (entry%list_slot == huge(1)) &   ! the rest of its last line must be blank
      field = [field, (field_entry(), slot=1, modulo(-size(field), fields_a_line))]
    do slot = 1, size(field)
      if (field(slot)%kind == kind_blank) then
        call add_row('', '', '', '', 'blank', 'must be blank')
      else
        call add_field('', field(slot)%name, field(slot))
      end if
    end do
    if (allocated(entry%record)) then
      do k = 1, size(entry%record)
        call add_field('..', trim(entry%record(k)%name)//'1 ..', entry%record(k))
        slot = slot + 1
      end do
    else if (allocated(entry%list_name)) then
      call add_row('..', entry%list_name//'1..', 'integer', 'none', 'used', &
                   entry%list_meaning//', as many as needed: each a whole number from 1 to 99999999')
    end if

  contains

    !> Add the line of a field.
    subroutine add_field(more, name, field)
      character(len=*), intent(in) :: more   !! text after the number of the field
      character(len=*), intent(in) :: name
      type(field_entry), intent(in) :: field

      call add_row(more, name, kind_name(field%kind), default_text(field), &
                   merge('used   ', 'ignored', field%used), meaning_text(field))
    end subroutine add_field

    !> Add the line of a slot. Columns are those of a small field, counted on its own line of the card.
    subroutine add_row(more, name, kind, default, use, meaning)
      character(len=*), intent(in) :: more   !! text after the number of the field
      character(len=*), intent(in) :: name, kind, default, use, meaning
      character(len=52) :: head
      integer :: first

      first = 9 + 8*mod(slot - 1, 8)
      write (head, '(i0, a, t8, i0, "-", i0, t17, a, t26, a, t35, a, t44, a)') &
        number_of(slot), more, first, first + 7, name, kind, default, use
      text = text//head//meaning//newline
    end subroutine add_row

    !> Meaning of a blank: a value, another field, an error (`none`), or `blank` if it has a meaning of its
    !! own.
    pure function default_text(field) result(text)
      type(field_entry), intent(in) :: field
      character(len=:), allocatable :: text

      text = 'blank'
      if (field%has_default) &
        text = text_of(nint(field%default))//merge('.0', '  ', field%kind == kind_real)
      if (field%same_as /= 0) text = entry%field_name(slot + field%same_as)
      if (field%required) text = 'none'
    end function default_text

    pure function meaning_text(field) result(text)
      type(field_entry), intent(in) :: field
      character(len=:), allocatable :: text

      text = trim(field%meaning)
      if (field%unit /= '') text = text//' ['//trim(field%unit)//']'
      if (field%kind /= kind_any) text = text//'; '//field%allowed()
    end function meaning_text
  end function card_text

  !> Describe the parameters of PARAM.
  function parameter_text() result(text)
    character(len=:), allocatable :: text
    type(field_entry), allocatable :: field(:)
    integer :: i

    text = newline//'NAME      VALUE'//newline
    field = parameters()
    do i = 1, size(field)
      text = text//field(i)%name//'  '//field(i)%allowed()//': '//trim(field(i)%meaning)//newline
    end do
  end function parameter_text
end module epcont_deck_manual
