!> What the figures of an answer are worth: the error of the mesh in the energy norm, in the approach, in the
!> total contact force and what of it each body bears, in the largest pressure and the half-width of each
!> zone; what rounding may have done to the contact forces; pairs that may as well be open.
module epcont_accuracy_accuracy
  use epcont_accuracy_error_fields, only: body_fields, compare_fields, error_fields
  use epcont_accuracy_error_sums, only: shift_errors, sum_errors, with_waves
  use epcont_accuracy_narrow_zone, only: find_turned, shifted_loads, too_near
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
    !> The motion's SUPORT freedom bears one [motions]
    logical, allocatable, private :: point_load(:)
  contains
    procedure, private :: assess_mesh
    procedure, private :: assess_zones
    procedure, private :: assess_sums
    procedure, private :: assess_forces
    procedure, private :: find_weak
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
    type(linear_problem), intent(inout) :: linear  !! of the last solve
    type(contact_line), intent(in) :: line         !! of the pairs
    type(kept_estimates), intent(inout) :: kept    !! of the load case before, if any; of this
    !> With its pressures and zones; the condition is added to it
    type(answer_type), intent(inout) :: answer
    type(accuracy_type), intent(out) :: accuracy   !! of its figures
    type(kept_estimates) :: none
    type(error_fields) :: field
    logical :: carried, pressed
    logical :: same   ! unit loads as before
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
    accuracy%point_load = find_point_loads(scene)
    allocate (accuracy%approach(motions), source=-1.0_wp)
    allocate (accuracy%body_force(directions, size(answer%bodies)), source=-1.0_wp)
    allocate (accuracy%approach_unbounded(motions), accuracy%weak(scene%model%pairs), source=.false.)
    allocate (accuracy%zone(0))
    call accuracy%assess_mesh(scene, linear, kept, answer, field)
    if (answer%condition < huge(1.0_wp)) call linear%estimate_condition(answer%condition)
    if (pressed) call accuracy%assess_zones(scene, linear, line, kept, answer, field)
    if (carried) call accuracy%assess_sums(scene, linear, line, kept, answer, field)
    accuracy%leading = leading_zone(answer%zones%max_pressure, accuracy%zone)
    if (accuracy%leading > 0) accuracy%max_pressure = accuracy%zone(accuracy%leading)%pressure
  end subroutine assess

  !> As `leading` has it: unbounded comes before not resolved, and that before the largest error.
  pure integer function leading_zone(pressure, zone) result(leading)
    real(wp), intent(in) :: pressure(:)            !! largest one of each zone [stress]
    type(zone_error), intent(in) :: zone(:)        !! errors of each
    logical :: worst(size(zone))

    leading = 0
    if (size(worst) == 0) return
    associate (off => zone%pressure)
      worst = pressure >= maxval(pressure) - no_effect*abs(maxval(pressure))
      if (any(worst .and. zone%unbounded)) worst = worst .and. zone%unbounded
      if (any(worst .and. .not. zone%resolved)) worst = worst .and. .not. zone%resolved
      leading = findloc(worst .and. off >= maxval(off, mask=worst)*(1.0_wp - no_effect), .true., dim=1)
      if (leading == 0) leading = findloc(worst, .true., dim=1)   ! of none the error is known
    end associate
  end function leading_zone

  !> Estimate the mesh error in the energy norm, and find the elements with the largest part of it.
  subroutine assess_mesh(self, scene, linear, kept, answer, field)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! that was solved
    type(linear_problem), intent(inout) :: linear  !! of its last solve
    type(kept_estimates), intent(inout) :: kept    !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(error_fields), intent(out) :: field       !! errors of strains
    if (kept%table%places == 0) kept%table = new_patch_table(scene%model)
    call compare_fields(scene, linear, answer, kept%table, kept%loads%contact, kept%field, field)
    self%element = field%element
    associate (error => sum(field%element))
      if (error > least_difference**2*held_energy(scene, linear, answer%load_factor)) &
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

  !> What the energy would be, about, if nothing gave way to the temperatures: where bodies expand freely,
  !! rounding of that is all there is.
  pure real(wp) function held_energy(scene, linear, load_factor) result(energy)
    type(planned_model), intent(in) :: scene       !! that was solved
    type(linear_problem), intent(in) :: linear     !! of its last solve
    real(wp), intent(in) :: load_factor            !! of the temperatures

    energy = 0.0_wp
    if (allocated(scene%model%free_strain)) &
      energy = sum(linear%operator%volume*scene%model%young(linear%materials%of_point)* &
                   (load_factor*scene%model%free_strain)**2)
  end function held_energy

  !> Largest pressures and half-widths.
  subroutine assess_zones(self, scene, linear, line, kept, answer, field)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! that was solved
    type(linear_problem), intent(in) :: linear     !! of its last solve
    type(contact_line), intent(in) :: line         !! of its pairs
    type(kept_estimates), intent(inout) :: kept    !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(error_fields), intent(in) :: field        !! errors of strains
    real(wp) :: energy   !! error of the mesh over all of it, but for that of point loads
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

  !> Approaches and forces, and what errors may do to pairs.
  subroutine assess_sums(self, scene, linear, line, kept, answer, field)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! that was solved
    type(linear_problem), intent(inout) :: linear  !! of its last solve
    type(contact_line), intent(in) :: line         !! of its pairs
    type(kept_estimates), intent(in) :: kept       !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(error_fields), intent(in) :: field        !! errors of strains
    !> Error of each assessed approach, of the total contact force, and of the forces on bodies
    real(wp) :: off(size(kept%loads%contact%unit))
    integer :: j

    self%sensitivity = linear%rule%sensitivity(answer, answer%condition)
    ! What the last step of refinement has not changed is right.
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
    ! Pressures are as much off as the total force, where that is not given by loads: of uniform ones
    ! nothing else tells.
    where (self%zone%pressure >= 0.0_wp) self%zone%pressure = &
      max(self%zone%pressure, &
          self%total_force/sum(answer%contact%force)*answer%zones%max_pressure)
    self%weak = self%find_weak(scene, linear, line, answer)
  end subroutine assess_sums

  !> The total contact force, and what of it each body bears: nothing is off where loads alone make it.
  subroutine assess_forces(self, scene, line, loads, answer, off)
    class(accuracy_type), intent(inout) :: self
    type(planned_model), intent(in) :: scene       !! that was solved
    type(contact_line), intent(in) :: line         !! of its pairs
    type(unit_loads), intent(in) :: loads          !! of this load case
    type(answer_type), intent(in) :: answer        !! of the last solve
    real(wp), intent(in) :: off(:)   !! errors of sums that come from errors of gaps [force] [any]
    real(wp) :: turned, turned_on(directions, scene%model%bodies)
    logical :: given(directions, scene%model%bodies)
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

  !> Is the SUPORT freedom of a motion the one node of its body's mesh that bears a load? [motions]
  pure function find_point_loads(scene) result(is_one)
    type(planned_model), intent(in) :: scene       !! that was solved
    logical :: is_one(scene%motions%count)
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
      do j = 1, size(is_one)
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
  pure function beside_point_loads(scene, table, point_load) result(beside)
    type(planned_model), intent(in) :: scene       !! that was solved
    type(patch_table), intent(in) :: table         !! of its elements
    logical, intent(in) :: point_load(:)           !! [motions]
    logical :: beside(scene%model%elements)
    integer, allocatable :: patch(:)
    integer :: j

    beside = .false.
    do j = 1, size(point_load)
      if (.not. point_load(j)) cycle
      call wide_patch(scene%model, table, scene%motions%node(j), patch)
      beside(patch) = .true.
    end do
  end function beside_point_loads

  !> Pairs pressed less than the error of their force, or open less than such a force would close [pairs].
  pure function find_weak(self, scene, linear, line, answer) result(weak)
    class(accuracy_type), intent(in) :: self
    type(planned_model), intent(in) :: scene       !! that was solved
    type(linear_problem), intent(in) :: linear     !! of its last solve
    type(contact_line), intent(in) :: line         !! of its pairs
    type(answer_type), intent(in) :: answer        !! of the last solve
    logical, allocatable :: weak(:)
    real(wp) :: off(scene%model%pairs)   !! error of the pressure [stress]
    real(wp), allocatable :: compliance(:)
    integer :: k, z

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
    ! From here on the error of the force. The smallest error of the gap is the compliance times that.
    off = off*line%tributary + self%sensitivity%rounding*maxval(answer%contact%force)
    weak = merge(answer%contact%force <= off, &
                 answer%contact%gap <= compliance*off, &
                 answer%contact%touching)
  end function find_weak

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
