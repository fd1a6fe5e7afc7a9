!> The loop of the plastic iteration; it knows nothing of the method that it drives.
module epcont_plasticity_iteration
  use epcont_assembly_bodies, only: weak_pivot
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_solved, contact_stalled
  use epcont_material_linear_law, only: elastic_law, linear_law
  use epcont_material_scene_materials, only: find_materials, scene_materials
  use epcont_model_controls, only: method_newton, method_secant, precision_single
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_numbering, only: numbering_type
  use epcont_plasticity_iteration_error, only: error_estimator, ratio
  use epcont_plasticity_linear_scene, only: linear_scene, new_linear_scene
  use epcont_plasticity_method, only: plastic_method
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_onlooker, only: iteration_record, onlooker
  use epcont_plasticity_scene_state, only: scene_state
  use epcont_system_stopwatch, only: stage_accuracy, stage_stiffness, stage_yielding
  implicit none
  private
  public :: plastic_run, follow_loads

  !> Displacements so many times those of the first solve, with a flat curve: nothing carries the load.
  real(wp), parameter :: far_away = 1.0e4_wp
  !> Stresses this near to their curves are on them but for rounding.
  real(wp), parameter :: rounding = 1.0e-10_wp
  !> Without mixing, so many solves tell the rate; where they are more, or more is to come than so many times the last change,
  !! it is a slow one. Few, slow or mixed steps say too little of what is to come, and prescribed displacements hide it in the
  !! largest: the estimate is tested.
  integer, parameter :: few_solves = 4, many_solves = 8
  real(wp), parameter :: slow = 3.0_wp
  !> A tangent step that shows more than so many times what was estimated is no measure of it.
  real(wp), parameter :: most_doubt = 1.0e2_wp
  !> A tangent with this part of the secant matrix in it, or more, tests nothing.
  real(wp), parameter :: too_stiff = 1.0e-3_wp
  !> Changes that fall no more are rounding up to this part of the largest displacement; beyond, it has lost the answer.
  real(wp), parameter :: stagnant = 1.0e-3_wp
  !> A strain that falls by less than this part of it stays.
  real(wp), parameter :: least_fall = 1.0e-6_wp

  !> What came of the loads, and how.
  type :: plastic_run
    type(scene_materials) :: materials
    type(scene_state), allocatable :: state    !! the answer, or what came nearest to one
    type(linear_scene), allocatable :: scene   !! as the last solve left it, if there is an answer
    type(linear_law), allocatable :: law       !! of that solve
    real(wp) :: load_factor = 0.0_wp       !! part of the loads that `state` carries
    logical :: converged = .false.         !! all loads, to the tolerance
    logical :: runs_away = .false.         !! no equilibrium: the displacements grow without end
    integer :: singular = 0                !! body that could not be factored
    logical :: lacks_memory = .false.      !! that was for want of memory
    integer :: factorizations = 0          !! of bodies
    real(wp) :: condition = 1.0_wp         !! of its stiffness, estimated in the 1-norm
    type(weak_pivot) :: weakest            !! of its stiffness
    real(wp) :: rounding_error = 0.0_wp    !! of displacements, strains and forces, relative: what single precision left
    type(iteration_record), allocatable :: history(:)
    integer :: unloaded = 0                !! elements whose strain fell from one load step to the next, after yielding
    integer :: first_unloaded = 0          !! one of them
  end type plastic_run

  !> What the loop works on.
  type :: loop_type
    type(iteration_plan) :: plan
    type(scene_materials) :: materials
    type(linear_scene), allocatable :: scene
    type(linear_law), allocatable :: law
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
  subroutine follow_loads(model, motions, numbering, plan, method, run, watch)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(iteration_plan), intent(in) :: plan
    class(plastic_method), intent(inout) :: method
    type(plastic_run), intent(out) :: run
    class(onlooker), intent(inout) :: watch
    type(loop_type) :: loop
    type(scene_state), allocatable :: state
    real(wp), allocatable :: strained(:)
    real(wp) :: part
    logical :: converged
    integer :: step

    call begin(model, motions, plan, loop)
    method%volume = loop%scene%operator%volume
    allocate (run%history(0), strained(model%points))
    strained = 0.0_wp
    call watch%lap(stage_stiffness)
    do step = 1, plan%load_steps
      part = real(step, wp)/plan%load_steps
      call iterate(model, motions, numbering, method, part, loop, run, state, converged, watch)
      run%factorizations = loop%scene%bodies%factorizations
      run%lacks_memory = loop%scene%bodies%lacks_memory()
      if (run%singular > 0) return
      ! Of a load that was not carried nothing is kept, if one was before.
      if (converged .or. step == 1 .or. state%contact%state /= contact_solved) call move_alloc(state, run%state)
      if (run%state%contact%state /= contact_solved) return
      if (converged .or. step == 1) then
        run%load_factor = part
        call loop%scene%estimate_condition(model, numbering, loop%law, run%condition)
        run%weakest = loop%scene%bodies%weakest()
        if (plan%precision == precision_single) &
          call loop%scene%rounding_error(model, numbering, loop%law, part, run%state, run%rounding_error)
        call watch%lap(stage_accuracy)
      end if
      if (.not. converged) exit
      if (plan%load_steps > 1) call find_unloaded(model, loop, strained, run)
      call watch%lap(stage_yielding)
    end do
    run%converged = converged
    call move_alloc(loop%scene, run%scene)
    call move_alloc(loop%law, run%law)
    run%materials = loop%materials
  end subroutine follow_loads

  subroutine begin(model, motions, plan, loop)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(iteration_plan), intent(in) :: plan
    type(loop_type), intent(out) :: loop

    loop%plan = plan
    loop%scene = new_linear_scene(model, motions, plan%body, plan%contact%by_blocks, plan%precision, plan%threads)
    call find_materials(model, loop%materials)
    allocate (loop%about%displacement(2, model%nodes), loop%about%strain(4, model%points), source=0.0_wp)
    if (loop%materials%yields) loop%about%point = loop%materials%states(loop%about%strain)
    allocate (loop%force(model%pairs), source=0.0_wp)
  end subroutine begin

  !> Iterate at one load. `state` is the last, or if that is not converged the one nearest to equilibrium.
  subroutine iterate(model, motions, numbering, method, part, loop, run, state, converged, watch)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    class(plastic_method), intent(inout) :: method
    real(wp), intent(in) :: part
    type(loop_type), intent(inout) :: loop
    type(plastic_run), intent(inout) :: run
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
    if (.not. loop%stiff) loop%law = elastic_law(loop%materials)   ! it may be a last step's tangent
    call method%restart()
    call loop%estimator%restart()
    loop%doubt = 1.0_wp
    do iteration = 1, model%controls%most_iterations
      call set_law(model, numbering, method, loop, run%singular, watch)
      if (run%singular > 0) return
      call loop%scene%solve(model, motions, numbering, loop%law, part, loop%touching, found, watch)
      if (found%contact%state /= contact_solved) then
        ! Not found about a later state, such as one beyond the limit load: what was found before is not converged.
        if (iteration == 1 .or. found%contact%state /= contact_stalled) call move_alloc(found, state)
        return
      end if
      now%load_factor = part
      now%iteration = iteration
      if (loop%materials%yields) found%point = loop%materials%states(found%strain)
      call measure(model, loop, found, now)
      call loop%estimator%estimate(method%telling_steps, loop%about, found, now)
      if (now%yielded + loop%yielded == 0 .or. now%residual <= rounding .and. now%error < 0.0_wp) then
        ! What changes is rounding, if anything.
        now%error = merge(now%change, 0.0_wp, iteration > 1)
        now%force_error = merge(now%force_change, 0.0_wp, iteration > 1)
      end if
      run%history = [run%history, now]
      converged = is_over(loop, run%history)
      if (converged .and. wants_test(model, loop, now)) &
        call step_by_tangent(model, motions, numbering, part, loop, run%history, found, converged, watch)
      now = run%history(size(run%history))
      travel = maxval(abs(found%displacement))
      if (iteration == 1) farthest = far_away*travel
      ! A state far away is none to show: its numbers may be at the end of their range.
      run%runs_away = .not. converged .and. model%has_flat_curve() .and. travel > farthest
      if (run%runs_away) return
      loop%touching = found%contact%touching
      loop%force = found%contact%force
      loop%yielded = now%yielded
      ! Behind the last load step nothing is linearised any more.
      if (loop%materials%yields .and. .not. (converged .and. part >= 1.0_wp)) &
        call method%advance(model, loop%materials, part, found, loop%about)
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

  !> The law about the last state, and the stiffness for it. `singular` is a body without any that can be factored.
  subroutine set_law(model, numbering, method, loop, singular, watch)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    class(plastic_method), intent(inout) :: method
    type(loop_type), intent(inout) :: loop
    integer, intent(out) :: singular
    class(onlooker), intent(inout) :: watch
    logical :: possible

    singular = 0
    if (loop%materials%yields) call method%linearise(loop%materials, loop%about, loop%law)
    call watch%lap(stage_yielding)
    if (loop%stiff .and. (method%keeps_stiffness .or. loop%elastic .and. loop%yielded == 0)) return
    loop%elastic = loop%yielded == 0
    do
      call loop%scene%set_stiffness(model, numbering, loop%law, singular, watch)
      loop%stiff = .true.
      if (singular == 0 .or. loop%scene%bodies%lacks_memory() .or. .not. loop%materials%yields) return
      call method%stiffen(loop%materials, loop%about, loop%law, possible)
      if (.not. possible) return
    end do
  end subroutine set_law

  !> How far the state found is from the last, and its stresses from the curve. Equilibrium and contact are exact in
  !! each solve: that distance is all that is left of the scene's equations.
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
    now%yielded = 0
    now%residual = 0.0_wp
    if (.not. loop%materials%yields) return
    allocate (yielded(model%elements), source=.false.)
    do p = 1, model%points
      associate (e => model%point_element(p), law => loop%materials%section(loop%materials%of_point(p))%law)
        if (.not. law%yields) cycle
        yielded(e) = yielded(e) .or. found%point(p)%yielded
        now%residual = max(now%residual, law%distance(found%point(p), found%stress(:, p)))
      end associate
    end do
    now%yielded = count(yielded)
  end subroutine measure

  !> Is the iteration over? It is when displacements neither change nor are estimated to be off by more than the tolerance.
  !! Where nothing has yielded, the first solve was exact; and where stresses are on their curves
  !! to rounding while the changes fall no more, rounding allows no smaller ones.
  pure logical function is_over(loop, history)
    type(loop_type), intent(in) :: loop
    type(iteration_record), intent(in) :: history(:)   !! to this iteration
    integer :: n

    n = size(history)
    associate (now => history(n))
      is_over = now%yielded + loop%yielded == 0
      if (now%change <= loop%plan%tolerance .and. now%residual <= loop%plan%off_curve) &
        is_over = is_over .or. now%residual <= rounding .or. now%error >= 0.0_wp .and. loop%doubt*now%error <= loop%plan%tolerance
      if (now%iteration > 3 .and. now%residual <= rounding .and. now%change <= stagnant) &
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
    wants_test = wants_test .and. now%residual > rounding
    wants_test = wants_test .and. loop%plan%method /= method_newton .and. .not. model%controls%paper_ratio
  end function wants_test

  !> The last step is one by the tangent, whose change is what was left. If that is more than the tolerance,
  !! all is as it was before, but for the doubt in estimates.
  subroutine step_by_tangent(model, motions, numbering, part, loop, history, found, holds, watch)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    real(wp), intent(in) :: part
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
    if (history(size(history))%iteration == model%controls%most_iterations) return
    about = loop%about
    now = history(size(history))
    now%iteration = now%iteration + 1
    now%change = huge(1.0_wp)
    loop%about = found
    loop%force = found%contact%force
    loop%yielded = now%yielded
    allocate (next)
    call set_law(model, numbering, tangent, loop, singular, watch)
    if (singular == 0 .and. tangent%blended() < too_stiff) then
      call loop%scene%solve(model, motions, numbering, loop%law, part, found%contact%touching, next, watch)
      if (next%contact%state == contact_solved) then
        next%point = loop%materials%states(next%strain)
        call measure(model, loop, next, now)
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
      loop%law = elastic_law(loop%materials)
    end if
    loop%stiff = .false.
  end subroutine step_by_tangent

  !> Elements beyond yield whose strain falls as the load grows: total theory takes them back along the curve.
  pure subroutine find_unloaded(model, loop, strained, run)
    type(model_type), intent(in) :: model
    type(loop_type), intent(in) :: loop
    real(wp), intent(inout) :: strained(:)    !! e of the points that yielded in the last load step, else 0 [points]
    type(plastic_run), intent(inout) :: run
    logical, allocatable :: fell(:)
    integer :: p

    allocate (fell(model%elements), source=.false.)
    do p = 1, model%points
      associate (e => model%point_element(p), now => run%state%point(p))
        fell(e) = fell(e) .or. now%deviatoric < (1.0_wp - max(loop%plan%tolerance, least_fall))*strained(p)
        strained(p) = merge(now%deviatoric, 0.0_wp, now%yielded)
      end associate
    end do
    run%unloaded = run%unloaded + count(fell)
    if (run%first_unloaded == 0) run%first_unloaded = findloc(fell, .true., dim=1)
  end subroutine find_unloaded
end module epcont_plasticity_iteration
