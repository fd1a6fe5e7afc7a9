!> The loop of the plastic iteration; it knows nothing of the method that it drives.
module epcont_plasticity_iteration
  use epcont_assembly_bodies, only: weak_pivot
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: solved_to
  use epcont_contact_problem, only: contact_solved, contact_stalled, pivot_record
  use epcont_element_kinematics, only: components, directions
  use epcont_linear_linear_problem, only: linear_problem, new_linear_problem
  use epcont_linear_scene_state, only: committed_step, scene_state
  use epcont_material_linear_law, only: elastic_law
  use epcont_model_controls, only: method_inistr, method_modsec, method_newton, method_secant
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_plasticity_initial_stress, only: initial_stress_method
  use epcont_plasticity_law_of_state, only: factor_law, linearise
  use epcont_plasticity_newton, only: newton_method
  use epcont_plasticity_observer, only: iteration_record, observer
  use epcont_plasticity_secant, only: secant_method
  use epcont_plasticity_unloading, only: find_unloaded
  use epcont_system_stopwatch, only: stage_stiffness, stage_yielding
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
  !> Changes that fall no more are rounding up to this part of the largest displacement; beyond, all is lost.
  real(wp), parameter :: stagnant = 1.0e-3_wp

  !> What came of the loads, and how: a state, the answer or what came nearest to one.
  type, extends(scene_state) :: followed_loads
    real(wp) :: load_factor = 0.0_wp       !! part of the loads for which the state is
    logical :: converged = .false.         !! all loads, to the tolerance of the iteration
    logical :: carried = .false.           !! a part of them, to that tolerance
    logical :: runs_away = .false.         !! no equilibrium: the displacements grow without end
    integer :: failed_body = 0             !! body that could not be factored
    logical :: lacks_memory = .false.      !! that was for want of memory
    integer :: factorizations = 0          !! of bodies
    real(wp) :: condition = 1.0_wp         !! of the stiffness, estimated in the 1-norm
    type(weak_pivot) :: weakest            !! of the stiffness
    type(iteration_record), allocatable :: history(:)   !! every solve
    type(pivot_record), allocatable :: pivot(:)         !! those that are kept of each, one after the other
    !> Flow theory: the load steps before the last, for the certificate [any]
    type(committed_step), allocatable :: committed(:)
    integer :: unloaded = 0                !! elements whose strain fell, after yielding, as the load grew
    integer :: first_unloaded = 0          !! one of them
  end type followed_loads

contains

  !> Load by load to the answer. Of several load cases the first is one without `linear`; the others have it
  !! from the one before, and the factors of the unloaded state.
  subroutine follow_loads(scene, plan, keeps, linear, virgin, answer, watch)
    type(planned_scene), intent(in) :: scene                   !! what is loaded
    type(iteration_plan), intent(in) :: plan                   !! how; it may differ from the scene's
    logical, intent(in) :: keeps                               !! another load case may follow
    type(linear_problem), allocatable, intent(inout) :: linear   !! as the last solve left it
    !> With factors of the unloaded state, where these will be wanted and the bodies yield
    type(linear_problem), allocatable, intent(inout) :: virgin
    type(followed_loads), intent(out) :: answer                !! what came of it
    class(observer), intent(inout) :: watch                    !! takes the time, and is told of each solve
    class(secant_method), allocatable :: method
    type(scene_state) :: about                ! that the law is about
    type(scene_state), allocatable :: state   ! found at this load
    type(iteration_record) :: now             ! of the last solve
    logical, allocatable :: touching(:)       ! the last contact set: the next contact starts from it [pairs]
    real(wp), allocatable :: force(:)         ! the last contact forces [force] [pairs]
    ! The last displacements, g of x, and g - x; by how much both had changed: |dg|/|d(g - x)| of the steps at
    ! this load, the contact forces' [force/length].
    real(wp), allocatable :: displacement(:, :), rest(:, :), gain(:), force_gain(:)
    real(wp), allocatable :: strained(:)      ! e of points that yielded in the last load step, else 0
    real(wp) :: load_factor                   ! of the loads
    real(wp) :: doubt                         ! times what was estimated is what a tangent step has shown
    integer :: yielded                        ! elements that yield in the state that the law is about
    logical :: stiff                          ! the scene has been factored
    logical :: elastic                        ! with the law of a state that has not yielded
    logical :: converged
    integer :: failed_body, factored_before, step

    call begin()
    call watch%lap(stage_stiffness)
    do step = 1, plan%load_steps
      load_factor = real(step, wp)/plan%load_steps
      if (scene%model%controls%flow_theory .and. step > 1) call commit()
      call iterate()
      answer%factorizations = linear%factorizations - factored_before
      answer%lacks_memory = any(linear%body%lacks_memory)
      if (answer%failed_body > 0) return
      ! Of a load that was not carried nothing is kept, if one was before.
      if (converged .or. step == 1 .or. state%contact%state /= contact_solved) call answer%take(state)
      if (answer%contact%state /= contact_solved) return
      if (converged .or. step == 1) answer%load_factor = load_factor
      if (converged .or. step == 1) answer%weakest = linear%weakest()
      ! Of the steps on the way nobody asks.
      failed_body = 0
      if (.not. converged .and. answer%carried) call return_to_carried(failed_body)
      if (failed_body > 0) answer%condition = huge(1.0_wp)
      if (.not. converged) exit
      answer%carried = .true.
      if (plan%load_steps > 1 .and. .not. scene%model%controls%flow_theory) &
        call find_unloaded(scene%model, answer%point, plan%tolerance, strained, answer%unloaded, &
                           answer%first_unloaded)
      call watch%lap(stage_yielding)
    end do
    answer%converged = converged
    call move_alloc(touching, linear%touching)

  contains

    !> The state without loads.
    subroutine begin()
      if (allocated(virgin)) linear = virgin
      stiff = allocated(linear)
      elastic = stiff
      if (stiff) then
        call linear%take_case(scene)
        call move_alloc(linear%touching, touching)
      else
        allocate (linear)
        call new_linear_problem(scene, plan, linear)
      end if
      linear%borne%keeps = keeps .and. .not. linear%materials%yields
      factored_before = linear%factorizations
      if (allocated(linear%materials%committed)) deallocate (linear%materials%committed)   ! of another case
      allocate (about%displacement(directions, scene%model%nodes), source=0.0_wp)
      allocate (about%strain(components, scene%model%points), source=0.0_wp)
      allocate (force(scene%model%pairs), strained(scene%model%points), source=0.0_wp)
      if (linear%materials%yields) about%point = linear%materials%states(about%strain)
      allocate (answer%history(0), answer%pivot(0), answer%committed(0))
      yielded = 0
    end subroutine begin

    !> The last load step becomes the state from which the next one goes on.
    subroutine commit()
      call linear%materials%commit(answer%strain)
      answer%committed = [answer%committed, committed_step(answer%load_factor, answer%deformation)]
    end subroutine commit

    !> The method, which knows nothing yet: so it begins at each load.
    subroutine choose_method()
      if (allocated(method)) deallocate (method)
      select case (plan%method)
      case (method_newton)
        allocate (newton_method :: method)
      case (method_inistr)
        allocate (initial_stress_method :: method)
      case default
        allocate (secant_method :: method)
      end select
      if (any(plan%method == [method_modsec, method_inistr])) allocate (method%mixer)
    end subroutine choose_method

    !> Iterate at one load. `state` is the last, or if that is not converged the one nearest to equilibrium.
    subroutine iterate()
      type(scene_state), allocatable :: found
      real(wp) :: farthest, least_residual, travel
      integer :: iteration

      converged = .false.
      least_residual = huge(1.0_wp)
      if (allocated(state)) deallocate (state)
      allocate (state, found)
      if (.not. stiff) linear%law = elastic_law(linear%materials)   ! it may be a last step's tangent
      call choose_method()
      gain = [real(wp) ::]
      force_gain = [real(wp) ::]
      doubt = 1.0_wp
      do iteration = 1, scene%model%controls%most_iterations
        call set_law(method, answer%failed_body)
        if (answer%failed_body > 0) return
        call linear%solve(scene, load_factor, touching, found, watch)
        if (found%contact%state /= contact_solved) then
          ! Not found about a later state, such as one beyond the limit load: what was found before is not
          ! converged.
          if (iteration == 1 .or. found%contact%state /= contact_stalled) call move_alloc(found, state)
          return
        end if
        now = iteration_record(iteration=iteration)
        call judge(found)
        travel = maxval(abs(found%displacement))
        if (iteration == 1) farthest = far_away*travel
        ! A state far away is none to show: its numbers may be at the end of their range.
        answer%runs_away = .not. converged .and. scene%model%has_flat_curve() .and. travel > farthest
        if (answer%runs_away) return
        if (.not. plan%from_first_pivot) touching = found%contact%touching
        force = found%contact%force
        yielded = now%yielded
        ! Behind the last load step nothing is linearised any more.
        if (linear%materials%yields .and. .not. (converged .and. load_factor >= 1.0_wp)) &
          call method%advance(scene%model, linear, load_factor, found, about)
        call watch%lap(stage_yielding)
        call watch%solved(now, converged)
        if (.not. converged .and. now%residual > least_residual) cycle
        least_residual = now%residual
        call move_alloc(found, state)
        if (converged) return
        if (allocated(state%point)) deallocate (state%point)
        allocate (found)
      end do
    end subroutine iterate

    !> The law about the last state, and the stiffness for it; `failed_body` has none that can be factored.
    subroutine set_law(method, failed_body)
      class(secant_method), intent(inout) :: method
      integer, intent(out) :: failed_body

      failed_body = 0
      method%blend = 0.0_wp
      call linearise(scene, method, about, linear, watch)
      if (stiff .and. (plan%method == method_inistr .or. elastic .and. yielded == 0)) return
      elastic = yielded == 0
      call factor_law(scene, method, about, linear, failed_body, watch)
      stiff = .true.
      if (keeps .and. elastic .and. linear%materials%yields .and. .not. allocated(virgin)) virgin = linear
    end subroutine set_law

    !> Add a solve to the history, what it has changed and left. Was it the last, or a further one by tangent?
    subroutine judge(found)
      type(scene_state), allocatable, intent(inout) :: found

      call measure(found)
      call estimate_errors(found)
      if (now%yielded + yielded == 0 .or. now%residual <= solved_to .and. now%error < 0.0_wp) then
        now%error = merge(now%change, 0.0_wp, now%iteration > 1)   ! what changes is rounding, if anything
        now%force_error = merge(now%force_change, 0.0_wp, now%iteration > 1)
      end if
      call keep(found)
      converged = is_over()
      if (converged .and. wants_test()) call step_by_tangent(found)
    end subroutine judge

    !> Put a solve into the history. Its pivots stand by themselves: a list of lists would be copied slowly.
    subroutine keep(found)
      type(scene_state), intent(in) :: found

      answer%history = [answer%history, now]
      if (now%kept > 0) answer%pivot = [answer%pivot, found%contact%history]
    end subroutine keep

    !> How far the state found is from the last, and its stresses from the curve. Equilibrium and contact are
    !! exact in each solve: that distance is all that is left of the scene's equations.
    subroutine measure(found)
      type(scene_state), intent(inout) :: found         !! its points are set

      now%load_factor = load_factor
      now%change = ratio(maxval(abs(found%displacement - about%displacement)), &
                         maxval(abs(found%displacement)))
      now%force_change = ratio(maxval(abs(found%contact%force - force)), maxval(found%contact%force))
      now%touching = count(found%contact%touching)
      now%pivots = found%contact%pivots
      now%kept = size(found%contact%history)
      if (.not. linear%materials%yields) return
      found%point = linear%materials%states(found%strain)
      call linear%materials%measure(scene%model, found%point, found%point_stress, now%residual, now%yielded)
    end subroutine measure

    !> How far the iteration still is from where it goes, from what its last steps were worth.
    !>
    !> An iteration takes x to g(x). To first order a step dx changes g by J dx and the rest g - x by (J - 1)
    !> dx, so that of a rest r there is J/(1 - J) r to come in g. How much that is at most, the steps behind
    !> tell: |dg|/|d(g - x)|. In an iteration without mixing it is the sum of the changes to come, each the
    !> last times the rate at which they fall; its last steps are the slowest.
    subroutine estimate_errors(found)
      type(scene_state), intent(in) :: found
      real(wp), allocatable :: last_rest(:, :)
      real(wp) :: step, largest
      integer :: first

      call move_alloc(rest, last_rest)
      rest = found%displacement - about%displacement
      largest = maxval(abs(rest))
      now%error = -1.0_wp
      now%force_error = -1.0_wp
      if (now%iteration > 1) then
        associate (u => found%displacement, now_force => found%contact%force)
          step = maxval(abs(rest - last_rest))
          gain = [gain, ratio(maxval(abs(u - displacement)), step)]
          force_gain = [force_gain, ratio(maxval([0.0_wp, abs(now_force - force)]), step)]
          if (largest < maxval(abs(last_rest)) .or. largest == 0.0_wp) then
            first = merge(1, max(1, size(gain) - 1), allocated(method%mixer))
            ! A step may by chance be short where much is to come: as long as stresses are off their curves,
            ! no less than the last change.
            now%error = max(ratio(maxval(gain(first:))*largest, maxval(abs(u))), &
                            min(now%change, now%residual))
            now%force_error = 0.0_wp
            if (any(now_force > 0.0_wp)) &
              now%force_error = max(ratio(maxval(force_gain(first:))*largest, maxval(now_force)), &
                                    min(now%force_change, now%residual))
          end if
        end associate
      end if
      displacement = found%displacement
    end subroutine estimate_errors

    !> Is the iteration over? It is when displacements neither change nor are estimated to be off by more than
    !! the tolerance. Where nothing has yielded, the first solve was exact; and where stresses are on their
    !! curves to rounding while the changes fall no more, rounding allows no smaller ones.
    pure logical function is_over()
      is_over = now%yielded + yielded == 0
      if (now%change <= plan%tolerance .and. now%residual <= plan%off_curve) is_over = is_over .or. &
        now%residual <= solved_to .or. now%error >= 0.0_wp .and. doubt*now%error <= plan%tolerance
      if (now%iteration > 3 .and. now%residual <= solved_to .and. now%change <= stagnant) &
        is_over = is_over .or. now%change >= answer%history(size(answer%history) - 2)%change
    end function is_over

    !> Is the estimate of what is to come to be tested, and is there a tangent to test it with?
    pure logical function wants_test()
      wants_test = plan%method /= method_secant .or. now%iteration <= few_solves .or. &
                   now%iteration > many_solves .or. now%error > slow*now%change .or. &
                   any(scene%model%prescribed /= 0.0_wp)
      wants_test = wants_test .and. now%residual > solved_to .and. plan%method /= method_newton .and. &
                   .not. scene%model%controls%paper_ratio
    end function wants_test

    !> The last step is one by the tangent, whose change is what was left. If that is more than the tolerance,
    !! all is as it was before, but for the doubt in estimates.
    subroutine step_by_tangent(found)
      type(scene_state), allocatable, intent(inout) :: found
      type(newton_method) :: tangent
      type(scene_state), allocatable :: next
      type(scene_state) :: before
      type(iteration_record) :: last
      integer :: failed_body

      converged = .false.
      if (now%iteration == scene%model%controls%most_iterations) return
      before = about
      last = now
      about = found
      force = found%contact%force
      yielded = now%yielded
      now%iteration = now%iteration + 1
      now%change = huge(1.0_wp)
      allocate (next)
      stiff = .false.   ! by no tangent, before and after
      call set_law(tangent, failed_body)
      if (failed_body == 0 .and. tangent%blend < too_stiff) then
        call linear%solve(scene, load_factor, found%contact%touching, next, watch)
        if (next%contact%state == contact_solved) call measure(next)
      end if
      converged = now%change <= plan%tolerance .and. now%residual <= plan%off_curve
      if (converged) then
        now%error = now%change
        now%force_error = now%force_change
        now%by_tangent = .true.
        call keep(next)
        call move_alloc(next, found)
      else
        doubt = max(2.0_wp*doubt, min(now%change/last%error, most_doubt))
        now = last
        about = before
        linear%law = elastic_law(linear%materials)
      end if
      stiff = .false.
    end subroutine step_by_tangent

    !> The stiffness of the last load that was carried, made once more.
    subroutine return_to_carried(failed_body)
      integer, intent(out) :: failed_body   !! that could not be factored again

      about = answer%scene_state
      stiff = stiff .and. plan%method == method_inistr   ! that is the elastic one, at any load
      call set_law(method, failed_body)
      load_factor = answer%load_factor
    end subroutine return_to_carried
  end subroutine follow_loads

  !> a/b, 0 where both are 0; finite.
  pure real(wp) function ratio(a, b)
    real(wp), intent(in) :: a, b

    ratio = max(a, 0.0_wp)/max(b, tiny(b)*max(a, 1.0_wp))
  end function ratio
end module epcont_plasticity_iteration
