!> The pairs as a line along the boundary: areas and neighbours.
module epcont_result_contact_line
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_tolerances, only: no_area
  use epcont_element_kinematics, only: directions
  use epcont_geometry_edge, only: edge_point, edge_point_count, edge_points
  use epcont_geometry_plane, only: cross_product
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: contact_line, find_contact_line, outer_sides, shares_of_nodes

  real(wp), parameter :: &
    !> An edge belongs to the contact line if it is within 45 degrees of the tangent; at a square's corner
    !! both edges are.
    along_tangent = sqrt(0.5_wp)*(1.0_wp + 1.0e-6_wp), &

    !> A line of symmetry is normal to the contact if the normal has at least this part along it.
    along_line = 0.9_wp, &
    !> A node of the other body is on the same line of symmetry within this part of an edge.
    beside_line = 1.0e-3_wp, &

    !> A master pair stands at the same point as another pair if their distance is less than this part of the
    !! distance of nodes.
    close = 0.22_wp

  !> The pairs as a line along the boundary.
  type :: contact_line
    !> Area of each pair: half of its edges, projected along the normal, times thickness; 0 without edges.
    !! Pressure times area is the normal force. [pairs]
    real(wp), allocatable :: tributary(:)
    integer, allocatable :: neighbour(:, :) !! pairs at the other ends of its edges; 0 if none [2, pairs]
    !> Parts of the area towards each neighbour; not set for mid-side nodes [2, pairs]
    real(wp), allocatable :: part(:, :)
    logical, allocatable :: middle(:)       !! mid-side node of an edge [pairs]
    !> Boundary node of each pair: B, or A if B has no elements [pairs]
    integer, allocatable :: node(:)
    real(wp), allocatable :: x(:, :)        !! position of this node [length] [2, pairs]
    logical, allocatable :: mirrored(:)     !! the line ends at the pair, on a line of symmetry [pairs]
    !> The pairs at each point: pairs so close that rounding divides the force between them.
    type(incidence) :: at_place
  contains
    procedure :: distance
    procedure :: in_contact
  end type contact_line

  !> A contact line under construction.
  type :: survey_type
    type(model_type), pointer :: model => null()
    type(contact_line) :: line
    type(incidence) :: at                !! pairs at each node
    integer :: within(2) = 0             !! first and last pair of the contact; with lines: of the slave line
    type(partition) :: places            !! of pairs at one place
  end type survey_type

contains

  !> Find areas and neighbours of the pairs.
  function find_contact_line(model) result(line)
    type(model_type), target, intent(in) :: model   !! the model
    type(contact_line) :: line
    type(survey_type) :: work
    integer, allocatable :: place(:)
    integer :: c, many

    associate (n => model%contact%pairs, a => model%contact%pair_node(1, :), &
               b => model%contact%pair_node(2, :))
      line%node = merge(b, a, model%mesh%around%start(b + 1) > model%mesh%around%start(b))
      line%x = model%mesh%x(:, line%node)
      allocate (line%tributary(n), line%part(2, n), source=0.0_wp)
      allocate (line%neighbour(2, n), source=0)
      allocate (line%middle(n), line%mirrored(n), source=.false.)
      work%places = new_partition(n)
    end associate
    work%model => model
    work%at = new_incidence(reshape(line%node, [1, model%contact%pairs]), model%mesh%nodes)
    work%line = line
    ! A node may have a pair in each of several contacts. Neighbours belong to the same contact.
    call find_edges(work, 1, model%contact%single_pairs())
    do c = 1, size(model%contact%line_contact)
      associate (contact => model%contact%line_contact(c))
        call find_edges(work, contact%first, contact%first_of_master - 1)
        if (contact%last >= contact%first_of_master) call insert_masters(work, contact)
      end associate
    end do
    line = work%line
    call work%places%numbers(place, many)
    line%at_place = new_incidence(reshape(place, [1, model%contact%pairs]), many)
  end function find_contact_line

  !> Find the edges at a range of pairs, and the neighbours among these.
  subroutine find_edges(work, first, last)
    type(survey_type), intent(inout) :: work
    integer, intent(in) :: first, last
    integer, allocatable :: sides(:, :)
    real(wp) :: longest, share(3)
    integer :: beside, end, i, k, pair, own

    work%within = [first, last]
    associate (model => work%model, line => work%line)
      do pair = first, last
        longest = 0.0_wp
        sides = outer_sides(model, line%node(pair))
        do i = 1, size(sides, 2)
          associate (side => sides(:3, i), n => model%contact%normal(:, pair))
            longest = max(longest, norm2(model%mesh%x(:, side(2)) - model%mesh%x(:, side(1))))
            if (.not. is_along(model, side, n)) cycle
            own = findloc(side, line%node(pair), dim=1)
            share = shares_of_nodes(model, sides(4, i), side, n)
            if (abs(share(own)) <= no_area*sum(share)) share(own) = 0.0_wp
            line%tributary(pair) = line%tributary(pair) + share(own)
            line%middle(pair) = own == 3
            if (own == 3) then
              line%neighbour(:, pair) = [(pair_of_side(work, side, side(end)), end=1, 2)]
            else
              beside = merge(side(3), side(3 - own), side(3) > 0)
              k = findloc(line%neighbour(:, pair), 0, dim=1)
              if (k == 0) cycle
              line%neighbour(k, pair) = pair_of_side(work, side, beside)
              if (line%neighbour(k, pair) > 0) line%part(k, pair) = share(own)
            end if
          end associate
        end do
        if (any(line%neighbour(:, pair) == 0)) &
          line%mirrored(pair) = is_on_symmetry(model, pair, line%node(pair), longest)
      end do
    end associate
  end subroutine find_edges

  !> Is a pair at the end of its line on a line of symmetry? Its node is fixed along the boundary. The other
  !! body is fixed too at its end on this line, or everywhere if rigid; a body that continues beyond the line
  !! is not mirrored. One of the two nodes is fixed along the boundary only: a node that is fully fixed, or in
  !! an RBE2, proves nothing.
  pure logical function is_on_symmetry(model, pair, node, side)
    type(model_type), intent(in) :: model        !! the model
    integer, intent(in) :: pair, node
    real(wp), intent(in) :: side   !! length of the longest edge at the node [length]
    logical :: ends, guided, rigid
    integer :: along, i

    is_on_symmetry = .false.
    along = merge(1, 2, abs(model%contact%normal(2, pair)) > abs(model%contact%normal(1, pair)))
    if (abs(model%contact%normal(3 - along, pair)) <= along_line .or. &
        .not. model%constraints%is_held(along, node)) return
    ends = .false.
    guided = is_guided(model, along, node)
    rigid = .true.
    do i = model%contact%row_start(pair), model%contact%row_start(pair + 1) - 1
      associate (other => model%contact%row_node(i))
        if (other == node) cycle
        if (.not. model%constraints%is_held(along, other)) then
          rigid = .false.
        else if (abs(model%mesh%x(along, other) - model%mesh%x(along, node)) <= beside_line*side) then
          ends = .true.
          guided = guided .or. is_guided(model, along, other)
        end if
      end associate
    end do
    is_on_symmetry = guided .and. (ends .or. rigid)
  end function is_on_symmetry

  !> Is a node fixed along the boundary by a support, and free normal to it?
  pure logical function is_guided(model, along, node)
    type(model_type), intent(in) :: model        !! the model
    integer, intent(in) :: along, node

    is_guided = model%constraints%held(along, node) .and. .not. model%constraints%is_held(3 - along, node)
  end function is_guided

  !> Is an edge along the tangent?
  pure logical function is_along(model, side, n)
    type(model_type), intent(in) :: model        !! the model
    integer, intent(in) :: side(3)
    real(wp), intent(in) :: n(directions)   !! normal of the contact

    associate (edge => model%mesh%x(:, side(2)) - model%mesh%x(:, side(1)))
      is_along = abs(dot_product(edge, n)) <= along_tangent*norm2(edge)
    end associate
  end function is_along

  !> Find the pair of an edge at one of its nodes; if there are several, the pair with a normal closest to the
  !! edge's. 0 if there is no pair.
  pure integer function pair_of_side(work, side, node) result(pair)
    type(survey_type), intent(in) :: work
    integer, intent(in) :: side(3), node   !! 0 if there is no such node
    integer, allocatable :: there(:)

    pair = 0
    if (node == 0) return
    there = work%at%of(node)
    there = pack(there, there >= work%within(1) .and. there <= work%within(2))
    associate (edge => work%model%mesh%x(:, side(2)) - work%model%mesh%x(:, side(1)))
      if (size(there) > 0) &
        pair = there(minloc(abs(matmul(edge, work%model%contact%normal(:, there))), dim=1))
    end associate
  end function pair_of_side

  !> Insert pairs of master nodes between those of the slave edge that they stand on. They share its area.
  subroutine insert_masters(work, contact)
    type(survey_type), intent(inout) :: work
    type(line_contact), intent(in) :: contact
    type(incidence) :: on_side
    integer, allocatable :: masters(:)
    integer :: side

    on_side = new_incidence(reshape(contact%stands_on, [1, size(contact%stands_on)]), &
                            size(contact%slave%element))
    do side = 1, size(contact%slave%element)
      masters = contact%first_of_master - 1 + on_side%of(side)
      if (size(masters) > 0) call link(work, contact, side, run_on(work, contact, side, masters))
    end do
  end subroutine insert_masters

  !> Point of a pair on the slave line [length].
  pure function foot_of(work, contact, pair) result(x)
    type(survey_type), intent(in) :: work
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: pair
    real(wp) :: x(directions)

    associate (model => work%model)
      x = model%mesh%x(:, work%line%node(pair))
      if (pair < contact%first_of_master) return
      ! weights of the opposite edge
      associate (first => model%contact%row_start(pair) + 1, last => model%contact%row_start(pair + 1) - 1)
        x = -matmul(model%mesh%x(:, model%contact%row_node(first:last)), model%contact%row_weight(first:last))
      end associate
    end associate
  end function foot_of

  !> The pairs along a slave edge, of slave and master nodes, in their order.
  pure function run_on(work, contact, side, masters) result(run)
    type(survey_type), intent(in) :: work
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: side
    integer, intent(in) :: masters(:)    !! pairs of master nodes on the edge
    integer, allocatable :: pairs(:), run(:)
    real(wp), allocatable :: away(:)     !! from the start
    integer :: i, before

    associate (node => contact%slave%segment(:, side))
      pairs = [(pair_of_side(work, node, node(i)), i=1, 3), masters]
      pairs = pack(pairs, pairs > 0)
      away = [(norm2(foot_of(work, contact, pairs(i)) - work%model%mesh%x(:, node(1))), i=1, size(pairs))]
    end associate
    allocate (run(0))
    do i = 1, size(pairs)
      before = count(away(:i - 1) <= away(i))
      run = [run(:before), pairs(i), run(before + 1:)]
    end do
  end function run_on

  !> Set neighbours and areas of the pairs along an edge: half of each piece between two of them, projected
  !! along their own normals. If a node of the edge has no pair, the pieces at this end belong to no pair.
  subroutine link(work, contact, segment, run)
    type(survey_type), intent(inout) :: work
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: segment   !! the edge
    integer, intent(in) :: run(:)
    real(wp) :: apart, share(3), width(size(run))
    integer :: i, k, pair

    associate (element => contact%slave%element(segment), side => contact%slave%segment(:, segment), &
               chord => contact%slave%chord_length(segment), line => work%line, &
               normal => work%model%contact%normal)
      do i = 1, size(run)
        pair = run(i)
        share = shares_of_nodes(work%model, element, side, normal(:, pair))
        width(i) = sum(share)/chord
        if (pair >= contact%first_of_master) cycle
        if (is_along(work%model, side, normal(:, pair))) &
          line%tributary(pair) = line%tributary(pair) - sum(share, mask=side == line%node(pair))
        do k = 1, 2
          if (.not. (line%middle(pair) .or. any(run == line%neighbour(k, pair)))) cycle
          line%neighbour(k, pair) = 0
          line%part(k, pair) = 0.0_wp
        end do
        line%middle(pair) = .false.   ! it is no longer between two other nodes
      end do
      do i = 1, size(run) - 1
        apart = norm2(foot_of(work, contact, run(i + 1)) - foot_of(work, contact, run(i)))
        if (apart < close*(chord/merge(2, 1, side(3) > 0))) call work%places%join(run(i), run(i + 1))
        call add_piece(line, run(i:i + 1), 0.5_wp*width(i:i + 1)*apart)
      end do
    end associate
  end subroutine link

  !> Two pairs are neighbours, and a piece of the boundary between them belongs to each.
  subroutine add_piece(line, pairs, piece)
    type(contact_line), intent(inout) :: line
    integer, intent(in) :: pairs(2)
    real(wp), intent(in) :: piece(2)   !! of each [length**2]
    integer :: i, k, pair

    do i = 1, 2
      pair = pairs(i)
      k = findloc(line%neighbour(:, pair), pairs(3 - i), dim=1)
      if (k == 0) k = findloc(line%neighbour(:, pair), 0, dim=1)
      if (k == 0) k = 2
      line%neighbour(k, pair) = pairs(3 - i)
      line%part(k, pair) = line%part(k, pair) + piece(i)
      line%tributary(pair) = line%tributary(pair) + piece(i)
    end do
  end subroutine add_piece

  !> Find the edges of the outline at a node: start node, end node, mid-side node (or 0), and element [4,
  !! any].
  pure function outer_sides(model, node) result(sides)
    type(model_type), intent(in) :: model   !! model
    integer, intent(in) :: node             !! any node
    integer, allocatable :: sides(:, :)
    integer :: i, k, side(3)

    allocate (sides(4, 0))
    associate (elements => model%mesh%around%of(node))
      do i = 1, size(elements)
        do k = 1, model%mesh%corners(elements(i))
          side = model%mesh%edge(elements(i), k)
          if (.not. any(side == node)) cycle
          if (is_shared(side, elements(i))) cycle
          sides = reshape([sides, side, elements(i)], [4, size(sides, 2) + 1])
        end do
      end do
    end associate

  contains

    !> Has another element this edge? Few have both of its corners.
    pure logical function is_shared(side, element)
      integer, intent(in) :: side(:), element
      integer :: i

      is_shared = .false.
      do i = model%mesh%around%start(side(1)), model%mesh%around%start(side(1) + 1) - 1
        associate (other => model%mesh%around%group(i))
          if (other == element .or. all(model%mesh%connectivity(:model%mesh%corners(other), &
                                                                other) /= side(2))) cycle
          is_shared = any(model%mesh%edge_between(other, side(1), side(2)) > 0)
        end associate
        if (is_shared) return
      end do
    end function is_shared
  end function outer_sides

  !> Find the area of an edge that belongs to each of its nodes: nodal forces of a unit pressure, along a
  !! normal or in total [length**2].
  pure function shares_of_nodes(model, element, side, normal) result(share)
    type(model_type), intent(in) :: model          !! model
    integer, intent(in) :: element, side(3)        !! of the edge; its nodes
    real(wp), intent(in), optional :: normal(directions)    !! projection
    real(wp) :: share(3)
    type(edge_point) :: point(edge_point_count)
    real(wp) :: seen
    integer :: p

    point = edge_points(model%mesh%edge_coordinates(side))
    share = 0.0_wp
    do p = 1, edge_point_count
      seen = norm2(point(p)%tangent)
      if (present(normal)) seen = abs(cross_product(point(p)%tangent, normal))
      share = share + model%depth(element, point(p)%x(1))*point(p)%values*seen
    end do
    if (side(3) == 0 .or. .not. model%has_rings()) return
    ! On a curved edge, a corner on the axis has a small area, which is no measure of its force.
    associate (on_axis => model%mesh%x(1, side(:2)) == 0.0_wp)
      share(3) = share(3) + sum(share(:2), mask=on_axis)
      where (on_axis) share(:2) = 0.0_wp
    end associate
  end function shares_of_nodes

  !> Distance of two pairs [length].
  pure real(wp) function distance(self, a, b)
    class(contact_line), intent(in) :: self
    integer, intent(in) :: a, b   !! the pairs

    distance = norm2(self%x(:, a) - self%x(:, b))
  end function distance

  !> Which pairs are in contact, or at a corner on the axis between such pairs? Such a corner has no area and
  !! so no force that shows its state. [pairs]
  pure function in_contact(self, touching) result(within)
    class(contact_line), intent(in) :: self
    logical, intent(in) :: touching(:)   !! [pairs]
    logical :: within(size(touching))
    integer :: pair

    within = touching
    do pair = 1, size(touching)
      if (self%tributary(pair) <= 0.0_wp) within(pair) = within(pair) .or. &
        any(touching(pack(self%neighbour(:, pair), self%neighbour(:, pair) > 0)))
    end do
  end function in_contact
end module epcont_result_contact_line
