!> Bodies of a model with a linear law, and their exact contact solution: one step of every iteration.
module epcont_linear_linear_problem
  use epcont_assembly_bodies, only: factored_bodies, new_bodies
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, negligible
  use epcont_contact_neutral_motions, only: choose_neutral
  use epcont_contact_problem, only: contact_solved
  use epcont_flexibility_flexibility, only: gap_opening, terms_of_openings
  use epcont_linear_choose_rule, only: choose_rule
  use epcont_linear_contact_rule, only: contact_rule
  use epcont_linear_solved_state, only: force_change, relative_change, solved_state
  use epcont_material_model_materials, only: find_materials, model_materials
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stage_displacements, stopwatch
  implicit none
  private
  public :: linear_problem, new_linear_problem

  type, extends(factored_bodies) :: linear_problem
    type(model_materials) :: materials
    class(contact_rule), allocatable :: rule   !! contact solver
    logical, allocatable :: touching(:)        !! of the last load case: start of the next [pairs]
  contains
    procedure :: take_case
    procedure :: set_stiffness
    procedure :: solve
    procedure :: sharpen
  end type linear_problem

contains

  !> Make the parts that do not depend on the law.
  subroutine new_linear_problem(scene, plan, linear)
    type(planned_model), intent(in) :: scene       !! the model
    type(iteration_plan), intent(in) :: plan       !! may differ from that of the model
    type(linear_problem), intent(out) :: linear    !! without its law

    call find_materials(scene%model, linear%materials)
    linear%factored_bodies = new_bodies(scene)
    call choose_rule(scene, plan, linear%rule)
  end subroutine new_linear_problem

  !> Take another load case of the model, with the present factors: those of the elastic bodies.
  subroutine take_case(self, scene)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene    !! the same model, with this case

    call self%rule%see_case(scene)
    call self%rule%take_case(scene, self%factored_bodies)
  end subroutine take_case

  !> Factor the bodies if the law of their elements has changed, and prepare the contact.
  subroutine set_stiffness(self, scene, failed_body, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene    !! the same model
    integer, intent(out) :: failed_body            !! first body that could not be factored, 0 if absent
    class(stopwatch), intent(inout) :: watch    !! measures the time

    call self%rule%factor(scene, self%factored_bodies, failed_body, watch)
  end subroutine set_stiffness

  !> Find displacements, stresses and contact under the loads of the model. Without contact equilibrium
  !! (`state%contact%state`) there are no displacements.
  subroutine solve(self, scene, start, state, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! the same model
    logical, allocatable, intent(in) :: start(:)   !! guess of the pairs in contact, if allocated [pairs]
    type(solved_state), intent(inout) :: state      !! the solution
    class(stopwatch), intent(inout) :: watch       !! measures the time

    call self%rule%solve(scene, self%factored_bodies, start, state, watch)
    if (state%contact%state == contact_solved) call complete(self, scene, state)
    call state%contact%split(scene%model%contact%pairs)
    if (state%contact%state /= contact_solved) return
    call watch%lap(stage_displacements)
  end subroutine solve

  !> Take one step of iterative refinement: if a body is long and its elements are fine, rounding
  !! leaves residual forces and gaps, although the factors are in double precision.
  subroutine sharpen(self, scene, state, change, watch)
    class(linear_problem), intent(inout) :: self
    type(planned_model), intent(in) :: scene    !! the same model
    type(solved_state), intent(inout) :: state   !! unchanged if no contact is found
    real(wp), intent(out) :: change             !! of displacements and contact forces, relative
    class(stopwatch), intent(inout) :: watch    !! measures the time
    type(solved_state) :: refined
    logical :: found

    change = huge(1.0_wp)
    refined = state
    call self%rule%refine(scene, self%factored_bodies, refined, found, watch)
    if (.not. found) return
    call complete(self, scene, refined)
    call refined%contact%split(scene%model%contact%pairs)
    change = max(relative_change(state%displacement, refined%displacement, of=refined%displacement), &
                 force_change(state%contact, refined%contact, of=refined%contact))
    if (allocated(refined%point)) deallocate (refined%point)   ! belongs to the strain before
    state = refined
    call watch%lap(stage_displacements)
  end subroutine sharpen

  !> Compute stresses, displacements and gaps from deformation, strains and contact.
  subroutine complete(self, scene, state)
    type(linear_problem), intent(in) :: self
    type(planned_model), intent(in) :: scene
    type(solved_state), intent(inout) :: state
    real(wp), dimension(scene%model%contact%rows()) :: gap, rounding

    state%point_stress = self%law%stress(state%strain)
    associate (contact => state%contact, travel => self%rule%travel_gap, problem => self%rule%problem)
      gap = problem%initial_gap + (gap_opening(scene%model, state%deformation) + travel) - &
            problem%motion%times(contact%approach)
      if (any(contact%motion_free)) then
        contact%gap = merge(0.0_wp, gap, problem%between(contact%force))
        call choose_neutral(problem, contact)
        gap = contact%gap
      end if
      state%displacement = state%deformation + scene%model%loads%travel
      call scene%motions%add(scene%model, contact%approach, state%displacement)
      ! A pair without force is in contact if its gap, computed from displacements, is only rounding,
      ! even if the contact solver finds another gap from the flexibility.
      rounding = negligible*(abs(problem%initial_gap) + abs(travel) + &
                             problem%motion%times(contact%approach, magnitudes=.true.) + &
                             terms_of_openings(scene%model, state%deformation)) + &
                 rounding_of_pairs(scene, state)
      associate (n => scene%model%contact%pairs, pressed => problem%between(contact%force))
        contact%touching(:n) = pressed(:n) .or. &
                               merge(-gap(:n), gap(:n), contact%at_upper(:n)) <= rounding(:n)
      end associate
      contact%gap = merge(0.0_wp, gap, contact%touching)
    end associate
  end subroutine complete

  !> Largest rounding of displacements of the bodies at each pair [length] [pairs].
  pure function rounding_of_pairs(scene, state) result(rounding)
    type(planned_model), intent(in) :: scene
    type(solved_state), intent(in) :: state
    real(wp) :: rounding(scene%model%contact%rows())
    real(wp) :: off(0:scene%model%mesh%bodies)
    integer, allocatable :: body(:, :)
    integer :: i, k

    off = 0.0_wp
    do i = 1, scene%model%mesh%nodes
      associate (b => scene%model%mesh%body(i))
        off(b) = max(off(b), negligible*maxval(abs(state%deformation(:, i))), &
                     cancelled*maxval(abs(state%displacement(:, i))))
      end associate
    end do
    body = scene%model%bodies_of_rows()
    rounding = [(maxval(off(body(:, k))), k=1, size(rounding))]
  end function rounding_of_pairs
end module epcont_linear_linear_problem
