!> The manual of the cards, printed from the catalogue that the reader checks by.
module epcont_deck_manual
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card_kinds, only: card_kinds, card_param
  use epcont_deck_catalogue, only: catalogue, parameters
  use epcont_deck_entry, only: card_entry, field_entry, kind_any, kind_components, kind_integer, kind_real, number_of, &
                               slot_of
  implicit none
  private
  public :: manual

  character(len=*), parameter :: newline = new_line('a')

contains

  !> The cards in one line each, or all about the card `name`. `found` is false where there is no such card.
  !! Each line is ended by a newline.
  function manual(name, found) result(text)
    character(len=*), intent(in) :: name  !! blank: all cards
    logical, intent(out) :: found
    character(len=:), allocatable :: text
    type(card_entry) :: entry(card_kinds)
    integer :: k

    entry = catalogue()
    text = ''
    found = name == ''
    do k = 1, card_kinds
      if (name == '') then
        text = text//entry(k)%name//'  '//entry(k)%meaning//newline
      else if (entry(k)%name == upper(name)) then
        found = .true.
        text = card_text(entry(k))
        if (k == card_param) text = text//parameter_text()
      end if
    end do
  end function manual

  !> All about one card.
  function card_text(entry) result(text)
    type(card_entry), intent(in) :: entry
    character(len=:), allocatable :: text
    integer :: slot

    text = trim(entry%name)//': '//entry%meaning//newline//newline
    text = text//row('field', 'columns', 'name', 'kind', 'default', 'use', 'meaning [unit], range')
    do slot = 1, last_slot(entry)
      text = text//field_text(entry, slot)
    end do
    if (entry%has_points) then
      slot = slot_of(entry%list_number)
      text = text//row(text_of(entry%list_number)//'..', columns(slot), 'X1 ..', 'real', 'none', 'used', entry%list_meaning)
    else if (entry%list_number > 0) then
      slot = slot_of(entry%list_number)
      text = text//row(text_of(entry%list_number)//'..', columns(slot), entry%list_name//'1..', 'integer', 'none', 'used', &
                       entry%list_meaning//', as many as needed: each a whole number from 1 to 99999999')
    end if
  end function card_text

  !> The last slot to be told of, the list not counted: the end of the line on which the last field is.
  pure integer function last_slot(entry)
    type(card_entry), intent(in) :: entry

    last_slot = 8*((size(entry%column_at) + 7)/8)
    if (entry%list_number > 0) last_slot = slot_of(entry%list_number) - 1
  end function last_slot

  !> One field of a card.
  function field_text(entry, slot) result(text)
    type(card_entry), intent(in) :: entry
    integer, intent(in) :: slot
    character(len=:), allocatable :: text
    integer :: column

    column = 0
    if (slot <= size(entry%column_at)) column = entry%column_at(slot)
    if (column == 0) then
      text = row(text_of(number_of(slot)), columns(slot), '', '', '', 'blank', 'must be blank')
    else
      associate (field => entry%field(column))
        text = row(text_of(field%number), columns(slot), trim(field%name), kind_text(field), default_text(entry, field), &
                   trim(merge('used ', 'noted', field%used)), meaning_text(field))
      end associate
    end if
  end function field_text

  !> The parameters that PARAM may set.
  function parameter_text() result(text)
    character(len=:), allocatable :: text
    type(field_entry), allocatable :: field(:)
    integer :: i

    field = parameters()
    text = newline//'NAME      VALUE'//newline
    do i = 1, size(field)
      text = text//field(i)%name//'  '//field(i)%allowed()//': '//field(i)%meaning//newline
    end do
  end function parameter_text

  !> One line of the table.
  pure function row(field, columns, name, kind, default, use, meaning) result(text)
    character(len=*), intent(in) :: field, columns, name, kind, default, use, meaning
    character(len=:), allocatable :: text
    character(len=46) :: head

    write (head, '(a5, 2x, a7, 2x, a6, 1x, a7, 2x, a7, 2x, a5)') &
      padded(field, 5), padded(columns, 7), padded(name, 6), padded(kind, 7), padded(default, 7), padded(use, 5)
    text = head//'  '//meaning//newline
  end function row

  pure function padded(word, width)
    character(len=*), intent(in) :: word
    integer, intent(in) :: width
    character(len=width) :: padded

    padded = word
  end function padded

  !> Columns of a small field; those of a continuation line are counted on that line.
  pure function columns(slot) result(text)
    integer, intent(in) :: slot
    character(len=:), allocatable :: text
    integer :: first

    first = 9 + 8*mod(slot - 1, 8)
    text = text_of(first)//'-'//text_of(first + 7)
  end function columns

  pure function kind_text(field) result(text)
    type(field_entry), intent(in) :: field
    character(len=:), allocatable :: text

    select case (field%kind)
    case (kind_integer)
      text = 'integer'
    case (kind_real)
      text = 'real'
    case (kind_components)
      text = 'digits'
    case (kind_any)
      text = 'any'
    case default
      text = 'word'
    end select
  end function kind_text

  !> What a blank means: a value, another field, nothing that would do, or `blank` where it has a meaning of its own.
  pure function default_text(entry, field) result(text)
    type(card_entry), intent(in) :: entry
    type(field_entry), intent(in) :: field
    character(len=:), allocatable :: text

    if (field%required) then
      text = 'none'
    else if (field%same_as > 0) then
      text = entry%field_name(field%same_as)
    else if (field%has_default) then
      text = text_of(nint(field%default))
      if (field%kind == kind_real) text = text//'.0'
    else
      text = 'blank'
    end if
  end function default_text

  pure function meaning_text(field) result(text)
    type(field_entry), intent(in) :: field
    character(len=:), allocatable :: text

    text = field%meaning
    if (len(field%unit) > 0) text = text//' ['//field%unit//']'
    if (field%kind /= kind_any) text = text//'; '//field%allowed()
  end function meaning_text
end module epcont_deck_manual
