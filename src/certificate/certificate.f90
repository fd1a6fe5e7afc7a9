!> Recomputes from displacements and forces alone whether they are an answer.
!>
!> Shares nothing with the solver: strains come from differences of what the displacements are between the
!> nodes (epcont_certificate_unit_strains), stresses on the curve from the paper's own equations
!> (epcont_certificate_yielding), nodal forces from the work of the stresses on unit displacements.
module epcont_certificate_certificate
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: valid_to
  use epcont_certificate_element_checks, only: checked_elements, check_elements, ratio
  use epcont_certificate_free_expansion, only: expansion_type, held_stress, part_of_held
  use epcont_certificate_mass_force, only: given_load
  use epcont_certificate_scene, only: overlaps_type
  use epcont_certificate_tied, only: check_springs, check_ties, gather_ties, longest_arms
  use epcont_certificate_unit_strains, only: find_slopes, largest_face, largest_of
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_kinematics, only: directions
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: certificate_type, certify

  real(wp), parameter :: &
    !> Roundings that a gap is the sum of.
    roundings = 8.0_wp, &
    !> Stresses are off by as many times `lost_stress`: an element has several nodes.
    several = 4.0_wp, &
    !> Largest part of the bodies' give that the rounding of the gaps may be: a travel far beyond it leaves no
    !! digits.
    largest_rounding = 1.0e-6_wp

  !> A rigid motion strains an element by so many roundings of its displacements, at most: motions of a chain
  !! of 40 hinges, sums that cancel, were seen to leave 750.
  real(wp), parameter, public :: most_roundings = 1.0e4_wp
  !> Bodies give way no less than this: no length over it is beyond the largest number.
  real(wp), parameter :: least_length = 1.0e-200_wp

  type :: certificate_type
    real(wp) :: equilibrium = 0.0_wp      !! largest unbalanced nodal force / largest sum of element forces
    real(wp) :: smallest_force = 0.0_wp   !! [force]
    real(wp) :: smallest_gap = 0.0_wp     !! [length]
    real(wp) :: overlap = 0.0_wp          !! largest by which a gap is below zero and its rounding [length]
    real(wp) :: force_gap = 0.0_wp        !! largest |R gap| [force*length]
    real(wp) :: off_curve = 0.0_wp        !! largest distance of a stress from its curve (`measure_stress`)
    real(wp) :: motion_strain = 0.0_wp    !! largest strain of the rigid motions / its rounding
    real(wp) :: lost_stress = 0.0_wp      !! largest stress that rounding of displacements makes, relative
    real(wp) :: rounding_stress = 0.0_wp  !! the same [stress]
    real(wp) :: stress_roundings = 0.0_wp !! largest stress / stress that rounding makes there
    real(wp) :: ties = 0.0_wp             !! what RBE2 that turns, or MPC, is off by / largest displacement
    real(wp) :: energy = 0.0_wp           !! |work of the forces - of the stresses| / sum of |terms|
    real(wp) :: force_scale = 1.0_wp      !! largest contact force [force]
    real(wp) :: length_scale = 1.0_wp     !! work over forces: how far the bodies give way [length]
    real(wp) :: gap_rounding = 0.0_wp     !! rounding of the gaps of pressed pairs, from their travel [length]
    real(wp) :: curve_tolerance = valid_to  !! largest `off_curve` that the iteration was asked for
    real(wp) :: off_curve_limit = valid_to  !! of a valid answer: rounding may add as much again
    logical :: balanced = .false.         !! all figures but `off_curve` are within the tolerance
    logical :: valid = .false.            !! that one too
    type(overlaps_type) :: scene          !! whether bodies pass through each other, where all else is right
  contains
    procedure :: figures
    procedure :: has_spoilt
  end type certificate_type

  !> Elements that a thread takes at once.
  integer, parameter :: at_once = 4096

  !> Figures that a limit is set to, and what they say.
  character(len=*), parameter :: off_the_curve = 'stresses are off their curve by'
  character(len=*), parameter, public :: figure_name(9) = [character(len=70) :: &
    'equilibrium is off by', off_the_curve, 'energy is off by', 'contact forces pull, by', &
    'gaps overlap, by', 'pressed gaps are open, by', &
    'the rounding of gaps and travels is, of what the bodies give way,', &
    'rigid motions strain the bodies; their roundings are', &
    'what RBE2 or MPC ties is apart by']

  !> What is summed up of all elements and pairs.
  type :: balance_type
    real(wp), allocatable :: residual(:, :)      !! out of balance [force] [directions, nodes]
    !> Sum of the sizes of the elements' forces at each node [force] [nodes]
    real(wp), allocatable :: element_force(:)
    real(wp) :: stored = 0.0_wp, work = 0.0_wp   !! work of the stresses, and of the forces [energy]
    real(wp) :: terms = 0.0_wp                   !! sum of the sizes of all that these two are sums of
    type(expansion_type) :: expansion
    real(wp) :: strained = 0.0_wp                !! volume times the largest strain, of all points [length**3]
  end type balance_type

contains

  !> Of an answer the certificate takes the displacements, with rigid motions and without, the reactions, the
  !! stresses at the points, the contact forces and the part of the loads.
  subroutine certify(model, answer, curve_tolerance, found)
    type(model_type), intent(in) :: model   !! model
    type(answer_type), intent(in) :: answer   !! what is to be checked
    real(wp), intent(in) :: curve_tolerance   !! how far off its curve the iteration may leave a stress
    type(certificate_type), intent(out) :: found   !! the certificate, without its scene
    real(wp) :: load(directions, model%nodes)
    type(balance_type) :: total
    real(wp) :: forces, largest_force, largest_stress, length
    real(wp), dimension(size(model%platen)) :: torque, turn   ! of those that turn
    real(wp) :: given_force   ! largest load or spring force [force]
    real(wp) :: face          ! of the largest element [length**2]
    logical :: unstressed     ! stresses and forces are rounding errors of zero

    load = answer%load_factor*given_load(model)
    allocate (total%residual(directions, model%nodes), total%element_force(model%nodes), source=0.0_wp)
    call check_springs(model, answer%displacement, total%residual, total%element_force, total%stored)
    given_force = max(maxval(abs(load)), maxval(total%element_force))
    face = largest_face(model)
    largest_stress = max(largest_of(size(answer%point_stress), answer%point_stress), &
                         part_of_held*held_stress(model, answer%load_factor), given_force/face)
    call add_elements(model, answer, largest_stress, total, found)
    total%residual = total%residual - load - answer%reaction
    unstressed = given_force == 0.0_wp .and. found%stress_roundings <= most_roundings
    if (unstressed) found%off_curve = 0.0_wp
    ! A rigid travel says nothing of how exact the gaps must be: only what the bodies give way does.
    ! Nor does a load that a support takes at once.
    forces = sum(abs(load + answer%reaction)) + sum(abs(answer%contact%force))
    length = ratio(max(abs(total%stored), total%stored - total%expansion%work), forces)
    associate (u => answer%displacement, reaction => answer%reaction)
      ! Where stops take all loads at once, nothing moves but by rounding of what the forces would push in.
      if (maxval(abs(u)) <= roundings*epsilon(1.0_wp)*least_indentation(model, &
          answer)) length = least_indentation(model, answer)
      ! Bodies without forces do not deform: rigid-body displacements close the gaps.
      if (unstressed) length = maxval(abs(u))
      if (total%expansion%held_work > 0.0_wp) length = max(length, &
          part_of_held*maxval(abs(answer%deformation)))
      found%length_scale = max(length, least_length)
      total%work = sum(load*u) + sum(reaction*u)
      total%terms = sum(abs(load*u)) + sum(abs(reaction*u)) + abs(total%stored) + &
              part_of_held*total%expansion%held_work
    end associate
    if (model%pairs > 0) call add_pairs(model, answer, load, total, found)
    largest_force = max(maxval(total%element_force), maxval(abs(load)), &
        part_of_held*total%expansion%held_force)
    if (any(answer%contact%force > 0.0_wp)) largest_force = max(largest_force, found%force_scale)
    if (unstressed) then   ! forces and their work are compared with rounding errors, not with each other
      largest_force = most_roundings*found%rounding_stress*face/valid_to
      total%terms = total%terms + largest_force*maxval(abs(answer%displacement))
    end if
    call gather_ties(model, total%residual, torque)
    call check_ties(model, answer%displacement, turn, found%ties)
    total%work = total%work + sum(answer%moment*turn)
    total%terms = total%terms + sum(abs(answer%moment*turn))
    found%equilibrium = maxval([ratio(abs(torque - answer%moment), largest_force*longest_arms(model)), &
                                0.0_wp])
    found%equilibrium = max(found%equilibrium, ratio(maxval(abs(total%residual)), largest_force))
    ! On its curve no stress does less than no work; as far off it as the iteration may leave it, it can.
    ! Of bodies that travel far and expand freely all work is that of the stress which rounding makes.
    found%energy = ratio(max(abs(total%work - total%stored), total%expansion%work - total%stored) - &
        found%rounding_stress*total%strained, &
                         total%terms)
    found%curve_tolerance = max(valid_to, curve_tolerance)
    found%off_curve_limit = found%curve_tolerance + min(several*found%lost_stress, found%curve_tolerance)
    found%valid = all(within_limits(found))
    found%balanced = all(within_limits(found) .or. figure_name == off_the_curve)
  end subroutine certify

  !> The largest contact force over the largest depth and modulus: how far it pushes in, at least.
  pure real(wp) function least_indentation(model, answer) result(length)
    type(model_type), intent(in) :: model        !! the model
    type(answer_type), intent(in) :: answer      !! what is to be checked
    real(wp) :: stiffest   ! [force/length]
    integer :: e

    stiffest = 0.0_wp
    do e = 1, model%elements
      associate (nodes => model%connectivity(:model%node_count(e), e))
        stiffest = max(stiffest, model%young(model%section(e))*model%depth(e, maxval(model%x(1, nodes))))
      end associate
    end do
    length = 0.0_wp
    if (stiffest > 0.0_wp) length = maxval([answer%contact%force, 0.0_wp])/stiffest
  end function least_indentation

  !> Internal forces at the nodes and work of the stresses on the strains; the stresses' largest distance
  !! from the curve and what roundings and rigid motions strain go into the certificate. Threads share the
  !! elements by parts, which are summed up one after the other.
  subroutine add_elements(model, answer, largest_stress, total, found)
    type(model_type), intent(in) :: model        !! the model
    type(answer_type), intent(in) :: answer      !! what is to be checked
    real(wp), intent(in) :: largest_stress       !! of the model [stress]
    type(balance_type), intent(inout) :: total   !! sums to add to
    type(certificate_type), intent(inout) :: found
    real(wp) :: slope(directions, most_nodes, most_points, size(model%kinds))
    type(checked_elements) :: part
    integer :: first, k

    do k = 1, size(model%kinds)
      call find_slopes(model%kinds(k), slope(:, :, :, k))
    end do
    !$omp parallel do num_threads(threads_over(model%elements)) schedule(dynamic) ordered private(part)
    do first = 1, model%elements, at_once
      call check_elements(model, answer, largest_stress, first, min(first + at_once - 1, model%elements), &
                          slope, part)
      !$omp ordered
      call add_part(model, total, found, first, part)
      !$omp end ordered
    end do
    !$omp end parallel do
  end subroutine add_elements

  !> What has been found of elements from `first` on.
  subroutine add_part(model, total, found, first, part)
    type(model_type), intent(in) :: model        !! the model
    type(balance_type), intent(inout) :: total   !! sums to add to
    type(certificate_type), intent(inout) :: found
    integer, intent(in) :: first
    type(checked_elements), intent(in) :: part
    integer :: e, k, p

    do e = first, first + size(part%force, 3) - 1
      do k = 1, model%node_count(e)
        associate (node => model%connectivity(k, e), force => part%force(:, k, e))
          total%residual(:, node) = total%residual(:, node) + force
          total%element_force(node) = total%element_force(node) + maxval(abs(force))
        end associate
      end do
      do p = model%first_point(e), model%first_point(e + 1) - 1
        total%stored = total%stored + part%work(p)
      end do
    end do
    total%strained = total%strained + part%strained
    call total%expansion%include(part%expansion)
    found%off_curve = max(found%off_curve, part%off_curve)
    found%motion_strain = max(found%motion_strain, part%motion_strain)
    found%lost_stress = max(found%lost_stress, part%lost_stress)
    found%rounding_stress = max(found%rounding_stress, part%rounding_stress)
    found%stress_roundings = max(found%stress_roundings, part%stress_roundings)
  end subroutine add_part

  !> Smallest force and gap, largest product; the work of the pairs' forces, which are taken off the
  !! residual.
  subroutine add_pairs(model, answer, load, total, found)
    type(model_type), intent(in) :: model        !! the model
    type(answer_type), intent(in) :: answer      !! what is to be checked
    real(wp), intent(in) :: load(:, :)           !! [force] [directions, nodes]
    type(balance_type), intent(inout) :: total   !! sums to add to
    type(certificate_type), intent(inout) :: found
    real(wp) :: apart(directions), gap, opening, rounding, travel
    integer :: i, k, node

    found%smallest_force = minval(answer%contact%force)
    found%smallest_gap = huge(1.0_wp)
    found%force_scale = max(maxval(abs(answer%contact%force)), maxval(abs(load)), tiny(1.0_wp))
    do k = 1, model%pairs
      associate (force => answer%contact%force(k), normal => model%normal(:, k))
        apart = 0.0_wp
        travel = 0.0_wp
        do i = model%row_start(k), model%row_start(k + 1) - 1
          node = model%row_node(i)
          apart = apart + model%row_weight(i)*answer%displacement(:, node)
          travel = max(travel, maxval(abs(answer%displacement(:, node))))
          total%residual(:, node) = total%residual(:, node) - model%row_weight(i)*force*normal
        end do
        opening = sum(normal*apart)
        total%work = total%work + force*opening
        total%terms = total%terms + abs(force*opening)
        rounding = roundings*epsilon(1.0_wp)*max(abs(model%initial_gap(k)), travel)
        if (force > 0.0_wp) found%gap_rounding = max(found%gap_rounding, rounding)
        gap = model%initial_gap(k) + opening
        found%smallest_gap = min(found%smallest_gap, gap)
        found%overlap = max(found%overlap, -gap - rounding)
        found%force_gap = max(found%force_gap, abs(gap*force))
      end associate
    end do
  end subroutine add_pairs

  !> All figures and the largest of each in a valid answer, as `figure_name` has them.
  pure subroutine figures(self, figure, largest)
    class(certificate_type), intent(in) :: self
    real(wp), intent(out) :: figure(:), largest(:)   !! [size(figure_name)]
    real(wp) :: exact

    exact = valid_to*self%length_scale + self%gap_rounding
    figure = [self%equilibrium, self%off_curve, self%energy, ratio(-self%smallest_force, self%force_scale), &
              self%overlap, ratio(self%force_gap, self%force_scale), self%gap_rounding/self%length_scale, &
              self%motion_strain, self%ties]
    largest = [valid_to, self%off_curve_limit, valid_to, valid_to, exact, exact, &
               largest_rounding, most_roundings, valid_to]
  end subroutine figures

  !> Is a figure beyond its limit that was not before?
  pure logical function has_spoilt(self, before)
    class(certificate_type), intent(in) :: self
    type(certificate_type), intent(in) :: before   !! the certificate of then

    has_spoilt = any(within_limits(before) .and. .not. within_limits(self))
  end function has_spoilt

  !> Which figures are no larger than they may be?
  pure function within_limits(certificate) result(within)
    class(certificate_type), intent(in) :: certificate
    logical :: within(size(figure_name))
    real(wp), dimension(size(figure_name)) :: figure, largest

    call certificate%figures(figure, largest)
    within = figure <= largest
  end function within_limits
end module epcont_certificate_certificate
