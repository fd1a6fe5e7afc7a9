!> What the figures of an answer are worth: the error of the mesh in the energy norm, in the approach, in the
!> total contact force and what of it each body bears, in the largest pressure and the half-width of each
!> zone; what rounding may have done to the contact forces; pairs that may as well be open.
module epcont_accuracy_accuracy
  use epcont_accuracy_error_fields, only: body_fields, compare_fields, error_fields
  use epcont_accuracy_joined_loads, only: contact_sensitivity
  use epcont_accuracy_narrow_zone, only: find_turned, shifted_loads, too_near
  use epcont_accuracy_patches, only: new_patch_table, patch_table, wide_patch
  use epcont_accuracy_surface_line, only: first_element, new_surface_line, smooth_pressures, surface_line
  use epcont_accuracy_unit_loads, only: find_sensitivity, find_unit_loads, unit_loads
  use epcont_accuracy_weights, only: concentrated, least_energy, of_shares, uncancelled, unresolved, &
      wave_height
  use epcont_accuracy_zone_error, only: estimate_zone, zone_error
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference, no_effect
  use epcont_contact_scaling, only: diagonal
  use epcont_element_kinematics, only: directions
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_model_arrays, only: angle
  use epcont_plan_planned_model, only: planned_model
  use epcont_result_answer, only: answer_type
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: accuracy_type, assess, kept_estimates

  !> Elements that are named as the worst.
  integer, parameter :: worst_count = 5

  type :: accuracy_type
    !> Error of the mesh over the size of the answer, in the energy norm
    real(wp) :: energy_norm = 0.0_wp
    real(wp), allocatable :: element(:)            !! square of each element's error [energy] [elements]
    integer, allocatable :: worst(:)               !! elements with the largest errors
    type(zone_error), allocatable :: zone(:)
    !> The zone with the largest pressure of all; of those equal but for rounding the one of which least is
    !! known, or the first. 0: there is no zone
    integer :: leading = 0
    !> Error of that pressure; negative: unknown [stress]
    real(wp) :: max_pressure = -1.0_wp
    real(wp), allocatable :: approach(:)           !! negative: unknown [motions]
    logical, allocatable :: approach_unbounded(:)  !! it grows with every finer mesh [motions]
    !> Error of the total contact force; negative: unknown [force]
    real(wp) :: total_force = -1.0_wp
    !> Of its resultants on bodies; negative: unknown [force] [directions, answer's bodies]
    real(wp), allocatable :: body_force(:, :)
    type(contact_sensitivity) :: sensitivity
    logical, allocatable :: weak(:)                !! pairs that errors may open, or close [pairs]
  end type accuracy_type

  !> What estimates of one load case leave to those of the next.
  type :: kept_estimates
    type(patch_table) :: table
    type(surface_line) :: surface                !! but for its pressures
    type(unit_loads) :: loads
    type(body_fields), allocatable :: field(:)   !! of these loads [bodies]
  end type kept_estimates

contains

  !> What the figures of an answer are worth.
  subroutine assess(scene, linear, line, kept, answer, accuracy)
    type(planned_model), intent(in) :: scene       !! that was solved
    !> Of the last solve; the basis of its contact is taken over
    type(linear_problem), intent(inout), target :: linear
    type(contact_line), intent(in) :: line         !! of the pairs
    type(kept_estimates), intent(inout) :: kept    !! of the load case before, if any; of this
    !> With its pressures and zones; the condition is added to it
    type(answer_type), intent(inout) :: answer
    type(accuracy_type), intent(out) :: accuracy   !! of its figures
    type(kept_estimates) :: none
    type(error_fields) :: field
    logical :: carried, pressed
    logical :: same   ! unit loads as before
    logical, allocatable :: point_load(:)   ! the motion's SUPORT freedom bears one [motions]
    integer :: motions

    pressed = any(answer%contact%force > 0.0_wp)
    ! Else the scene is that of a load that was not carried, or nothing tells what its stiffness is.
    carried = pressed .and. answer%converged .and. answer%condition < huge(1.0_wp)
    same = .false.
    if (carried) then
      call find_unit_loads(scene, linear, answer, kept%loads, same)
    else
      kept%loads = none%loads
      allocate (kept%loads%contact%force(scene%model%pairs, 0), kept%loads%contact%unit(0))
    end if
    if (.not. same) then
      if (allocated(kept%field)) deallocate (kept%field)
      allocate (kept%field(scene%model%bodies))
    end if
    motions = scene%motions%count
    point_load = find_point_loads()
    allocate (accuracy%approach(motions), source=-1.0_wp)
    allocate (accuracy%body_force(directions, size(answer%bodies)), source=-1.0_wp)
    allocate (accuracy%approach_unbounded(motions), accuracy%weak(scene%model%pairs), source=.false.)
    allocate (accuracy%zone(0))
    call assess_mesh()
    if (answer%condition < huge(1.0_wp)) call linear%estimate_condition(scene, answer%condition)
    if (pressed) call assess_zones()
    if (carried) call assess_sums()
    accuracy%leading = leading_zone()
    if (accuracy%leading > 0) accuracy%max_pressure = accuracy%zone(accuracy%leading)%pressure

  contains

    !> As `leading` has it: unbounded comes before not resolved, and that before the largest error.
    pure integer function leading_zone() result(leading)
      logical :: worst(size(accuracy%zone))

      leading = 0
      if (size(worst) == 0) return
      associate (pressure => answer%zones%max_pressure, zone => accuracy%zone, off => accuracy%zone%pressure)
        worst = pressure >= maxval(pressure) - no_effect*abs(maxval(pressure))
        if (any(worst .and. zone%unbounded)) worst = worst .and. zone%unbounded
        if (any(worst .and. .not. zone%resolved)) worst = worst .and. .not. zone%resolved
        leading = findloc(worst .and. off >= maxval(off, mask=worst)*(1.0_wp - no_effect), .true., dim=1)
        if (leading == 0) leading = findloc(worst, .true., dim=1)   ! of none the error is known
      end associate
    end function leading_zone

    !> The error of the mesh in the energy norm, and the elements that have the most of it.
    subroutine assess_mesh()
      if (kept%table%places == 0) kept%table = new_patch_table(scene%model)
      call compare_fields(scene, linear, answer, kept%table, kept%loads%contact, kept%field, field)
      accuracy%element = field%element
      associate (error => sum(field%element))
        if (error > least_difference**2*held_energy()) &
          accuracy%energy_norm = sqrt(error/(error + abs(field%energy)))
      end associate
      if (accuracy%energy_norm > least_difference) then
        accuracy%worst = worst_of(accuracy%element)
      else
        accuracy%energy_norm = 0.0_wp
        accuracy%element = 0.0_wp
        accuracy%worst = [integer ::]
        field%along = 0.0_wp
      end if
    end subroutine assess_mesh

    !> What the energy would be, about, if nothing gave way to the temperatures: where bodies expand freely,
    !! rounding of that is all there is.
    pure real(wp) function held_energy() result(energy)
      energy = 0.0_wp
      if (allocated(scene%model%free_strain)) &
        energy = sum(linear%operator%volume*scene%model%young(linear%materials%of_point)* &
                     (answer%load_factor*scene%model%free_strain)**2)
    end function held_energy

    !> Largest pressures and half-widths.
    subroutine assess_zones()
      real(wp) :: energy   !! error of the mesh over all of it, but for that of point loads
      logical :: yielded
      integer :: z

      associate (pressure => smooth_pressures(scene%model, linear%materials, field%smooth))
        if (.not. allocated(kept%surface%bend)) kept%surface = new_surface_line(scene%model, line, pressure)
        kept%surface%smooth_pressure = pressure
      end associate
      energy = 0.0_wp
      if (accuracy%energy_norm > 0.0_wp) energy = accuracy%energy_norm**2* &
        max(0.0_wp, sum(accuracy%element, mask=.not. beside_point_loads())/sum(accuracy%element))
      yielded = any(answer%plastic)
      accuracy%zone = [(estimate_zone(scene%model, kept%surface, answer, yielded, energy, answer%zones(z)), &
                        z=1, size(answer%zones))]
      do z = 1, size(answer%zones)
        accuracy%zone(z)%too_near = too_near(scene%model, kept%surface, answer%contact%force, &
                                             accuracy%zone(z), answer%zones(z)%pairs)
      end do
    end subroutine assess_zones

    !> Approaches and forces, and what errors may do to pairs.
    subroutine assess_sums()
      !> Error of each approach, of the sum of forces, of what bodies bear
      real(wp) :: off(size(kept%loads%contact%unit))
      integer :: j

      accuracy%sensitivity = kept%loads%sensitivity
      if (.not. scene%numbering%joined) &
        accuracy%sensitivity = find_sensitivity( &
          kept%loads%problem, kept%loads%basis, answer%contact%force, &
          abs(linear%problem%initial_gap) + abs(linear%problem%load_gap) &
          + linear%problem%motion%times(answer%contact%approach, magnitudes=.true.), answer%condition)
      ! What the last step of refinement has not changed is right.
      accuracy%sensitivity%rounding = min(accuracy%sensitivity%rounding, answer%last_correction)
      off = errors()
      associate (motion => kept%loads%contact%motion)
        do j = 1, size(motion)
          if (kept%loads%contact%unit(j) <= 0.0_wp) cycle
          accuracy%approach(motion(j)) = off(j)
          accuracy%approach_unbounded(motion(j)) = point_load(motion(j))
        end do
        call assess_forces(off(size(motion) + 1:))
      end associate
      ! Pressures are as much off as the total force, where that is not given by loads: of uniform ones
      ! nothing else tells.
      where (accuracy%zone%pressure >= 0.0_wp) accuracy%zone%pressure = &
        max(accuracy%zone%pressure, &
            accuracy%total_force/sum(answer%contact%force)*answer%zones%max_pressure)
      accuracy%weak = find_weak()
    end subroutine assess_sums

    !> Errors of approaches, then of sums of forces.
    pure function errors() result(off)
      real(wp) :: off(size(kept%loads%contact%unit))
      !> What a force at each pair adds of what contact at nodes alone lets the bodies come too near, and of
      !! what its ends leave open [length] [pairs]
      real(wp), dimension(scene%model%pairs) :: near, at_ends
      real(wp), dimension(size(off)) :: near_sum, end_sum   !! of these, under each load
      real(wp) :: at_end
      integer :: j, z

      near = 0.0_wp
      at_ends = 0.0_wp
      do z = 1, size(accuracy%zone)
        associate (zone => accuracy%zone(z), pairs => answer%zones(z)%pairs)
          at_end = answer%zones(z)%max_pressure*zone%half_length*kept%surface%compliance(zone%peak)
          ! Between the nodes of flat faces there is no gap: where an edge or a tip makes the pressure, it
          ! says nothing of one.
          if (.not. zone%unbounded) &
            near(pairs) = near(pairs) + zone%weights%between*(at_end*zone%resolution**2)
          at_ends(pairs) = at_ends(pairs) + zone%weights%end*(at_end*zone%end_resolution**2) &
                           + wave_height*zone%wave_height + zone%too_near
        end associate
      end do
      ! Of a tilt of either sign the ends count, not the sum.
      near_sum = matmul(near, kept%loads%contact%force)
      end_sum = matmul(at_ends, abs(kept%loads%contact%force))
      off = 0.0_wp
      do j = 1, size(off)
        if (kept%loads%contact%unit(j) > 0.0_wp) off(j) = error_along(j, near_sum(j), end_sum(j))
      end do
      associate (shifted => shifted_loads(scene%model, line, scene%motions, answer), &
                 shared => kept%loads%contact%shared, before => size(kept%loads%contact%motion))
        do j = 1, size(shared, 2)
          off(before + j) = off(before + j) + sum(abs(matmul(shared(:, j), shifted)))
        end do
      end associate
    end function errors

    !> Error of an approach, or of a sum of contact forces: the product of the errors of the scene and of its
    !! answer to a unit load along the motion, or to closing gaps, signed, with what contact at nodes alone
    !! lets the bodies come too near.
    pure real(wp) function error_along(j, near, at_ends) result(error)
      integer, intent(in) :: j               !! the load
      real(wp), intent(in) :: near, at_ends  !! what contact at nodes alone, and its ends, add
      real(wp) :: short, vague

      vague = merge(1.0_wp, unresolved, all(accuracy%zone%resolved))
      short = max(abs(field%along(1, j) - near), uncancelled*field%along(2, j))
      ! Of what pairs or bodies share no part cancels another.
      if (j > max(1, size(kept%loads%contact%motion))) short = of_shares*(field%along(2, j) + abs(near))
      ! What a mesh misses is measured by what it has: each error is larger by as much as the energy of its
      ! field is too small. Of unlike elements that bear the largest weight counts.
      error = vague*(at_ends + maxval(accuracy%zone%weights%product)*short/ &
        max(least_energy, 1.0_wp - accuracy%energy_norm**2)/max(least_energy, 1.0_wp - field%missing(j)))
    end function error_along

    !> The total contact force, and what of it each body bears: nothing is off where loads alone make it.
    subroutine assess_forces(off)
      real(wp), intent(in) :: off(:)   !! errors of sums that come from errors of gaps [force] [any]
      real(wp) :: turned, turned_on(directions, scene%model%bodies)
      logical :: given(directions, scene%model%bodies)
      integer :: c, i

      given = .false.
      given(:, answer%bodies%body) = kept%loads%column == 0
      if (scene%model%has_rings()) given(1, :) = .false.
      call find_turned(scene%model, line, answer, given, turned, turned_on)
      where (kept%loads%column == 0) accuracy%body_force = 0.0_wp
      if (.not. kept%loads%basis%sound) return
      accuracy%total_force = with_waves(off, 1) + turned
      do i = 1, size(answer%bodies)
        do c = 1, directions
          if (kept%loads%column(c, i) > 0) accuracy%body_force(c, i) = &
            with_waves(off, kept%loads%column(c, i)) + turned_on(c, answer%bodies(i)%body)
        end do
      end do
    end subroutine assess_forces

    !> Where motions are given, waves of the gap that are not pressed flat bear more than what is meant: the
    !! higher they are the more, and none of it where they are flat; nothing where loads alone make the sum
    !! [force].
    pure real(wp) function with_waves(off, k) result(force)
      real(wp), intent(in) :: off(:)   !! errors, without waves
      integer, intent(in) :: k         !! which sum
      integer :: z

      force = 0.0_wp
      if (off(k) <= least_difference*sum(answer%contact%force)) return   ! that is rounding
      do z = 1, size(accuracy%zone)
        force = force + min(1.0_wp, accuracy%zone(z)%waviness**3)* &
                        sum(abs(kept%loads%contact%share(answer%zones(z)%pairs, k))* &
                            answer%contact%force(answer%zones(z)%pairs))
      end do
      force = off(k) + force
    end function with_waves

    !> Is the SUPORT freedom of a motion the one node of its body's mesh that bears a load? [motions]
    pure function find_point_loads() result(is_one)
      logical :: is_one(motions)
      real(wp) :: on_body(directions, scene%model%bodies), own(directions, scene%model%nodes)
      integer :: c, followers(directions, scene%model%nodes), i, j

      on_body = 0.0_wp
      followers = 0
      associate (model => scene%model)
        own = model%load
        if (allocated(model%body_force)) own = own - model%body_force   ! those act on no node alone
        do i = 1, model%nodes
          on_body(:, model%body(i)) = on_body(:, model%body(i)) + abs(model%load(:, i))
          do c = 1, directions
            followers(c, model%leader(c, i)) = followers(c, model%leader(c, i)) + 1
          end do
        end do
        do j = 1, motions
          associate (node => scene%motions%node(j), c => scene%motions%component(j))
            is_one(j) = .false.
            if (c == angle) cycle
            is_one(j) = abs(own(c, node)) > concentrated*on_body(c, model%body(node)) .and. &
                        followers(c, node) == 1 .and. first_element(model, node) > 0
          end associate
        end do
      end associate
    end function find_point_loads

    !> Elements at a load on one node, and around these: there no mesh is fine enough, and the contact does
    !! not feel it [elements].
    pure function beside_point_loads() result(beside)
      logical :: beside(scene%model%elements)
      integer, allocatable :: patch(:)
      integer :: j

      beside = .false.
      do j = 1, motions
        if (.not. point_load(j)) cycle
        call wide_patch(scene%model, kept%table, scene%motions%node(j), patch)
        beside(patch) = .true.
      end do
    end function beside_point_loads

    !> Pairs pressed less than the error of their force, or open less than such a force would close [pairs].
    pure function find_weak() result(weak)
      logical, allocatable :: weak(:)
      real(wp) :: off(scene%model%pairs)   !! error of the pressure [stress]
      real(wp), allocatable :: compliance(:)
      integer :: k, z

      if (scene%numbering%joined) then
        compliance = linear%joined%compliance
      else
        compliance = diagonal(linear%problem%flexibility)
      end if
      off = 0.0_wp
      do z = 1, size(accuracy%zone)
        off(answer%zones(z)%pairs) = max(0.0_wp, accuracy%zone(z)%pressure)
        associate (beyond => answer%zones(z)%beyond)
          do k = 1, size(beyond)
            off(beyond(k)) = max(off(beyond(k)), accuracy%zone(z)%pressure)
          end do
        end associate
      end do
      ! Now of the force; what its pair gives way by under it alone is the least.
      off = off*line%tributary + accuracy%sensitivity%rounding*maxval(answer%contact%force)
      weak = merge(answer%contact%force <= off, &
                   answer%contact%gap <= compliance*off, &
                   answer%contact%touching)
    end function find_weak
  end subroutine assess

  !> Elements with the largest errors, largest first; of equal ones, but for rounding, the first. None where
  !! there is no error.
  pure function worst_of(energy) result(worst)
    real(wp), intent(in) :: energy(:)
    integer, allocatable :: worst(:)
    logical :: left(size(energy))
    real(wp) :: largest
    integer :: k

    allocate (worst(0))
    left = .true.
    do k = 1, min(worst_count, size(energy))
      largest = maxval(energy, mask=left)   ! by rounding it may be below zero
      worst = [worst, findloc(left .and. energy >= largest - no_effect*abs(largest), .true., dim=1)]
      left(worst(k)) = .false.
    end do
  end function worst_of
end module epcont_accuracy_accuracy
