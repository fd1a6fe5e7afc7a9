!> Input and result of the contact solver.
!>
!> For n candidate pairs and m rigid-body modes of the bodies, find contact forces R, gaps w and
!> rigid-body displacements q with (3-2)..(3-5), generalised:
!>
!>     w = g0 + gl + F R - A q,   A'R = P,   w >= 0,   R >= 0,   w R = 0
!>
!> F is symmetric and semidefinite; it may be singular.
!>
!> With friction, tangential rows follow those of the pairs. Their force T is between -mu R and mu R of their
!> pair, and their gap is the slip of this load step.
module epcont_contact_problem
  use epcont_base_kinds, only: wp
  use epcont_flexibility_motion_matrix, only: motion_matrix
  implicit none
  private
  public :: contact_problem, contact_solution, new_solution

  !> State of the solution.
  integer, parameter, public :: contact_solved = 0   !! forces, gaps and approach satisfy all conditions
  !> No R >= 0 carry P: the bodies are unconstrained along `escape`.
  integer, parameter, public :: contact_no_equilibrium = 1
  !> The pairs `overlapping` are too close and nothing deforms.
  integer, parameter, public :: contact_overlap = 2
  !> No active set passed the test: inconclusive because of rounding.
  integer, parameter, public :: contact_stalled = 3

  type :: contact_problem
    real(wp), allocatable :: flexibility(:, :)  !! F, opening of pair i by a unit force at pair j [n, n]
    type(motion_matrix) :: motion               !! A, closing of the gaps by unit rigid-body modes [n, m]
    real(wp), allocatable :: initial_gap(:)     !! g0, negative: an overlap [length] [n]
    real(wp), allocatable :: load_gap(:)        !! gl, opening by the loads without contact [length] [n]
    real(wp), allocatable :: resultant(:)       !! P, load of the bodies along their rigid-body modes [m]
    !> Forces near the solution, and the gaps under loads and these forces, without modes:
    !! F is applied to the difference of forces only. Not allocated: zero [force], [length] [n]
    real(wp), allocatable :: known_force(:), known_gap(:)
    !> Displacements of the body by each unit mode: undetermined modes get the least displacements.
    !! Not allocated: the largest gap that each mode closes [length] [any, m]
    real(wp), allocatable :: travel(:, :)
    integer, allocatable :: body(:)             !! of each mode [m]
    !> Coefficient of friction and pair of each tangential row; the last rows are tangential. Not allocated:
    !! no friction [tangential rows]
    real(wp), allocatable :: friction(:)
    integer, allocatable :: pair_of(:)
    !> With friction: forces with the states that are tried first if no forces are known, for example those of
    !! the last load step; not allocated: all pairs stick [force] [n]
    real(wp), allocatable :: guess_force(:)
  contains
    procedure :: between
  end type contact_problem

  type :: contact_solution
    integer :: state = contact_stalled       !! one of the states above
    real(wp), allocatable :: force(:)        !! R [force] [n]
    real(wp), allocatable :: change(:)       !! forces minus the known forces [force] [n]
    real(wp), allocatable :: gap(:)          !! w [length] [n]
    real(wp), allocatable :: approach(:)     !! q [m]
    !> Closed pairs, with or without force; tangential rows that stick [n]
    logical, allocatable :: touching(:)
    logical, allocatable :: at_upper(:)      !! tangential rows whose force is at its upper bound [n]
    !> y with P'y > 0 and A y <= 0, if there is no equilibrium; if no set passed, with A y only slightly
    !! positive, if that is the cause [m]
    real(wp), allocatable :: escape(:)
    !> Pairs that overlap and cannot deform, or the only pairs that resist such a y [n]
    logical, allocatable :: overlapping(:)
    !> Pairs whose force is not unique: `force` is one choice of many [n]
    logical, allocatable :: indeterminate(:)
    !> Undetermined modes; `approach` is one choice of many [m]
    logical, allocatable :: motion_free(:)
    !> With friction: pairs whose state differs in another solution; not allocated if none was sought [pairs]
    logical, allocatable :: several(:)
    !> False: other solutions are possible, but were not sought because of the number of pairs
    logical :: searched = .true.
    integer :: sets = 0                      !! active sets tried by RULE JOINED, or with friction; else 0
    integer :: pivots = 0                    !! of the simplex; pairs exchanged by RULE JOINED
    integer :: restarts = 0                  !! fresh starts after a set failed the test at full load
    !> Taken out of the arrays above by `split`: force, slip and sticking of the tangential rows
    real(wp), allocatable :: friction_force(:)   !! [force] [tangential rows]
    real(wp), allocatable :: slip(:)             !! [length] [tangential rows]
    logical, allocatable :: sticking(:)          !! [tangential rows]
  contains
    procedure :: split
    procedure :: row_forces
  end type contact_solution

contains

  !> Find forces between their bounds [n].
  pure function between(self, force)
    class(contact_problem), intent(in) :: self
    real(wp), intent(in) :: force(:)
    logical :: between(size(force))

    between = force > 0.0_wp
    if (.not. allocated(self%friction)) return
    associate (n => size(force) - size(self%friction))
      between(n + 1:) = abs(force(n + 1:)) < self%friction*force(self%pair_of)
    end associate
  end function between

  !> Separate the tangential rows from those of the pairs.
  pure subroutine split(self, pairs)
    class(contact_solution), intent(inout) :: self   !! with all rows
    integer, intent(in) :: pairs                     !! number of pairs

    if (size(self%force) == pairs) return
    if (allocated(self%friction_force)) deallocate (self%friction_force, self%slip, self%sticking)
    allocate (self%friction_force, source=self%force(pairs + 1:))
    allocate (self%slip, source=self%gap(pairs + 1:))
    allocate (self%sticking, source=self%touching(pairs + 1:))
    self%force = self%force(:pairs)
    self%gap = self%gap(:pairs)
    self%touching = self%touching(:pairs)
    self%at_upper = self%at_upper(:pairs)
    self%overlapping = self%overlapping(:pairs)
    self%indeterminate = self%indeterminate(:pairs)
  end subroutine split

  !> Forces of all rows: of the pairs, then of friction [force] [n].
  pure function row_forces(self) result(force)
    class(contact_solution), intent(in) :: self
    real(wp), allocatable :: force(:)

    force = self%force
    if (allocated(self%friction_force)) force = [self%force, self%friction_force]
  end function row_forces

  !> Make a solution without contact.
  pure type(contact_solution) function new_solution(pairs, motions) result(solution)
    integer, intent(in) :: pairs, motions   !! n, m

    allocate (solution%force(pairs), solution%gap(pairs), solution%approach(motions), &
              solution%escape(motions), source=0.0_wp)
    allocate (solution%touching(pairs), solution%at_upper(pairs), solution%overlapping(pairs), &
              solution%indeterminate(pairs), solution%motion_free(motions), source=.false.)
  end function new_solution
end module epcont_contact_problem
