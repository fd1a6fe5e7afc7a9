!> What the estimates want to know at each pair of the line: how much the surfaces there give way, how the gap
!> bends, and what pressure the smooth strains say.
!>
!> Waves are gaps whose bend alternates from node to node: sides of a curve drawn as chords, middle nodes
!> between their corners instead of on it, polygons of unlike divisions in each other. They are no part of the
!> scene that is meant. Nodes that stand a above and a below the gap that is meant, by turns, a distance d
!> apart, bend it by r = 8 a/d more at the one than at the other.
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

  !> An outline that turns by more than this ends [rad].
  real(wp), parameter, public :: corner = 35.0_wp*acos(-1.0_wp)/180.0_wp
  !> Of a side's nodes that share in a gap, those with stresses must have this part.
  real(wp), parameter :: least_weight = 0.5_wp

  type, extends(contact_line) :: surface_line
    real(wp), allocatable :: compliance(:)        !! `surface_compliance` [1/stress] [pairs]
    real(wp), allocatable :: bend(:)              !! by how much the gap bends open [rad] [pairs]
    !> That over the length that the pair stands for [1/length] [pairs]
    real(wp), allocatable :: curvature(:)
    real(wp), allocatable :: smooth_pressure(:)   !! `smooth_pressures` [stress] [pairs]
  contains
    procedure :: beyond
  end type surface_line

contains

  !> A line with all that.
  pure function new_surface_line(model, line, smooth_pressure) result(surface)
    type(model_type), intent(in) :: model           !! the scene
    type(contact_line), intent(in) :: line          !! of its pairs
    real(wp), intent(in) :: smooth_pressure(:)      !! `smooth_pressures` [stress] [pairs]
    type(surface_line) :: surface
    integer :: k

    surface%contact_line = line
    surface%smooth_pressure = smooth_pressure
    surface%compliance = [(surface_compliance(model, k), k=1, model%pairs)]
    associate (bends => reshape([(bend_at(k), k=1, model%pairs)], [2, model%pairs]))
      surface%bend = bends(1, :)
      surface%curvature = bends(2, :)
    end associate

  contains

    !> Bend and curvature; a pair without neighbours on both sides does not bend.
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
          if (long(k) == 0.0_wp) cycle   ! at a joint two pairs have one place
          slope(k) = (model%initial_gap(other) - model%initial_gap(pair))/long(k)
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

  !> The pair behind one, seen from its neighbour; 0: none.
  pure integer function beyond(self, pair, from)
    class(surface_line), intent(in) :: self
    integer, intent(in) :: pair, from   !! one, and its neighbour

    associate (next => self%neighbour(:, pair))   ! round a corner it may be another pair of that node
      beyond = maxval(merge(next, 0, self%node(max(next, 1)) /= self%node(from)))
    end associate
  end function beyond

  !> An element at a node: of the first section there, and of the first kind in it; 0: none.
  pure integer function first_element(model, node) result(element)
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: node             !! any
    integer, allocatable :: there(:)

    element = 0
    there = model%around%of(node)
    if (size(there) > 0) &
      element = there(minloc(model%section(there)*size(model%kinds) + model%kind(there), dim=1))
  end function first_element

  !> The elements at a node that tell how it gives way: those of the section of the first; none where it is
  !! held all over, or none of them can be strained.
  pure function elements_behind(model, node) result(elements)
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: node             !! any
    integer, allocatable :: elements(:)
    integer :: i

    elements = model%around%of(node)
    if (size(elements) == 0) return
    elements = pack(elements, model%section(elements) == model%section(first_element(model, node)))
    if (.not. all(model%is_held([1, 2], node))) then
      do i = 1, size(elements)
        if (.not. model%is_rigid(model%connectivity(:model%node_count(elements(i)), elements(i)))) return
      end do
    end if
    elements = [integer ::]
  end function elements_behind

  !> The normal stress at each pair, as a pressure: the mean of both sides', of which each has errors of its
  !! own; 0 where neither gives way [stress] [pairs].
  pure function smooth_pressures(model, materials, smooth) result(pressure)
    type(model_type), intent(in) :: model              !! the scene
    type(model_materials), intent(in) :: materials     !! of its sections
    real(wp), intent(in) :: smooth(:, :)               !! strains [components, places: first the nodes']
    real(wp) :: pressure(model%pairs)
    type(point_state) :: state
    real(wp) :: side(2), weight(2)
    logical :: seen(2)
    integer, allocatable :: elements(:)
    integer :: i, k, n

    pressure = 0.0_wp
    do k = 1, model%pairs
      side = 0.0_wp
      weight = 0.0_wp
      do i = model%row_start(k), model%row_start(k + 1) - 1
        elements = elements_behind(model, model%row_node(i))
        if (size(elements) == 0) cycle
        state = materials%state_at(model%first_point(elements(1)), smooth(:, model%row_node(i)))
        ! the row's first node is one side, the others share the other
        n = merge(1, 2, i == model%row_start(k))
        associate (normal => model%normal(:, k), stress => state%stress)
          side(n) = side(n) - model%row_weight(i)*(stress(1)*normal(1)**2 + stress(2)*normal(2)**2 + &
              2.0_wp*stress(4)*normal(1)*normal(2))
        end associate
        weight(n) = weight(n) + model%row_weight(i)
      end do
      seen = abs(weight) > least_weight
      if (any(seen)) pressure(k) = sum(side/merge(weight, 1.0_wp, seen), mask=seen)/count(seen)
    end do
  end function smooth_pressures

  !> 1/E*, of both sides of a pair: (1 - nu**2)/E, 1/E of sheets, 0 of nodes that give way nowhere; of the
  !! nodes that share the other side the largest [1/stress].
  pure real(wp) function surface_compliance(model, pair) result(compliance)
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: pair             !! which pair
    real(wp) :: nu, side(2)
    integer, allocatable :: elements(:)
    integer :: i, k, section

    side = 0.0_wp
    do i = model%row_start(pair), model%row_start(pair + 1) - 1
      k = merge(1, 2, i == model%row_start(pair))
      elements = elements_behind(model, model%row_node(i))
      if (size(elements) == 0) cycle
      section = model%section(elements(1))
      nu = merge(0.0_wp, model%poisson(section), model%kinematics(section) == plane_stress)
      side(k) = max(side(k), (1.0_wp - nu**2)/model%young(section))
    end do
    compliance = sum(side)
  end function surface_compliance

  !> Of the pairs of a zone: the pressure that flattens all uneven bends, the largest; whether these are
  !! waves; how high they are then, the mean. A tip bends the gap once, where a fillet begins its curvature
  !! steps: these are uneven bends, and no waves.
  pure subroutine find_waves(line, pairs, pressure, are_waves, height)
    type(surface_line), intent(in) :: line    !! of all pairs
    integer, intent(in) :: pairs(:)           !! of the zone
    real(wp), intent(out) :: pressure         !! [stress]
    logical, intent(out) :: are_waves         !! where the gap bends by turns at enough pairs
    real(wp), intent(out) :: height           !! 0 where there are none [length]
    real(wp) :: angle, spacing
    real(wp) :: least   !! curvature that rounding makes of straight sides beside a tip [1/length]
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

    !> How much more, or less, the gap bends at a pair than beside it: by its curvature there, since sides may
    !! grow along a line. Does it so by turns? Of four pairs in a row the first and the third bend it by more
    !! than the others, or by less.
    pure subroutine uneven_bend(pair, angle, spacing, alternates)
      integer, intent(in) :: pair
      real(wp), intent(out) :: angle     !! [rad]
      real(wp), intent(out) :: spacing   !! [length]
      logical, intent(out) :: alternates
      real(wp) :: curvature(5)
      integer :: k, run(5)   !! the pair in the middle of four others; 0: none
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
      do k = 1, 5   ! beyond a corner a pair faces a step, or another side
        if (k /= 3) known(k) = known(k) .and. abs(line%bend(max(run(k), 1))) <= corner
      end do
      associate (beside => pack(curvature([2, 4]), known([2, 4])))
        if (size(beside) > 0) angle = spacing*abs(curvature(3) - sum(beside)/size(beside))
      end associate
      do k = 1, 2
        if (all(known(k:k + 3))) alternates = alternates .or. by_turns(curvature(k:k + 3))
      end do
    end subroutine uneven_bend

    !> The pair behind one, seen from its neighbour, as mirrored at a line of symmetry; 0: none.
    pure integer function behind(pair, from)
      integer, intent(in) :: pair, from

      behind = from
      if (.not. line%mirrored(pair)) behind = line%beyond(pair, from)
    end function behind

    !> Does the line go on to both sides of a pair? Else nothing is known of its bend.
    pure logical function goes_on(pair)
      integer, intent(in) :: pair   !! 0: none

      goes_on = .false.
      if (pair > 0) goes_on = all(line%neighbour(:, pair) > 0) .or. line%mirrored(pair)
    end function goes_on

    !> Are the first and the third of four curvatures above the others, or below?
    pure logical function by_turns(x)
      real(wp), intent(in) :: x(4)

      associate (odd => x([1, 3]), even => x([2, 4]))
        by_turns = minval(odd) - maxval(even) > least .or. minval(even) - maxval(odd) > least
      end associate
    end function by_turns
  end subroutine find_waves
end module epcont_accuracy_surface_line
