!> Mortar weights: weights of the master nodes in the gaps of the slave nodes, by a dual mortar method.
!>
!> The pressure of slave node i is distributed by the dual function psi_i of its shape functions N, which is
!> orthogonal to the other slave nodes: integral of psi_i N_j = d_ij integral of N_i. Its gap is that of the
!> node, minus the master displacement averaged with psi_i: weights (integral of psi_i
!> N_master)/(integral of N_i). A uniform pressure passes exactly between non-matching lines; on matching ones
!> each node has its opposite node only. (Wohlmuth, A mortar finite element method using dual
!> spaces for the Lagrange multiplier, SIAM J. Numer. Anal. 38, 2000.) The slave edges are cut into
!> pieces by epcont_contact_geometry_mortar_sides.
module epcont_contact_geometry_mortar
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_area, rounded_off
  use epcont_contact_geometry_faces, only: faces_type
  use epcont_contact_geometry_mortar_sides, only: cut_sides, side_points
  use epcont_geometry_boundary_line, only: facing_type
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_mortar_rows, mortar_row

  !> Nodes of the other line and their weights, whose sum is 1.
  type :: mortar_row
    integer, allocatable :: node(:)       !! [any]
    real(wp), allocatable :: weight(:)    !! [any]
  end type mortar_row

contains

  !> Find rows of master nodes and weights, one for each slave node with a pair, then those of joints. Rows
  !! without a covered edge use the projection of their node.
  subroutine find_mortar_rows(model, contact, faces, rows, covered, ends)
    type(model_type), intent(in) :: model          !! the model, without these pairs
    type(line_contact), intent(in) :: contact      !! the contact of lines
    type(faces_type), intent(in) :: faces          !! projections of the slave nodes
    type(mortar_row), allocatable, intent(out) :: rows(:)   !! [rows]
    logical, intent(out) :: covered(:)             !! edges that are fully opposite the master [edges]
    integer, allocatable, intent(out) :: ends(:)   !! master nodes at joints that have rows
    type(side_points), allocatable :: points(:)
    real(wp), allocatable :: area(:)               ! [rows]
    logical, allocatable :: alone(:)               ! [rows]
    integer :: i, row

    call cut_sides(model, contact, faces, points, covered, ends)
    allocate (area(size(faces%row) + size(ends)), source=0.0_wp)
    do i = 1, size(points)
      call set_integrals(points(i))
      associate (own => pack(points(i)%row, points(i)%row > 0))
        area(own) = area(own) + pack(points(i)%integral, points(i)%row > 0)
      end associate
    end do
    alone = .not. area > 0.0_wp
    where (alone) area = area + 1.0_wp
    rows = [(mortar_row([integer ::], [real(wp) ::]), row=1, size(area))]
    do i = 1, size(points)
      call add_side(points(i))
    end do
    do row = 1, size(rows)
      if (alone(row)) call add(faces%row(row)%facing_type, 1.0_wp)
      associate (counts => abs(rows(row)%weight) > rounded_off)
        rows(row) = mortar_row(pack(rows(row)%node, counts), pack(rows(row)%weight, counts))
      end associate
    end do

  contains

    !> Add the contribution of an edge to the rows of its nodes: by its points if covered, else at the nodes.
    subroutine add_side(own)
      type(side_points), intent(in) :: own
      integer :: k, p

      do k = 1, 3
        row = own%row(k)
        if (row == 0) cycle
        if (own%covered) then
          do p = 1, size(own%weight)
            call add(own%facing(p), own%dual(k, p))
          end do
        else
          call add(faces%row(row)%facing_type, own%integral(k))
        end if
      end do
    end subroutine add_side

    !> Add a weight to the gap row, distributed over the nodes of the opposite edge.
    subroutine add(facing, weight)
      type(facing_type), intent(in) :: facing
      real(wp), intent(in) :: weight
      integer :: i, k

      associate (node => contact%master%segment(:, facing%segment), part => weight*facing%share, &
                 own => rows(row))
        do k = 1, 3
          if (node(k) == 0 .or. part(k) == 0.0_wp) cycle
          i = findloc(own%node, node(k), dim=1)
          if (i == 0) then
            own%node = [own%node, node(k)]
            own%weight = [own%weight, 0.0_wp]
            i = size(own%node)
          end if
          own%weight(i) = own%weight(i) + part(k)/area(row)
        end do
      end associate
    end subroutine add
  end subroutine find_mortar_rows

  !> Integrals of the shape functions of an edge's nodes, and if it is covered, the dual functions.
  pure subroutine set_integrals(own)
    type(side_points), intent(inout) :: own
    real(wp) :: dual(3, 3), mass(3, 3)
    integer :: j, k, p

    associate (n => own%share, w => own%weight, integral => own%integral)
      integral = [(sum(w*n(k, :)), k=1, 3)]
      if (.not. own%covered) return
      mass = reshape([((sum(w*n(j, :)*n(k, :)), j=1, 3), k=1, 3)], [3, 3])
      if (own%row(3) == 0) mass(3, 3) = sum(integral)
      integral = max(integral, no_area*sum(integral))
      dual = spread(integral, 2, 3)*inverse(mass)
      allocate (own%dual(3, size(w)))
      do p = 1, size(w)
        own%dual(:, p) = w(p)*matmul(dual, n(:, p))
      end do
    end associate
  end subroutine set_integrals

  !> Invert by cofactors.
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
end module epcont_contact_geometry_mortar
