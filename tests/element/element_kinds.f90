!> Shapes of every element type, patches of them, and properties of an element: strains, stiffness, eigenvalues.
module element_kinds
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: element_kind, most_nodes
  use epcont_element_integration_point, only: evaluate_points, integration_point
  use epcont_element_element_kinds, only: all_kinds => element_kinds
  use epcont_linalg_dense, only: lu_solve
  use epcont_material_elasticity, only: constants => elasticity, isotropic_matrix, new_elasticity
  use epcont_element_kinematics, only: plane_stress
  use lapack_checks, only: dsyev
  implicit none
  private
  public :: sample_shapes, label, sample_place, local_node, kind_with, shape_values, slopes, corners_of, centroid_radius
  public :: points_of, places_of, strains_of, linear_field, elasticity, stiffness, eigenvalues
  public :: patch_of, solved_patch, grid_element, polygon_area

  integer, parameter, public :: node_numbers(4) = [3, 6, 4, 8]
  real(wp), parameter, public :: thickness = 0.7_wp
  real(wp), parameter, public :: rounding = 1.0e-13_wp
  !> A general displacement gradient and translation, and a rotation.
  real(wp), parameter, public :: gradient(2, 2) = reshape([0.6_wp, -0.3_wp, 0.8_wp, -0.5_wp], [2, 2])
  real(wp), parameter, public :: shift(2) = [0.4_wp, -0.7_wp]
  real(wp), parameter, public :: turn(2, 2) = reshape([real(wp) :: 0, 1, -1, 0], [2, 2])
  character(len=*), parameter, public :: kinematics_name(3) = [', plane strain', ', plane stress', ', ring        ']

  !> One element; all are to the right of the axis of axisymmetric bodies.
  type, public :: element_shape
    character(len=30) :: name
    real(wp), allocatable :: x(:, :)   !! [2, nodes]
    logical :: straight                !! edges, with their nodes in their middles
  end type element_shape

  !> Elements that share nodes.
  type, public :: patch
    real(wp), allocatable :: x(:, :)              !! [2, nodes]
    integer, allocatable :: connectivity(:, :)    !! [nodes of an element, elements]
    logical, allocatable :: inner(:)              !! is not on the boundary [nodes]
  end type patch

contains

  !> Elements of all numbers of nodes.
  function sample_shapes() result(shape)
    type(element_shape), allocatable :: shape(:)
    real(wp), parameter :: right(2, 3) = reshape([real(wp) :: 1, 0, 2, 0, 1, 1], [2, 3])
    real(wp), parameter :: scalene(2, 3) = reshape([0.3_wp, -0.2_wp, 2.1_wp, 0.4_wp, 0.9_wp, 1.7_wp], [2, 3])
    real(wp), parameter :: flat(2, 3) = reshape([4.0_wp, 0.3_wp, 2.6_wp, 0.5_wp, 1.0_wp, 0.0_wp], [2, 3])
    real(wp), parameter :: axis(2, 3) = reshape([0.0_wp, 1.5_wp, 0.0_wp, 0.1_wp, 1.2_wp, 0.4_wp], [2, 3])
    real(wp), parameter :: one_arc(2, 3) = reshape([real(wp) :: 0.05_wp, -0.15_wp, 0, 0, 0, 0], [2, 3])
    real(wp), parameter :: arcs(2, 3) = reshape([0.0_wp, -0.1_wp, -0.08_wp, -0.06_wp, 0.1_wp, 0.02_wp], [2, 3])
    real(wp), parameter :: four_arcs(2, 4) = reshape([0.0_wp, -0.1_wp, 0.08_wp, 0.05_wp, 0.1_wp, 0.06_wp, 0.0_wp, 0.0_wp], [2, 4])
    real(wp), parameter :: square(2, 4) = reshape([real(wp) :: 1, 0, 2, 0, 2, 1, 1, 1], [2, 4])
    real(wp), parameter :: skew(2, 4) = reshape([1.0_wp, 0.0_wp, 2.5_wp, 0.3_wp, 3.3_wp, 1.4_wp, 1.8_wp, 1.1_wp], [2, 4])
    real(wp), parameter :: trapezoid(2, 4) = reshape([real(wp) :: 1, 0, 3, 0, 2.2_wp, 1, 1.5_wp, 1], [2, 4])
    real(wp), parameter :: irregular(2, 4) = reshape([2.1_wp, 1.3_wp, 0.8_wp, 1.5_wp, 0.4_wp, -0.1_wp, 1.6_wp, -0.6_wp], [2, 4])
    real(wp), parameter :: at_axis(2, 4) = reshape([0.0_wp, 0.0_wp, 0.9_wp, 0.2_wp, 1.1_wp, 0.8_wp, 0.0_wp, 1.2_wp], [2, 4])
    integer :: k

    allocate (shape(20))
    k = 0
    call add('right tria3', right)
    call add('scalene tria3', scalene)
    call add('flat tria3', flat)
    call add('tria3 at the axis', axis)
    call add('right tria6', with_middles(right))
    call add('scalene tria6', with_middles(scalene))
    call add('flat tria6', with_middles(flat))
    call add('tria6 at the axis', with_middles(axis))
    call add('tria6 with one arc', with_middles(right, one_arc))
    call add('tria6 with three arcs', with_middles(scalene, arcs))
    call add('square quad4', square)
    call add('skew quad4', skew)
    call add('trapezoid quad4', trapezoid)
    call add('irregular quad4', irregular)
    call add('quad4 at the axis', at_axis)
    call add('square quad8', with_middles(square))
    call add('skew quad8', with_middles(skew))
    call add('irregular quad8', with_middles(irregular))
    call add('quad8 at the axis', with_middles(at_axis))
    call add('quad8 with arcs', with_middles(trapezoid, four_arcs))
  contains
    ! An array constructor of shapes leaks with gfortran 12.
    subroutine add(name, x)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: x(:, :)

      k = k + 1
      shape(k)%name = name
      shape(k)%x = x
      shape(k)%straight = index(name, ' arc') == 0
    end subroutine add
  end function sample_shapes

  function label(shape, kinematics) result(text)
    type(element_shape), intent(in) :: shape
    integer, intent(in) :: kinematics
    character(len=:), allocatable :: text

    text = trim(shape%name)//trim(kinematics_name(kinematics))
  end function label

  !> Six or eight nodes from three or four corners, the mid-side ones moved by `bend`.
  pure function with_middles(corner, bend) result(x)
    real(wp), intent(in) :: corner(:, :)
    real(wp), intent(in), optional :: bend(:, :)
    real(wp) :: x(2, 2*size(corner, 2))

    associate (n => size(corner, 2))
      x(:, :n) = corner
      x(:, n + 1:) = 0.5_wp*(corner + cshift(corner, 1, dim=2))
      if (present(bend)) x(:, n + 1:) = x(:, n + 1:) + bend
    end associate
  end function with_middles

  !> The corners, or these with the mid-side nodes between them.
  pure function with_nodes(nodes, corner) result(x)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: corner(:, :)
    real(wp) :: x(2, nodes)

    if (nodes == size(corner, 2)) then
      x = corner
    else
      x = with_middles(corner)
    end if
  end function with_nodes

  !> Points all over the square from -1 to 1, without pattern.
  pure function sample_place(i) result(place)
    integer, intent(in) :: i
    real(wp) :: place(2)

    place = 2.0_wp*modulo(i*[0.754877666246693_wp, 0.569840290998053_wp], 1.0_wp) - 1.0_wp
  end function sample_place

  !> Local coordinates of the nodes.
  pure function local_node(nodes) result(place)
    integer, intent(in) :: nodes
    real(wp) :: place(2, nodes)

    if (modulo(nodes, 4) == 0) then
      place = with_nodes(nodes, reshape([real(wp) :: -1, -1, 1, -1, 1, 1, -1, 1], [2, 4]))
    else
      place = with_nodes(nodes, reshape([real(wp) :: 0, 0, 1, 0, 0, 1], [2, 3]))
    end if
  end function local_node

  !> The row of the table with this number of nodes.
  function kind_with(nodes) result(kind)
    integer, intent(in) :: nodes
    type(element_kind) :: kind
    type(element_kind), allocatable :: kinds(:)

    kinds = all_kinds()
    kind = kinds(findloc(kinds%nodes, nodes, dim=1))
  end function kind_with

  function shape_values(nodes, place) result(n)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: place(2)
    real(wp) :: n(nodes), slope(2, nodes)

    call find_shape(nodes, place, n, slope)
  end function shape_values

  function slopes(nodes, place) result(slope)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: place(2)
    real(wp) :: n(nodes), slope(2, nodes)

    call find_shape(nodes, place, n, slope)
  end function slopes

  subroutine find_shape(nodes, place, n, slope)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: place(2)
    real(wp), intent(out) :: n(nodes), slope(2, nodes)
    type(element_kind) :: kind
    real(wp) :: all_values(most_nodes), all_slopes(2, most_nodes)

    kind = kind_with(nodes)
    call kind%shape(place, all_values, all_slopes)
    n = all_values(:nodes)
    slope = all_slopes(:, :nodes)
  end subroutine find_shape

  !> The nodes at corners.
  pure function corners_of(x) result(corner)
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: corner(:, :)

    corner = x(:, :merge(4, 3, modulo(size(x, 2), 4) == 0))
  end function corners_of

  !> Signed area of a polygon: positive if its corners are counter-clockwise.
  pure real(wp) function polygon_area(x) result(area)
    real(wp), intent(in) :: x(:, :)

    area = 0.5_wp*sum(x(1, :)*cshift(x(2, :), 1) - x(2, :)*cshift(x(1, :), 1))
  end function polygon_area

  !> Distance of a polygon's centroid from the axis.
  pure real(wp) function centroid_radius(corner) result(radius)
    real(wp), intent(in) :: corner(:, :)
    integer :: k

    radius = 0.0_wp
    do k = 2, size(corner, 2) - 1
      radius = radius + polygon_area(corner(:, [1, k, k + 1]))*sum(corner(1, [1, k, k + 1]))/3.0_wp
    end do
    radius = radius/polygon_area(corner)
  end function centroid_radius

  !> Result of `evaluate_points`.
  function points_of(x, kinematics) result(point)
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kinematics
    type(integration_point), allocatable :: point(:)

    associate (kind => kind_with(size(x, 2)))
      allocate (point(kind%points))
      call evaluate_points(kind, x, kinematics, thickness, point)
    end associate
  end function points_of

  !> Coordinates of the integration points.
  function places_of(x) result(place)
    real(wp), intent(in) :: x(:, :)
    real(wp), allocatable :: place(:, :)

    associate (kind => kind_with(size(x, 2)))
      place = matmul(x, kind%values(:kind%nodes, :kind%points))
    end associate
  end function places_of

  !> Strains at the integration points.
  function strains_of(x, kinematics, u) result(strain)
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kinematics
    real(wp), intent(in) :: u(:, :)   !! displacements of the nodes [2, nodes]
    real(wp), allocatable :: strain(:, :)
    type(integration_point), allocatable :: point(:)
    integer :: p

    point = points_of(x, kinematics)
    allocate (strain(4, size(point)))
    do p = 1, size(point)
      strain(:, p) = matmul(point(p)%b(:, :size(u)), reshape(u, [size(u)]))
    end do
  end function strains_of

  !> Displacements u = gradient x + translation.
  pure function linear_field(x, gradient, shift) result(u)
    real(wp), intent(in) :: x(:, :), gradient(2, 2), shift(2)
    real(wp) :: u(2, size(x, 2))

    u = matmul(gradient, x) + spread(shift, 2, size(x, 2))
  end function linear_field

  !> D for a Young's modulus of 1.
  pure function elasticity(kinematics, poisson) result(d)
    integer, intent(in) :: kinematics
    real(wp), intent(in) :: poisson
    real(wp) :: d(4, 4)
    type(constants) :: elastic

    elastic = new_elasticity(1.0_wp, poisson)
    d = isotropic_matrix(elastic%bulk, elastic%shear, kinematics == plane_stress)
  end function elasticity

  function stiffness(x, kinematics, poisson) result(k)
    real(wp), intent(in) :: x(:, :)
    integer, intent(in) :: kinematics
    real(wp), intent(in) :: poisson
    real(wp) :: k(2*size(x, 2), 2*size(x, 2))
    type(integration_point), allocatable :: point(:)
    integer :: p

    point = points_of(x, kinematics)
    k = 0.0_wp
    do p = 1, size(point)
      associate (b => point(p)%b(:, :size(k, 1)))
        k = k + point(p)%volume*matmul(transpose(b), matmul(elasticity(kinematics, poisson), b))
      end associate
    end do
  end function stiffness

  !> Eigenvalues of a symmetric matrix, ascending.
  pure function eigenvalues(a) result(value)
    real(wp), intent(in) :: a(:, :)
    real(wp) :: value(size(a, 1))
    real(wp) :: copy(size(a, 1), size(a, 1)), work(8*size(a, 1))
    integer :: info

    copy = a
    call dsyev('N', 'U', size(a, 1), copy, size(a, 1), value, work, size(work), info)
    if (info /= 0) value = -huge(1.0_wp)
  end function eigenvalues

  !> An irregular patch: 4 triangles about a node, or 5 quadrilaterals, one of them inside the others.
  function patch_of(nodes, bend) result(made)
    integer, intent(in) :: nodes
    real(wp), intent(in) :: bend       !! displacement of mid-side nodes from the middles of their edges
    type(patch) :: made
    real(wp), parameter :: outer(8) = [1.0_wp, 0.0_wp, 3.0_wp, 0.2_wp, 3.3_wp, 2.1_wp, 0.8_wp, 1.7_wp]
    real(wp), parameter :: within(8) = [1.6_wp, 0.5_wp, 2.3_wp, 0.7_wp, 2.6_wp, 1.6_wp, 1.2_wp, 1.1_wp]
    integer, parameter :: next(4) = [2, 3, 4, 1]
    integer :: k

    if (modulo(nodes, 4) == 0) then
      made%x = reshape([outer, within], [2, 8])
      made%connectivity = reshape([([k, next(k), 4 + next(k), 4 + k], k=1, 4), [5, 6, 7, 8]], [4, 5])
    else
      made%x = reshape([outer, [1.9_wp, 0.7_wp]], [2, 5])
      made%connectivity = reshape([([k, next(k), 5], k=1, 4)], [3, 4])
    end if
    made%inner = [(k > 4, k=1, size(made%x, 2))]
    if (nodes > 4) call add_middles(made, bend)
  end function patch_of

  !> Nodes in the middles of all edges; those of the outer edges, which only one element has, are on the boundary.
  subroutine add_middles(made, bend)
    type(patch), intent(inout) :: made
    real(wp), intent(in) :: bend
    integer, allocatable :: ends(:, :), node(:, :)
    integer :: corners, e, k, middle, side(2)

    corners = size(made%connectivity, 1)
    allocate (node(2*corners, size(made%connectivity, 2)), ends(2, 0))
    node(:corners, :) = made%connectivity
    do e = 1, size(node, 2)
      do k = 1, corners
        side = [minval(node([k, modulo(k, corners) + 1], e)), maxval(node([k, modulo(k, corners) + 1], e))]
        middle = findloc(ends(1, :) == side(1) .and. ends(2, :) == side(2), .true., dim=1)
        if (middle == 0) then
          ends = reshape([ends, side], [2, size(ends, 2) + 1])
          middle = size(ends, 2)
          made%x = reshape([made%x, 0.5_wp*(made%x(:, side(1)) + made%x(:, side(2))) &
                            + bend*[sin(2.0_wp*middle), cos(3.0_wp*middle)]], [2, size(made%x, 2) + 1])
          made%inner = [made%inner, .false.]
        else
          made%inner(size(made%inner) - size(ends, 2) + middle) = .true.
        end if
        node(corners + k, e) = size(made%inner) - size(ends, 2) + middle
      end do
    end do
    made%connectivity = node
  end subroutine add_middles

  !> Displacements of a patch whose inner nodes are free of forces; those of the others are given.
  function solved_patch(given, kinematics, poisson, u) result(solved)
    type(patch), intent(in) :: given
    integer, intent(in) :: kinematics
    real(wp), intent(in) :: poisson
    real(wp), intent(in) :: u(:, :)   !! of all nodes; those of inner ones are ignored [2, nodes]
    real(wp) :: solved(2, size(u, 2))
    real(wp) :: k(size(u), size(u)), flat(size(u))
    real(wp), allocatable :: a(:, :), b(:, :)
    integer, allocatable :: free(:), held(:), row(:)
    integer :: e, i, info

    k = 0.0_wp
    do e = 1, size(given%connectivity, 2)
      associate (node => given%connectivity(:, e))
        row = [([2*node(i) - 1, 2*node(i)], i=1, size(node))]
        k(row, row) = k(row, row) + stiffness(given%x(:, node), kinematics, poisson)
      end associate
    end do
    free = pack([(i, i=1, size(u))], [(given%inner((i + 1)/2), i=1, size(u))])
    held = pack([(i, i=1, size(u))], [(.not. given%inner((i + 1)/2), i=1, size(u))])
    flat = reshape(u, [size(u)])
    a = k(free, free)
    b = reshape(-matmul(k(free, held), flat(held)), [size(free), 1])
    call lu_solve(a, b, info)
    if (info /= 0) b = huge(1.0_wp)
    flat(free) = b(:, 1)
    solved = reshape(flat, shape(solved))
  end function solved_patch

  !> Nodes of one element of a distorted grid: cell (i, j) of n by n, or one half of it for a triangle.
  pure function grid_element(nodes, n, i, j, half) result(x)
    integer, intent(in) :: nodes, n, i, j, half
    real(wp) :: x(2, nodes)
    real(wp) :: corner(2, 4), local(2, nodes)
    integer :: k

    corner(1, :) = (i - 1 + [real(wp) :: 0, 1, 1, 0])/n
    corner(2, :) = (j - 1 + [real(wp) :: 0, 0, 1, 1])/n
    if (modulo(nodes, 4) == 0) then
      local = with_nodes(nodes, corner)
    else
      local = with_nodes(nodes, corner(:, merge([1, 2, 3], [1, 3, 4], half == 1)))
    end if
    do k = 1, nodes
      associate (s => local(1, k), t => local(2, k))
        x(:, k) = [1.0_wp + s + 0.1_wp*sin(3.0_wp*t), t + 0.2_wp*s*s + 0.1_wp*sin(4.0_wp*s*t)]
      end associate
    end do
  end function grid_element
end module element_kinds
