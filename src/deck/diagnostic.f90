!> Faults of a deck: what is wrong, where, and what would be right. They are collected, so that one
!> run reports them all; `epcont_deck_render` turns them into text.
module epcont_deck_diagnostic
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
    character(len=:), allocatable :: what    !! `GRID 17: field 4 (X1) is not a real number`
    character(len=:), allocatable :: remedy  !! `a real such as 1.5`; may be empty
  end type diagnostic

  !> The faults of one deck, in the order in which they were found.
  type :: diagnostics
    private
    integer :: count = 0
    integer :: counts(3) = 0  !! by severity
    type(diagnostic), allocatable :: list(:)
  contains
    procedure :: add_error
    procedure :: add_warning
    procedure :: add_note
    procedure :: error_count
    procedure :: warning_count
    procedure :: note_count
    procedure :: in_deck_order
    procedure :: item
  end type diagnostics

contains

  !> An error: the deck is rejected.
  subroutine add_error(self, place, what, remedy)
    class(diagnostics), intent(inout) :: self
    type(place_type), intent(in) :: place   !! where
    character(len=*), intent(in) :: what, remedy   !! is wrong, and what would be right (may be empty)

    call add(self, diagnostic(severity_error, place, what, remedy))
  end subroutine add_error

  !> A warning: the deck is read all the same.
  subroutine add_warning(self, place, what, remedy)
    class(diagnostics), intent(inout) :: self
    type(place_type), intent(in) :: place   !! where
    character(len=*), intent(in) :: what, remedy !! is to be looked at, and what would be right (may be empty)

    call add(self, diagnostic(severity_warning, place, what, remedy))
  end subroutine add_warning

  !> A note: something accepted without effect, or else worth a line in the listing.
  subroutine add_note(self, place, what)
    class(diagnostics), intent(inout) :: self
    type(place_type), intent(in) :: place   !! where
    character(len=*), intent(in) :: what   !! is worth a line

    call add(self, diagnostic(severity_note, place, what, ''))
  end subroutine add_note

  subroutine add(self, fault)
    type(diagnostics), intent(inout) :: self
    type(diagnostic), intent(in) :: fault
    type(diagnostic), allocatable :: longer(:)

    if (.not. allocated(self%list)) allocate (self%list(16))
    if (self%count == size(self%list)) then
      allocate (longer(2*self%count))
      longer(:self%count) = self%list
      call move_alloc(longer, self%list)
    end if
    self%count = self%count + 1
    self%list(self%count) = fault
    self%counts(fault%severity) = self%counts(fault%severity) + 1
  end subroutine add

  !> How many errors there are.
  pure integer function error_count(self)
    class(diagnostics), intent(in) :: self

    error_count = self%counts(severity_error)
  end function error_count

  !> How many warnings.
  pure integer function warning_count(self)
    class(diagnostics), intent(in) :: self

    warning_count = self%counts(severity_warning)
  end function warning_count

  !> How many notes.
  pure integer function note_count(self)
    class(diagnostics), intent(in) :: self

    note_count = self%counts(severity_note)
  end function note_count

  !> The faults by line, then column, then arrival; those of the deck as a whole come last.
  pure function in_deck_order(self) result(order)
    class(diagnostics), intent(in) :: self
    integer, allocatable :: order(:)
    integer, allocatable :: line(:), column(:)

    order = [integer ::]
    if (self%count == 0) return
    line = self%list(:self%count)%place%line
    where (line == 0) line = huge(1)
    column = self%list(:self%count)%place%first
    order = sorted_order(column)
    order = order(sorted_order(line(order)))
  end function in_deck_order

  !> The fault that arrived as number `i`.
  pure function item(self, i) result(fault)
    class(diagnostics), intent(in) :: self
    integer, intent(in) :: i   !! in the order of arrival
    type(diagnostic) :: fault

    fault = self%list(i)
  end function item
end module epcont_deck_diagnostic
