!> Checks pairs before solving: errors and warnings.
module epcont_contact_geometry_pair_checks
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real
  use epcont_base_tolerances, only: least_difference, no_effect, rounded_off
  use epcont_element_kinematics, only: directions
  use epcont_geometry_plane, only: cross_product, right_of, unit
  use epcont_model_finding, only: and_more, findings, of_couple, of_element, of_node, of_pair
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_pairs

  real(wp), parameter :: &
    !> Cosine between normals of the same sense: at most 60 degrees.
    same_way = 0.5_wp, &
    !> Cosine between equal normals of two CGAPs: at most 2.5 degrees. The walls of a groove have a larger
    !! angle, and each has its force.
    parallel = 0.999_wp, &
    !> Cosine between the normals of a CGAP and a line, which bends from node to node: at most 45 degrees.
    one_face = sqrt(0.5_wp)

contains

  !> Report pairs at the same point as errors; warn of pairs with a wrong sense, of nodes not opposite each
  !! other, of pairs that can neither open nor close, and of six-node edges with incomplete pairs.
  subroutine check_pairs(model, found)
    type(model_type), intent(in) :: model   !! the model
    type(findings), intent(inout) :: found   !! errors are added
    type(incidence) :: around          ! CGAPs at each node
    logical :: on_line(0:model%mesh%nodes)  ! nodes of lines in contact
    !> At each node: longest edge [length]; outward normal of the boundary, zero if there is no boundary
    real(wp) :: longest(model%mesh%nodes), outward(2, model%mesh%nodes)
    integer :: c, cgaps

    if (model%contact%pairs == 0) return
    cgaps = model%contact%single_pairs()
    if (cgaps > 0) then
      around = new_incidence(model%contact%pair_node(:, :cgaps), model%mesh%nodes)
      call refuse_pairs_twice(model, around, cgaps, found)
      call look_around_nodes(model, longest, outward)
      call warn_of_wrong_ways()
      call warn_of_sideways()
      call warn_of_held(model, 1, cgaps, 0, found)
    end if
    on_line = .false.
    do c = 1, size(model%contact%line_contact)
      associate (contact => model%contact%line_contact(c))
        on_line([contact%slave%segment, contact%master%segment]) = .true.
        call warn_of_held(model, contact%first, contact%last, contact%couple(1), found)
      end associate
    end do
    if (cgaps > 0) call warn_of_half_sides(model, around, on_line, found)

  contains

    !> Warn of normals that point into the body of node A, or out of that of node B, unless the other node
    !! shows that they are right.
    subroutine warn_of_wrong_ways()
      real(wp) :: along(2)   ! cosines with the two boundary normals
      integer :: i, k

      do k = 1, cgaps
        along = [(dot_product(outward(:, model%contact%pair_node(i, k)), model%contact%normal(:, k)), i=1, 2)]
        if (along(1) >= same_way .or. along(2) <= -same_way) cycle
        if (along(1) <= -same_way .or. along(2) >= same_way) &
          call found%add_warning(of_pair, k, 1, ': its normal points the wrong way: into the body of GA, '// &
                                 'or out of that of GB', &
                                 'exchange GA and GB, or reverse the x-axis of CID')
      end do
    end subroutine warn_of_wrong_ways

    !> Give one warning for all CGAPs whose nodes, both on bodies, are farther apart across the normal than
    !! the longest edge there.
    subroutine warn_of_sideways()
      real(wp) :: sideways(cgaps)
      integer :: far, k

      do k = 1, cgaps
        associate (node => model%contact%pair_node(:, k))
          sideways(k) = abs(cross_product(model%mesh%x(:, node(2)) - model%mesh%x(:, node(1)), &
                                          model%contact%normal(:, k)))
          if (any(longest(node) == 0.0_wp) .or. sideways(k) <= maxval(longest(node))) sideways(k) = 0.0_wp
        end associate
      end do
      if (all(sideways == 0.0_wp)) return
      far = maxloc(sideways, dim=1)
      call found%add_warning(of_pair, far, 4, ': GA and GB lie '//short_real(sideways(far))// &
                             ' apart along the contact, more than an edge there ('// &
                             short_real(maxval(longest(model%contact%pair_node(:, far))))//')'// &
                             and_more(count(sideways > 0.0_wp), '; so do ', ' more'), &
                             'pair nodes that are opposite each other, or use BLSEG lines with a BCONP')
    end subroutine warn_of_sideways
  end subroutine check_pairs

  !> Report CGAPs at the same point as another CGAP or a pair of lines: each would carry a part of the force,
  !! and the pressure would be too small.
  subroutine refuse_pairs_twice(model, around, cgaps, found)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: cgaps
    type(findings), intent(inout) :: found
    integer :: c, k
    type(incidence) :: lines   ! pairs of lines of each node that is projected
    integer, dimension(cgaps) :: cgap, line   ! equal pair, 0 if absent

    lines = new_incidence(reshape(model%contact%row_node(model%contact%row_start(cgaps + &
      1:model%contact%pairs)), &
        [1, model%contact%pairs - cgaps]), model%mesh%nodes)
    cgap = [(cgap_like(model, around, k), k=1, cgaps)]
    line = [(line_pair_like(model, cgaps, lines, k), k=1, cgaps)]
    k = findloc(cgap > 0, .true., dim=1)
    if (k > 0) call found%add_error(of_pair, k, 1, ': joins the nodes of '// &
        model%name_of(of_pair, cgap(k))//' along the same normal, with the '// &
        'same gap'//like_this(cgap), &
        'keep one CGAP for two nodes and a normal')
    k = findloc(line > 0, .true., dim=1)
    if (k == 0) return
    c = findloc(model%contact%line_contact%last >= line(k), .true., dim=1)
    call found%add_error(of_pair, k, 1, ': joins nodes that '// &
                         model%name_of(of_couple, model%contact%line_contact(c)%couple(1))// &
                         ' joins along the same normal'//like_this(line), 'use either CGAPs or a BCONP')
  end subroutine refuse_pairs_twice

  !> First CGAP before pair k with the same nodes, normal and gap, 0 if absent.
  pure integer function cgap_like(model, around, k) result(other)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: k
    real(wp) :: apart
    integer :: i, node, way

    associate (a => model%contact%pair_node(1, k), b => model%contact%pair_node(2, k))
      apart = norm2(model%mesh%x(:, b) - model%mesh%x(:, a)) + abs(model%contact%initial_gap(k))
      ! A node of the ground may have thousands.
      node = merge(a, b, around%start(a + 1) - around%start(a) < around%start(b + 1) - around%start(b))
      do i = around%start(node), around%start(node + 1) - 1
        other = around%group(i)
        if (other == k) exit
        way = 0
        if (all(model%contact%pair_node(:, other) == [a, b])) way = 1
        if (all(model%contact%pair_node(:, other) == [b, a])) way = -1
        if (way*dot_product(model%contact%normal(:, other), model%contact%normal(:, k)) < parallel) cycle
        if (abs(model%contact%initial_gap(other) - model%contact%initial_gap(k)) <= rounded_off*apart) return
      end do
    end associate
    other = 0
  end function cgap_like

  !> First pair of lines between the nodes of CGAP k, with the same normal, 0 if absent.
  pure integer function line_pair_like(model, cgaps, lines, k) result(pair)
    type(model_type), intent(in) :: model
    integer, intent(in) :: cgaps, k
    type(incidence), intent(in) :: lines
    integer :: i, which

    do which = 1, 2
      associate (near => lines%of(model%contact%pair_node(which, k)), &
                 other => model%contact%pair_node(3 - which, k))
        do i = 1, size(near)
          pair = cgaps + near(i)
          if (all(model%contact%row_node(model%contact%row_start(pair) + &
                                         1:model%contact%row_start(pair + 1) - 1) /= other)) cycle
          if (dot_product(model%contact%normal(:, pair), model%contact%normal(:, k))*merge(1, -1, &
            which == 2) >= one_face) &
            return
        end do
      end associate
    end do
    pair = 0
  end function line_pair_like

  !> Find the longest side and the outward normal of the boundary at each node.
  subroutine look_around_nodes(model, longest, outward)
    type(model_type), intent(in) :: model
    real(wp), intent(inout) :: longest(:), outward(:, :)
    real(wp) :: chord(2), length(model%mesh%nodes)   ! of all edges around each node
    integer :: k, s

    longest = 0.0_wp
    length = 0.0_wp
    outward = 0.0_wp
    do s = 1, model%mesh%body_outline%sides
      associate (node => model%mesh%body_outline%node(:, s))
        chord = model%mesh%x(:, node(2)) - model%mesh%x(:, node(1))
        do k = 1, merge(3, 2, node(3) > 0)
          longest(node(k)) = max(longest(node(k)), norm2(chord))
          length(node(k)) = length(node(k)) + norm2(chord)
          outward(:, node(k)) = outward(:, node(k)) + right_of(chord)
        end do
      end associate
    end do
    do k = 1, model%mesh%nodes   ! edges all around a node cancel
      if (norm2(outward(:, k)) <= no_effect*length(k)) outward(:, k) = 0.0_wp
      outward(:, k) = unit(outward(:, k))
    end do
  end subroutine look_around_nodes

  !> Give one warning for all pairs of a range whose nodes are fixed along the normal. A fixed overlap gives
  !! no warning here: it ends the run with an error.
  subroutine warn_of_held(model, first, last, couple, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: first, last       !! the range
    integer, intent(in) :: couple            !! couple of lines of the pairs; 0: CGAPs
    type(findings), intent(inout) :: found
    integer, allocatable :: held(:)
    character(len=:), allocatable :: which
    integer :: k

    held = pack([(k, k=first, last)], [(is_held(k), k=first, last)])
    if (size(held) == 0) return
    which = and_more(size(held), ', and ', ' more')
    if (couple > 0) which = ': '//model%name_of(of_node, model%contact%pair_node(2, held(1)))//which
    call found%add_warning(merge(of_couple, of_pair, couple > 0), merge(couple, held(1), couple > 0), 1, &
                           which//': can neither open nor close: the nodes on both sides are fixed '// &
                           'along the normal', 'free the node on one side, or remove the pair')

  contains

    !> Are all nodes of a pair fixed along its normal, without overlap?
    pure logical function is_held(pair)
      integer, intent(in) :: pair
      real(wp) :: gap
      integer :: c, i

      gap = model%contact%initial_gap(pair)
      is_held = .false.
      do i = model%contact%row_start(pair), model%contact%row_start(pair + 1) - 1
        do c = 1, directions
          if (abs(model%contact%normal(c, pair)) <= least_difference) cycle
          associate (leader => model%constraints%leader(c, model%contact%row_node(i)))
            if (.not. model%constraints%held(c, leader)) return
            gap = gap + model%contact%row_weight(i)*model%contact%normal(c, pair)*model%loads%prescribed(c, &
              leader)
          end associate
        end do
      end do
      is_held = gap >= 0.0_wp
    end function is_held
  end subroutine warn_of_held

  !> Warn of incomplete pairs of six-node edges. An edge carries two thirds of its force at the mid-side node
  !! and the rest at its ends; it penetrates at a node without a pair. A mid-side pair alone may be
  !! a point support, but not two of them on neighbouring edges.
  subroutine warn_of_half_sides(model, around, on_line, found)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    logical, intent(in) :: on_line(0:)
    type(findings), intent(inout) :: found
    integer, allocatable :: half(:)
    character(len=:), allocatable :: what
    logical :: at(3)
    integer :: s

    half = pack([(s, s=1, model%mesh%body_outline%sides)], &
                [(is_half(model, around, on_line, s), s=1, model%mesh%body_outline%sides)])
    if (size(half) == 0) return
    associate (node => model%mesh%body_outline%node(:, half(1)), &
               element => model%mesh%body_outline%element(half(1)))
      at = has_pair(model, around, node)
      what = ' at both ends and none at its middle, '//model%name_of(of_node, node(3))
      if (at(3)) what = ' at its middle, '//model%name_of(of_node, node(3))//', and none at its ends'
      call found%add_warning(of_pair, around%group(around%start(node(merge(3, 1, at(3))))), 1, &
                             ': an edge of '//model%name_of(of_element, element)//' has CGAPs'//what// &
                             ': it will pass through what it touches, and the pressures are wrong'// &
                             and_more(size(half), '; so do ', ' more'), &
                             'add CGAPs at all three nodes of the edges, or use BLSEG and BCONP')
    end associate
  end subroutine warn_of_half_sides

  !> Has a flexible six-node edge, on no line, pairs only at its ends, or, beside another such edge,
  !! only at its mid-side node?
  pure logical function is_half(model, around, on_line, side)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    logical, intent(in) :: on_line(0:)
    integer, intent(in) :: side
    logical :: at(3), beside(3)

    associate (outline => model%mesh%body_outline, node => model%mesh%body_outline%node(:, side))
      is_half = node(3) > 0 .and. .not. on_line(node(3))
      if (is_half) is_half = .not. model%constraints%is_rigid(node)
      if (.not. is_half) return
      at = has_pair(model, around, node)
      beside = has_pair(model, around, outline%node(:, outline%before(side))) .or. &
               has_pair(model, around, outline%node(:, outline%after(side)))
    end associate
    is_half = merge(beside(3) .and. .not. any(at(:2)), all(at(:2)), at(3))
  end function is_half

  !> Have the nodes of a six-node edge a CGAP along its normal?
  pure function has_pair(model, around, node)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: node(3)
    logical :: has_pair(3)
    real(wp) :: across(2)
    integer :: i, k

    has_pair = .false.
    if (node(3) == 0) return
    across = unit(right_of(model%mesh%x(:, node(2)) - model%mesh%x(:, node(1))))
    do k = 1, 3
      associate (pairs => around%of(node(k)))
        has_pair(k) = any([(abs(dot_product(across, model%contact%normal(:, pairs(i)))) >= same_way, &
                            i=1, size(pairs))])
      end associate
    end do
  end function has_pair

  !> Name the equal pair, and the number of further CGAPs with an equal pair.
  pure function like_this(pair) result(text)
    integer, intent(in) :: pair(:)   !! 0 if absent
    character(len=:), allocatable :: text

    text = ': forces would be shared between the two'
    if (count(pair > 0) > 1) text = text//'; so do '//plural(count(pair > 0) - 1, 'more CGAP')
  end function like_this
end module epcont_contact_geometry_pair_checks
