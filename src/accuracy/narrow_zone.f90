!> What contact on one pair or two tells too little of: where it begins, how near the bodies come, and which
!> way it presses; and which way pairs beside a corner, and wide zones as a whole, may press.
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

  !> Pairs up to which a zone is too narrow to tell where its contact begins.
  integer, parameter :: narrow = 2

contains

  !> What contact on few pairs says too little: how much nearer the bodies come on a three times finer mesh,
  !! and how high a smooth gap may bulge between one pair and the next, where contact truly begins; of two
  !! pairs, half of that between them [length].
  pure real(wp) function too_near(model, line, force, zone, pairs)
    type(model_type), intent(in) :: model     !! the scene
    type(surface_line), intent(in) :: line    !! of its pairs
    real(wp), intent(in) :: force(:)          !! of all [force] [pairs]
    type(zone_error), intent(in) :: zone      !! what is known of it
    integer, intent(in) :: pairs(:)           !! of the zone
    integer :: bearing

    too_near = 0.0_wp
    bearing = bearing_pairs(model, force(pairs))
    if (bearing > narrow) return
    if (.not. zone%unbounded) too_near = bulge()/bearing   ! a tip is where contact begins
    if (bearing == 1) too_near = too_near + finer*line%compliance(zone%peak)*force_of_depth()

  contains

    !> How far a smooth gap may fall below its values at the peak and beside it, by the most that it bends at
    !! one of them [length].
    pure real(wp) function bulge()
      integer :: k, near(3)

      bulge = 0.0_wp
      near = [zone%peak, line%neighbour(:, zone%peak)]
      do k = 1, 3
        if (near(k) == 0) cycle
        ! beyond, one pair faces a step, or another side
        if (line%curvature(near(k)) <= 0.0_wp .or. line%bend(near(k)) > corner) cycle
        ! an eighth of angle times spacing
        bulge = max(bulge, line%bend(near(k))**2/line%curvature(near(k))/8.0_wp)
      end do
    end function bulge

    !> Force of the peak over the depth of its elements [force/length].
    pure real(wp) function force_of_depth()
      real(wp) :: depth
      integer :: element, k, node

      force_of_depth = 0.0_wp
      do k = 1, 2
        node = model%pair_node(k, zone%peak)
        element = first_element(model, node)
        if (element == 0) cycle
        depth = model%depth(element, model%x(1, node))
        if (depth > 0.0_wp) force_of_depth = force(zone%peak)/depth
      end do
    end function force_of_depth
  end function too_near

  !> How many pairs bear the force of a zone: as many as would if all bore the same. (In rings forces grow
  !! with the radius: there those that bear any.)
  pure integer function bearing_pairs(model, force)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: force(:)

    bearing_pairs = count(force > no_effect*sum(force))
    if (.not. model%has_rings() .and. bearing_pairs > 0) bearing_pairs = nint(sum(force)**2/sum(force**2))
    bearing_pairs = max(bearing_pairs, 1)
  end function bearing_pairs

  !> What the force of a narrow zone does along each motion, more or less, where it is half a side aside, of
  !! two pairs a quarter: where in its sides contact is, nothing tells [force*length or force] [motions,
  !! narrow zones].
  pure function shifted_loads(model, line, motions, answer) result(load)
    type(model_type), intent(in) :: model        !! the scene
    class(contact_line), intent(in) :: line      !! of its pairs
    type(free_motions), intent(in) :: motions    !! of its bodies
    type(answer_type), intent(in) :: answer      !! with forces and zones
    real(wp), allocatable :: load(:, :)
    real(wp) :: aside
    integer, allocatable :: beside(:), zones(:)
    integer :: bearing(size(answer%zones)), body, i, k, m, z   ! the first: pairs of each zone

    bearing = [(bearing_pairs(model, answer%contact%force(answer%zones(z)%pairs)), z=1, size(bearing))]
    zones = pack([(z, z=1, size(bearing))], bearing <= narrow)
    allocate (load(motions%count, size(zones)), source=0.0_wp)
    do z = 1, size(zones)
      associate (pairs => answer%zones(zones(z))%pairs, force => answer%contact%force)
        k = pairs(maxloc(line%tributary(pairs), dim=1, &   ! of equal ones the widest
                         mask=force(pairs) >= (1.0_wp - no_effect)*maxval(force(pairs))))
        beside = pack(line%neighbour(:, k), line%neighbour(:, k) > 0)
        aside = maxval([0.0_wp, (0.5_wp*line%distance(k, beside(i))/bearing(zones(z)), i=1, size(beside))])
        do i = 1, 2   ! A is pushed against the normal, B along it
          body = model%body(model%pair_node(i, k))
          do m = motions%first(body), motions%first(body + 1) - 1
            if (answer%contact%motion_free(m)) cycle   ! nothing resists it
            load(m, z) = load(m, z) + (2*i - 3)*sum(force(pairs))*aside/motions%parts%extent(body) &
                         *motions%turn(model%pair_node(i, k), m)
          end do
        end do
      end associate
    end do
  end function shifted_loads

  !> How much more or less force there would be if pairs pressed another way that may be the right one.
  !!
  !! Pairs may press along the node's own normal instead of that of what it faces: of smooth boundaries these
  !! are the same only where the bodies touch. In narrow zones each pair by itself; in wide ones all normals
  !! of the one body, or of the other.
  subroutine find_turned(model, line, answer, given, total, of_body)
    type(model_type), intent(in) :: model               !! the scene
    class(contact_line), intent(in) :: line             !! of its pairs
    type(answer_type), intent(in) :: answer             !! with forces and zones
    !> Loads make that component of the resultant [directions, bodies]
    logical, intent(in) :: given(:, :)
    real(wp), intent(out) :: total                      !! of the total contact force [force]
    !> Of the resultant on each body [force]
    real(wp), intent(out) :: of_body(directions, model%bodies)
    real(wp) :: along, least, more
    real(wp), dimension(directions) :: change, own, on
    real(wp), dimension(directions, model%bodies) :: lean, resultant
    logical :: is_narrow
    integer :: b, body(2), i, k, z
    real(wp) :: smooth_normal(directions, model%pairs)

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
          body = model%body(model%pair_node(:, k))
          own = -smooth_normal(:, k)
          on = kept(resultant(:, body), given(:, body) .and. abs(resultant(:, body)) > least)
          ! Of a ring that is free along its axis contacts may balance each other: each bears its part.
          if (model%has_rings() .and. any(given(2, body)) .and. force(k)*abs(model%normal(2, k)) > least) &
            on = [0.0_wp, force(k)*model%normal(2, k)]
          if (all(own == 0.0_wp) .or. norm2(on) <= least) cycle
          ! The pair bears the same along `on`, if it bears anything there.
          along = 0.0_wp
          if (is_narrow .or. abs(dot_product(on, own)) >= bears_on*norm2(on)) &
            along = excess(dot_product(on, model%normal(:, k)), dot_product(on, own), no_effect*norm2(on))
          change = (1.0_wp + along)*own - model%normal(:, k)
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
    where (abs(lean) > least) of_body = of_body + abs(lean)   ! less is what sums leave
    call turn_shared_places()

  contains

    !> Pairs at one place, beside a corner, divide a force between them by chance: each may press as the
    !! strongest there does, and on what that presses on.
    subroutine turn_shared_places()
      real(wp) :: way
      integer, allocatable :: pairs(:)
      integer :: bodies(4)                !! of the pair and of the strongest
      integer :: strongest(model%pairs)   !! at the place of each

      associate (force => answer%contact%force)
        do k = 1, size(line%at_place%start) - 1
          pairs = line%at_place%of(k)
          strongest(pairs) = pairs(maxloc(force(pairs), dim=1))
        end do
        do k = 1, model%pairs
          if (force(k) <= 0.0_wp .or. strongest(k) == k) cycle
          body = model%body(model%pair_node(:, k))
          ! The normal is the other way round where what stands on the other line there stood on it here.
          way = merge(1.0_wp, -1.0_wp, any(model%body(model%pair_node(:, strongest(k))) == body))
          change = force(k)*abs(model%normal(:, k) - way*model%normal(:, strongest(k)))
          total = total + norm2(change)
          bodies = model%body([model%pair_node(:, [k, strongest(k)])])
          do b = 1, size(bodies)
            if (all(bodies(:b - 1) /= bodies(b))) of_body(:, bodies(b)) = of_body(:, bodies(b)) + change
          end do
        end do
      end associate
    end subroutine turn_shared_places
  end subroutine find_turned

  !> What stays the same of the resultants on two bodies where their contact turns: what loads make, else the
  !! larger one.
  pure function kept(resultant, given) result(on)
    real(wp), intent(in) :: resultant(directions, 2)
    logical, intent(in) :: given(directions, 2)
    real(wp) :: on(directions), of_loads(directions, 2)

    of_loads = merge(resultant, 0.0_wp, given)
    if (.not. any(given)) of_loads = resultant
    on = of_loads(:, merge(1, 2, norm2(of_loads(:, 1)) > (1.0_wp + no_effect)*norm2(of_loads(:, 2))))
  end function kept

  !> a/b - 1, between -1 and 1; of equal ones 0, and 1 where b alone is nothing.
  pure real(wp) function excess(a, b, least)
    real(wp), intent(in) :: a, b
    real(wp), intent(in) :: least   !! up to which there is nothing

    excess = merge(1.0_wp, 0.0_wp, abs(a - b) > least)
    if (abs(b) > least) excess = max(-1.0_wp, min(1.0_wp, (a - b)/b))
  end function excess

  !> Normals of lines in contact at the nodes of pairs that stand on the other line; none at a corner, or
  !! without lines [directions, pairs].
  function smooth_normals(model) result(normal)
    type(model_type), intent(in) :: model
    real(wp) :: normal(directions, model%pairs)
    integer :: place(2, model%nodes)   ! of a node in the line that is looked at: which of which side; 0: none
    integer :: c

    normal = 0.0_wp
    place = 0
    do c = 1, size(model%line_contact)
      associate (contact => model%line_contact(c))
        call take_normals(contact%slave, contact%first, min(contact%first_of_master - 1, contact%last))
        call take_normals(contact%master, max(contact%first_of_master, contact%first), contact%last)
      end associate
    end do

  contains

    !> Those of one line, at some pairs.
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
        associate (at => place(:, model%pair_node(2, pair)))
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
