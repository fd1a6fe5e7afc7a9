!> A contact rule: how the contact of bodies with a linear law is found. The plan chooses one
!> (`linear/choose_rule.f90`); the others call it without asking which one it is.
module epcont_linear_contact_rule
  use epcont_assembly_bodies, only: factored_bodies
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem
  use epcont_flexibility_flexibility, only: gap_opening, see_motions
  use epcont_linear_solved_state, only: solved_state
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stopwatch
  implicit none
  private
  public :: contact_loads, contact_rule, contact_sensitivity

  !> A unit load along each of some rigid-body modes, then gaps that shrink by the share of each pair in a sum
  !> of forces. Pairs in contact stay so, the others open.
  type :: contact_loads
    integer, allocatable :: motion(:)      !! the modes [assessed modes]
    real(wp), allocatable :: share(:, :)   !! of each pair in each sum [pairs, sums]
    logical :: sound = .false.             !! the forces below are unique
    real(wp), allocatable :: force(:, :)   !! at each pair under each load [force] [pairs, loads]
    !> Largest force under each load; 0: nothing is asked of it [force] [loads]
    real(wp), allocatable :: unit(:)
    !> Change of each sum by a unit load along each mode of the model [modes, sums]
    real(wp), allocatable :: shared(:, :)
    !> Under each load; not allocated if the rule finds no displacements with the forces [length]
    !> [directions, loads, nodes]
    real(wp), allocatable :: displacement(:, :, :)
  contains
    procedure :: ask_for
  end type contact_loads

  !> What errors of the stiffness and of the gaps do to the contact forces.
  type :: contact_sensitivity
    logical :: known = .false.
    !> Relative error of the forces / relative error of the flexibility, at most
    real(wp) :: amplification = 0.0_wp
    real(wp) :: rounding = 0.0_wp        !! what rounding may leave in a force, of the largest
  end type contact_sensitivity

  type, abstract :: contact_rule
    type(contact_problem) :: problem   !! its gaps and motions; F if the rule has one
    real(wp), allocatable :: travel_gap(:)   !! opened by prescribed rigid-body displacements [length] [pairs]
    real(wp), allocatable :: resultant(:)    !! of all loads along the rigid-body modes [motions]
    integer :: threads = 1             !! that share the work
    logical :: keeps = .false.         !! the bodies cannot yield, and a load case may follow
    logical :: explains = .true.       !! it can say why there is no answer, and which forces are not unique
    logical :: failed = .false.        !! to find a contact in this load case
  contains
    procedure, non_overridable :: see_case
    procedure(take_case), deferred :: take_case
    procedure(factor), deferred :: factor
    procedure(solve), deferred :: solve
    procedure :: refine
    procedure :: is_unique
    procedure(respond), deferred :: respond
    procedure(sensitivity), deferred :: sensitivity
    procedure(compliance), deferred :: compliance
  end type contact_rule

  abstract interface
    !> Another load case, seen before, with the factors of the case before.
    subroutine take_case(self, scene, bodies)
      import :: contact_rule, factored_bodies, planned_model
      class(contact_rule), intent(inout) :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies
    end subroutine take_case

    !> Factor the bodies as far as their law has changed, and prepare the contact.
    subroutine factor(self, scene, bodies, failed_body, watch)
      import :: contact_rule, factored_bodies, planned_model, stopwatch
      class(contact_rule), intent(inout) :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies
      integer, intent(out) :: failed_body            !! first body that could not be factored; 0: all could
      class(stopwatch), intent(inout) :: watch       !! takes the time
    end subroutine factor

    !> Find contact, deformation and strains under a part of the loads, or why there is no contact.
    subroutine solve(self, scene, bodies, load_factor, start, state, watch)
      import :: contact_rule, factored_bodies, planned_model, solved_state, stopwatch, wp
      class(contact_rule), intent(inout) :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies
      real(wp), intent(in) :: load_factor            !! of the loads
      logical, allocatable, intent(in) :: start(:)   !! guess of the pairs in contact, if allocated [pairs]
      type(solved_state), intent(inout) :: state
      class(stopwatch), intent(inout) :: watch
    end subroutine solve

    !> Find forces under unit loads, and what the sensitivity depends on. The pairs in contact stay so.
    subroutine respond(self, scene, bodies, state, loads, known)
      import :: contact_loads, contact_rule, factored_bodies, planned_model, solved_state
      class(contact_rule), intent(inout), target :: self
      type(planned_model), intent(in) :: scene
      class(factored_bodies), intent(inout) :: bodies   !! as the last solve left them
      class(solved_state), intent(in) :: state          !! the answer, with some contact
      type(contact_loads), intent(inout) :: loads       !! with motions and shares
      logical, intent(in) :: known   !! the forces, since the last load case had the same contacts
    end subroutine respond

    !> How much errors of the stiffness and of the gaps change the contact forces, after `respond`.
    function sensitivity(self, state, condition) result(found)
      import :: contact_rule, contact_sensitivity, solved_state, wp
      class(contact_rule), intent(inout), target :: self
      class(solved_state), intent(in) :: state      !! the answer
      real(wp), intent(in) :: condition             !! of the stiffness
      type(contact_sensitivity) :: found
    end function sensitivity

    !> Opening of each pair by a unit force of its own, about [length/force] [pairs].
    pure function compliance(self)
      import :: contact_rule, wp
      class(contact_rule), intent(in) :: self
      real(wp), allocatable :: compliance(:)
    end function compliance
  end interface

contains

  !> What loads and supports of the model's load case do to gaps and rigid-body modes.
  subroutine see_case(self, scene)
    class(contact_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene

    self%travel_gap = gap_opening(scene%model, scene%model%loads%travel)
    call see_motions(scene%model, scene%motions, self%problem%motion, self%resultant)
  end subroutine see_case

  !> Take one step of iterative refinement. A rule whose steps end where nothing changes gains nothing by it.
  subroutine refine(self, scene, bodies, load_factor, state, refined, watch)
    class(contact_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    real(wp), intent(in) :: load_factor
    type(solved_state), intent(inout) :: state   !! contact, deformation and strain
    logical, intent(out) :: refined              !! false: there is nothing to gain, or no contact
    class(stopwatch), intent(inout) :: watch

    refined = .false.
  end subroutine refine

  !> Are the contact forces the only ones? A rule that can say which ones are not unique need not know.
  logical function is_unique(self, scene, bodies)
    class(contact_rule), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies

    is_unique = .true.
  end function is_unique

  !> Say which loads are asked for; loads without forces tell nothing.
  pure subroutine ask_for(self, asked)
    class(contact_loads), intent(inout) :: self
    logical, intent(in) :: asked(:)   !! [loads]

    self%unit = merge(maxval(abs(self%force), dim=1), 0.0_wp, asked .and. any(self%force /= 0.0_wp, dim=1))
  end subroutine ask_for
end module epcont_linear_contact_rule
