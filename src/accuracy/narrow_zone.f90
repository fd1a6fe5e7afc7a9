!> Errors of narrow zones, with contact at one or two pairs: unknown start of the contact, overclosure, and
!> direction of the force. Also unknown force directions of pairs beside a corner and of wide zones.
module epcont_accuracy_narrow_zone
  use epcont_accuracy_surface_line, only: corner, first_element, surface_line
  use epcont_accuracy_weights, only: askew, bears_on, finer
  use epcont_accuracy_zone_error, only: zone_error
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_element_kinematics, only: directions
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_result_answer, only: answer_type
  use epcont_result_body_force, only: resultants
  use epcont_result_contact_line, only: contact_line
  implicit none
  private
  public :: find_turned, shifted_loads, too_near

  !> A zone of at most this number of pairs does not show where its contact begins.
  integer, parameter :: narrow = 2

contains

  !> Estimate the overclosure of a zone with few pairs: how much nearer the bodies come on a three times finer
  !! mesh, and the bulge of a smooth gap between neighbouring pairs, where contact begins in truth. For two
  !! pairs the bulge counts by half [length].
  pure real(wp) function too_near(model, line, force, zone, pairs)
    type(model_type), intent(in) :: model     !! model
    type(surface_line), intent(in) :: line    !! of its pairs
    real(wp), intent(in) :: force(:)          !! of all pairs [force] [pairs]
    type(zone_error), intent(in) :: zone      !! its known errors
    integer, intent(in) :: pairs(:)           !! of the zone
    integer :: bearing

    too_near = 0.0_wp
    bearing = bearing_pairs(model, force(pairs))
    if (bearing > narrow) return
    if (.not. zone%unbounded) too_near = bulge()/bearing   ! contact begins at the tip
    if (bearing == 1) too_near = too_near + finer*line%compliance(zone%peak)*force_of_depth()

  contains

    !> Find the largest bulge of a smooth gap below its values at the peak and its neighbours, from the bends
    !! there [length].
    pure real(wp) function bulge()
      integer :: k, near(3)

      bulge = 0.0_wp
      near = [zone%peak, line%neighbour(:, zone%peak)]
      do k = 1, 3
        if (near(k) == 0) cycle
        ! beyond a corner, a pair projects onto a step or another edge
        if (line%curvature(near(k)) <= 0.0_wp .or. line%bend(near(k)) > corner) cycle
        ! an eighth of angle times spacing
        bulge = max(bulge, line%bend(near(k))**2/line%curvature(near(k))/8.0_wp)
      end do
    end function bulge

    !> Find the force of the peak divided by the depth of its elements [force/length].
    pure real(wp) function force_of_depth()
      real(wp) :: depth
      integer :: element, k, node

      force_of_depth = 0.0_wp
      do k = 1, 2
        node = model%contact%pair_node(k, zone%peak)
        element = first_element(model, node)
        if (element == 0) cycle
        depth = model%depth(element, model%mesh%x(1, node))
        if (depth > 0.0_wp) force_of_depth = force(zone%peak)/depth
      end do
    end function force_of_depth
  end function too_near

  !> Count the pairs that carry the force of a zone: the number of equal forces with the same sum and sum of
  !! squares. In axisymmetric models forces grow with the radius; there all pairs with a force count.
  pure integer function bearing_pairs(model, force)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: force(:)

    bearing_pairs = count(force > no_effect*sum(force))
    if (.not. model%has_rings() .and. bearing_pairs > 0) bearing_pairs = nint(sum(force)**2/sum(force**2))
    bearing_pairs = max(bearing_pairs, 1)
  end function bearing_pairs

  !> Find the load along each rigid-body mode if the force of a narrow zone is shifted by half an edge (a
  !! quarter of an edge for two pairs), since the position of the contact within its edges is unknown
  !! [force*length or force] [motions, narrow zones].
  pure function shifted_loads(model, line, motions, answer) result(load)
    type(model_type), intent(in) :: model        !! model
    class(contact_line), intent(in) :: line      !! of its pairs
    type(free_motions), intent(in) :: motions    !! of its bodies
    type(answer_type), intent(in) :: answer      !! with forces and zones
    real(wp), allocatable :: load(:, :)
    real(wp) :: aside
    integer, allocatable :: beside(:), zones(:)
    integer :: bearing(size(answer%zones)), body, i, k, m, z   ! the first: number of loaded pairs of each
                                                               ! zone

    bearing = [(bearing_pairs(model, answer%contact%force(answer%zones(z)%pairs)), z=1, size(bearing))]
    zones = pack([(z, z=1, size(bearing))], bearing <= narrow)
    allocate (load(motions%count, size(zones)), source=0.0_wp)
    do z = 1, size(zones)
      associate (pairs => answer%zones(zones(z))%pairs, force => answer%contact%force)
        k = pairs(maxloc(line%tributary(pairs), dim=1, &   ! of equal forces the widest pair
                         mask=force(pairs) >= (1.0_wp - no_effect)*maxval(force(pairs))))
        beside = pack(line%neighbour(:, k), line%neighbour(:, k) > 0)
        aside = maxval([0.0_wp, (0.5_wp*line%distance(k, beside(i))/bearing(zones(z)), i=1, size(beside))])
        do i = 1, 2   ! A is pushed against the normal, B along it
          body = model%mesh%body(model%contact%pair_node(i, k))
          do m = motions%first(body), motions%first(body + 1) - 1
            if (answer%contact%motion_free(m)) cycle   ! undetermined mode
            load(m, z) = load(m, z) + (2*i - 3)*sum(force(pairs))*aside/motions%parts%extent(body) &
                         *motions%turn(model%contact%pair_node(i, k), m)
          end do
        end do
      end associate
    end do
  end function shifted_loads

  !> Find the change of forces if pairs push along another direction that may be the right one.
  !!
  !! A pair may push along the normal of its own node instead of the normal of the opposite edge. On smooth
  !! boundaries the two are equal only where the bodies touch. In narrow zones each pair counts by itself; in
  !! wide zones all normals of one body, or of the other, count together.
  subroutine find_turned(model, line, answer, given, total, of_body)
    type(model_type), intent(in) :: model               !! model
    class(contact_line), intent(in) :: line             !! of its pairs
    type(answer_type), intent(in) :: answer             !! with forces and zones
    !> Loads determine this component of the resultant [directions, bodies]
    logical, intent(in) :: given(:, :)
    real(wp), intent(out) :: total                      !! change of the total contact force [force]
    !> Change of the resultant on each body [force]
    real(wp), intent(out) :: of_body(directions, model%mesh%bodies)
    real(wp) :: along, least, more
    real(wp), dimension(directions) :: change, own, on
    real(wp), dimension(directions, model%mesh%bodies) :: lean, resultant
    logical :: is_narrow
    integer :: b, body(2), i, k, z
    real(wp) :: smooth_normal(directions, model%contact%pairs)

    smooth_normal = smooth_normals(model)
    total = 0.0_wp
    of_body = 0.0_wp
    lean = 0.0_wp
    least = no_effect*sum(answer%contact%force)
    resultant = resultants(model, answer%contact%force)
    do z = 1, size(answer%zones)
      more = 0.0_wp
      associate (pairs => answer%zones(z)%pairs, force => answer%contact%force)
        is_narrow = bearing_pairs(model, force(pairs)) <= narrow
        do i = 1, size(pairs)
          k = pairs(i)
          body = model%mesh%body(model%contact%pair_node(:, k))
          own = -smooth_normal(:, k)
          on = kept(resultant(:, body), given(:, body) .and. abs(resultant(:, body)) > least)
          ! The contacts of an axisymmetric body that can move along its axis may balance each other: each
          ! pair keeps its axial force.
          if (model%has_rings() .and. any(given(2, body)) .and. &
              force(k)*abs(model%contact%normal(2, k)) > least) &
            on = [0.0_wp, force(k)*model%contact%normal(2, k)]
          if (all(own == 0.0_wp) .or. norm2(on) <= least) cycle
          ! The pair keeps its force along `on`, if it has any.
          along = 0.0_wp
          if (is_narrow .or. abs(dot_product(on, own)) >= bears_on*norm2(on)) &
            along = excess(dot_product(on, model%contact%normal(:, k)), dot_product(on, own), &
                           no_effect*norm2(on))
          change = (1.0_wp + along)*own - model%contact%normal(:, k)
          if (is_narrow) total = total + askew*force(k)*abs(along)
          if (.not. is_narrow) more = more + force(k)*along
          do b = 1, 2   ! A is pushed against the normal, B along it
            if (is_narrow) then
              of_body(:, body(b)) = of_body(:, body(b)) + askew*force(k)*abs(change)
            else
              lean(:, body(b)) = lean(:, body(b)) + (2*b - 3)*force(k)*change
            end if
          end do
        end do
      end associate
      total = total + abs(more)
    end do
    where (abs(lean) > least) of_body = of_body + abs(lean)   ! smaller values are rounding
    call turn_shared_places()

  contains

    !> Rounding divides a force between pairs at one point beside a corner: each pair may push as the
    !! strongest pair there does, on the same body.
    subroutine turn_shared_places()
      real(wp) :: way
      integer, allocatable :: pairs(:)
      integer :: bodies(4)                !! of the pair and of the strongest pair
      integer :: strongest(model%contact%pairs)   !! strongest pair at the point of each pair

      associate (force => answer%contact%force)
        do k = 1, size(line%at_place%start) - 1
          pairs = line%at_place%of(k)
          strongest(pairs) = pairs(maxloc(force(pairs), dim=1))
        end do
        do k = 1, model%contact%pairs
          if (force(k) <= 0.0_wp .or. strongest(k) == k) cycle
          body = model%mesh%body(model%contact%pair_node(:, k))
          ! The normal is opposite if the pairs stand on different lines.
          way = merge(1.0_wp, -1.0_wp, any(model%mesh%body(model%contact%pair_node(:, strongest(k))) == body))
          change = force(k)*abs(model%contact%normal(:, k) - way*model%contact%normal(:, strongest(k)))
          total = total + norm2(change)
          bodies = model%mesh%body([model%contact%pair_node(:, [k, strongest(k)])])
          do b = 1, size(bodies)
            if (all(bodies(:b - 1) /= bodies(b))) of_body(:, bodies(b)) = of_body(:, bodies(b)) + change
          end do
        end do
      end associate
    end subroutine turn_shared_places
  end subroutine find_turned

  !> Find the resultant on two bodies that stays if their contact direction changes: the part that loads
  !! determine, else the larger resultant.
  pure function kept(resultant, given) result(on)
    real(wp), intent(in) :: resultant(directions, 2)
    logical, intent(in) :: given(directions, 2)
    real(wp) :: on(directions), of_loads(directions, 2)

    of_loads = merge(resultant, 0.0_wp, given)
    if (.not. any(given)) of_loads = resultant
    on = of_loads(:, merge(1, 2, norm2(of_loads(:, 1)) > (1.0_wp + no_effect)*norm2(of_loads(:, 2))))
  end function kept

  !> a/b - 1, limited to [-1, 1]; 0 if a and b are equal, and 1 if b alone is zero.
  pure real(wp) function excess(a, b, least)
    real(wp), intent(in) :: a, b
    real(wp), intent(in) :: least   !! smaller differences are zero

    excess = merge(1.0_wp, 0.0_wp, abs(a - b) > least)
    if (abs(b) > least) excess = max(-1.0_wp, min(1.0_wp, (a - b)/b))
  end function excess

  !> Find the normals of lines in contact at the nodes of pairs on the opposite line; zero at a corner, or
  !! without lines [directions, pairs].
  function smooth_normals(model) result(normal)
    type(model_type), intent(in) :: model
    real(wp) :: normal(directions, model%contact%pairs)
    ! of a node in the current line: as end of which edge; 0 if it is not
    integer :: place(2, model%mesh%nodes)
                                       ! there
    integer :: c

    normal = 0.0_wp
    place = 0
    do c = 1, size(model%contact%line_contact)
      associate (contact => model%contact%line_contact(c))
        call take_normals(contact%slave, contact%first, min(contact%first_of_master - 1, contact%last))
        call take_normals(contact%master, max(contact%first_of_master, contact%first), contact%last)
      end associate
    end do

  contains

    !> Find the normals of one line at some pairs.
    subroutine take_normals(line, first, last)
      class(boundary_line), intent(in) :: line
      integer, intent(in) :: first, last
      integer :: k, pair, side

      if (last < first) return
      do side = size(line%segment, 2), 1, -1
        do k = 3, 1, -1
          if (line%segment(k, side) > 0) place(:, line%segment(k, side)) = [k, side]
        end do
      end do
      do pair = first, last
        associate (at => place(:, model%contact%pair_node(2, pair)))
          if (at(1) == 0) cycle
          if (at(1) < 3) then
            if (line%corner(at(1), at(2))) cycle
          end if
          normal(:, pair) = line%normal(:, at(1), at(2))
        end associate
      end do
      do side = 1, size(line%segment, 2)
        place(:, pack(line%segment(:, side), line%segment(:, side) > 0)) = 0
      end do
    end subroutine take_normals
  end function smooth_normals
end module epcont_accuracy_narrow_zone
