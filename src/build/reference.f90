!> Ids of cards: unique in their space, and found where other cards name them.
module epcont_build_reference
  use epcont_base_sorting, only: id_index, new_id_index, sorted_order
  use epcont_base_text, only: text_of
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  implicit none
  private
  public :: index_of_ids, check_unique, resolve

contains

  !> Index of the ids in the first field of all cards of a table.
  pure function index_of_ids(deck, card) result(index)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card  !! which table
    type(id_index) :: index

    index = new_id_index(int(deck%card(card)%value(1, :)))
  end function index_of_ids

  !> Each id stands once in the first fields of these tables, which share one id space.
  subroutine check_unique(deck, cards, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: cards(:)
    type(diagnostics), intent(inout) :: faults
    integer, allocatable :: id(:), table(:), row(:), order(:)
    integer :: c, i, k, earlier

    k = sum(deck%card(cards)%count)
    allocate (id(k), table(k), row(k))
    k = 0
    do c = 1, size(cards)
      do i = 1, deck%card(cards(c))%count
        k = k + 1
        id(k) = int(deck%card(cards(c))%value(1, i))
        table(k) = cards(c)
        row(k) = i
      end do
    end do
    order = sorted_order(id)
    do k = 2, size(id)
      i = order(k)
      earlier = order(k - 1)
      if (id(i) /= id(earlier)) cycle
      if (.not. deck%card(table(i))%given(1, row(i))) cycle
      call faults%add_error(deck%place(table(i), row(i), 1), deck%identity(table(i), row(i))// &
                            ': the id is taken by '//deck%identity(table(earlier), row(earlier)), 'an id of its own')
    end do
  end subroutine check_unique

  !> Position of the card that a field names; 0, and a fault, where there is none.
  subroutine resolve(deck, card, i, column, index, wanted, faults, position)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: card, i            !! which table, which card of it
    integer, intent(in) :: column             !! the field that holds the id
    type(id_index), intent(in) :: index       !! of the cards that may be meant
    character(len=*), intent(in) :: wanted    !! their name
    type(diagnostics), intent(inout) :: faults
    integer, intent(out) :: position
    character(len=:), allocatable :: article

    position = 0
    if (.not. deck%card(card)%given(column, i)) return  ! the reader has said so
    position = index%find(int(deck%card(card)%value(column, i)))
    if (position > 0 .or. .not. deck%card(card)%sound(i)) return
    article = 'the id of a '
    if (wanted == 'element') article = 'the id of an '
    call faults%add_error(deck%place(card, i, column), deck%identity(card, i)//': '// &
                          deck%card(card)%entry%field_text(column)// &
                          ': there is no '//wanted//' '// &
                          text_of(nint(deck%card(card)%value(column, i))), article//wanted)
  end subroutine resolve
end module epcont_build_reference
