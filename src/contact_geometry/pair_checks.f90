!> Checks pairs before solving: errors and warnings.
module epcont_contact_geometry_pair_checks
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_base_tolerances, only: no_effect
  use epcont_geometry_plane, only: cross_product, right_of, unit
  use epcont_model_finding, only: and_more, findings, of_element, of_node, of_pair
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_pairs

  !> Cosine between normals of the same sense: at most 60 degrees.
  real(wp), parameter :: same_way = 0.5_wp

contains

  !> Warn of CGAPs with a wrong sense, of nodes not opposite each other, and of six-node edges with incomplete
  !! CGAPs.
  subroutine check_pairs(model, found)
    type(model_type), intent(in) :: model   !! the model
    type(findings), intent(inout) :: found   !! warnings are added
    !> At each node: longest edge [length]; outward normal of the boundary, zero if there is no boundary
    real(wp) :: longest(model%mesh%nodes), outward(2, model%mesh%nodes)
    integer :: cgaps

    cgaps = model%contact%single_pairs()
    if (cgaps == 0) return
    call look_around_nodes(model, longest, outward)
    call warn_of_wrong_ways()
    call warn_of_sideways()
    call warn_of_half_sides(model, cgaps, found)

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

  !> Warn of flexible six-node edges with CGAPs along their normal at both ends, and no pair at their mid-side
  !! node, which carries two thirds of the force of an edge.
  subroutine warn_of_half_sides(model, cgaps, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: cgaps
    type(findings), intent(inout) :: found
    type(incidence) :: around          ! CGAPs at each node
    integer, allocatable :: half(:)
    logical :: paired(model%mesh%nodes)
    integer :: s

    around = new_incidence(model%contact%pair_node(:, :cgaps), model%mesh%nodes)
    paired = .false.
    paired(model%contact%row_node) = .true.
    associate (outline => model%mesh%body_outline)
      half = pack([(s, s=1, outline%sides)], [(is_half(outline%node(:, s)), s=1, outline%sides)])
      if (size(half) == 0) return
      associate (node => outline%node(:, half(1)))
        call found%add_warning(of_pair, around%group(around%start(node(1))), 1, &
          ': an edge of '//model%name_of(of_element, outline%element(half(1)))// &
          ' has CGAPs at both ends and none at its middle, '//model%name_of(of_node, node(3))// &
          ': it will pass through what it touches, and the pressures are wrong'// &
          and_more(size(half), '; so do ', ' more'), &
          'add CGAPs at all three nodes of the edges, or use BLSEG and BCONP')
      end associate
    end associate

  contains

    pure logical function is_half(node)
      integer, intent(in) :: node(3)
      integer, allocatable :: pairs(:)
      real(wp) :: across(2)
      integer :: i, k

      is_half = node(3) > 0
      if (is_half) is_half = .not. (paired(node(3)) .or. model%constraints%is_rigid(node))
      across = unit(right_of(model%mesh%x(:, node(2)) - model%mesh%x(:, node(1))))
      do k = 1, merge(2, 0, is_half)
        pairs = around%of(node(k))
        is_half = is_half .and. any([(abs(dot_product(across, model%contact%normal(:, pairs(i)))), &
                                      i=1, size(pairs))] >= same_way)
      end do
    end function is_half
  end subroutine warn_of_half_sides
end module epcont_contact_geometry_pair_checks
