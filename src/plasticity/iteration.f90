!> The loop of the plastic iteration; it knows nothing of the method that it drives.
module epcont_plasticity_iteration
  use epcont_assembly_bodies, only: weak_pivot
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: solved_to
  use epcont_contact_problem, only: contact_solved, contact_stalled
  use epcont_material_linear_law, only: elastic_law
  use epcont_model_controls, only: method_newton, method_secant, precision_single
  use epcont_model_model, only: model_type
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_plasticity_iteration_error, only: error_estimator, ratio
  use epcont_linear_linear_problem, only: linear_problem, new_linear_problem
  use epcont_plasticity_method, only: plastic_method
  use epcont_plasticity_methods, only: choose_method
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_onlooker, only: iteration_record, onlooker
  use epcont_linear_scene_state, only: scene_state
  use epcont_system_stopwatch, only: stage_accuracy, stage_stiffness, stage_yielding
  implicit none
  private
  public :: followed_loads, follow_loads

  !> Displacements so many times those of the first solve, with a flat curve: nothing carries the load.
  real(wp), parameter :: far_away = 1.0e4_wp
  !> Without mixing, so many solves tell the rate; where they are more, or more is to come than so many times
  !! the last change, it is a slow one. Few, slow or mixed steps say too little of what is to come, and
  !! prescribed displacements hide it in the largest: the estimate is tested.
  integer, parameter :: few_solves = 4, many_solves = 8
  real(wp), parameter :: slow = 3.0_wp
  !> A tangent step that shows more than so many times what was estimated is no measure of it.
  real(wp), parameter :: most_doubt = 1.0e2_wp
  !> A tangent with this part of the secant matrix in it, or more, tests nothing.
  real(wp), parameter :: too_stiff = 1.0e-3_wp
  !> Changes that fall no more are rounding up to this part of the largest displacement; beyond, it has lost
  !! the answer.
  real(wp), parameter :: stagnant = 1.0e-3_wp
  !> A strain that falls by less than this part of it stays.
  real(wp), parameter :: least_fall = 1.0e-6_wp

  !> What came of the loads, and how: a state, the answer or what came nearest to one.
  type, extends(scene_state) :: followed_loads
    real(wp) :: load_factor = 0.0_wp       !! part of the loads for which the state is
    logical :: converged = .false.         !! all loads, to the tolerance of the iteration
    logical :: runs_away = .false.         !! no equilibrium: the displacements grow without end
    integer :: singular = 0                !! body that could not be factored
    logical :: lacks_memory = .false.      !! that was for want of memory
    integer :: factorizations = 0          !! of bodies
    real(wp) :: condition = 1.0_wp         !! of the stiffness, estimated in the 1-norm
    type(weak_pivot) :: weakest            !! of the stiffness
    real(wp) :: rounding_error = 0.0_wp    !! of displacements, strains and forces, relative: what single precision left
    type(iteration_record), allocatable :: history(:)   !! every solve
    integer :: unloaded = 0                !! elements whose strain fell, after yielding, as the load grew
    integer :: first_unloaded = 0          !! one of them
  end type followed_loads

  !> What the loop works on.
  type :: loop_type
    type(iteration_plan) :: plan
    class(plastic_method), allocatable :: method
    type(linear_problem), allocatable :: linear
    real(wp) :: part = 0.0_wp                         !! of the loads
    type(scene_state) :: about                        !! the state that the law is about
    integer :: yielded = 0                            !! elements that yield there
    logical, allocatable :: touching(:)               !! the last contact set: the next simplex starts from it [pairs]
    real(wp), allocatable :: force(:)                 !! the last contact forces [force] [pairs]
    logical :: stiff = .false.                        !! the scene has been factored
    logical :: elastic = .false.                      !! with the law of a state that has not yielded
    type(error_estimator) :: estimator
    real(wp) :: doubt = 1.0_wp                        !! times what was estimated is what a tangent step has shown
  end type loop_type

contains

  !> Load by load to the answer.
  subroutine follow_loads(scene, plan, linear, answer, watch)
    type(planned_scene), intent(in) :: scene
    type(iteration_plan), intent(in) :: plan
    type(linear_problem), allocatable, intent(out) :: linear   !! as the last solve left it, if there is an answer
    type(followed_loads), intent(out) :: answer
    class(onlooker), intent(inout) :: watch
    type(loop_type) :: loop
    type(scene_state), allocatable :: state
    real(wp), allocatable :: strained(:)
    logical :: converged
    integer :: step

    call begin(scene, plan, loop)
    allocate (answer%history(0), strained(scene%model%points))
    strained = 0.0_wp
    call watch%lap(stage_stiffness)
    do step = 1, plan%load_steps
      loop%part = real(step, wp)/plan%load_steps
      call iterate(scene, loop, answer, state, converged, watch)
      answer%factorizations = loop%linear%bodies%factorizations
      answer%lacks_memory = loop%linear%bodies%lacks_memory()
      if (answer%singular > 0) return
      ! Of a load that was not carried nothing is kept, if one was before.
      if (converged .or. step == 1 .or. state%contact%state /= contact_solved) call answer%take(state)
      if (answer%contact%state /= contact_solved) return
      if (converged .or. step == 1) then
        answer%load_factor = loop%part
        call loop%linear%estimate_condition(scene, answer%condition)
        answer%weakest = loop%linear%bodies%weakest()
        if (plan%precision == precision_single) &
          call loop%linear%rounding_error(scene, loop%part, answer%scene_state, answer%rounding_error)
        call watch%lap(stage_accuracy)
      end if
      if (.not. converged) exit
      if (plan%load_steps > 1) call find_unloaded(scene%model, loop, strained, answer)
      call watch%lap(stage_yielding)
    end do
    answer%converged = converged
    call move_alloc(loop%linear, linear)
  end subroutine follow_loads

  subroutine begin(scene, plan, loop)
    type(planned_scene), intent(in) :: scene
    type(iteration_plan), intent(in) :: plan
    type(loop_type), intent(out) :: loop

    loop%plan = plan
    allocate (loop%linear)
    call new_linear_problem(scene, plan, loop%linear)
    call choose_method(plan%method, loop%method)
    loop%method%volume = loop%linear%operator%volume
    allocate (loop%about%displacement(2, scene%model%nodes), loop%about%strain(4, scene%model%points), source=0.0_wp)
    if (loop%linear%materials%yields) loop%about%point = loop%linear%materials%states(loop%about%strain)
    allocate (loop%force(scene%model%pairs), source=0.0_wp)
  end subroutine begin

  !> Iterate at one load. `state` is the last, or if that is not converged the one nearest to equilibrium.
  subroutine iterate(scene, loop, answer, state, converged, watch)
    type(planned_scene), intent(in) :: scene
    type(loop_type), intent(inout) :: loop
    type(followed_loads), intent(inout) :: answer
    type(scene_state), allocatable, intent(out) :: state
    logical, intent(out) :: converged
    class(onlooker), intent(inout) :: watch
    type(scene_state), allocatable :: found
    type(iteration_record) :: now
    real(wp) :: farthest, least_residual, travel
    integer :: iteration

    converged = .false.
    least_residual = huge(1.0_wp)
    allocate (state, found)
    if (.not. loop%stiff) loop%linear%law = elastic_law(loop%linear%materials)   ! it may be a last step's tangent
    call loop%method%restart()
    call loop%estimator%restart()
    loop%doubt = 1.0_wp
    do iteration = 1, scene%model%controls%most_iterations
      call set_law(scene, loop%method, loop, answer%singular, watch)
      if (answer%singular > 0) return
      call loop%linear%solve(scene, loop%part, loop%touching, found, watch)
      if (found%contact%state /= contact_solved) then
        ! Not found about a later state, such as one beyond the limit load: what was found before is not
        ! converged.
        if (iteration == 1 .or. found%contact%state /= contact_stalled) call move_alloc(found, state)
        return
      end if
      now%load_factor = loop%part
      now%iteration = iteration
      if (loop%linear%materials%yields) found%point = loop%linear%materials%states(found%strain)
      call measure(scene%model, loop, found, now)
      call loop%estimator%estimate(loop%method%telling_steps, loop%about, found, now)
      if (now%yielded + loop%yielded == 0 .or. now%residual <= solved_to .and. now%error < 0.0_wp) then
        ! What changes is rounding, if anything.
        now%error = merge(now%change, 0.0_wp, iteration > 1)
        now%force_error = merge(now%force_change, 0.0_wp, iteration > 1)
      end if
      answer%history = [answer%history, now]
      converged = is_over(loop, answer%history)
      if (converged .and. wants_test(scene%model, loop, now)) &
        call step_by_tangent(scene, loop, answer%history, found, converged, watch)
      now = answer%history(size(answer%history))
      travel = maxval(abs(found%displacement))
      if (iteration == 1) farthest = far_away*travel
      ! A state far away is none to show: its numbers may be at the end of their range.
      answer%runs_away = .not. converged .and. scene%model%has_flat_curve() .and. travel > farthest
      if (answer%runs_away) return
      if (.not. scene%model%controls%original) loop%touching = found%contact%touching
      loop%force = found%contact%force
      loop%yielded = now%yielded
      ! Behind the last load step nothing is linearised any more.
      if (loop%linear%materials%yields .and. .not. (converged .and. loop%part >= 1.0_wp)) &
        call loop%method%advance(scene%model, loop%linear%materials, loop%part, found, loop%about)
      call watch%lap(stage_yielding)
      call watch%solved(now, converged)
      if (converged .or. now%residual <= least_residual) then
        least_residual = now%residual
        call move_alloc(found, state)
        if (converged) return
        if (allocated(state%point)) deallocate (state%point)
        allocate (found)
      end if
    end do
  end subroutine iterate

  !> The law about the last state, and the stiffness for it. `singular` is a body without any that can be
  !! factored.
  subroutine set_law(scene, method, loop, singular, watch)
    type(planned_scene), intent(in) :: scene
    class(plastic_method), intent(inout) :: method
    type(loop_type), intent(inout) :: loop
    integer, intent(out) :: singular
    class(onlooker), intent(inout) :: watch
    logical :: possible

    singular = 0
    if (loop%linear%materials%yields) call method%linearise(loop%linear%materials, loop%about, loop%linear%law)
    call watch%lap(stage_yielding)
    if (loop%stiff .and. (method%keeps_stiffness .or. loop%elastic .and. loop%yielded == 0)) return
    loop%elastic = loop%yielded == 0
    do
      call loop%linear%set_stiffness(scene, singular, watch)
      loop%stiff = .true.
      if (singular == 0 .or. loop%linear%bodies%lacks_memory() .or. .not. loop%linear%materials%yields) return
      call method%stiffen(loop%linear%materials, loop%about, loop%linear%law, possible)
      if (.not. possible) return
    end do
  end subroutine set_law

  !> How far the state found is from the last, and its stresses from the curve. Equilibrium and contact are
  !! exact in each solve: that distance is all that is left of the scene's equations.
  pure subroutine measure(model, loop, found, now)
    type(model_type), intent(in) :: model
    type(loop_type), intent(in) :: loop
    type(scene_state), intent(in) :: found
    type(iteration_record), intent(inout) :: now
    logical, allocatable :: yielded(:)
    integer :: p

    now%change = ratio(maxval(abs(found%displacement - loop%about%displacement)), maxval(abs(found%displacement)))
    now%force_change = 0.0_wp
    if (model%pairs > 0) now%force_change = ratio(maxval(abs(found%contact%force - loop%force)), maxval(found%contact%force))
    now%touching = count(found%contact%touching)
    now%pivots = found%contact%pivots
    now%pivot = found%contact%history
    now%yielded = 0
    now%residual = 0.0_wp
    if (.not. loop%linear%materials%yields) return
    allocate (yielded(model%elements), source=.false.)
    do p = 1, model%points
      associate (e => model%point_element(p), m => loop%linear%materials)
        if (.not. m%section(m%of_point(p))%law%yields) cycle
        yielded(e) = yielded(e) .or. found%point(p)%yielded
        now%residual = max(now%residual, &
                           m%section(m%of_point(p))%law%distance(found%point(p), found%point_stress(:, p)))
      end associate
    end do
    now%yielded = count(yielded)
  end subroutine measure

  !> Is the iteration over? It is when displacements neither change nor are estimated to be off by more than
  !! the tolerance. Where nothing has yielded, the first solve was exact; and where stresses are on their
  !! curves to rounding while the changes fall no more, rounding allows no smaller ones.
  pure logical function is_over(loop, history)
    type(loop_type), intent(in) :: loop
    type(iteration_record), intent(in) :: history(:)   !! to this iteration
    integer :: n

    n = size(history)
    associate (now => history(n))
      is_over = now%yielded + loop%yielded == 0
      if (now%change <= loop%plan%tolerance .and. now%residual <= loop%plan%off_curve) &
        is_over = is_over .or. now%residual <= solved_to .or. &
                  now%error >= 0.0_wp .and. loop%doubt*now%error <= loop%plan%tolerance
      if (now%iteration > 3 .and. now%residual <= solved_to .and. now%change <= stagnant) &
        is_over = is_over .or. now%change >= history(n - 2)%change
    end associate
  end function is_over

  !> Is the estimate of what is to come to be tested, and is there a tangent to test it with?
  pure logical function wants_test(model, loop, now)
    type(model_type), intent(in) :: model
    type(loop_type), intent(in) :: loop
    type(iteration_record), intent(in) :: now

    wants_test = loop%plan%method /= method_secant .or. now%iteration <= few_solves .or. now%iteration > many_solves &
                 .or. now%error > slow*now%change .or. any(model%prescribed /= 0.0_wp)
    wants_test = wants_test .and. now%residual > solved_to
    wants_test = wants_test .and. loop%plan%method /= method_newton .and. .not. model%controls%paper_ratio
  end function wants_test

  !> The last step is one by the tangent, whose change is what was left. If that is more than the tolerance,
  !! all is as it was before, but for the doubt in estimates.
  subroutine step_by_tangent(scene, loop, history, found, holds, watch)
    type(planned_scene), intent(in) :: scene
    type(loop_type), intent(inout) :: loop
    type(iteration_record), allocatable, intent(inout) :: history(:)
    type(scene_state), allocatable, intent(inout) :: found
    logical, intent(out) :: holds
    class(onlooker), intent(inout) :: watch
    type(newton_method) :: tangent
    type(scene_state), allocatable :: next
    type(scene_state) :: about
    type(iteration_record) :: now
    integer :: singular

    holds = .false.
    if (history(size(history))%iteration == scene%model%controls%most_iterations) return
    about = loop%about
    now = history(size(history))
    now%iteration = now%iteration + 1
    now%change = huge(1.0_wp)
    loop%about = found
    loop%force = found%contact%force
    loop%yielded = now%yielded
    allocate (next)
    call set_law(scene, tangent, loop, singular, watch)
    if (singular == 0 .and. tangent%blended() < too_stiff) then
      call loop%linear%solve(scene, loop%part, found%contact%touching, next, watch)
      if (next%contact%state == contact_solved) then
        next%point = loop%linear%materials%states(next%strain)
        call measure(scene%model, loop, next, now)
      end if
    end if
    holds = now%change <= loop%plan%tolerance .and. now%residual <= loop%plan%off_curve
    if (holds) then
      now%error = now%change
      now%force_error = now%force_change
      now%by_tangent = .true.
      history = [history, now]
      call move_alloc(next, found)
    else
      loop%doubt = max(2.0_wp*loop%doubt, min(now%change/history(size(history))%error, most_doubt))
      loop%about = about
      loop%linear%law = elastic_law(loop%linear%materials)
    end if
    loop%stiff = .false.
  end subroutine step_by_tangent

  !> Elements beyond yield whose strain falls as the load grows: total theory takes them back along the curve.
  pure subroutine find_unloaded(model, loop, strained, answer)
    type(model_type), intent(in) :: model
    type(loop_type), intent(in) :: loop
    real(wp), intent(inout) :: strained(:)    !! e of the points that yielded in the last load step, else 0 [points]
    type(followed_loads), intent(inout) :: answer
    logical, allocatable :: fell(:)
    integer :: p

    allocate (fell(model%elements), source=.false.)
    do p = 1, model%points
      associate (e => model%point_element(p), now => answer%point(p))
        fell(e) = fell(e) .or. now%deviatoric < (1.0_wp - max(loop%plan%tolerance, least_fall))*strained(p)
        strained(p) = merge(now%deviatoric, 0.0_wp, now%yielded)
      end associate
    end do
    answer%unloaded = answer%unloaded + count(fell)
    if (answer%first_unloaded == 0) answer%first_unloaded = findloc(fell, .true., dim=1)
  end subroutine find_unloaded
end module epcont_plasticity_iteration
