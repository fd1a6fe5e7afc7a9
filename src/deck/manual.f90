!> The manual of the cards, printed from the catalogue that the reader checks by.
module epcont_deck_manual
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card_kinds, only: card_kinds, card_param
  use epcont_deck_catalogue, only: catalogue, parameters
  use epcont_deck_entry, only: card_entry, field_entry, fields_a_line, kind_any, kind_blank, kind_real, number_of
  implicit none
  private
  public :: manual

  character(len=*), parameter :: newline = new_line('a')
  !> What fields hold, by their kinds.
  character(len=7), parameter :: kind_name(5) = ['integer', 'real   ', 'digits ', 'word   ', 'any    ']

contains

  !> The cards in one line each, or all about the card `name`. `found` is false where there is no such card.
  !! Each line is ended by a newline.
  function manual(name, found) result(text)
    character(len=*), intent(in) :: name  !! blank: all cards
    logical, intent(out) :: found   !! there is such a card
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
    character(len=:), allocatable :: text, number
    integer :: slot, last

    text = trim(entry%name)//': '//entry%meaning//newline//newline
    text = text//row('field', 'columns', 'name', 'kind', 'default', 'use', 'meaning [unit], range')
    last = fields_a_line*((size(entry%field) + fields_a_line - 1)/fields_a_line)
    do slot = 1, min(last, entry%list_slot - 1)
      text = text//field_row(entry, slot)
    end do
    if (.not. allocated(entry%list_name)) return
    number = text_of(number_of(entry%list_slot))//'..'
    if (entry%has_points) then
      text = text//row(number, columns(entry%list_slot), 'X1 ..', 'real', 'none', 'used', entry%list_meaning)
    else
      text = text//row(number, columns(entry%list_slot), entry%list_name//'1..', 'integer', 'none', 'used', &
                       entry%list_meaning//', as many as needed: each a whole number from 1 to 99999999')
    end if
  end function card_text

  !> One field of a card.
  function field_row(entry, slot) result(text)
    type(card_entry), intent(in) :: entry
    integer, intent(in) :: slot
    character(len=:), allocatable :: text, number

    number = text_of(number_of(slot))
    text = row(number, columns(slot), '', '', '', 'blank', 'must be blank')
    if (slot > size(entry%field)) return
    associate (field => entry%field(slot))
      if (field%kind /= kind_blank) &
        text = row(number, columns(slot), field%name, kind_name(field%kind), default_text(entry, slot), &
                   merge('used ', 'noted', field%used), meaning_text(field))
    end associate
  end function field_row

  !> The parameters that PARAM may set.
  function parameter_text() result(text)
    character(len=:), allocatable :: text
    type(field_entry), allocatable :: field(:)
    integer :: i

    field = parameters()
    text = newline//'NAME      VALUE'//newline
    do i = 1, size(field)
      text = text//field(i)%name//'  '//field(i)%allowed()//': '//trim(field(i)%meaning)//newline
    end do
  end function parameter_text

  !> One line of the table.
  pure function row(field, columns, name, kind, default, use, meaning) result(text)
    character(len=*), intent(in) :: field, columns, name, kind, default, use, meaning
    character(len=:), allocatable :: text
    character(len=48) :: head

    write (head, '(a, t8, a, t17, a, t24, a, t33, a, t42, a)') field, columns, name, kind, default, use
    text = head//meaning//newline
  end function row

  !> Columns of a small field; those of a continuation line are counted on that line.
  pure function columns(slot) result(text)
    integer, intent(in) :: slot
    character(len=:), allocatable :: text
    integer :: first

    first = 9 + 8*mod(slot - 1, 8)
    text = text_of(first)//'-'//text_of(first + 7)
  end function columns

  !> What a blank means: a value, another field, nothing that would do, or `blank` where it has a meaning of
  !! its own.
  pure function default_text(entry, slot) result(text)
    type(card_entry), intent(in) :: entry
    integer, intent(in) :: slot
    character(len=:), allocatable :: text

    associate (field => entry%field(slot))
      if (field%required) then
        text = 'none'
      else if (field%same_as /= 0) then
        text = entry%field_name(slot + field%same_as)
      else if (field%has_default) then
        text = text_of(nint(field%default))
        if (field%kind == kind_real) text = text//'.0'
      else
        text = 'blank'
      end if
    end associate
  end function default_text

  pure function meaning_text(field) result(text)
    type(field_entry), intent(in) :: field
    character(len=:), allocatable :: text

    text = trim(field%meaning)
    if (field%unit /= '') text = text//' ['//trim(field%unit)//']'
    if (field%kind /= kind_any) text = text//'; '//field%allowed()
  end function meaning_text
end module epcont_deck_manual
