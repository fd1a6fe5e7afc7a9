!> Bulk data: check each card field by field against the catalogue, and store it in its table.
module epcont_deck_bulk
  use epcont_base_diagnostic, only: diagnostics
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of, upper
  use epcont_deck_card, only: card_fields, continues, find_name, gather
  use epcont_deck_card_kinds, only: card_kinds, card_param
  use epcont_deck_card_reader, only: read_card
  use epcont_deck_case_control, only: keyword
  use epcont_deck_catalogue, only: catalogue, parameters
  use epcont_deck_entry, only: card_entry, field_entry, kind_word
  use epcont_deck_field, only: scan_sound, scan_word
  use epcont_deck_refused, only: refused_card
  use epcont_deck_source, only: source
  use epcont_deck_spelling, only: suggestion
  use epcont_deck_table, only: card_table
  implicit none
  private
  public :: read_bulk

  !> Kinds of lines other than those of known cards.
  integer, parameter :: no_card = 0, unknown_card = card_kinds + 1

contains

  !> Read the cards, beginning with line `first`.
  subroutine read_bulk(lines, first, table, faults)
    type(source), intent(in) :: lines   !! of the deck
    integer, intent(in) :: first                              !! first line after case control
    type(card_table), allocatable, intent(out) :: table(:)    !! cards of each kind [card_kinds]
    type(diagnostics), intent(inout) :: faults   !! errors and notes are added
    type(card_entry) :: entry(card_kinds)
    type(card_fields) :: card
    type(field_entry), allocatable :: parameter_entry(:)
    character(len=8) :: names(card_kinds)
    integer, allocatable :: kind(:, :)   ! kind of the card that begins on each line [1, lines]
    type(incidence) :: begun             ! lines on which the cards of each kind begin
    integer :: next(card_kinds)          ! for each kind, the card that the next line may begin
    integer :: errors, k, line

    entry = catalogue()
    names = entry%name
    parameter_entry = parameters()
    call find_kinds(lines, first, names, kind)
    begun = new_incidence(kind, unknown_card)
    allocate (table(card_kinds))
    do k = 1, card_kinds
      call table(k)%begin(entry(k), begun%of(k))
    end do
    next = 1
    do line = first, lines%count
      k = kind(1, line)
      if (k == no_card) cycle
      errors = faults%errors
      call gather(lines, line, card, faults)
      if (k == unknown_card) then
        if (card%sound) call refuse_name(first, card, names, faults)
        cycle
      end if
      call table(k)%begin_list(next(k))
      if (k == card_param .and. card%sound) &
        call choose_parameter(card, parameter_entry, table(k)%entry%field(2), faults)
      if (faults%errors == errors) call read_card(card, table(k), next(k), faults)
      table(k)%sound(next(k)) = faults%errors == errors
      next(k) = next(k) + 1
    end do
    do k = 1, card_kinds
      call note_fields(lines, table(k), faults)
    end do
  end subroutine read_bulk

  !> Find the kind of the card that begins on each line. Cards with the same name are usually consecutive.
  subroutine find_kinds(lines, first, names, kind)
    type(source), intent(in) :: lines
    integer, intent(in) :: first
    character(len=*), intent(in) :: names(:)
    integer, allocatable, intent(inout) :: kind(:, :)
    character(len=8) :: name, before
    logical :: is_first, large
    integer :: at, comma, found, from, to

    allocate (kind(1, lines%count), source=no_card)
    is_first = .true.
    before = ''
    found = unknown_card   ! a card without a name
    do at = first, lines%count
      if (lines%blank(at)) cycle
      associate (text => lines%text(lines%line(at)%first:lines%line(at)%last))
        if (continues(text) .and. .not. is_first) cycle
        is_first = .false.
        comma = 0
        if (lines%line(at)%special <= lines%line(at)%last) comma = index(text, ',')
        call find_name(text, comma, from, to, large)
        name = text(from:min(to, from + 7))
        if (name /= before) found = findloc([names, upper(name)] == upper(name), .true., dim=1)
        before = name
        kind(1, at) = found
      end associate
    end do
  end subroutine find_kinds

  !> Report a card whose name is not in the catalogue.
  subroutine refuse_name(first, card, names, faults)
    integer, intent(in) :: first
    type(card_fields), intent(in) :: card
    character(len=*), intent(in) :: names(:)
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: name, remedy, why, word

    name = upper(card%text(card%name_first:card%name_last))
    if (scan(card%text(1:1), '+*') > 0 .or. name == '') then
      call faults%add_error(card%place(0), 'a continuation line without a card before it', &
                            'begin with the name of a card')
      return
    end if
    word = name(:scan(name//' ', ' =(;') - 1)
    call refused_card(name, why, remedy)
    if (len(why) > 0) then
      call faults%add_error(card%place(0), name//' is not supported:'//why, remedy)
      return
    end if
    remedy = suggestion(name, names, 'epcont --cards lists the cards that are read')
    if (any(names == word)) remedy = 'use fields of 8 columns, or commas'
    if (first == 1 .and. any(keyword == word) .or. word == 'BEGIN') &
      remedy = 'write one line BEGIN BULK after case control'
    call faults%add_error(card%place(0), 'unknown card '//name, remedy)
  end subroutine refuse_name

  !> Find the PARAM and its possible values. A malformed name gets any word as its value; an unknown name is
  !! an error.
  subroutine choose_parameter(card, parameter_entry, value_entry, faults)
    type(card_fields), intent(in) :: card
    type(field_entry), intent(in) :: parameter_entry(:)
    type(field_entry), intent(out) :: value_entry
    type(diagnostics), intent(inout) :: faults
    character(len=8) :: word
    integer :: outcome, i

    value_entry = field_entry('VALUE', kind_word, required=.true.)
    if (.not. card%filled(1)) return
    call scan_word(card%text(card%slot(1)%first:card%slot(1)%last), word, outcome)
    if (outcome /= scan_sound) return
    i = findloc(parameter_entry%name == word, .true., dim=1)
    if (i > 0) then
      value_entry = parameter_entry(i)
      value_entry%name = 'VALUE'
      value_entry%used = .true.
      if (.not. parameter_entry(i)%used) &
        call faults%add_note(card%place(1), 'PARAM '//trim(word)//' has no effect')
    else
      call faults%add_error(card%place(1), 'unknown parameter '//trim(word), &
                            suggestion(word, parameter_entry%name, &
                                       'epcont --cards PARAM lists the parameters'))
    end if
  end subroutine choose_parameter

  !> Report once each field that is filled but has no effect.
  subroutine note_fields(lines, cards, faults)
    type(source), intent(in) :: lines
    type(card_table), intent(in) :: cards
    type(diagnostics), intent(inout) :: faults
    type(card_fields) :: card
    type(diagnostics) :: unheard
    logical, allocatable :: noted(:)
    integer :: slot

    do slot = 1, size(cards%given, 1)
      associate (field => cards%entry%field(slot))
        if (field%used .and. field%heard_to == huge(1.0_wp)) cycle
        noted = cards%given(slot, :) .and. (.not. field%used .or. cards%value(slot, :) > field%heard_to)
      end associate
      if (.not. any(noted)) cycle
      call gather(lines, cards%line(findloc(noted, .true., dim=1)), card, unheard)
      call faults%add_note(card%place(slot), trim(cards%entry%name)//': '// &
                           cards%entry%field_text(slot)//' has no effect (cards with it: '// &
                           text_of(count(noted))//')')
    end do
  end subroutine note_fields
end module epcont_deck_bulk
