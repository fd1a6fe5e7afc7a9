!> The pairs as a line along the boundary: their areas and neighbours.
module epcont_result_contact_line
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_sorting, only: sorted_order
  use epcont_base_tolerances, only: no_area
  use epcont_geometry_edge, only: edge_point, edge_point_count, edge_points
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: line_contact, model_type
  use epcont_result_symmetry, only: is_on_symmetry
  implicit none
  private
  public :: contact_line, find_contact_line, distance, shared, in_contact

  !> An edge belongs to the contact line where it lies within 45 degrees of the tangent, both of a square's
  !! corner's too.
  real(wp), parameter :: along_tangent = sqrt(0.5_wp)*(1.0_wp + 1.0e-6_wp)

  !> A pair of the master stands at the place of one that is nearer than this part of the way from node to
  !! node.
  real(wp), parameter :: close = 0.22_wp

  !> The pairs as a line along the boundary.
  type :: contact_line
    !> Area of each pair: half of its edges, as seen along the normal, times thickness; 0: no edges. A
    !! pressure on the edges exerts along the normal what it would on that area. [pairs]
    real(wp), allocatable :: tributary(:)
    integer, allocatable :: neighbour(:, :) !! pairs at the other ends of its edges, 0: none [2, pairs]
    real(wp), allocatable :: part(:, :)     !! of the area, towards each neighbour; of a middle node not set [2, pairs]
    logical, allocatable :: middle(:)       !! the middle node of an edge [pairs]
    integer, allocatable :: node(:)         !! of the boundary at each pair: B, or A where B has no elements [pairs]
    logical, allocatable :: mirrored(:)     !! the line ends at the pair, on a line of symmetry [pairs]
    !> The place that a pair stands at: one for those so near to each other that the force is divided between
    !! them by chance. Not allocated where none are. [pairs]
    integer, allocatable :: place(:)
  end type contact_line

contains

  !> Edges of the boundary at the pairs.
  pure function find_contact_line(model) result(line)
    type(model_type), intent(in) :: model
    type(contact_line) :: line
    type(partition) :: places
    integer :: c, last, pair

    allocate (line%tributary(model%pairs), source=0.0_wp)
    allocate (line%neighbour(2, model%pairs), source=0)
    allocate (line%part(2, model%pairs), source=0.0_wp)
    allocate (line%middle(model%pairs), source=.false.)
    allocate (line%node(model%pairs))
    allocate (line%mirrored(model%pairs), source=.false.)
    do pair = 1, model%pairs
      associate (a => model%pair_node(1, pair), b => model%pair_node(2, pair))
        line%node(pair) = merge(b, a, model%around%start(b + 1) > model%around%start(b))
      end associate
    end do
    ! A node may have a pair in each of several contacts: neighbours are of one.
    last = model%pairs
    if (size(model%line_contact) > 0) last = model%line_contact(1)%first - 1
    call find_edges(model, 1, last, line)
    places = new_partition(model%pairs)
    do c = 1, size(model%line_contact)
      call find_edges(model, model%line_contact(c)%first, model%line_contact(c)%first_of_master - 1, line)
      call insert_masters(model, model%line_contact(c), line, places)
    end do
    call places%numbers(line%place, last)
    if (last == model%pairs) deallocate (line%place)
  end function find_contact_line

  !> Pairs of the master's nodes stand between those of the slave's on their side, and share its area with
  !! them.
  pure subroutine insert_masters(model, contact, line, places)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(contact_line), intent(inout) :: line
    type(partition), intent(inout) :: places
    type(incidence) :: at
    integer, allocatable :: order(:)
    integer :: first, last

    if (contact%last < contact%first_of_master) return
    at = pairs_at_nodes(model, contact%first, contact%first_of_master - 1, line)
    order = sorted_order(contact%stands_on)
    last = 0
    do while (last < size(order))
      first = last + 1
      associate (side => contact%stands_on(order(first)))
        do last = first, size(order) - 1
          if (contact%stands_on(order(last + 1)) /= side) exit
        end do
        call link(model, contact, side, run_on(model, contact, side, at, order(first:last), line), line, places)
      end associate
    end do
  end subroutine insert_masters

  !> Of a range of pairs those at each node, counted from the first of the range.
  pure function pairs_at_nodes(model, first, last, line) result(at)
    type(model_type), intent(in) :: model
    integer, intent(in) :: first, last
    type(contact_line), intent(in) :: line
    type(incidence) :: at

    at = new_incidence(reshape(line%node(first:last), [1, last - first + 1]), model%nodes)
  end function pairs_at_nodes

  !> The pair that a side has at one of its nodes: of several there the one that presses on it the most
  !! squarely; 0: none.
  pure integer function pair_of_side(model, at, first, side, node) result(pair)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: at
    integer, intent(in) :: first           !! of the range of pairs
    integer, intent(in) :: side(3), node   !! 0: none

    pair = 0
    if (node == 0) return
    associate (there => first - 1 + at%group(at%start(node):at%start(node + 1) - 1))
      if (size(there) == 0) return
      pair = there(minloc(abs(matmul(model%x(:, side(2)) - model%x(:, side(1)), model%normal(:, there))), dim=1))
    end associate
  end function pair_of_side

  !> Between the places of two pairs [length].
  pure real(wp) function distance(model, line, a, b)
    type(model_type), intent(in) :: model
    type(contact_line), intent(in) :: line
    integer, intent(in) :: a, b

    distance = norm2(model%x(:, line%node(a)) - model%x(:, line%node(b)))
  end function distance

  !> Where a pair stands on the slave [length].
  pure function foot_of(model, contact, line, pair) result(x)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(contact_line), intent(in) :: line
    integer, intent(in) :: pair
    real(wp) :: x(2)

    x = model%x(:, line%node(pair))
    if (pair < contact%first_of_master) return
    associate (first => model%row_start(pair) + 1, last => model%row_start(pair + 1) - 1)   ! behind the node itself
      x = -matmul(model%x(:, model%row_node(first:last)), model%row_weight(first:last))
    end associate
  end function foot_of

  !> The pairs along a side of the slave, of its nodes and of the master's, from its start on.
  pure function run_on(model, contact, side, at, masters, line) result(run)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: side
    type(incidence), intent(in) :: at    !! the slave's pairs
    integer, intent(in) :: masters(:)    !! which of the master's pairs stand on the side
    type(contact_line), intent(in) :: line
    integer, allocatable :: pairs(:), run(:)
    integer :: i, j

    associate (node => contact%slave%segment(:, side))
      pairs = [(pair_of_side(model, at, contact%first, node, node(i)), i=1, 3), contact%first_of_master - 1 + masters]
    end associate
    pairs = pack(pairs, pairs > 0)
    allocate (run(0))
    do i = 1, size(pairs)
      do j = 1, size(run)
        if (away(run(j)) > away(pairs(i))) exit
      end do
      run = [run(:j - 1), pairs(i), run(j:)]
    end do

  contains

    !> From the start of the side.
    pure real(wp) function away(pair)
      integer, intent(in) :: pair

      away = norm2(foot_of(model, contact, line, pair) - model%x(:, contact%slave%segment(1, side)))
    end function away
  end function run_on

  !> Neighbours and areas of the pairs along a side: half of each piece between two of them. Where a node of
  !! the side has no pair, the pieces at its end belong to none.
  pure subroutine link(model, contact, segment, run, line, places)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: segment   !! the side
    integer, intent(in) :: run(:)
    type(contact_line), intent(inout) :: line
    type(partition), intent(inout) :: places
    real(wp) :: half, spacing, width
    integer :: element, i, k, side(3)

    element = contact%slave%element(segment)
    side = contact%slave%segment(:, segment)
    i = findloc(run >= contact%first_of_master, .true., dim=1)   ! whose normal is the side's
    width = area(model, element, side, model%normal(:, run(i)))/norm2(model%x(:, side(2)) - model%x(:, side(1)))
    do i = 1, size(run)
      associate (pair => run(i))
        if (pair >= contact%first_of_master) cycle
        if (is_along(model, side, model%normal(:, pair))) &
          line%tributary(pair) = line%tributary(pair) - share(model, element, side, line%node(pair), model%normal(:, pair))
        if (line%middle(pair)) then
          line%neighbour(:, pair) = 0
          line%part(:, pair) = 0.0_wp
          line%middle(pair) = .false.   ! no node between two others any more
        else
          do k = 1, 2
            if (.not. any(run == line%neighbour(k, pair)) .or. line%neighbour(k, pair) == 0) cycle
            line%neighbour(k, pair) = 0
            line%part(k, pair) = 0.0_wp
          end do
        end if
      end associate
    end do
    spacing = contact%slave%chord_length(segment)/merge(2, 1, side(3) > 0)
    do i = 1, size(run) - 1
      half = norm2(foot_of(model, contact, line, run(i + 1)) - foot_of(model, contact, line, run(i)))
      if (half < close*spacing) call places%join(run(i), run(i + 1))
      half = 0.5_wp*width*half
      call add_piece(run(i), run(i + 1), half, line)
      call add_piece(run(i + 1), run(i), half, line)
    end do
  end subroutine link

  !> Where a pair stands among another's neighbours, or an empty place.
  pure integer function slot_of(neighbour, pair) result(slot)
    integer, intent(in) :: neighbour(2), pair

    slot = findloc(neighbour, pair, dim=1)
    if (slot == 0) slot = findloc(neighbour, 0, dim=1)
    if (slot == 0) slot = 2
  end function slot_of

  !> A piece of the boundary between two pairs belongs to one of them.
  pure subroutine add_piece(pair, towards, piece, line)
    integer, intent(in) :: pair, towards
    real(wp), intent(in) :: piece
    type(contact_line), intent(inout) :: line
    integer :: k

    k = slot_of(line%neighbour(:, pair), towards)
    line%neighbour(k, pair) = towards
    line%part(k, pair) = line%part(k, pair) + piece
    line%tributary(pair) = line%tributary(pair) + piece
  end subroutine add_piece

  !> Edges at a range of pairs, and the neighbours among them.
  pure subroutine find_edges(model, first, last, line)
    type(model_type), intent(in) :: model
    integer, intent(in) :: first, last
    type(contact_line), intent(inout) :: line
    type(incidence) :: at
    real(wp) :: longest, own
    integer :: beside, e, end, i, k, pair, side(3)

    at = pairs_at_nodes(model, first, last, line)
    do pair = first, last
      associate (node => line%node(pair), n => model%normal(:, pair))
        longest = 0.0_wp
        do i = model%around%start(node), model%around%start(node + 1) - 1
          e = model%around%group(i)
          do k = 1, model%corners(e)
            side = model%edge(e, k)
            if (.not. any(side == node) .or. shared(model, side(1), side(2))) cycle
            longest = max(longest, norm2(model%x(:, side(2)) - model%x(:, side(1))))
            if (.not. is_along(model, side, n)) cycle
            own = share(model, e, side, node, n)
            if (abs(own) <= no_area*area(model, e, side, n)) own = 0.0_wp
            line%tributary(pair) = line%tributary(pair) + own
            line%middle(pair) = side(3) == node
            if (line%middle(pair)) then
              line%neighbour(:, pair) = [(pair_of_side(model, at, first, side, side(end)), end=1, 2)]
            else
              beside = merge(side(3), sum(side(:2)) - node, side(3) > 0)
              call add_neighbour(pair_of_side(model, at, first, side, beside), own, line%neighbour(:, pair), line%part(:, pair))
            end if
          end do
        end do
        if (any(line%neighbour(:, pair) == 0)) line%mirrored(pair) = is_on_symmetry(model, pair, node, longest)
      end associate
    end do
  end subroutine find_edges

  !> Does a side lie along the tangent?
  pure logical function is_along(model, side, n)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side(3)
    real(wp), intent(in) :: n(2)   !! normal of the contact

    associate (edge => model%x(:, side(2)) - model%x(:, side(1)))
      is_along = abs(dot_product(edge, n)) <= along_tangent*norm2(edge)
    end associate
  end function is_along

  !> What a uniform pressure on a side gives to one of its nodes along the normal, over that pressure
  !! [length**2].
  pure real(wp) function share(model, element, side, node, n)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element, side(3), node
    real(wp), intent(in) :: n(2)
    type(edge_point) :: point(edge_point_count)
    real(wp) :: depth
    integer :: p

    point = edge_points(model%edge_coordinates(side))
    share = 0.0_wp
    do p = 1, edge_point_count
      depth = model%depth(element, point(p)%x(1))
      share = share + depth*point(p)%values(findloc(side, node, dim=1))*abs(cross_product(point(p)%tangent, n))
    end do
  end function share

  !> Area of a side, as seen along the normal [length**2].
  pure real(wp) function area(model, element, side, n)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element, side(3)
    real(wp), intent(in) :: n(2)
    integer :: k

    area = 0.0_wp
    do k = 1, merge(3, 2, side(3) > 0)
      area = area + share(model, element, side, side(k), n)
    end do
  end function area

  !> The pair beside a node on one of its sides, with its share of the side's area.
  pure subroutine add_neighbour(beside, share, neighbour, part)
    integer, intent(in) :: beside
    real(wp), intent(in) :: share
    integer, intent(inout) :: neighbour(2)
    real(wp), intent(inout) :: part(2)
    integer :: k

    k = findloc(neighbour, 0, dim=1)
    if (k == 0) return
    neighbour(k) = beside
    part(k) = share
  end subroutine add_neighbour

  !> Whether two elements share the edge between two nodes.
  pure logical function shared(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b
    integer :: i, found

    found = 0
    do i = model%around%start(a), model%around%start(a + 1) - 1
      if (any(model%connectivity(:, model%around%group(i)) == b)) found = found + 1
    end do
    shared = found > 1
  end function shared

  !> Pairs that touch, and those without an area beside them: a corner on the axis of rings, which bears
  !! nothing that would tell whether it touches. [pairs]
  pure function in_contact(line, touching) result(within)
    type(contact_line), intent(in) :: line
    logical, intent(in) :: touching(:)
    logical, allocatable :: within(:)
    integer :: k, pair

    within = touching
    do pair = 1, size(touching)
      if (line%tributary(pair) > 0.0_wp) cycle
      do k = 1, 2
        if (line%neighbour(k, pair) > 0) within(pair) = within(pair) .or. touching(line%neighbour(k, pair))
      end do
    end do
  end function in_contact
end module epcont_result_contact_line
