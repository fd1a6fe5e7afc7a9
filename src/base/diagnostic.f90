!> Faults of a deck or of a scene: what is wrong, where, and what would be right. They are collected, so that
!> one run reports them all; `epcont_deck_render` turns them into text.
module epcont_base_diagnostic
  use epcont_base_sorting, only: sorted_order
  implicit none
  private
  public :: place_type, diagnostic, diagnostics

  integer, parameter, public :: &
    severity_error = 1, &    !! the deck is rejected
    severity_warning = 2, &  !! the deck is read, but look here
    severity_note = 3        !! for the listing only

  !> A stretch of columns of one line of the deck.
  type :: place_type
    integer :: line = 0   !! index into the lines of the source, in deck order; 0: the deck as a whole
    integer :: first = 0  !! first column
    integer :: last = 0   !! last column
  end type place_type

  !> One fault.
  type :: diagnostic
    integer :: severity = severity_error
    type(place_type) :: place
    !> What it is about, where that is no place in a deck, or not yet: a card (above zero) or a part of a
    !! scene (`epcont_model_finding`), which of these, which of its data
    integer :: of = 0, which = 0, item = 0
    character(len=:), allocatable :: what    !! `GRID 17: field 4 (X1) is not a real number`
    character(len=:), allocatable :: remedy  !! `a real such as 1.5`; may be empty
    integer, allocatable :: node(:)          !! all the nodes that it is about, if these matter [any]
  end type diagnostic

  !> The faults of one deck or scene, in the order in which they were found.
  type :: diagnostics
    integer :: errors = 0, warnings = 0, notes = 0   !! how many there are of each severity
    integer :: count = 0
    type(diagnostic), allocatable :: list(:)         !! [count or more]
    !> Items that come from others: of, which, item of the first, then of the other [6, origins or more]
    integer, allocatable, private :: origin(:, :)
    integer, private :: origins = 0
  contains
    generic :: add_error => add_error_at, add_error_of
    procedure, private :: add_error_at
    procedure, private :: add_error_of
    procedure :: add_warning
    generic :: add_note => add_note_at, add_note_of
    procedure, private :: add_note_at
    procedure, private :: add_note_of
    procedure :: add
    procedure :: add_origin
    procedure :: origin_of
    procedure :: has
    procedure :: in_deck_order
  end type diagnostics

contains

  !> An error: the deck is rejected, the scene cannot be.
  pure subroutine add_error_at(self, place, what, remedy)
    class(diagnostics), intent(inout) :: self
    type(place_type), intent(in) :: place          !! where
    character(len=*), intent(in) :: what, remedy   !! is wrong, and what would be right (may be empty)

    call self%add(diagnostic(severity_error, place, what=what, remedy=remedy))
  end subroutine add_error_at

  !> The same of a card or a part of a scene.
  pure subroutine add_error_of(self, of, which, item, what, remedy)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: of, which, item         !! what it is about
    character(len=*), intent(in) :: what, remedy   !! is wrong, behind its name; would be right

    call self%add(diagnostic(severity_error, place_type(), of, which, item, what, remedy))
  end subroutine add_error_of

  !> A warning: the scene can be, but is hardly meant.
  pure subroutine add_warning(self, of, which, item, what, remedy)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: of, which, item         !! what it is about
    character(len=*), intent(in) :: what, remedy   !! is to be looked at, behind its name; would be right

    call self%add(diagnostic(severity_warning, place_type(), of, which, item, what, remedy))
  end subroutine add_warning

  !> A note: something accepted without effect, or else worth a line in the listing.
  pure subroutine add_note_at(self, place, what)
    class(diagnostics), intent(inout) :: self
    type(place_type), intent(in) :: place   !! where
    character(len=*), intent(in) :: what    !! is worth a line

    call self%add(diagnostic(severity_note, place, what=what, remedy=''))
  end subroutine add_note_at

  !> The same of a card.
  pure subroutine add_note_of(self, of, which, item, what)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: of, which, item   !! what it is about
    character(len=*), intent(in) :: what     !! is worth a line, behind its name

    call self%add(diagnostic(severity_note, place_type(), of, which, item, what, remedy=''))
  end subroutine add_note_of

  !> Behind the others; where there is no room, in a list of twice the length.
  pure subroutine add(self, fault)
    class(diagnostics), intent(inout) :: self
    type(diagnostic), intent(in) :: fault   !! of any severity
    type(diagnostic), allocatable :: longer(:)

    if (.not. allocated(self%list)) allocate (self%list(16))
    if (self%count == size(self%list)) then
      allocate (longer(2*self%count))
      longer(:self%count) = self%list
      call move_alloc(longer, self%list)
    end if
    self%count = self%count + 1
    self%list(self%count) = fault
    select case (fault%severity)
    case (severity_error)
      self%errors = self%errors + 1
    case (severity_warning)
      self%warnings = self%warnings + 1
    case default
      self%notes = self%notes + 1
    end select
  end subroutine add

  !> Note that an item comes from another one.
  pure subroutine add_origin(self, item, from)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: item(3), from(3)   !! of, which, item; of the other one

    if (.not. allocated(self%origin)) allocate (self%origin(6, 16))
    if (self%origins == size(self%origin, 2)) &   ! room doubles
      self%origin = reshape([self%origin, self%origin], [6, 2*self%origins])
    self%origins = self%origins + 1
    self%origin(:, self%origins) = [item, from]
  end subroutine add_origin

  !> What an item comes from: of, which, item; itself if nothing has been noted.
  pure function origin_of(self, item) result(from)
    class(diagnostics), intent(in) :: self
    integer, intent(in) :: item(3)   !! of, which, item
    integer :: from(3), k

    from = item
    do k = 1, self%origins
      if (all(self%origin(:3, k) == item)) from = self%origin(4:, k)
    end do
  end function origin_of

  !> The faults by line, then column, then arrival; those of the deck as a whole come last.
  pure function in_deck_order(self) result(order)
    class(diagnostics), intent(in) :: self
    integer, allocatable :: line(:), order(:)

    order = [integer ::]
    if (self%count == 0) return
    line = self%list(:self%count)%place%line
    where (line == 0) line = huge(1)
    order = sorted_order(self%list(:self%count)%place%first)
    order = order(sorted_order(line(order)))
  end function in_deck_order

  !> Is one said already, of the same place?
  pure logical function has(self, fault)
    class(diagnostics), intent(in) :: self
    type(diagnostic), intent(in) :: fault   !! of a deck, with its place
    integer :: i

    has = .false.
    do i = 1, self%count
      associate (one => self%list(i))
        has = has .or. one%place%line == fault%place%line .and. one%place%first == fault%place%first .and. &
              one%what == fault%what
      end associate
    end do
  end function has
end module epcont_base_diagnostic
