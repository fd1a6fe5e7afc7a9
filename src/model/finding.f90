!> What is wrong with a scene, or looks so: collected, so that one look finds all of it. Of a scene made from
!> arrays the first error is told in a sentence; of one made from a deck everything has its place among the
!> cards.
module epcont_model_finding
  use epcont_base_text, only: text_of
  implicit none
  private
  public :: finding, findings, and_more

  !> What a finding is of, by its position in the model; above zero are cards of a deck. PARAM MUP is one of
  !! its own; a body, by one of its nodes, is named in what is said of it.
  integer, parameter, public :: of_scene = 0, of_node = -1, of_element = -2, of_section = -3, of_pair = -4, &
    of_line = -5, of_couple = -6, of_paper_ratio = -7, of_body = -8

  !> How grave it is.
  integer, parameter, public :: found_error = 1, found_warning = 2, found_note = 3

  !> One of them.
  type :: finding
    integer :: severity = found_error
    integer :: of = of_scene
    integer :: which = 0                     !! of these
    !> Of its data, as the fields of its card: 0 all, 1 the id; -k: the k-th of its list
    integer :: item = 0
    character(len=:), allocatable :: what    !! goes on behind its name: `: lies on the axis`
    character(len=:), allocatable :: remedy  !! what would be right
    integer, allocatable :: node(:)          !! all the nodes that it is about, if these matter [any]
  end type finding

  !> All of them, in the order in which they were found.
  type :: findings
    integer :: errors = 0                    !! those of the deck's reader may be counted in before
    integer :: count = 0
    type(finding), allocatable :: list(:)    !! [count or more]
  contains
    procedure :: add_error
    procedure :: add_warning
    procedure :: add_note
  end type findings

contains

  !> The scene cannot be.
  pure subroutine add_error(self, of, which, item, what, remedy)
    class(findings), intent(inout) :: self
    integer, intent(in) :: of               !! a kind of things, see above
    integer, intent(in) :: which            !! of these
    integer, intent(in) :: item             !! of its data
    character(len=*), intent(in) :: what    !! behind its name
    character(len=*), intent(in) :: remedy   !! what would be right

    self%errors = self%errors + 1
    call add(self, finding(found_error, of, which, item, what, remedy))
  end subroutine add_error

  !> The scene can be, but is hardly meant.
  pure subroutine add_warning(self, of, which, item, what, remedy)
    class(findings), intent(inout) :: self
    integer, intent(in) :: of, which, item        !! as above
    character(len=*), intent(in) :: what, remedy  !! as above

    call add(self, finding(found_warning, of, which, item, what, remedy))
  end subroutine add_warning

  !> Worth a line in the listing.
  pure subroutine add_note(self, of, which, item, what)
    class(findings), intent(inout) :: self
    integer, intent(in) :: of, which, item        !! as above
    character(len=*), intent(in) :: what          !! as above

    call add(self, finding(found_note, of, which, item, what, ''))
  end subroutine add_note

  !> Behind the others; where there is no room, in a list of twice the length.
  pure subroutine add(self, one)
    type(findings), intent(inout) :: self
    type(finding), intent(in) :: one
    type(finding), allocatable :: longer(:)

    if (.not. allocated(self%list)) allocate (self%list(16))
    if (self%count == size(self%list)) then
      allocate (longer(2*self%count))
      longer(:self%count) = self%list
      call move_alloc(longer, self%list)
    end if
    self%count = self%count + 1
    self%list(self%count) = one
  end subroutine add

  !> How many more there are than the one that is named: `; so do 3 more`; empty where it is the only one.
  pure function and_more(count, before, behind) result(text)
    integer, intent(in) :: count                    !! all, the one included
    character(len=*), intent(in) :: before, behind  !! words around the number
    character(len=:), allocatable :: text

    text = ''
    if (count > 1) text = before//text_of(count - 1)//behind
  end function and_more
end module epcont_model_finding
