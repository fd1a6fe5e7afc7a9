!> Stiffness of one body, assembled and factored: a band, and a border of the ties' free leaders.
!>
!>     K = [ K_bb  K_br ]   b: band,  r: border (few)
!>         [ K_rb  K_rr ]
!>
!> The band is factored alone; the border follows by its Schur complement S = K_rr - K_rb W, W = K_bb^-1 K_br.
module epcont_assembly_stiffness
  use epcont_assembly_strain_operator, only: strain_operator
  use epcont_base_kinds, only: wp
  use epcont_linalg_panel, only: panel_matrix
  use epcont_linalg_dense, only: cholesky_factor, cholesky_solve
  use epcont_model_model, only: model_type, most_nodes
  use epcont_plan_numbering, only: body_numbering
  implicit none
  private
  public :: body_stiffness, assemble_body

  type :: body_stiffness
    type(panel_matrix) :: band                !! K_bb, then its factor
    real(wp), allocatable :: coupling(:, :)   !! K_br, then W [band, border]
    real(wp), allocatable :: schur(:, :)      !! K_rr, then the factor of S [border, border]
    real(wp) :: smallest_ratio = 1.0_wp       !! smallest pivot**2 over its diagonal entry
    integer :: weakest = 0                    !! its equation
  contains
    procedure :: factor
    procedure :: solve
  end type body_stiffness

contains

  !> Assemble the elements of a body; `matrix` is that of the material at each point [4, 4, points]. `settlement`
  !! receives the forces that prescribed displacements exert on the free freedoms: minus K_fp u_p [force] [2, nodes].
  subroutine assemble_body(model, operator, matrix, equation, body, stiffness, settlement)
    type(model_type), intent(in) :: model
    type(strain_operator), intent(in) :: operator
    real(wp), intent(in) :: matrix(:, :, :)
    integer, intent(in) :: equation(:, :)
    type(body_numbering), intent(in) :: body
    type(body_stiffness), intent(inout) :: stiffness
    real(wp), intent(inout) :: settlement(:, :)
    real(wp) :: k(2*most_nodes, 2*most_nodes), forced(2*most_nodes)
    integer :: e, i, n

    call stiffness%band%begin(body%reach)
    if (allocated(stiffness%coupling)) deallocate (stiffness%coupling, stiffness%schur)
    allocate (stiffness%coupling(body%equations, body%border), stiffness%schur(body%border, body%border), source=0.0_wp)
    do e = 1, size(body%element)
      associate (element => body%element(e))
        n = model%order(element)
        call operator%element_stiffness(model, element, matrix, k)
        associate (node => model%connectivity(:n, element))
          call add(k(:2*n, :2*n), reshape(equation(:, node), [2*n]), stiffness)
          do i = 1, n
            forced(2*i - 1) = model%prescribed(1, model%leader(1, node(i)))
            forced(2*i) = model%prescribed(2, model%leader(2, node(i)))
          end do
          if (all(forced(:2*n) == 0.0_wp)) cycle
          settlement(:, node) = settlement(:, node) - reshape(matmul(k(:2*n, :2*n), forced(:2*n)), [2, n])
        end associate
      end associate
    end do
  end subroutine assemble_body

  !> Add an element matrix to the band, the coupling and the border.
  pure subroutine add(k, number, stiffness)
    real(wp), intent(in) :: k(:, :)
    integer, intent(in) :: number(:)
    type(body_stiffness), intent(inout) :: stiffness
    integer :: i, j

    do j = 1, size(number)
      if (number(j) == 0) cycle
      do i = 1, size(number)
        if (number(i) == 0) cycle
        if (number(i) >= number(j) .and. number(j) > 0) then
          call stiffness%band%add(number(i), number(j), k(i, j))
        else if (number(i) > 0 .and. number(j) < 0) then
          stiffness%coupling(number(i), -number(j)) = stiffness%coupling(number(i), -number(j)) + k(i, j)
        else if (number(i) < 0 .and. number(j) < 0) then
          stiffness%schur(-number(i), -number(j)) = stiffness%schur(-number(i), -number(j)) + k(i, j)
        end if
      end do
    end do
  end subroutine add

  !> Factor the band, then the Schur complement of the border.
  pure subroutine factor(self)
    class(body_stiffness), intent(inout) :: self
    real(wp), allocatable :: coupled(:, :)
    integer :: info

    call self%band%factor(self%smallest_ratio, self%weakest)
    if (self%smallest_ratio == 0.0_wp .or. size(self%schur) == 0) return
    coupled = self%coupling
    call self%band%solve(self%coupling)
    self%schur = self%schur - matmul(transpose(coupled), self%coupling)
    call cholesky_factor(self%schur, info)
    if (info == 0) return
    self%smallest_ratio = 0.0_wp
    self%weakest = -info
  end subroutine factor

  !> Solve for one right-hand side, in place.
  pure subroutine solve(self, band, border)
    class(body_stiffness), intent(in) :: self
    real(wp), contiguous, intent(inout) :: band(:, :)     !! [band, 1]
    real(wp), contiguous, intent(inout) :: border(:, :)   !! [border, 1]

    border = border - matmul(transpose(self%coupling), band)
    call self%band%solve(band)
    if (size(border) == 0) return
    call cholesky_solve(self%schur, border)
    band = band - matmul(self%coupling, border)
  end subroutine solve
end module epcont_assembly_stiffness
