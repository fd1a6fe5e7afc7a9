!> How the nodes of a master line share in the gaps of the slave nodes: a dual mortar.
!>
!> The pressure of slave node i is spread by the dual function psi_i of its shape functions N, which gives
!> nothing to the other slave nodes: integral of psi_i N_j = d_ij integral of N_i. Its gap is then that of the
!> node, less the master line's displacement averaged with psi_i: weights (integral of psi_i
!> N_master)/(integral of N_i). A uniform pressure passes exactly between lines that do not match, and where
!> they do match each node is against its twin alone. (Wohlmuth, A mortar finite element method using dual
!> spaces for the Lagrange multiplier, SIAM J. Numer. Anal. 38, 2000.) A side whose slave nodes do not all
!> face the other line, or not all along, counts at its nodes' own places.
module epcont_contact_geometry_mortar
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_base_tolerances, only: no_area, rounded_off
  use epcont_contact_geometry_faces, only: faces_type
  use epcont_geometry_boundary_line, only: beyond, boundary_line, facing_place
  use epcont_geometry_facing, only: facing_type, find_facing, looking_point, rise_of
  use epcont_model_model, only: line_contact
  implicit none
  private
  public :: find_mortar_rows, mortar_rows

  !> Nodes and weights of rows: row k has the entries start(k) to start(k + 1) - 1. The weights of a row sum
  !! to 1.
  type :: mortar_rows
    integer, allocatable :: start(:)      !! [rows + 1]
    integer, allocatable :: node(:)       !! [entries]
    real(wp), allocatable :: weight(:)    !! [entries]
  contains
    procedure :: append
  end type mortar_rows

  !> Gauss points of each piece of a side: exact for the product of two quadratics on a straight one.
  integer, parameter :: gauss_points = 3
  real(wp), parameter :: gauss_place(3) = 0.5_wp + 0.5_wp*[-sqrt(0.6_wp), 0.0_wp, sqrt(0.6_wp)]
  real(wp), parameter :: gauss_weight(3) = [5.0_wp, 8.0_wp, 5.0_wp]/18.0_wp
  !> Normals that differ by less (cosine) along a side may be those of one curve: 35 degrees.
  real(wp), parameter :: one_curve = 0.816_wp

  !> Where gaps jump by more than this part of a side there is a step in the other line.
  real(wp), parameter :: step = 0.01_wp
  !> Only sides that are nearly parallel, by this cosine, can touch all along: 20 degrees.
  real(wp), parameter :: parallel = 0.94_wp
  !> Normals whose cosine is less, on either side of a node, meet at a corner there: more than 9 degrees.
  real(wp), parameter :: smooth = 0.988_wp

  !> A part of the weight of a node in a row.
  type :: weight_part
    integer :: row = 0, node = 0
    real(wp) :: weight = 0.0_wp
  end type weight_part

  !> Parts of weights, gathered in any order.
  type :: weight_list
    integer :: count = 0
    type(weight_part), allocatable :: part(:)   !! [count or more]
    real(wp), allocatable :: area(:)            !! integral of N_i so far [rows]
  contains
    procedure :: add
    procedure :: add_own_place
  end type weight_list

  !> The integration points of one side.
  type :: side_points
    integer :: count = 0
    logical :: covered = .true.               !! all of them face the other line, nearly parallel
    real(wp), allocatable :: along(:)         !! place on the side, from 0 to 1 [points]
    real(wp), allocatable :: share(:, :)      !! shape functions of the side's nodes [3, points]
    real(wp), allocatable :: weight(:)        !! length, in rings times radius
    type(facing_type), allocatable :: facing(:)
  end type side_points

contains

  !> Add a row behind the others.
  pure subroutine append(self, node, weight)
    class(mortar_rows), intent(inout) :: self
    integer, intent(in) :: node(:)          !! its nodes
    real(wp), intent(in) :: weight(:)       !! and their weights

    self%node = [self%node, node]
    self%weight = [self%weight, weight]
    self%start = [self%start, size(self%node) + 1]
  end subroutine append

  !> Rows of master nodes and weights, one for each slave node that has a pair. Rows of no side count at their
  !! own places.
  pure subroutine find_mortar_rows(contact, obstacles, faces, ring, rows, covered)
    type(line_contact), intent(in) :: contact   !! the contact of lines
    type(boundary_line), intent(in) :: obstacles      !! the outlines of all bodies
    type(faces_type), intent(in) :: faces          !! what the slave's nodes face
    logical, intent(in) :: ring                    !! x is a radius
    type(mortar_rows), intent(out) :: rows   !! one for each of these nodes
    logical, intent(out) :: covered(:)             !! sides that face the master all along [sides]
    type(weight_list) :: list
    type(side_points) :: points
    integer :: k, row, s

    allocate (list%part(64))
    allocate (list%area(faces%slave%count), source=0.0_wp)
    associate (slave => contact%slave, master => contact%master, facing => faces%slave%facing)
      do s = 1, size(slave%element)
        associate (row_of => faces%row_of(:, s))
          call cut_side(contact, obstacles, s, reach_of(contact, s, row_of, facing), ring, points)
          covered(s) = is_covered(points, facing, row_of, slave%segment(:, s), slave%chord_length(s))
          if (covered(s)) then
            call add_dual(master, points, row_of, list)
            cycle
          end if
          do k = 1, 3
            if (row_of(k) > 0) call list%add_own_place(row_of(k), master, facing(row_of(k)), &
                                     sum(points%weight(:points%count)*points%share(k, :points%count)))
          end do
        end associate
      end do
      do row = 1, faces%slave%count
        if (.not. list%area(row) > 0.0_wp) call list%add_own_place(row, master, facing(row), 1.0_wp)
      end do
    end associate
    call collect(list, rows)
  end subroutine find_mortar_rows

  !> Do all nodes and integration points of a side face the other line, and one face of it, without a step or
  !! a corner?
  pure logical function is_covered(points, facing, row, segment, length)
    type(side_points), intent(in) :: points
    type(facing_type), intent(in) :: facing(:)
    integer, intent(in) :: row(3), segment(3)
    real(wp), intent(in) :: length             !! of the side
    real(wp) :: before, behind, cut, normal(2, points%count)
    integer :: k, p

    is_covered = points%covered .and. all(row > 0 .or. segment == 0)
    if (.not. is_covered) return
    normal = reshape([(points%facing(p)%normal, p=1, points%count)], [2, points%count])
    do k = 1, 3
      if (row(k) > 0) is_covered = is_covered .and. &
                                   all(matmul(facing(row(k))%normal, normal) > one_curve)
    end do
    do p = gauss_points, points%count - 1, gauss_points
      is_covered = is_covered .and. dot_product(normal(:, p), normal(:, p + 1)) > smooth
    end do
    if (.not. is_covered) return
    before = facing(row(1))%gap
    do p = gauss_points, points%count, gauss_points   ! piece by piece
      associate (gap => points%facing(p - gauss_points + 1:p)%gap, &
                 s => points%along(p - gauss_points + 1:p))
        cut = s(1) - (s(gauss_points) - s(1))*gauss_place(1)/(gauss_place(gauss_points) - gauss_place(1))
        is_covered = abs(continued(s, gap, cut) - before) <= step*length
        cut = s(gauss_points) + (s(1) - cut)
        behind = continued(s, gap, cut)
      end associate
      if (.not. is_covered) return
      before = behind
    end do
    is_covered = abs(facing(row(2))%gap - before) <= step*length
  end function is_covered

  !> The value at s of the parabola through three points.
  pure real(wp) function continued(at, value, s)
    real(wp), intent(in) :: at(3), value(3), s

    continued = value(1)*(s - at(2))*(s - at(3))/((at(1) - at(2))*(at(1) - at(3))) + &
                value(2)*(s - at(1))*(s - at(3))/((at(2) - at(1))*(at(2) - at(3))) + &
                value(3)*(s - at(1))*(s - at(2))/((at(3) - at(1))*(at(3) - at(2)))
  end function continued

  !> How far from a side the part of the other line lies that it faces, at most: twice as far as its ends say,
  !! or its length.
  pure real(wp) function reach_of(contact, side, row, facing)
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: side
    integer, intent(in) :: row(3)                  !! of its nodes; 0: they face nothing, or there is none
    type(facing_type), intent(in) :: facing(:)     !! what the nodes face [rows]

    reach_of = contact%search
    if (any(row == 0 .and. contact%slave%segment(:, side) > 0)) return
    reach_of = min(reach_of, 2.0_wp*max(contact%slave%chord_length(side), &
                                        maxval(abs(facing(row(:2))%gap))))
  end function reach_of

  !> Integration points of a side, cut where nodes of the other line face it.
  pure subroutine cut_side(contact, obstacles, side, reach, ring, points)
    type(line_contact), intent(in) :: contact
    type(boundary_line), intent(in) :: obstacles
    integer, intent(in) :: side
    real(wp), intent(in) :: reach             !! the part of the other line that may cut it lies within
    logical, intent(in) :: ring
    type(side_points), intent(out) :: points
    type(looking_point) :: from
 type(facing_type)::seen(2)
    real(wp), allocatable :: cut(:)
    real(wp) :: s, tangent(2)
    integer :: i, k

    cut = cuts_of(contact%slave, side, contact%master, reach)
    allocate (points%share(3, gauss_points*size(cut)), points%weight(gauss_points*size(cut)))
    allocate (points%facing(gauss_points*size(cut)), points%along(gauss_points*size(cut)))
    do i = 2, size(cut)
      if (cut(i) - cut(i - 1) <= beyond) cycle   ! what lies beyond an end by so little is not beyond it
      do k = 1, gauss_points
        s = cut(i - 1) + (cut(i) - cut(i - 1))*gauss_place(k)
        points%count = points%count + 1
        points%along(points%count) = s
        associate (p => points%count, slave => contact%slave)
          call slave%at(side, s, points%share(:, p), from%x, tangent)
          points%weight(p) = gauss_weight(k)*(cut(i) - cut(i - 1))*norm2(tangent)
          if (ring) points%weight(p) = points%weight(p)*dot_product(points%share(:, p), slave%x(1, :, side))
          from%outward = [tangent(2), -tangent(1)]/norm2(tangent)
          from%along = 0.5_wp*tangent
          from%rise = rise_of(slave, side)
          seen= find_facing(contact%master, obstacles, from, contact%search)
points%facing(p)=seen(1)
          points%covered = points%covered .and. points%facing(p)%found .and. &
                           dot_product(points%facing(p)%normal, from%outward) < -parallel
        end associate
      end do
    end do
  end subroutine cut_side

  !> Places along a side, from 0 to 1, at which the ends of the other line's sides, within `reach`, face it.
  pure function cuts_of(slave, side, master, reach) result(cut)
    type(boundary_line), intent(in) :: slave, master
    integer, intent(in) :: side
    real(wp), intent(in) :: reach
    real(wp), allocatable :: cut(:)
    integer, allocatable :: near(:)
    real(wp) :: middle(2), s, within
    integer :: i, k, n
    type(facing_place) :: place

    middle = 0.5_wp*(slave%x(:, 1, side) + slave%x(:, 2, side))
    within = reach + slave%chord_length(side)
    near = master%in_box(middle - within, middle + within)
    allocate (cut(2*size(near) + 2))
    cut(:2) = [1.0_wp, 0.0_wp]
    n = 2
    do i = 1, size(near)
      do k = 1, 2
        if (k == 2 .and. i < size(near)) then
          if (near(i + 1) == master%neighbour(2, near(i))) cycle   ! the start of the next
        end if
        place = slave%face(side, master%x(:, k, near(i)))
        if (place%found .and. place%s >= 0.0_wp .and. place%s <= 1.0_wp .and. abs(place%gap) <= reach*(1.0_wp + beyond)) &
 call insert(place%s, n, cut)
      end do
    end do
    cut = cut(n:1:-1)
  end function cuts_of

  !> Insert a number from 0 to 1 into some in falling order, the last of them 0: lines that face each other
  !! are walked in opposite directions, so that most come to stand near the end.
  pure subroutine insert(s, n, falling)
    real(wp), intent(in) :: s
    integer, intent(inout) :: n
    real(wp), intent(inout) :: falling(:)
    integer :: i

    do i = n, 1, -1
      if (falling(i) >= s) exit
      falling(i + 1) = falling(i)
    end do
    falling(i + 1) = s
    n = n + 1
  end subroutine insert

  !> Add the weights of a side that faces the other line all along.
  pure subroutine add_dual(master, points, row, list)
    type(boundary_line), intent(in) :: master
    type(side_points), intent(in) :: points
    integer, intent(in) :: row(3)
    type(weight_list), intent(inout) :: list
    real(wp) :: dual(3, 3), mass(3, 3), integral(3), psi(3)
    integer :: j, k, p

    mass = 0.0_wp
    integral = 0.0_wp
    do p = 1, points%count
      associate (n => points%share(:, p), w => points%weight(p))
        integral = integral + w*n
        do j = 1, 3
          mass(:, j) = mass(:, j) + w*n*n(j)
        end do
      end associate
    end do
    if (row(3) == 0) mass(3, 3) = sum(integral)   ! no middle node
    integral = max(integral, no_area*sum(integral))
    dual = inverse(mass)
    do k = 1, 3
      dual(k, :) = integral(k)*dual(k, :)
      if (row(k) > 0) list%area(row(k)) = list%area(row(k)) + integral(k)
    end do
    do p = 1, points%count
      psi = points%weight(p)*matmul(dual, points%share(:, p))
      associate (facing => points%facing(p))
        do k = 1, 3
          if (row(k) > 0) call list%add(row(k), master%segment(:, facing%segment), psi(k)*facing%share)
        end do
      end associate
    end do
  end subroutine add_dual

  !> By cofactors.
  pure function inverse(a) result(b)
    real(wp), intent(in) :: a(3, 3)
    real(wp) :: b(3, 3)
    integer :: i, j, p, q, r, s

    do j = 1, 3
      do i = 1, 3
        p = mod(j, 3) + 1
        q = mod(p, 3) + 1
        r = mod(i, 3) + 1
        s = mod(r, 3) + 1
        b(i, j) = a(p, r)*a(q, s) - a(p, s)*a(q, r)
      end do
    end do
    b = b/dot_product(a(1, :), b(:, 1))
  end function inverse

  !> Note the weights of a side's nodes in a row; node 0 is none.
  pure subroutine add(self, row, node, weight)
    class(weight_list), intent(inout) :: self
    integer, intent(in) :: row, node(3)   !! the row; start, end and middle of the side
    real(wp), intent(in) :: weight(3)   !! of these
    integer :: k

    do k = 1, 3
      if (node(k) == 0 .or. weight(k) == 0.0_wp) cycle
      if (self%count == size(self%part)) self%part = [self%part, self%part]   ! room for twice as many
      self%count = self%count + 1
      self%part(self%count) = weight_part(row, node(k), weight(k))
    end do
  end subroutine add

  !> Note what a node faces at its own place.
  pure subroutine add_own_place(self, row, master, facing, integral)
    class(weight_list), intent(inout) :: self
    integer, intent(in) :: row   !! the row
    type(boundary_line), intent(in) :: master   !! whose side is faced
    type(facing_type), intent(in) :: facing   !! what it faces
    real(wp), intent(in) :: integral   !! of the node's shape function, as far as this counts for

    call self%add(row, master%segment(:, facing%segment), integral*facing%share)
    self%area(row) = self%area(row) + integral
  end subroutine add_own_place

  !> The rows: weights of one node added up, over the row's area, without rounding.
  pure subroutine collect(list, rows)
    type(weight_list), intent(in) :: list
    type(mortar_rows), intent(out) :: rows
    integer, allocatable :: order(:)
    integer :: first, i, k, n, row

    order = sorted_order(list%part(:list%count)%row)
    allocate (rows%start(size(list%area) + 1), rows%node(list%count), rows%weight(list%count))
    n = 0
    i = 1
    associate (node => rows%node, weight => rows%weight)
      do row = 1, size(list%area)
        first = n + 1
        rows%start(row) = first
        do while (i <= list%count)
          associate (part => list%part(order(i)))
            if (part%row /= row) exit
            k = first - 1 + findloc(node(first:n), part%node, dim=1)
            if (k < first) then
              n = n + 1
              k = n
              node(n) = part%node
              weight(n) = 0.0_wp
            end if
            weight(k) = weight(k) + part%weight/list%area(row)
          end associate
          i = i + 1
        end do
        k = n
        n = first - 1 + count(abs(weight(first:k)) > rounded_off)
        node(first:n) = pack(node(first:k), abs(weight(first:k)) > rounded_off)
        weight(first:n) = pack(weight(first:k), abs(weight(first:k)) > rounded_off)
      end do
    end associate
    rows%start(size(rows%start)) = n + 1
    rows%node = rows%node(:n)
    rows%weight = rows%weight(:n)
  end subroutine collect
end module epcont_contact_geometry_mortar
