!> Error estimates of an answer: mesh error in the energy norm, in the approaches, in the total contact force
!> and its resultant on each body, and in the largest pressure and half-width of each zone. Also the effect of
!> rounding on contact forces, and the pairs with uncertain contact state.
module epcont_accuracy_accuracy
  use epcont_accuracy_error_fields, only: body_fields, compare_fields, error_fields
  use epcont_accuracy_error_sums, only: shift_errors, sum_errors, with_waves
  use epcont_accuracy_narrow_zone, only: find_turned, shifted_loads, too_near
  use epcont_accuracy_shear_error, only: add_shear_errors
  use epcont_accuracy_patches, only: new_patch_table, patch_table, wide_patch
  use epcont_accuracy_surface_line, only: first_element, new_surface_line, smooth_pressures, surface_line
  use epcont_accuracy_unit_loads, only: find_unit_loads, unit_loads
  use epcont_accuracy_weights, only: concentrated
  use epcont_accuracy_zone_error, only: estimate_zone, zone_error
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference, no_effect
  use epcont_element_kinematics, only: directions
  use epcont_linear_contact_rule, only: contact_sensitivity
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_model_arrays, only: angle
  use epcont_plan_planned_model, only: planned_model
  use epcont_result_answer, only: answer_type, pair_slips, pair_sticks
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: accuracy_type, assess, kept_estimates

  !> Number of elements named as the worst.
  integer, parameter :: worst_count = 5

  type :: accuracy_type
    !> Mesh error relative to the size of the answer, in the energy norm
    real(wp) :: energy_norm = 0.0_wp
    real(wp), allocatable :: element(:)            !! square of each element's error [energy] [elements]
    integer, allocatable :: worst(:)               !! elements with the largest errors
    type(zone_error), allocatable :: zone(:)
    !> Zone with the largest pressure; 0 if there is no zone. Of pressures equal up to rounding, the zone with
    !! the worst estimate is taken, then the first.
    integer :: leading = 0
    !> Error of this pressure; negative: unknown [stress]
    real(wp) :: max_pressure = -1.0_wp
    real(wp), allocatable :: approach(:)           !! errors; negative: unknown [motions]
    logical, allocatable :: approach_unbounded(:)  !! singular: diverges with mesh refinement [motions]
    !> Error of the total contact force; negative: unknown [force]
    real(wp) :: total_force = -1.0_wp
    !> Errors of its resultants on bodies; negative: unknown [force] [directions, answer's bodies]
    real(wp), allocatable :: body_force(:, :)
    type(contact_sensitivity) :: sensitivity
    logical, allocatable :: weak(:)                !! pairs with uncertain contact state [pairs]
    !> Tangential rows that may slip although they stick, or the reverse; not allocated: unknown
    logical, allocatable :: weak_friction(:)       !! [tangential rows]
    !> The SUPORT DOF of the mode carries a point load [motions]
    logical, allocatable, private :: point_load(:)
  contains
    procedure, private :: assess_mesh
    procedure, private :: assess_zones
    procedure, private :: assess_sums
    procedure, private :: assess_forces
    procedure, private :: find_weak
  end type accuracy_type

  !> Data that the estimates of the next load case reuse.
  type :: kept_estimates
    type(patch_table) :: table
    type(surface_line) :: surface                !! except its pressures
    type(unit_loads) :: loads
    type(body_fields), allocatable :: field(:)   !! adjoint fields of these loads [bodies]
  end type kept_estimates

contains

  !> Estimate the errors of an answer.
  subroutine assess(scene, linear, line, kept, answer, accuracy)
    type(planned_model), intent(in) :: scene       !! solved model
    type(linear_problem), intent(inout) :: linear  !! of the last solve
    type(contact_line), intent(in) :: line         !! of the pairs
    type(kept_estimates), intent(inout) :: kept    !! in: of the previous load case, if any; out: of this one
    !> With its pressures and zones; the condition number is added
    type(answer_type), intent(inout) :: answer
    type(accuracy_type), intent(out) :: accuracy   !! its error estimates
    type(kept_estimates) :: none
    type(error_fields) :: field
    logical :: carried, pressed
    logical :: same   ! adjoint loads as before
    integer :: motions

    pressed = any(answer%contact%force > 0.0_wp)
    ! Otherwise the load is not carried, or the stiffness is unknown.
    carried = pressed .and. answer%converged .and. answer%condition < huge(1.0_wp)
    same = .false.
    if (carried) then
      call find_unit_loads(scene, linear, answer, kept%loads, same)
    else
      kept%loads = none%loads
      allocate (kept%loads%contact%force(scene%model%contact%rows(), 0), kept%loads%contact%unit(0))
    end if
    if (.not. same) then
      if (allocated(kept%field)) deallocate (kept%field)
      allocate (kept%field(scene%model%mesh%bodies))
    end if
    motions = scene%motions%count
    accuracy%point_load = find_point_loads(scene)
    allocate (accuracy%approach(motions), source=-1.0_wp)
    allocate (accuracy%body_force(directions, size(answer%bodies)), source=-1.0_wp)
    allocate (accuracy%approach_unbounded(motions), accuracy%weak(scene%model%contact%pairs), source=.false.)
    allocate (accuracy%zone(0))
    call accuracy%assess_mesh(scene, linear, kept, answer, field)
    if (answer%condition < huge(1.0_wp)) call linear%estimate_condition(answer%condition)
    if (pressed) call accuracy%assess_zones(scene, linear, line, kept, answer, field)
    if (carried) call accuracy%assess_sums(scene, linear, line, kept, answer, field)
    if (pressed .and. scene%model%contact%has_friction()) &
      call add_shear_errors(scene%model, kept%surface, answer, accuracy%zone)
    accuracy%leading = leading_zone(answer%zones%max_pressure, accuracy%zone)
    if (accuracy%leading > 0) accuracy%max_pressure = accuracy%zone(accuracy%leading)%pressure
  end subroutine assess

  !> Choose the leading zone: singular comes before unresolved, and unresolved before the largest error.
  pure integer function leading_zone(pressure, zone) result(leading)
    real(wp), intent(in) :: pressure(:)            !! largest pressure of each zone [stress]
    type(zone_error), intent(in) :: zone(:)        !! errors of each
    logical :: worst(size(zone))

    leading = 0
    if (size(worst) == 0) return
    associate (off => zone%pressure)
      worst = pressure >= maxval(pressure) - no_effect*abs(maxval(pressure))
      if (any(worst .and. zone%unbounded)) worst = worst .and. zone%unbounded
      if (any(worst .and. .not. zone%resolved)) worst = worst .and. .not. zone%resolved
      leading = findloc(worst .and. off >= maxval(off, mask=worst)*(1.0_wp - no_effect), .true., dim=1)
      if (leading == 0) leading = findloc(worst, .true., dim=1)   ! all errors are unknown
    end associate
  end function leading_zone

  !> Estimate the mesh error in the energy norm, and find the elements with the largest part of it.
  subroutine assess_mesh(self, scene, linear, kept, answer, field)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! solved model
    type(linear_problem), intent(inout) :: linear  !! of its last solve
    type(kept_estimates), intent(inout) :: kept    !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(error_fields), intent(out) :: field       !! strain errors
    if (kept%table%places == 0) kept%table = new_patch_table(scene%model)
    call compare_fields(scene, linear, answer, kept%table, kept%loads%contact, kept%field, field)
    self%element = field%element
    associate (error => sum(field%element))
      if (error > least_difference**2*held_energy(scene, linear)) &
        self%energy_norm = sqrt(error/(error + abs(field%energy)))
    end associate
    if (self%energy_norm > least_difference) then
      self%worst = worst_of(self%element)
    else
      self%energy_norm = 0.0_wp
      self%element = 0.0_wp
      self%worst = [integer ::]
      field%along = 0.0_wp
    end if
  end subroutine assess_mesh

  !> Approximate strain energy if all thermal expansion were fixed. If bodies expand freely, the remaining
  !! strain energy is rounding of this value.
  pure real(wp) function held_energy(scene, linear) result(energy)
    type(planned_model), intent(in) :: scene       !! solved model
    type(linear_problem), intent(in) :: linear     !! of its last solve

    energy = 0.0_wp
    if (allocated(scene%model%loads%free_strain)) &
      energy = sum(linear%operator%volume*scene%model%sections%young(linear%materials%of_point)* &
                   scene%model%loads%free_strain**2)
  end function held_energy

  !> Estimate the errors of the largest pressures and half-widths.
  subroutine assess_zones(self, scene, linear, line, kept, answer, field)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! solved model
    type(linear_problem), intent(in) :: linear     !! of its last solve
    type(contact_line), intent(in) :: line         !! of its pairs
    type(kept_estimates), intent(inout) :: kept    !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(error_fields), intent(in) :: field        !! strain errors
    real(wp) :: energy   !! mesh error of the whole model, except that of point loads
    logical :: yielded
    integer :: z

    associate (pressure => smooth_pressures(scene%model, linear%materials, field%smooth))
      if (.not. allocated(kept%surface%bend)) kept%surface = new_surface_line(scene%model, line, pressure)
      kept%surface%smooth_pressure = pressure
    end associate
    energy = 0.0_wp
    if (self%energy_norm > 0.0_wp) energy = self%energy_norm**2* &
      max(0.0_wp, sum(self%element, mask=.not. beside_point_loads(scene, kept%table, self%point_load)) &
          /sum(self%element))
    yielded = any(answer%plastic)
    self%zone = [(estimate_zone(scene%model, kept%surface, answer, yielded, energy, answer%zones(z)), &
                      z=1, size(answer%zones))]
    do z = 1, size(answer%zones)
      self%zone(z)%too_near = too_near(scene%model, kept%surface, answer%contact%force, &
                                           self%zone(z), answer%zones(z)%pairs)
    end do
  end subroutine assess_zones

  !> Estimate the errors of approaches and forces, and find the pairs with uncertain state.
  subroutine assess_sums(self, scene, linear, line, kept, answer, field)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! solved model
    type(linear_problem), intent(inout) :: linear  !! of its last solve
    type(contact_line), intent(in) :: line         !! of its pairs
    type(kept_estimates), intent(in) :: kept       !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(error_fields), intent(in) :: field        !! strain errors
    !> Errors of the assessed approaches, of the total contact force, and of the forces on bodies
    real(wp) :: off(size(kept%loads%contact%unit))
    integer :: j

    self%sensitivity = linear%rule%sensitivity(answer, answer%condition)
    ! A change by the last refinement step bounds the rounding error from above.
    self%sensitivity%rounding = min(self%sensitivity%rounding, answer%last_correction)
    off = sum_errors(kept%loads%contact, kept%surface, answer, self%zone, field, self%energy_norm)
    off(size(kept%loads%contact%motion) + 1:) = off(size(kept%loads%contact%motion) + 1:) + &
      shift_errors(kept%loads%contact%shared, shifted_loads(scene%model, line, scene%motions, answer))
    associate (motion => kept%loads%contact%motion)
      do j = 1, size(motion)
        if (kept%loads%contact%unit(j) <= 0.0_wp) cycle
        self%approach(motion(j)) = off(j)
        self%approach_unbounded(motion(j)) = self%point_load(motion(j))
      end do
      call self%assess_forces(scene, line, kept%loads, answer, off(size(motion) + 1:))
    end associate
    ! If loads do not determine the total force, pressures are at least as wrong as this force. Uniform
    ! pressures show no other error.
    where (self%zone%pressure >= 0.0_wp) self%zone%pressure = &
      max(self%zone%pressure, &
          self%total_force/sum(answer%contact%force)*answer%zones%max_pressure)
    call self%find_weak(scene, linear, line, answer)
  end subroutine assess_sums

  !> Estimate errors of the total contact force and its resultants on bodies. Zero if loads alone determine
  !! them.
  subroutine assess_forces(self, scene, line, loads, answer, off)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! solved model
    type(contact_line), intent(in) :: line         !! of its pairs
    type(unit_loads), intent(in) :: loads          !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    real(wp), intent(in) :: off(:)   !! errors of sums, from errors of gaps [force] [any]
    real(wp) :: turned, turned_on(directions, scene%model%mesh%bodies)
    logical :: given(directions, scene%model%mesh%bodies)
    integer :: c, i

    given = .false.
    given(:, answer%bodies%body) = loads%column == 0
    if (scene%model%has_rings()) given(1, :) = .false.
    call find_turned(scene%model, line, answer, given, turned, turned_on)
    where (loads%column == 0) self%body_force = 0.0_wp
    if (.not. loads%contact%sound) return
    self%total_force = with_waves(off, 1, loads%contact%share, answer, self%zone) + turned
    do i = 1, size(answer%bodies)
      do c = 1, directions
        if (loads%column(c, i) > 0) self%body_force(c, i) = &
          with_waves(off, loads%column(c, i), loads%contact%share, answer, self%zone) &
          + turned_on(c, answer%bodies(i)%body)
      end do
    end do
  end subroutine assess_forces

  !> Is the SUPORT DOF of a mode at the only loaded mesh node of its body? [motions]
  pure function find_point_loads(scene) result(is_one)
    type(planned_model), intent(in) :: scene       !! solved model
    logical :: is_one(scene%motions%count)
    real(wp) :: on_body(directions, scene%model%mesh%bodies), own(directions, scene%model%mesh%nodes)
    integer :: c, followers(directions, scene%model%mesh%nodes), i, j

    on_body = 0.0_wp
    followers = 0
    associate (model => scene%model)
      own = model%loads%load
      ! mass forces do not act on single nodes
      if (allocated(model%loads%body_force)) own = own - model%loads%body_force
      do i = 1, model%mesh%nodes
        on_body(:, model%mesh%body(i)) = on_body(:, model%mesh%body(i)) + abs(model%loads%load(:, i))
        do c = 1, directions
          followers(c, model%constraints%leader(c, i)) = followers(c, model%constraints%leader(c, i)) + 1
        end do
      end do
      do j = 1, size(is_one)
        associate (node => scene%motions%node(j), c => scene%motions%component(j))
          is_one(j) = .false.
          if (c == angle) cycle
          is_one(j) = abs(own(c, node)) > concentrated*on_body(c, model%mesh%body(node)) .and. &
                      followers(c, node) == 1 .and. first_element(model, node) > 0
        end associate
      end do
    end associate
  end function find_point_loads

  !> Find the elements at a point load, and their neighbours [elements]. No mesh is fine enough there, and the
  !! contact does not depend on it.
  pure function beside_point_loads(scene, table, point_load) result(beside)
    type(planned_model), intent(in) :: scene       !! solved model
    type(patch_table), intent(in) :: table         !! of its elements
    logical, intent(in) :: point_load(:)           !! [motions]
    logical :: beside(scene%model%mesh%elements)
    integer, allocatable :: patch(:)
    integer :: j

    beside = .false.
    do j = 1, size(point_load)
      if (.not. point_load(j)) cycle
      call wide_patch(scene%model, table, scene%motions%node(j), patch)
      beside(patch) = .true.
    end do
  end function beside_point_loads

  !> Find pairs with a force below its error, and open pairs that such a force would close; and with friction
  !! those that may slip although they stick, or stick although they slip.
  pure subroutine find_weak(self, scene, linear, line, answer)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! solved model
    type(linear_problem), intent(in) :: linear     !! of its last solve
    type(contact_line), intent(in) :: line         !! of its pairs
    type(answer_type), intent(in) :: answer        !! of the last solve
    real(wp) :: off(scene%model%contact%pairs)   !! error of the pressure [stress]
    real(wp), allocatable :: compliance(:)       !! [length/force] [rows]
    integer :: k, state(size(scene%model%contact%sliding)), z

    compliance = linear%rule%compliance()
    off = 0.0_wp
    do z = 1, size(self%zone)
      off(answer%zones(z)%pairs) = max(0.0_wp, self%zone(z)%pressure)
      associate (beyond => answer%zones(z)%beyond)
        do k = 1, size(beyond)
          off(beyond(k)) = max(off(beyond(k)), self%zone(z)%pressure)
        end do
      end associate
    end do
    ! From here on `off` is the error of the force. The smallest gap error is the compliance times this error.
    off = off*line%tributary + self%sensitivity%rounding*maxval(answer%contact%force)
    associate (contact => answer%contact, n => size(off), sliding => scene%model%contact%sliding)
      self%weak = merge(contact%force <= off, contact%gap <= compliance(:n)*off, contact%touching)
      if (.not. allocated(contact%slip)) return
      ! Friction has the error of its limit.
      off = scene%model%contact%friction*off
      state = answer%friction_states(sliding)
      self%weak_friction = state == pair_sticks .and. &
        scene%model%contact%friction(sliding)*contact%force(sliding) - abs(contact%friction_force) <= &
        off(sliding) .or. state == pair_slips .and. abs(contact%slip) <= compliance(n + 1:)*off(sliding)
    end associate
  end subroutine find_weak

  !> Find the elements with the largest errors, largest first; of equal ones (up to rounding), the first.
  !! Empty if there are no elements.
  pure function worst_of(energy) result(worst)
    real(wp), intent(in) :: energy(:)
    integer, allocatable :: worst(:)
    logical :: left(size(energy))
    real(wp) :: largest
    integer :: k

    allocate (worst(0))
    left = .true.
    do k = 1, min(worst_count, size(energy))
      largest = maxval(energy, mask=left)   ! rounding may make it negative
      worst = [worst, findloc(left .and. energy >= largest - no_effect*abs(largest), .true., dim=1)]
      left(worst(k)) = .false.
    end do
  end function worst_of
end module epcont_accuracy_accuracy
