!> Quantities at each pair that the estimates need: surface compliance, bend of the gap, and pressure from
!> recovered strains.
!>
!> Gap oscillation means that the bend of the gap alternates from node to node. Its sources are curves meshed
!> with chords, mid-side nodes between their corners instead of on the curve, and nested polygons with
!> non-matching meshes. It is not part of the intended model. Nodes at a distance d that stand alternately a
!> above and a below the intended gap bend it by r = 8 a/d more at one than at the next.
module epcont_accuracy_surface_line
  use epcont_accuracy_weights, only: waves_are_common, waves_flattened
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_element_kinematics, only: plane_stress
  use epcont_material_material_law, only: point_state
  use epcont_material_model_materials, only: model_materials
  use epcont_model_model, only: model_type
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: elements_behind, find_waves, first_element, new_surface_line, smooth_pressures, &
            surface_compliance, surface_line

  !> An outline that turns by more than this has a corner [rad].
  real(wp), parameter, public :: corner = 35.0_wp*acos(-1.0_wp)/180.0_wp
  !> Of the nodes with weights in a gap row, those with stresses must have this part.
  real(wp), parameter :: least_weight = 0.5_wp

  type, extends(contact_line) :: surface_line
    real(wp), allocatable :: compliance(:)        !! of both bodies, see `surface_compliance` [1/stress]
                                                  !! [pairs]
    real(wp), allocatable :: bend(:)              !! angle by which the gap bends open [rad] [pairs]
    !> Bend divided by the pair's part of the line [1/length] [pairs]
    real(wp), allocatable :: curvature(:)
    real(wp), allocatable :: smooth_pressure(:)   !! from recovered strains, see `smooth_pressures` [stress]
                                                  !! [pairs]
  contains
    procedure :: beyond
  end type surface_line

contains

  !> Extend a contact line by these quantities.
  pure function new_surface_line(model, line, smooth_pressure) result(surface)
    type(model_type), intent(in) :: model           !! model
    type(contact_line), intent(in) :: line          !! of its pairs
    real(wp), intent(in) :: smooth_pressure(:)      !! from recovered strains [stress] [pairs]
    type(surface_line) :: surface
    integer :: k

    surface%contact_line = line
    surface%smooth_pressure = smooth_pressure
    surface%compliance = [(surface_compliance(model, k), k=1, model%contact%pairs)]
    associate (bends => reshape([(bend_at(k), k=1, model%contact%pairs)], [2, model%contact%pairs]))
      surface%bend = bends(1, :)
      surface%curvature = bends(2, :)
    end associate

  contains

    !> Find bend and curvature; a pair without neighbours on both sides does not bend.
    pure function bend_at(pair) result(bend)
      integer, intent(in) :: pair
      real(wp) :: bend(2), long(2), slope(2)
      integer :: k

      bend = 0.0_wp
      long = 0.0_wp
      do k = 1, 2
        associate (other => line%neighbour(k, pair))
          if (other == 0) cycle
          long(k) = line%distance(other, pair)
          if (long(k) == 0.0_wp) cycle   ! two pairs at a joint have one point
          slope(k) = (model%contact%initial_gap(other) - model%contact%initial_gap(pair))/long(k)
        end associate
      end do
      if (any(long == 0.0_wp)) then
        if (all(long == 0.0_wp) .or. .not. line%mirrored(pair)) return
        k = maxloc(long, dim=1)
        long = long(k)
        slope = slope(k)
      end if
      bend = [sum(slope), 2.0_wp*sum(slope)/sum(long)]
    end function bend_at
  end function new_surface_line

  !> Find the pair beyond this one, as seen from its neighbour; 0 if it does not exist.
  pure integer function beyond(self, pair, from)
    class(surface_line), intent(in) :: self
    integer, intent(in) :: pair, from   !! the pair, and its neighbour

    associate (next => self%neighbour(:, pair))   ! beyond a corner it may be another pair of this node
      beyond = maxval(merge(next, 0, self%node(max(next, 1)) /= self%node(from)))
    end associate
  end function beyond

  !> Find an element at a node: of the first section there, and of the first type in it; 0 if there are no
  !! elements.
  pure integer function first_element(model, node) result(element)
    type(model_type), intent(in) :: model   !! model
    integer, intent(in) :: node             !! any node
    integer, allocatable :: there(:)

    element = 0
    there = model%mesh%around%of(node)
    if (size(there) > 0) &
      element = there(minloc(model%mesh%section(there)*size(model%mesh%kinds) + model%mesh%kind(there), &
                             dim=1))
  end function first_element

  !> Find the elements that determine the compliance at a node: those with the section of the first. Empty if
  !! the node is fixed, or no element can deform.
  pure function elements_behind(model, node) result(elements)
    type(model_type), intent(in) :: model   !! model
    integer, intent(in) :: node             !! any node
    integer, allocatable :: elements(:)
    integer :: i

    elements = model%mesh%around%of(node)
    if (size(elements) == 0) return
    elements = pack(elements, model%mesh%section(elements) == model%mesh%section(first_element(model, node)))
    if (.not. all(model%constraints%is_held([1, 2], node))) then
      do i = 1, size(elements)
        if (.not. model%constraints%is_rigid(model%mesh%connectivity(:model%mesh%node_count(elements(i)), &
                                                                     elements(i)))) return
      end do
    end if
    elements = [integer ::]
  end function elements_behind

  !> Find the pressure at each pair from the normal stresses of both bodies (their mean, since each has its
  !! own error); 0 if neither body deforms [stress] [pairs].
  pure function smooth_pressures(model, materials, smooth) result(pressure)
    type(model_type), intent(in) :: model              !! model
    type(model_materials), intent(in) :: materials     !! of its sections
    real(wp), intent(in) :: smooth(:, :)               !! recovered strains [components, places: first the
                                                       !! nodes']
    real(wp) :: pressure(model%contact%pairs)
    type(point_state) :: state
    real(wp) :: side(2), weight(2)
    logical :: seen(2)
    integer, allocatable :: elements(:)
    integer :: i, k, n

    pressure = 0.0_wp
    do k = 1, model%contact%pairs
      side = 0.0_wp
      weight = 0.0_wp
      do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
        elements = elements_behind(model, model%contact%row_node(i))
        if (size(elements) == 0) cycle
        state = materials%state_at(model%mesh%first_point(elements(1)), smooth(:, model%contact%row_node(i)))
        ! the first node of the row is on one body, the others share the other
        n = merge(1, 2, i == model%contact%row_start(k))
        associate (normal => model%contact%normal(:, k), stress => state%stress)
          side(n) = side(n) - model%contact%row_weight(i)*(stress(1)*normal(1)**2 + stress(2)*normal(2)**2 + &
              2.0_wp*stress(4)*normal(1)*normal(2))
        end associate
        weight(n) = weight(n) + model%contact%row_weight(i)
      end do
      seen = abs(weight) > least_weight
      if (any(seen)) pressure(k) = sum(side/merge(weight, 1.0_wp, seen), mask=seen)/count(seen)
    end do
  end function smooth_pressures

  !> Surface compliance 1/E* of both bodies at a pair: (1 - nu**2)/E, in plane stress 1/E, 0 if rigid; of the
  !! nodes with weights on the opposite edge the largest [1/stress].
  pure real(wp) function surface_compliance(model, pair) result(compliance)
    type(model_type), intent(in) :: model   !! model
    integer, intent(in) :: pair             !! number of the pair
    real(wp) :: nu, side(2)
    integer, allocatable :: elements(:)
    integer :: i, k, section

    side = 0.0_wp
    do i = model%contact%row_start(pair), model%contact%row_start(pair + 1) - 1
      k = merge(1, 2, i == model%contact%row_start(pair))
      elements = elements_behind(model, model%contact%row_node(i))
      if (size(elements) == 0) cycle
      section = model%mesh%section(elements(1))
      nu = merge(0.0_wp, model%sections%poisson(section), model%sections%kinematics(section) == plane_stress)
      side(k) = max(side(k), (1.0_wp - nu**2)/model%sections%young(section))
    end do
    compliance = sum(side)
  end function surface_compliance

  !> Find the gap oscillation of a zone: the largest pressure that flattens an uneven bend, whether the bends
  !! alternate, and their mean amplitude. A tip bends the gap once, and at the start of a fillet its curvature
  !! jumps: these bends are uneven but do not alternate.
  pure subroutine find_waves(line, pairs, pressure, are_waves, height)
    type(surface_line), intent(in) :: line    !! of all pairs
    integer, intent(in) :: pairs(:)           !! of the zone
    real(wp), intent(out) :: pressure         !! [stress]
    logical, intent(out) :: are_waves         !! the bend alternates at enough pairs
    real(wp), intent(out) :: height           !! 0 if there is no oscillation [length]
    real(wp) :: angle, spacing
    real(wp) :: least   !! curvature of straight edges beside a tip, by rounding [1/length]
    logical :: alternates(size(pairs))
    integer :: k

    pressure = 0.0_wp
    height = 0.0_wp
    least = no_effect*maxval(abs(line%curvature(pairs)))
    do k = 1, size(pairs)
      call uneven_bend(pairs(k), angle, spacing, alternates(k))
      if (line%compliance(pairs(k)) > 0.0_wp) &
        pressure = max(pressure, waves_flattened*angle/line%compliance(pairs(k)))
      height = height + angle*spacing/8.0_wp/size(pairs)
    end do
    are_waves = count(alternates) >= waves_are_common*size(pairs)
    if (.not. are_waves) height = 0.0_wp

  contains

    !> Find the difference between the bend at a pair and at its neighbours, by curvatures, since edges may
    !! grow along a line. It alternates if, of four pairs in a row, the first and third bend the gap more than
    !! the others, or less.
    pure subroutine uneven_bend(pair, angle, spacing, alternates)
      integer, intent(in) :: pair
      real(wp), intent(out) :: angle     !! [rad]
      real(wp), intent(out) :: spacing   !! [length]
      logical, intent(out) :: alternates
      real(wp) :: curvature(5)
      integer :: k, run(5)   !! the pair in the middle of four others; 0 if it does not exist
      logical :: known(5)

      angle = 0.0_wp
      spacing = 0.0_wp
      alternates = .false.
      if (.not. goes_on(pair)) return
      run(2:4) = [line%neighbour(1, pair), pair, line%neighbour(2, pair)]
      if (line%mirrored(pair)) run([2, 4]) = maxval(run([2, 4]))
      if (any(run([2, 4]) == 0)) return
      spacing = 0.5_wp*(line%distance(pair, run(2)) + line%distance(pair, run(4)))
      run([1, 5]) = [behind(run(2), pair), behind(run(4), pair)]
      known = [(goes_on(run(k)), k=1, 5)]
      curvature = line%curvature(max(run, 1))
      do k = 1, 5   ! beyond a corner, a pair projects onto a step or another edge
        if (k /= 3) known(k) = known(k) .and. abs(line%bend(max(run(k), 1))) <= corner
      end do
      associate (beside => pack(curvature([2, 4]), known([2, 4])))
        if (size(beside) > 0) angle = spacing*abs(curvature(3) - sum(beside)/size(beside))
      end associate
      do k = 1, 2
        if (all(known(k:k + 3))) alternates = alternates .or. by_turns(curvature(k:k + 3))
      end do
    end subroutine uneven_bend

    !> Find the pair beyond this one, as seen from its neighbour, mirrored at a line of symmetry; 0 if it
    !! does not exist.
    pure integer function behind(pair, from)
      integer, intent(in) :: pair, from

      behind = from
      if (.not. line%mirrored(pair)) behind = line%beyond(pair, from)
    end function behind

    !> Does the line continue on both sides of a pair? Otherwise its bend is unknown.
    pure logical function goes_on(pair)
      integer, intent(in) :: pair   !! 0 if it does not exist

      goes_on = .false.
      if (pair > 0) goes_on = all(line%neighbour(:, pair) > 0) .or. line%mirrored(pair)
    end function goes_on

    !> Are the first and third of four curvatures both above the others, or both below?
    pure logical function by_turns(x)
      real(wp), intent(in) :: x(4)

      associate (odd => x([1, 3]), even => x([2, 4]))
        by_turns = minval(odd) - maxval(even) > least .or. minval(even) - maxval(odd) > least
      end associate
    end function by_turns
  end subroutine find_waves
end module epcont_accuracy_surface_line
