!> Check an answer, with its displacements and forces alone as input.
!>
!> The check shares nothing with the solver. Strains come from differences of the interpolated displacements
!> (epcont_certificate_unit_strains), stresses on the curve from the paper's equations
!> (epcont_certificate_yielding), nodal forces from the work of the stresses in unit displacements.
module epcont_certificate_certificate
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: valid_to
  use epcont_certificate_element_checks, only: checked_elements, check_elements, ratio
  use epcont_certificate_free_expansion, only: expansion_type, held_stress, part_of_held
  use epcont_certificate_increment_work, only: point_energies, work_state
  use epcont_certificate_mass_force, only: given_load
  use epcont_certificate_scene, only: overlaps_type
  use epcont_certificate_tied, only: check_springs, check_ties, gather_ties, longest_arms
  use epcont_certificate_unit_strains, only: find_slopes, largest_face
  use epcont_certificate_yielding, only: replayed_history
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_kinematics, only: directions
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: certificate_type, certify

  real(wp), parameter :: &
    !> Number of rounding errors in a gap.
    roundings = 8.0_wp, &
    !> Stress errors are this multiple of `lost_stress`, since an element has several nodes.
    several = 4.0_wp, &
    !> Largest rounding error of the gaps, relative to the deformation of the bodies. Much larger
    !! displacements leave no digits.
    largest_rounding = 1.0e-6_wp

  !> Largest strain of an element by a rigid-body displacement, in roundings of its displacements. Chains of
  !! 40 hinges were seen to reach 750, by cancelling sums.
  real(wp), parameter, public :: most_roundings = 1.0e4_wp
  !> Smallest deformation: no length divided by it overflows.
  real(wp), parameter :: least_length = 1.0e-200_wp

  type :: certificate_type
    real(wp) :: equilibrium = 0.0_wp      !! largest unbalanced nodal force / largest sum of element forces
    real(wp) :: smallest_force = 0.0_wp   !! [force]
    real(wp) :: smallest_gap = 0.0_wp     !! [length]
    real(wp) :: overlap = 0.0_wp          !! largest penetration of a pair, minus its rounding error [length]
    real(wp) :: force_gap = 0.0_wp        !! largest |R gap| [force*length]
    real(wp) :: excess = 0.0_wp           !! largest friction force above mu R [force]
    !> Largest slip times the friction force that is missing against it, up to mu R [force*length]
    real(wp) :: force_slip = 0.0_wp
    real(wp) :: off_curve = 0.0_wp        !! largest stress error (`check_stress`)
    real(wp) :: motion_strain = 0.0_wp    !! largest strain by rigid-body displacements / its rounding error
    real(wp) :: lost_stress = 0.0_wp      !! largest stress error by rounding of displacements, relative
    real(wp) :: rounding_stress = 0.0_wp  !! the same [stress]
    real(wp) :: stress_roundings = 0.0_wp !! largest stress / stress error by rounding there
    real(wp) :: ties = 0.0_wp             !! violation of RBE2 or MPC / largest displacement
    real(wp) :: energy = 0.0_wp           !! |work of the forces - of the stresses| / sum of |terms|
    real(wp) :: force_scale = 1.0_wp      !! largest contact force [force]
    real(wp) :: length_scale = 1.0_wp     !! work / forces: deformation of the bodies [length]
    real(wp) :: gap_rounding = 0.0_wp     !! rounding of the gaps of closed pairs, from displacements [length]
    real(wp) :: curve_tolerance = valid_to  !! largest stress error that the iteration allows
    real(wp) :: off_curve_limit = valid_to  !! limit for a valid answer: rounding may add as much
    logical :: balanced = .false.         !! all values except `off_curve` are within tolerance
    logical :: valid = .false.            !! `off_curve` is within tolerance too
    type(overlaps_type) :: scene          !! penetration of bodies; searched if all else is valid
    type(work_state), allocatable :: worked   !! increments: state and energy after the increment
  contains
    procedure :: figures
    procedure :: has_spoilt
  end type certificate_type

  !> Number of elements that a thread takes at once.
  integer, parameter :: at_once = 4096

  !> Checked values, as sentences of messages.
  character(len=*), parameter :: off_the_curve = 'stress error'
  character(len=*), parameter, public :: figure_name(11) = [character(len=70) :: &
    'equilibrium residual', off_the_curve, 'energy balance', 'tensile contact force', &
    'penetration', 'contact force at an open gap', &
    'friction force above mu R', 'slip without the full friction force against it', &
    'rounding error of gaps relative to the deformation', &
    'strain by rigid-body displacements relative to its rounding error', &
    'violation of RBE2 or MPC']

  !> Sums over all elements and pairs.
  type :: balance_type
    real(wp), allocatable :: residual(:, :)      !! residual [force] [directions, nodes]
    !> Sum of absolute element forces at each node [force] [nodes]
    real(wp), allocatable :: element_force(:)
    real(wp) :: stored = 0.0_wp, work = 0.0_wp   !! work of the stresses, and of the forces [energy]
    real(wp) :: terms = 0.0_wp                   !! sum of absolute terms of these two sums
    type(expansion_type) :: expansion
    type(point_energies) :: energy               !! increments
    real(wp) :: strained = 0.0_wp                !! sum of volume times largest strain over all points
                                                 !! [length**3]
  end type balance_type

contains

  !> Check an answer. Its inputs are the displacements with and without rigid-body displacements, the
  !! reactions, the stresses at the integration points and the contact forces.
  subroutine certify(model, answer, curve_tolerance, found, worked)
    type(model_type), intent(in) :: model   !! model
    type(answer_type), intent(in) :: answer   !! answer to check
    real(wp), intent(in) :: curve_tolerance   !! largest stress error that the iteration allows
    type(certificate_type), intent(out) :: found   !! the certificate, without its search for penetration
    !> Increments: state and energy before the increment
    type(work_state), intent(in), optional :: worked
    real(wp), dimension(directions, model%mesh%nodes) :: load
    real(wp), dimension(directions, model%mesh%nodes) :: start   ! displacements before the increment
    type(balance_type) :: total
    real(wp) :: forces, largest_force, largest_stress, length
    real(wp), dimension(size(model%constraints%platen)) :: torque, turn   ! of the rotating platens
    real(wp) :: given_force   ! largest load or spring force [force]
    real(wp) :: face          ! face of the largest element [length**2]
    real(wp) :: springs       ! work of spring forces
    logical :: unstressed     ! stresses and forces are rounding errors of zero

    load = given_load(model)
    allocate (total%residual(directions, model%mesh%nodes), total%element_force(model%mesh%nodes), &
              source=0.0_wp)
    call check_springs(model, answer%displacement, total%residual, total%element_force, total%stored)
    springs = total%stored
    given_force = max(maxval(abs(load)), maxval(total%element_force))
    face = largest_face(model)
    largest_stress = max(maxval(abs(answer%point_stress)), part_of_held*held_stress(model), given_force/face)
    if (present(worked)) found%worked = worked
    call add_elements(model, answer, largest_stress, total, found)
    if (present(worked)) then
      found%worked%friction = 0.0_wp
      found%worked%stored = 0.5_wp*springs + total%energy%stored
      found%worked%force = total%residual
    end if
    total%residual = total%residual - load - answer%reaction
    unstressed = given_force == 0.0_wp .and. found%stress_roundings <= most_roundings
    if (unstressed) found%off_curve = 0.0_wp
    ! The accuracy of the gaps must match the deformation of the bodies, not rigid-body displacements, and not
    ! loads that a support takes directly.
    forces = sum(abs(load + answer%reaction)) + sum(abs(answer%contact%row_forces()))
    length = ratio(max(abs(total%stored), total%stored - total%expansion%work), forces)
    associate (u => answer%displacement, reaction => answer%reaction)
      ! Bodies without forces do not deform: rigid-body displacements close the gaps.
      if (unstressed) length = maxval(abs(u))
      if (total%expansion%held_work > 0.0_wp) length = max(length, &
          part_of_held*maxval(abs(answer%deformation)))
      found%length_scale = max(length, least_length)
      total%work = sum(load*u) + sum(reaction*u)
      total%terms = sum(abs(load*u)) + sum(abs(reaction*u)) + abs(total%stored) + &
              part_of_held*total%expansion%held_work
    end associate
    start = 0.0_wp
    if (present(worked)) start = worked%displacement
    if (model%contact%pairs > 0) call add_pairs(model, answer, load, start, total, found)
    largest_force = max(maxval(total%element_force), maxval(abs(load)), &
        part_of_held*total%expansion%held_force)
    if (any(answer%contact%force > 0.0_wp)) largest_force = max(largest_force, found%force_scale)
    if (unstressed) then   ! forces and their work are compared with rounding errors, not with each other
      largest_force = most_roundings*found%rounding_stress*face/valid_to
      total%terms = total%terms + largest_force*maxval(abs(answer%displacement))
    end if
    if (present(worked)) found%worked%force = found%worked%force - total%residual
    call gather_ties(model, total%residual, torque)
    call check_ties(model, answer%displacement, turn, found%ties)
    total%work = total%work + sum(answer%moment*turn)
    total%terms = total%terms + sum(abs(answer%moment*turn))
    found%equilibrium = maxval([ratio(abs(torque - answer%moment), largest_force*longest_arms(model)), &
                                0.0_wp])
    found%equilibrium = max(found%equilibrium, ratio(maxval(abs(total%residual)), largest_force))
    ! On its curve a stress does no negative work; within the tolerance of the iteration it may. For bodies
    ! with large displacements and free expansion, all work is that of rounding errors of stresses.
    found%energy = ratio(max(abs(total%work - total%stored), total%expansion%work - total%stored) - &
        found%rounding_stress*total%strained, &
                         total%terms)
    if (present(worked)) then
      found%worked%displacement = answer%displacement
      found%worked%moment = answer%moment
      found%worked%turn = turn
      found%worked%off_curve = found%off_curve
      found%worked%dissipated = total%energy%dissipated + total%energy%rubbed
      found%worked%friction_work = &
        -0.5_wp*sum((worked%friction + found%worked%friction)*(answer%displacement - start))
      ! The energy of a nonlinear elastic material is not quadratic.
      if (.not. (unstressed .or. any(model%sections%curve%elastic))) &
        found%energy = max(found%energy, found%worked%imbalance(worked, total%energy))
    end if
    found%curve_tolerance = max(valid_to, curve_tolerance)
    found%off_curve_limit = found%curve_tolerance + min(several*found%lost_stress, found%curve_tolerance)
    found%valid = all(within_limits(found))
    found%balanced = all(within_limits(found) .or. figure_name == off_the_curve)
  end subroutine certify

  !> Add the internal forces of elements and the work of their stresses. Put the largest stress error and the
  !! effects of rounding and rigid-body displacements into the certificate. Threads share the elements in
  !! fixed parts, which are added in order.
  subroutine add_elements(model, answer, largest_stress, total, found)
    type(model_type), intent(in) :: model        !! the model
    type(answer_type), intent(in) :: answer      !! answer to check
    real(wp), intent(in) :: largest_stress       !! of the model [stress]
    type(balance_type), intent(inout) :: total   !! sums to add to
    type(certificate_type), intent(inout) :: found
    type(replayed_history), allocatable :: before(:)   ! not allocated: absent
    real(wp) :: slope(directions, most_nodes, most_points, size(model%mesh%kinds))
    type(checked_elements) :: part
    integer :: first, k

    if (allocated(found%worked)) before = found%worked%history
    do k = 1, size(model%mesh%kinds)
      call find_slopes(model%mesh%kinds(k), slope(:, :, :, k))
    end do
    !$omp parallel do num_threads(threads_over(model%mesh%elements)) schedule(dynamic) ordered private(part)
    do first = 1, model%mesh%elements, at_once
      call check_elements(model, answer, largest_stress, &
                          [first, min(first + at_once - 1, model%mesh%elements)], slope, part, before)
      !$omp ordered
      call add_part(model, total, found, first, part)
      !$omp end ordered
    end do
    !$omp end parallel do
  end subroutine add_elements

  !> Add the results of elements from `first` on.
  subroutine add_part(model, total, found, first, part)
    type(model_type), intent(in) :: model        !! the model
    type(balance_type), intent(inout) :: total   !! sums to add to
    type(certificate_type), intent(inout) :: found
    integer, intent(in) :: first
    type(checked_elements), intent(in) :: part
    integer :: e, k, p

    do e = first, first + size(part%force, 3) - 1
      do k = 1, model%mesh%node_count(e)
        associate (node => model%mesh%connectivity(k, e), force => part%force(:, k, e))
          total%residual(:, node) = total%residual(:, node) + force
          total%element_force(node) = total%element_force(node) + maxval(abs(force))
        end associate
      end do
      do p = model%mesh%first_point(e), model%mesh%first_point(e + 1) - 1
        total%stored = total%stored + part%work(p)
      end do
    end do
    if (allocated(part%history)) &
      found%worked%history(lbound(part%work, 1):ubound(part%work, 1)) = part%history
    call total%energy%include(part%energy)
    total%strained = total%strained + part%strained
    call total%expansion%include(part%expansion)
    found%off_curve = max(found%off_curve, part%off_curve)
    found%motion_strain = max(found%motion_strain, part%motion_strain)
    found%lost_stress = max(found%lost_stress, part%lost_stress)
    found%rounding_stress = max(found%rounding_stress, part%rounding_stress)
    found%stress_roundings = max(found%stress_roundings, part%stress_roundings)
  end subroutine add_part

  !> Find the smallest force and gap and the largest product of pairs, and check friction. Add the work of the
  !! forces, and subtract these from the residual.
  subroutine add_pairs(model, answer, load, start, total, found)
    type(model_type), intent(in) :: model        !! the model
    type(answer_type), intent(in) :: answer      !! answer to check
    real(wp), intent(in) :: load(:, :)           !! [force] [directions, nodes]
    real(wp), intent(in) :: start(:, :)          !! displacements before the increment [directions, nodes]
    type(balance_type), intent(inout) :: total   !! sums to add to
    type(certificate_type), intent(inout) :: found
    real(wp), dimension(directions) :: apart, force_here, moved   ! moved: since the start
    real(wp) :: gap, opening, rounding, travel
    real(wp), allocatable :: forces(:)   ! of all rows [force]
    integer :: i, k, node

    forces = answer%contact%row_forces()
    found%smallest_force = minval(answer%contact%force)
    found%smallest_gap = huge(1.0_wp)
    found%force_scale = max(maxval(abs(answer%contact%force)), maxval(abs(load)), tiny(1.0_wp))
    do k = 1, model%contact%rows()
      associate (force => forces(k), normal => model%contact%normal(:, k))
        apart = 0.0_wp
        moved = 0.0_wp
        travel = 0.0_wp
        do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
          node = model%contact%row_node(i)
          apart = apart + model%contact%row_weight(i)*answer%displacement(:, node)
          moved = moved + model%contact%row_weight(i)*(answer%displacement(:, node) - start(:, node))
          travel = max(travel, maxval(abs(answer%displacement(:, node))))
          force_here = model%contact%row_weight(i)*force*normal
          total%residual(:, node) = total%residual(:, node) - force_here
          if (k > model%contact%pairs .and. allocated(found%worked)) &
            found%worked%friction(:, node) = found%worked%friction(:, node) + force_here
        end do
        opening = sum(normal*apart)
        total%work = total%work + force*opening
        total%terms = total%terms + abs(force*opening)
        if (k > model%contact%pairs) then
          call check_friction(model, forces, k, sum(normal*moved), roundings*epsilon(1.0_wp)*travel, &
                              total%energy, found)
          cycle
        end if
        rounding = roundings*epsilon(1.0_wp)*max(abs(model%contact%initial_gap(k)), travel)
        if (force > 0.0_wp) found%gap_rounding = max(found%gap_rounding, rounding)
        gap = model%contact%initial_gap(k) + opening
        found%smallest_gap = min(found%smallest_gap, gap)
        found%overlap = max(found%overlap, -gap - rounding)
        found%force_gap = max(found%force_gap, abs(gap*force))
      end associate
    end do
  end subroutine add_pairs

  !> Check the friction of a pair: its force is at most mu R, and it is mu R against any slip.
  pure subroutine check_friction(model, force, row, slip, rounding, energy, found)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: force(:)       !! of all rows [force]
    integer, intent(in) :: row             !! tangential row
    real(wp), intent(in) :: slip           !! of B relative to A in the increment [length]
    real(wp), intent(in) :: rounding       !! of the slip [length]
    type(point_energies), intent(inout) :: energy
    type(certificate_type), intent(inout) :: found
    real(wp) :: beyond, most   ! slip above rounding [length]

    associate (j => row - model%contact%pairs)
      most = model%contact%friction(model%contact%sliding(j))*max(force(model%contact%sliding(j)), 0.0_wp)
    end associate
    found%excess = max(found%excess, abs(force(row)) - most)
    beyond = sign(max(abs(slip) - rounding, 0.0_wp), slip)
    found%force_slip = max(found%force_slip, abs(beyond)*abs(most + sign(force(row), slip*force(row))))
    energy%rubbed = energy%rubbed - force(row)*beyond
    energy%least = min(energy%least, -force(row)*beyond)
  end subroutine check_friction

  !> Find the checked values and their limits, in the order of `figure_name`.
  pure subroutine figures(self, figure, largest)
    class(certificate_type), intent(in) :: self
    real(wp), intent(out) :: figure(:), largest(:)   !! [size(figure_name)]
    real(wp) :: exact

    exact = valid_to*self%length_scale + self%gap_rounding
    figure = [self%equilibrium, self%off_curve, self%energy, ratio(-self%smallest_force, self%force_scale), &
              self%overlap, ratio(self%force_gap, self%force_scale), ratio(self%excess, self%force_scale), &
              ratio(self%force_slip, self%force_scale), self%gap_rounding/self%length_scale, &
              self%motion_strain, self%ties]
    largest = [valid_to, self%off_curve_limit, valid_to, valid_to, exact, exact, valid_to, exact, &
               largest_rounding, most_roundings, valid_to]
  end subroutine figures

  !> Is a value beyond its limit now that was within it before?
  pure logical function has_spoilt(self, before)
    class(certificate_type), intent(in) :: self
    type(certificate_type), intent(in) :: before   !! the certificate before

    has_spoilt = any(within_limits(before) .and. .not. within_limits(self))
  end function has_spoilt

  !> Which values are within their limits?
  pure function within_limits(certificate) result(within)
    class(certificate_type), intent(in) :: certificate
    logical :: within(size(figure_name))
    real(wp), dimension(size(figure_name)) :: figure, largest

    call certificate%figures(figure, largest)
    within = figure <= largest
  end function within_limits
end module epcont_certificate_certificate
