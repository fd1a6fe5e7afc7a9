!> Contact solver for bodies with a linear material law. The plan chooses one
!> (`linear/choose_rule.f90`); callers do not depend on which one it is.
module epcont_linear_contact_rule
  use epcont_assembly_bodies, only: factored_bodies
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem, contact_solution
  use epcont_flexibility_flexibility, only: gap_opening, see_motions
  use epcont_linear_solved_state, only: solved_state
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stopwatch
  implicit none
  private
  public :: contact_loads, contact_rule, contact_sensitivity

  !> Unit loads along some rigid-body modes, then gaps that shrink by the weight of each pair in a sum
  !> of forces. Pairs in contact stay closed, the others open.
  type :: contact_loads
    integer, allocatable :: motion(:)      !! the modes [assessed modes]
    real(wp), allocatable :: share(:, :)   !! weight of each row in each sum [rows, sums]
    logical :: sound = .false.             !! the forces below are unique
    real(wp), allocatable :: force(:, :)   !! of each row under each load [force] [rows, loads]
    !> Largest force under each load; 0: the load is not needed [force] [loads]
    real(wp), allocatable :: unit(:)
    !> Change of each sum by a unit load along each mode of the model [modes, sums]
    real(wp), allocatable :: shared(:, :)
    !> Under each load; not allocated if the contact solver computes only the forces [length]
    !> [directions, loads, nodes]
    real(wp), allocatable :: displacement(:, :, :)
  contains
    procedure :: ask_for
  end type contact_loads

  !> Sensitivity of the contact forces to errors of the stiffness and of the gaps.
  type :: contact_sensitivity
    logical :: known = .false.
    !> Upper bound of relative error of the forces / relative error of the flexibility
    real(wp) :: amplification = 0.0_wp
    real(wp) :: rounding = 0.0_wp        !! upper bound of rounding in a force, over the largest
  end type contact_sensitivity

  type, abstract :: contact_rule
    type(contact_problem) :: problem   !! its gaps and modes; F if the contact solver has one
    real(wp), allocatable :: travel_gap(:)   !! opened by prescribed rigid-body displacements [length] [pairs]
    real(wp), allocatable :: resultant(:)    !! of all loads along the rigid-body modes [modes]
    integer :: threads = 1             !! number of threads
    logical :: keeps = .false.         !! all bodies are elastic, and a load case may follow
    logical :: explains = .true.       !! it reports why there is no solution, and which forces are not unique
    logical :: failed = .false.        !! no contact found in this load case
  contains
    procedure, non_overridable :: see_case
    procedure(take_case), deferred :: take_case
    procedure(factor), deferred :: factor
    procedure(solve), deferred :: solve
    procedure :: refine
    procedure :: is_unique
    procedure :: find_others
    procedure(respond), deferred :: respond
    procedure(sensitivity), deferred :: sensitivity
    procedure(compliance), deferred :: compliance
  end type contact_rule

  abstract interface
    !> Take another known load case, with the factors of the case before.
    subroutine take_case(self, scene, bodies)
      import :: contact_rule, factored_bodies, planned_model
      class(contact_rule), intent(inout) :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies
    end subroutine take_case

    !> Factor the bodies whose law has changed, and prepare the contact.
    subroutine factor(self, scene, bodies, failed_body, watch)
      import :: contact_rule, factored_bodies, planned_model, stopwatch
      class(contact_rule), intent(inout) :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies
      integer, intent(out) :: failed_body            !! first body that could not be factored, 0 if absent
      class(stopwatch), intent(inout) :: watch       !! measures the time
    end subroutine factor

    !> Find contact, deformation and strains under the loads, or why there is no contact.
    subroutine solve(self, scene, bodies, start, state, watch)
      import :: contact_rule, factored_bodies, planned_model, solved_state, stopwatch
      class(contact_rule), intent(inout) :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies
      logical, allocatable, intent(in) :: start(:)   !! guess of the pairs in contact, if allocated [pairs]
      type(solved_state), intent(inout) :: state
      class(stopwatch), intent(inout) :: watch
    end subroutine solve

    !> Find forces under unit loads, and the data of the sensitivity. The pairs in contact stay closed.
    subroutine respond(self, scene, bodies, state, loads, known)
      import :: contact_loads, contact_rule, factored_bodies, planned_model, solved_state
      class(contact_rule), intent(inout), target :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies   !! as after the last solve
      class(solved_state), intent(in) :: state          !! the solution, with some contact
      type(contact_loads), intent(inout) :: loads       !! with modes and weights
      logical, intent(in) :: known   !! the forces are known from a load case with the same contacts
    end subroutine respond

    !> Compute the sensitivity of the contact forces to errors of the stiffness and gaps, after `respond`.
    function sensitivity(self, state, condition) result(found)
      import :: contact_rule, contact_sensitivity, solved_state, wp
      class(contact_rule), intent(inout), target :: self
      class(solved_state), intent(in) :: state      !! the solution
      real(wp), intent(in) :: condition             !! of the stiffness
      type(contact_sensitivity) :: found
    end function sensitivity

    !> Opening of each pair by a unit force on it, approximately [length/force] [pairs].
    pure function compliance(self)
      import :: contact_rule, wp
      class(contact_rule), intent(in) :: self
      real(wp), allocatable :: compliance(:)
    end function compliance
  end interface

contains

  !> Compute the effect of loads and supports of the load case on gaps and rigid-body modes.
  subroutine see_case(self, scene)
    class(contact_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene

    self%problem%initial_gap = [scene%model%contact%initial_gap, -scene%model%contact%slipped]
    self%travel_gap = gap_opening(scene%model, scene%model%loads%travel)
    call see_motions(scene%model, scene%motions, self%problem%motion, self%resultant)
  end subroutine see_case

  !> Take one step of iterative refinement, unless the solver's own iteration has already converged.
  subroutine refine(self, scene, bodies, state, refined, watch)
    class(contact_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    type(solved_state), intent(inout) :: state   !! contact, deformation and strain
    logical, intent(out) :: refined              !! false: no step was taken, or no contact found
    class(stopwatch), intent(inout) :: watch

    refined = .false.
  end subroutine refine

  !> Are the contact forces unique? Not needed from a solver that reports which forces are not unique.
  logical function is_unique(self, scene, bodies)
    class(contact_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies

    is_unique = .true.
  end function is_unique

  !> Search for other answers with friction, if this solver can.
  subroutine find_others(self, contact)
    class(contact_rule), intent(inout) :: self
    type(contact_solution), intent(inout) :: contact   !! the answer; pairs at which others differ are marked

  end subroutine find_others

  !> Choose the loads that are needed; loads without forces give no information.
  pure subroutine ask_for(self, asked)
    class(contact_loads), intent(inout) :: self
    logical, intent(in) :: asked(:)   !! [loads]

    self%unit = merge(maxval(abs(self%force), dim=1), 0.0_wp, asked .and. any(self%force /= 0.0_wp, dim=1))
  end subroutine ask_for
end module epcont_linear_contact_rule
