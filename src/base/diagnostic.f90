!> Errors, warnings and notes about a deck or a model. They are collected, so that one run reports all of
!> them; `epcont_deck_render` makes their text.
module epcont_base_diagnostic
  use epcont_base_sorting, only: sorted_order
  implicit none
  private
  public :: place_type, diagnostic, diagnostics

  integer, parameter, public :: &
    severity_error = 1, &    !! the deck is rejected
    severity_warning = 2, &  !! the deck is accepted, but is probably not meant so
    severity_note = 3        !! only in the listing

  !> Columns of one line of the deck.
  type :: place_type
    integer :: line = 0   !! index of the line in the source, in deck order; 0: the deck as a whole
    integer :: first = 0  !! first column
    integer :: last = 0   !! last column
  end type place_type

  !> An error, a warning or a note.
  type :: diagnostic
    integer :: severity = severity_error
    type(place_type) :: place
    !> Subject, if it has no columns in a deck yet: card (positive) or part of a model
    !! (`epcont_model_finding`), its number, and the number of its item
    integer :: of = 0, which = 0, item = 0
    character(len=:), allocatable :: what    !! `GRID 17: field 4 (X1) is not a real number`
    character(len=:), allocatable :: remedy  !! an imperative; may be empty
  end type diagnostic

  !> All findings about a deck or model, in the order in which they were found.
  type :: diagnostics
    integer :: errors = 0, warnings = 0, notes = 0   !! number of each severity
    integer :: count = 0
    type(diagnostic), allocatable :: list(:)         !! [count or more]
    !> Items and their origins: of, which, item of each [6, origins or more]
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
    procedure :: in_deck_order
  end type diagnostics

contains

  !> Add an error at columns of the deck.
  pure subroutine add_error_at(self, place, what, remedy)
    class(diagnostics), intent(inout) :: self
    type(place_type), intent(in) :: place          !! columns
    character(len=*), intent(in) :: what, remedy   !! fault and remedy (may be empty)

    call self%add(diagnostic(severity_error, place, what=what, remedy=remedy))
  end subroutine add_error_at

  !> Add an error of a card or a part of a model.
  pure subroutine add_error_of(self, of, which, item, what, remedy)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: of, which, item         !! subject
    character(len=*), intent(in) :: what, remedy   !! fault, after the name of the subject; remedy

    call self%add(diagnostic(severity_error, place_type(), of, which, item, what, remedy))
  end subroutine add_error_of

  !> Add a warning: the model is possible, but probably not meant.
  pure subroutine add_warning(self, of, which, item, what, remedy)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: of, which, item         !! subject
    character(len=*), intent(in) :: what, remedy   !! finding, after the name of the subject; remedy

    call self%add(diagnostic(severity_warning, place_type(), of, which, item, what, remedy))
  end subroutine add_warning

  !> Add a note: input without effect, or a fact for the listing.
  pure subroutine add_note_at(self, place, what)
    class(diagnostics), intent(inout) :: self
    type(place_type), intent(in) :: place   !! columns
    character(len=*), intent(in) :: what    !! fact

    call self%add(diagnostic(severity_note, place, what=what, remedy=''))
  end subroutine add_note_at

  !> Add a note about a card.
  pure subroutine add_note_of(self, of, which, item, what)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: of, which, item   !! subject
    character(len=*), intent(in) :: what     !! fact, after the name of the subject

    call self%add(diagnostic(severity_note, place_type(), of, which, item, what, remedy=''))
  end subroutine add_note_of

  !> Append a finding. If the list is full, its length is doubled.
  pure subroutine add(self, fault)
    class(diagnostics), intent(inout) :: self
    type(diagnostic), intent(in) :: fault   !! any severity
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

  !> Record that an item was made from another one.
  pure subroutine add_origin(self, item, from)
    class(diagnostics), intent(inout) :: self
    integer, intent(in) :: item(3), from(3)   !! of, which, item of both

    if (.not. allocated(self%origin)) allocate (self%origin(6, 16))
    if (self%origins == size(self%origin, 2)) &   ! double the size
      self%origin = reshape([self%origin, self%origin], [6, 2*self%origins])
    self%origins = self%origins + 1
    self%origin(:, self%origins) = [item, from]
  end subroutine add_origin

  !> Origin of an item: of, which, item; the item itself if no origin is recorded.
  pure function origin_of(self, item) result(from)
    class(diagnostics), intent(in) :: self
    integer, intent(in) :: item(3)   !! of, which, item
    integer :: from(3), k

    from = item
    do k = 1, self%origins
      if (all(self%origin(:3, k) == item)) from = self%origin(4:, k)
    end do
  end function origin_of

  !> Order of the findings: by line, column, and arrival; those about the whole deck come last.
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
end module epcont_base_diagnostic
