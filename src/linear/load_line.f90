!> Prediction for successive load cases that are multiples of the same loads. While the contacts stay,
!> their states are on one line, and two of them give the next.
module epcont_linear_load_line
  use epcont_base_kinds, only: wp
  use epcont_linear_solved_state, only: solved_state
  implicit none
  private
  public :: load_line, multiple_of

  !> Rounding by the factors of load cases.
  real(wp), parameter :: rounding = 4.0_wp*epsilon(1.0_wp)

  type :: load_line
    type(solved_state), allocatable :: last     !! last solution
    real(wp), allocatable, private :: before(:, :), force(:), approach(:)   !! the earlier state on the line
    real(wp), allocatable, private :: load(:, :)   !! of the load case [force] [directions, nodes]
    !> The case's load over that of `last`, that of the earlier state over that; 0: not on one line
    real(wp), private :: times = 0.0_wp, times_before = 0.0_wp
  contains
    procedure :: take_load
    procedure :: keep
    procedure :: next
  end type load_line

contains

  !> Take the loads of another case.
  pure subroutine take_load(self, load)
    class(load_line), intent(inout) :: self
    real(wp), intent(in) :: load(:, :)   !! [force] [directions, nodes]

    self%times = 0.0_wp
    if (allocated(self%last)) self%times = multiple_of(load, self%load)
    self%load = load
  end subroutine take_load

  !> Keep the solution of the case, and the state before if it is on the line.
  pure subroutine keep(self, state)
    class(load_line), intent(inout) :: self
    type(solved_state), intent(in) :: state

    self%times_before = 0.0_wp
    if (allocated(self%last) .and. self%times /= 0.0_wp .and. self%times /= 1.0_wp) then
      self%before = self%last%deformation
      self%force = self%last%contact%force
      self%approach = self%last%contact%approach
      self%times_before = 1.0_wp/self%times
    end if
    self%times = 0.0_wp
    self%last = state
  end subroutine keep

  !> Predict from the last two states; return the last one if there is no line.
  pure function next(self) result(state)
    class(load_line), intent(in) :: self
    type(solved_state) :: state
    real(wp) :: share

    state = self%last
    if (self%times == 0.0_wp .or. self%times_before == 0.0_wp) return
    share = (self%times - 1.0_wp)/(1.0_wp - self%times_before)
    state%deformation = state%deformation + share*(state%deformation - self%before)
    state%contact%force = state%contact%force + share*(state%contact%force - self%force)
    state%contact%approach = state%contact%approach + share*(state%contact%approach - self%approach)
  end function next

  !> Factor between two fields of forces; 0 if they are not multiples.
  pure real(wp) function multiple_of(force, of) result(times)
    real(wp), intent(in) :: force(:, :), of(:, :)   !! [force] [directions, nodes]
    integer :: at(2)

    times = 0.0_wp
    at = maxloc(abs(of))
    if (of(at(1), at(2)) == 0.0_wp) return
    times = force(at(1), at(2))/of(at(1), at(2))
    if (any(abs(force - times*of) > rounding*abs(force(at(1), at(2))))) times = 0.0_wp
  end function multiple_of
end module epcont_linear_load_line
