!> What the figures of an answer are worth: the error of the mesh in the energy norm, in the approach, in the
!> total contact force and what of it each body bears, in the largest pressure and the half-width of each
!> zone; what rounding may have done to the contact forces; pairs that may as well be open.
module epcont_accuracy_accuracy
  use epcont_accuracy_body_shares, only: find_shares
  use epcont_accuracy_contact_stress, only: smooth_pressures, surface_compliance
  use epcont_accuracy_error_fields, only: compare_fields, error_fields
  use epcont_accuracy_narrow_zone, only: find_turned, shifted_loads, too_near
  use epcont_accuracy_patches, only: new_patch_table, patch_table, wide_patch
  use epcont_accuracy_sensitivity, only: contact_sensitivity, find_sensitivity
  use epcont_accuracy_unit_motion, only: closing_forces, unit_forces
  use epcont_accuracy_weights, only: estimate_weights, weights_of
  use epcont_accuracy_zone_error, only: estimate_zone, zone_error
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: alike, least_difference
  use epcont_contact_basis, only: contact_basis, new_basis
  use epcont_contact_problem, only: contact_problem
  use epcont_contact_scaling, only: scale_problem, scaled_problem
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_result_answer, only: answer_type
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: accuracy_type, assess

  !> Elements that are named as the worst.
  integer, parameter, public :: worst_count = 5
  !> A part of the resultant at one node of the mesh from which on it is a point load.
  real(wp), parameter :: concentrated = 0.5_wp

  !> Part of the energy that a mesh has at least for its errors to be measured by it.
  real(wp), parameter :: least_energy = 0.5_wp

  type :: accuracy_type
    real(wp) :: energy_norm = 0.0_wp               !! error of the mesh over the size of the answer, in the energy norm
    real(wp), allocatable :: element(:)            !! square of each element's error [energy] [elements]
    integer, allocatable :: worst(:)               !! elements with the largest errors
    type(zone_error), allocatable :: zone(:)
    real(wp) :: max_pressure = -1.0_wp             !! error of the largest pressure of all; negative: unknown [stress]
    logical :: pressure_unbounded = .false.        !! it grows with every finer mesh
    real(wp), allocatable :: approach(:)           !! negative: unknown [motions]
    logical, allocatable :: approach_unbounded(:)  !! it grows with every finer mesh [motions]
    real(wp) :: total_force = -1.0_wp              !! error of the total contact force; negative: unknown [force]
    real(wp), allocatable :: body_force(:, :)      !! of its resultants on bodies; negative: unknown [force] [2, answer's bodies]
    type(contact_sensitivity) :: sensitivity
    logical, allocatable :: weak(:)                !! pairs that errors may open, or close [pairs]
  end type accuracy_type

  !> Weights are measured on approaches: forces that pairs or bodies share are off by so much more.
  real(wp), parameter :: of_shares = 1.3_wp
  !> Errors are so much larger where a zone has too few pairs to see its pressures.
  real(wp), parameter :: unresolved = 1.4_wp
  !> A part of the products of elements that may not be trusted to cancel.
  real(wp), parameter :: uncertain = 1.0_wp/3.0_wp

  !> A unit load along a motion, or gaps that shrink.
  type :: unit_load
    real(wp), allocatable :: force(:)   !! contact forces under it [pairs]
    real(wp) :: product(2)              !! of its error and the scene's, of all elements, and of each without its sign
    real(wp) :: missing                 !! part of its energy
    logical :: shared                   !! of forces that may go from one pair or body to another: parts cancel that need not
  end type unit_load

contains

  pure subroutine assess(scene, linear, line, answer, accuracy)
    type(planned_scene), intent(in) :: scene
    type(linear_problem), intent(in) :: linear   !! of the last solve
    type(contact_line), intent(in) :: line
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(out) :: accuracy
    type(patch_table) :: table
    type(error_fields) :: field
    type(scaled_problem) :: problem
    type(contact_basis) :: basis
    real(wp), allocatable :: share(:, :)        !! of pairs in the sum of all, and in what bodies bear [pairs, any]
    real(wp), allocatable :: unit_force(:, :)   !! contact forces of unit loads, closing gaps [pairs, any]
    real(wp), allocatable :: off(:)             !! error of each approach, of the sum of forces, of what bodies bear
    integer, allocatable :: column(:, :)        !! of what bodies bear, of each body [2, bodies]
    integer, allocatable :: moved(:)            !! unit loads that say something
    logical :: carried, pressed
    integer :: j

    associate (model => scene%model, motions => scene%motions)
    pressed = any(answer%contact%force > 0.0_wp)
    carried = pressed .and. answer%converged   ! else the scene is that of a load that was not carried
    allocate (moved(0), unit_force(model%pairs, 0))
    if (carried) then
      problem = scale_problem(linear%problem)
      basis = new_basis(problem, answer%contact%force > 0.0_wp)
      call find_shares(model, motions, answer%contact%touching, answer%bodies, share, column)
      share = reshape([spread(1.0_wp, 1, model%pairs), share], [model%pairs, 1 + size(share, 2)])
      unit_force = reshape([unit_forces(problem, basis, motions%count), closing_forces(problem, basis, share)], &
                           [model%pairs, motions%count + size(share, 2)])
      moved = pack([(j, j=1, size(unit_force, 2))], any(unit_force /= 0.0_wp, dim=1) .and. &
                   [.not. answer%contact%motion_free, spread(.true., 1, size(share, 2))])
    end if
    table = new_patch_table(model)
    call compare_fields(scene, linear, answer, table, unit_force(:, moved), field)
    accuracy%element = field%element
    accuracy%energy_norm = sqrt(part(sum(field%element), sum(field%element) + abs(field%energy)))
    allocate (accuracy%worst(0))
    if (accuracy%energy_norm > least_difference) then
      accuracy%worst = worst_of(accuracy%element)
    else
      accuracy%energy_norm = 0.0_wp
      accuracy%element = 0.0_wp
      field%along = 0.0_wp
    end if
    allocate (accuracy%approach(motions%count), accuracy%body_force(2, size(answer%bodies)), source=-1.0_wp)
    allocate (accuracy%approach_unbounded(motions%count), accuracy%weak(model%pairs), source=.false.)
    allocate (accuracy%zone(0))
    if (.not. pressed) return

    call assess_zones(model, table, line, answer, smooth_pressures(model, table, linear%materials, field%smooth), &
                      accuracy%energy_norm**2*part(sum(accuracy%element, mask=.not. beside_point_loads(model, motions, table)), &
                                                   sum(accuracy%element)), accuracy)
    if (.not. carried) return

    accuracy%sensitivity = find_sensitivity(problem, basis, answer%contact%force, &
                                            travel(linear%problem, answer%contact%approach), answer%condition)
    ! What the last step of refinement has not changed is right.
    accuracy%sensitivity%rounding = min(accuracy%sensitivity%rounding, answer%last_correction)
    allocate (off(size(unit_force, 2)), source=0.0_wp)
    do j = 1, size(moved)
      off(moved(j)) = error_along(model, line, answer, table, unit_load(unit_force(:, moved(j)), field%along(:, j), &
                                  field%missing(j), moved(j) > max(1, motions%count)), accuracy)
    end do
    associate (of_motions => matmul(transpose(share), unit_force(:, :motions%count)))
      off(motions%count + 1:) = off(motions%count + 1:) &
                                + sum(abs(matmul(of_motions, shifted_loads(model, line, motions, answer))), dim=2)
    end associate
    accuracy%approach = merge(off(:motions%count), -1.0_wp, [(any(moved == j), j=1, motions%count)])
    accuracy%approach_unbounded = [(any(moved == j) .and. is_point_load(model, motions, table, j), j=1, motions%count)]
    call assess_forces(model, line, answer, share, column, off(motions%count + 1:), accuracy)
    call widen_pressures(answer, accuracy)
    accuracy%weak = find_weak(model, line, answer, linear%problem%flexibility, accuracy)
    end associate
  end subroutine assess

  !> The total contact force, and what of it each body bears: nothing is off where loads alone make it.
  pure subroutine assess_forces(model, line, answer, share, column, off, accuracy)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    type(answer_type), intent(in) :: answer
    real(wp), intent(in) :: share(:, :)      !! of each pair in the sum of all, and in what bodies bear [pairs, any]
    integer, intent(in) :: column(:, :)      !! of the latter, of each body [2, bodies]
    real(wp), intent(in) :: off(:)           !! errors of these sums that come from errors of gaps [force] [any]
    type(accuracy_type), intent(inout) :: accuracy
    real(wp) :: turned, turned_on(2, model%bodies)
    logical :: given(2, model%bodies)
    integer :: c, i

    given = .false.
    do i = 1, size(column, 2)
      given(:, answer%bodies(i)%body) = column(:, i) == 0
      if (model%has_rings()) given(1, answer%bodies(i)%body) = .false.
    end do
    call find_turned(model, line, answer, given, turned, turned_on)
    accuracy%total_force = summed(1) + turned
    do i = 1, size(column, 2)
      do c = 1, 2
        if (column(c, i) >= 0) accuracy%body_force(c, i) = 0.0_wp
        if (column(c, i) <= 0) cycle
        accuracy%body_force(c, i) = summed(1 + column(c, i)) + turned_on(c, answer%bodies(i)%body)
      end do
    end do

  contains

    !> With what waves bear, unless loads alone make the sum.
    pure real(wp) function summed(k)
      integer, intent(in) :: k

      summed = off(k)
      if (off(k) > least_difference*sum(answer%contact%force)) &
        summed = summed + force_of_waves(answer, accuracy, share(:, k))
    end function summed
  end subroutine assess_forces

  !> a/b, 0 where a is 0.
  pure real(wp) function part(a, b)
    real(wp), intent(in) :: a, b

    part = 0.0_wp
    if (a > 0.0_wp) part = a/b
  end function part

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
      worst = [worst, findloc(left .and. energy >= largest - alike*abs(largest), .true., dim=1)]
      left(worst(k)) = .false.
    end do
  end function worst_of

  !> What the gaps of the pairs are the sum of, added up [length] [pairs].
  pure function travel(problem, approach) result(length)
    type(contact_problem), intent(in) :: problem
    real(wp), intent(in) :: approach(:)   !! [motions]
    real(wp), allocatable :: length(:)

    length = abs(problem%initial_gap) + abs(problem%load_gap) + matmul(abs(problem%motion), abs(approach))
  end function travel

  !> Largest pressures and half-widths.
  pure subroutine assess_zones(model, table, line, answer, stress_pressure, energy, accuracy)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(contact_line), intent(in) :: line
    type(answer_type), intent(in) :: answer
    real(wp), intent(in) :: stress_pressure(:)   !! [pairs]
    real(wp), intent(in) :: energy               !! error of the mesh over all of it
    type(accuracy_type), intent(inout) :: accuracy
    integer :: z

    accuracy%zone = [(estimate_zone(model, table, line, answer, stress_pressure, energy, answer%zones(z)), &
                     z=1, size(answer%zones))]
    if (size(accuracy%zone) == 0) return
    z = maxloc(answer%zones%max_pressure, dim=1)
    accuracy%max_pressure = accuracy%zone(z)%pressure
    accuracy%pressure_unbounded = accuracy%zone(z)%unbounded
  end subroutine assess_zones

  !> Pressures are as much off as the total force, where that is not given by loads: of uniform ones nothing
  !! else tells.
  pure subroutine widen_pressures(answer, accuracy)
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(inout) :: accuracy
    real(wp) :: relative
    integer :: z

    relative = accuracy%total_force/sum(answer%contact%force)
    do z = 1, size(accuracy%zone)
      associate (pressure => accuracy%zone(z)%pressure)
        if (pressure >= 0.0_wp) pressure = max(pressure, relative*answer%zones(z)%max_pressure)
      end associate
    end do
    if (size(accuracy%zone) > 0) accuracy%max_pressure = accuracy%zone(maxloc(answer%zones%max_pressure, dim=1))%pressure
  end subroutine widen_pressures

  !> Error of an approach, or of the total contact force: the product of the errors of the scene and of its
  !! answer to a unit load along the motion, or to closing gaps, signed, with what contact at nodes alone lets
  !! the bodies come too near.
  pure real(wp) function error_along(model, line, answer, table, load, accuracy) result(error)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    type(answer_type), intent(in) :: answer
    type(patch_table), intent(in) :: table
    type(unit_load), intent(in) :: load
    type(accuracy_type), intent(in) :: accuracy
    real(wp) :: at_end, between, end_error, near, short, vague
    type(estimate_weights) :: weights
    integer :: z

    near = 0.0_wp
    end_error = 0.0_wp
    vague = 1.0_wp
    weights = weights_of(3, model%has_rings(), any(answer%plastic))   ! without a zone
    do z = 1, size(accuracy%zone)
      associate (zone => accuracy%zone(z), force => load%force(answer%zones(z)%pairs))
        weights = weights_of(model%kinds(zone%kind)%estimated_as, model%has_rings(), any(answer%plastic))
        at_end = answer%zones(z)%max_pressure*zone%half_length*surface_compliance(model, table, zone%peak)
        between = at_end*zone%resolution**2
        at_end = at_end*zone%end_resolution**2
        ! Between the nodes of flat faces there is no gap: where an edge or a tip makes the pressure, it says
        ! nothing of one.
        if (.not. zone%unbounded) near = near + weights%between*between*sum(force)
        ! Of a tilt of either sign the ends count, not the sum. Waves are as high above as below the gap that
        ! is meant.
        if (.not. zone%resolved) vague = unresolved
        end_error = end_error + sum(abs(force))*(weights%end*at_end + 2.0_wp*zone%wave_height + &
                                                 too_near(model, line, answer, table, zone, answer%zones(z)%pairs))
      end associate
    end do
    ! What a mesh misses is measured by what it has: each error is larger by as much as the energy of its
    ! field is too small.
    short = max(abs(load%product(1) - near), uncertain*load%product(2))
    if (load%shared) short = of_shares*(load%product(2) + abs(near))   ! no part cancels another
    error = weights%product*short &
            /max(least_energy, 1.0_wp - accuracy%energy_norm**2)/max(least_energy, 1.0_wp - load%missing) + end_error
    error = vague*error
  end function error_along

  !> Where motions are given, waves of the gap that are not pressed flat bear more than what is meant: the
  !! higher they are the more, and none of it where they are flat [force].
  pure real(wp) function force_of_waves(answer, accuracy, share) result(force)
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(in) :: accuracy
    real(wp), intent(in) :: share(:)   !! of each pair [pairs]
    integer :: z

    force = 0.0_wp
    do z = 1, size(accuracy%zone)
      associate (pairs => answer%zones(z)%pairs)
        force = force + min(1.0_wp, accuracy%zone(z)%waviness**3)*sum(abs(share(pairs))*answer%contact%force(pairs))
      end associate
    end do
  end function force_of_waves

  !> Is a SUPORT freedom the one node of its body's mesh that bears a load?
  pure logical function is_point_load(model, motions, table, j)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(patch_table), intent(in) :: table
    integer, intent(in) :: j

    associate (node => motions%node(j), c => motions%component(j))
      is_point_load = abs(model%load(c, node)) > concentrated*sum(abs(model%load(c, :)), mask=model%body == motions%body(j)) &
                      .and. count(model%leader(c, :) == node) == 1 .and. table%around%start(node + 1) > table%around%start(node)
    end associate
  end function is_point_load

  !> Elements at a load on one node, and around these: there no mesh is fine enough, and the contact does not
  !! feel it [elements].
  pure function beside_point_loads(model, motions, table) result(beside)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(patch_table), intent(in) :: table
    logical :: beside(model%elements)
    integer :: seen(model%elements)
    integer, allocatable :: patch(:)
    integer :: count, j

    beside = .false.
    seen = 0
    allocate (patch(64))
    do j = 1, motions%count
      if (.not. is_point_load(model, motions, table, j)) cycle
      call wide_patch(model, table, motions%node(j), seen, patch, count)
      beside(patch(:count)) = .true.
    end do
  end function beside_point_loads

  !> Pairs pressed less than the error of their force, or open less than such a force would close.
  pure function find_weak(model, line, answer, flexibility, accuracy) result(weak)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    type(answer_type), intent(in) :: answer
    real(wp), intent(in) :: flexibility(:, :)   !! [length/force] [pairs, pairs]
    type(accuracy_type), intent(in) :: accuracy
    logical, allocatable :: weak(:)
    real(wp), allocatable :: off(:)   !! error of the pressure [stress] [pairs]
    real(wp) :: force
    integer :: i, k, z

    allocate (off(model%pairs), source=0.0_wp)
    do z = 1, size(accuracy%zone)
      associate (pairs => answer%zones(z)%pairs)
        off(pairs) = max(0.0_wp, accuracy%zone(z)%pressure)
        do i = 1, 2
          associate (beyond => line%neighbour(:, pairs(merge(1, size(pairs), i == 1))))
            do k = 1, 2
              if (beyond(k) > 0) off(beyond(k)) = max(off(beyond(k)), accuracy%zone(z)%pressure)
            end do
          end associate
        end do
      end associate
    end do
    allocate (weak(model%pairs))
    do k = 1, model%pairs
      force = off(k)*line%tributary(k) + accuracy%sensitivity%rounding*maxval(answer%contact%force)
      if (answer%contact%touching(k)) then
        weak(k) = answer%contact%force(k) <= force
      else
        weak(k) = answer%contact%gap(k) <= flexibility(k, k)*force
      end if
    end do
  end function find_weak
end module epcont_accuracy_accuracy
