!> Stiffness of one body, assembled and factored: a band or fronts, and a border of the ties' free leaders.
!>
!>     K = [ K_bb  K_br ]   b: band or fronts,  r: border (few)
!>         [ K_rb  K_rr ]
!>
!> K_bb is factored alone; the border follows by its Schur complement S = K_rr - K_rb W, W = K_bb^-1 K_br.
module epcont_assembly_stiffness
  use epcont_assembly_strain_operator, only: strain_operator
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes
  use epcont_linalg_assembled, only: assembled_matrix
  use epcont_linalg_dense, only: cholesky_factor, cholesky_solve
  use epcont_linalg_front, only: front_matrix
  use epcont_linalg_panel, only: panel_matrix
  use epcont_linalg_single_front, only: single_front_matrix => front_matrix
  use epcont_linalg_single_panel, only: single_panel_matrix => panel_matrix
  use epcont_material_linear_law, only: linear_law
  use epcont_model_controls, only: solver_frontal
  use epcont_model_model, only: model_type
  use epcont_plan_numbering, only: body_numbering, numbering_type
  implicit none
  private
  public :: body_stiffness, assemble_body, norm_of

  type :: body_stiffness
    class(assembled_matrix), allocatable :: matrix   !! K_bb, then its factor
    real(wp), allocatable :: coupling(:, :)   !! K_br, then W [equations, border]
    real(wp), allocatable :: schur(:, :)      !! K_rr, then the factor of S [border, border]
    logical :: single = .false.               !! K_bb is factored in single precision
    !> K is over this, in the range of single precision; a power of four [force/length]
    real(wp) :: unit = 1.0_wp
    real(wp) :: smallest_ratio = 1.0_wp       !! smallest pivot over its diagonal entry
    integer :: weakest = 0                    !! its equation
  contains
    procedure :: factor
    procedure :: is_sound
    procedure :: solve_lower
    procedure :: solve_upper
  end type body_stiffness

contains

  !> Assemble the elements of a body, and factor what is complete on the way. Where only some elements have
  !! changed since it was factored, nothing is touched that does not depend on them.
  subroutine assemble_body(model, operator, law, changed, numbering, b, stiffness)
    type(model_type), intent(in) :: model   !! the scene
    type(strain_operator), intent(in) :: operator   !! strains of nodal displacements
    type(linear_law), intent(in) :: law   !! stresses of strains
    logical, intent(in) :: changed(:)        !! since it was factored last [elements]
    type(numbering_type), intent(in) :: numbering   !! of its equations
    integer, intent(in) :: b                 !! the body
    type(body_stiffness), intent(inout) :: stiffness   !! of the body, filled; what could be is factored
    real(wp) :: k((2*most_nodes)**2)
    real(wp), allocatable :: row_sum(:)
    logical, allocatable :: stale(:)
    integer :: e, n, number(2*most_nodes)
    logical :: first

    first = .not. allocated(stiffness%matrix)
    if (first .and. stiffness%single) then
      stiffness%unit = unit_of(model, operator, law, numbering%body(b)%element)
    end if
    call begin(model, changed, numbering, b, stiffness, stale)
    if (stiffness%matrix%lacks_memory) return
    associate (body => numbering%body(b))
      allocate (row_sum(merge(body%equations, 0, first)), source=0.0_wp)
      do e = 1, size(body%element)
        n = 2*model%order(body%element(e))
        number = numbering%of_element(model, body%element(e))
        if (body%border == 0 .and. .not. any_of(stale, number)) cycle
        call operator%element_stiffness(model, body%element(e), law, n, k)
        if (stiffness%single) k(:n**2) = k(:n**2)/stiffness%unit
        call stiffness%matrix%add(n, number, k)
        if (body%border > 0) call add_to_border(n, number, k, stiffness)
        if (first) call add_magnitudes(n, number, k, row_sum)
      end do
    end associate
    if (first) stiffness%matrix%norm = max(0.0_wp, maxval(row_sum))
  end subroutine assemble_body

  !> A bound of the 1-norm of a body's stiffness as it is factored, from its elements.
  pure real(wp) function norm_of(model, operator, law, numbering, b, stiffness) result(norm)
    type(model_type), intent(in) :: model   !! the scene
    type(strain_operator), intent(in) :: operator   !! strains of nodal displacements
    type(linear_law), intent(in) :: law       !! as it was assembled with
    type(numbering_type), intent(in) :: numbering   !! of its equations
    integer, intent(in) :: b                  !! the body
    type(body_stiffness), intent(in) :: stiffness   !! of the body
    real(wp) :: k((2*most_nodes)**2), row_sum(numbering%body(b)%equations)
    integer :: e, n

    row_sum = 0.0_wp
    do e = 1, size(numbering%body(b)%element)
      associate (element => numbering%body(b)%element(e))
        n = 2*model%order(element)
        call operator%element_stiffness(model, element, law, n, k)
        call add_magnitudes(n, numbering%of_element(model, element), k, row_sum)
      end associate
    end do
    norm = max(0.0_wp, maxval(row_sum))/stiffness%unit
  end function norm_of

  !> Add an element's part of the sums of the magnitudes of each row. (A matrix has no larger ones: where
  !! elements meet, their entries may cancel.)
  pure subroutine add_magnitudes(n, number, k, row_sum)
    integer, intent(in) :: n, number(n)
    real(wp), intent(in) :: k(n, n)
    real(wp), intent(inout) :: row_sum(:)
    real(wp) :: sums(n)
    integer :: j

    sums = 0.0_wp
    do j = 1, n
      if (number(j) > 0) sums = sums + abs(k(:, j))
    end do
    do j = 1, n
      if (number(j) > 0) row_sum(number(j)) = row_sum(number(j)) + sums(j)
    end do
  end subroutine add_magnitudes

  !> A power of four near the largest stiffness of some elements [force/length].
  pure real(wp) function unit_of(model, operator, law, element)
    type(model_type), intent(in) :: model
    type(strain_operator), intent(in) :: operator
    type(linear_law), intent(in) :: law
    integer, intent(in) :: element(:)
    real(wp) :: largest
    integer :: e, p

    largest = 0.0_wp
    do e = 1, size(element)
      do p = model%first_point(element(e)), model%first_point(element(e) + 1) - 1
        associate (b => operator%b(:, operator%column(p) + 1:operator%column(p) + 2*model%order(element(e))))
          largest = max(largest, operator%volume(p)*maxval(abs(law%matrix(:, :, law%matrix_of(p)))) &
                        *maxval(abs(b))**2)
        end associate
      end do
    end do
    unit_of = scale(1.0_wp, exponent(largest)/2*2)
  end function unit_of

  !> Is one of these equations marked? Those of number 0 and less are not.
  pure logical function any_of(marked, number)
    logical, intent(in) :: marked(:)
    integer, intent(in) :: number(:)
    integer :: i

    any_of = .true.
    do i = 1, size(number)
      if (number(i) <= 0) cycle
      if (marked(number(i))) return
    end do
    any_of = .false.
  end function any_of

  !> Make the stiffness ready to be filled: anew where elements have changed and its factor can be kept, else
  !! all of it.
  subroutine begin(model, changed, numbering, b, stiffness, stale)
    type(model_type), intent(in) :: model
    logical, intent(in) :: changed(:)
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b
    type(body_stiffness), intent(inout) :: stiffness
    logical, allocatable, intent(out) :: stale(:)   !! which equations are to be filled
    integer :: e, i, number(2*most_nodes)

    associate (body => numbering%body(b))
      allocate (stale(body%equations), source=.true.)
      if (.not. allocated(stiffness%matrix)) then
        call begin_matrix(body, stiffness%single, stiffness%matrix)
      else
        if (stiffness%is_sound() .and. body%border == 0) then
          stale = .false.
          do e = 1, size(body%element)
            if (.not. changed(body%element(e))) cycle
            number = numbering%of_element(model, body%element(e))
            do i = 1, size(number)
              if (number(i) > 0) stale(number(i)) = .true.
            end do
          end do
        end if
        call stiffness%matrix%clear(stale)
        deallocate (stiffness%coupling, stiffness%schur)
      end if
      allocate (stiffness%coupling(body%equations, body%border), stiffness%schur(body%border, body%border), &
                source=0.0_wp)
    end associate
  end subroutine begin

  !> A matrix of zeros, of the kind that the plan has chosen.
  subroutine begin_matrix(body, single, matrix)
    type(body_numbering), intent(in) :: body
    logical, intent(in) :: single
    class(assembled_matrix), allocatable, intent(out) :: matrix
    type(front_matrix), allocatable :: fronts
    type(single_front_matrix), allocatable :: single_fronts
    type(panel_matrix), allocatable :: panels
    type(single_panel_matrix), allocatable :: single_panels

    associate (once => .not. body%can_yield, trailing => merge(body%contact_equations, 0, body%contact_last))
      if (body%solver == solver_frontal .and. single) then
        allocate (single_fronts)
        call single_fronts%begin(body%fronts, once, trailing)
        call move_alloc(single_fronts, matrix)
      else if (body%solver == solver_frontal) then
        allocate (fronts)
        call fronts%begin(body%fronts, once, trailing)
        call move_alloc(fronts, matrix)
      else if (single) then
        allocate (single_panels)
        call single_panels%begin(body%panels, once, trailing)
        call move_alloc(single_panels, matrix)
      else
        allocate (panels)
        call panels%begin(body%panels, once, trailing)
        call move_alloc(panels, matrix)
      end if
    end associate
  end subroutine begin_matrix

  !> Add an element matrix to the coupling and the border.
  pure subroutine add_to_border(n, number, k, stiffness)
    integer, intent(in) :: n, number(n)
    real(wp), intent(in) :: k(n, n)
    type(body_stiffness), intent(inout) :: stiffness
    integer :: i, j

    do j = 1, n
      if (number(j) >= 0) cycle
      do i = 1, n
        if (number(i) > 0) then
          stiffness%coupling(number(i), -number(j)) = stiffness%coupling(number(i), -number(j)) + k(i, j)
        else if (number(i) < 0) then
          stiffness%schur(-number(i), -number(j)) = stiffness%schur(-number(i), -number(j)) + k(i, j)
        end if
      end do
    end do
  end subroutine add_to_border

  !> Factor the matrix, then the Schur complement of the border.
  pure subroutine factor(self)
    class(body_stiffness), intent(inout) :: self
    real(wp), allocatable :: coupled(:, :)
    integer :: info

    self%smallest_ratio = 0.0_wp
    if (self%matrix%lacks_memory) return
    call self%matrix%factor(self%smallest_ratio, self%weakest)
    if (self%smallest_ratio == 0.0_wp .or. size(self%schur) == 0) return
    coupled = self%coupling
    call self%matrix%solve(self%coupling)
    self%schur = self%schur - matmul(transpose(coupled), self%coupling)
    call cholesky_factor(self%schur, info)
    if (info == 0) return
    self%smallest_ratio = 0.0_wp
    self%weakest = -info
  end subroutine factor

  !> Is the factor one that can be solved with?
  pure logical function is_sound(self)
    class(body_stiffness), intent(in) :: self

    is_sound = self%smallest_ratio > self%matrix%rounding
  end function is_sound

  !> The first half of a solve for one right-hand side, in place: what has it behind it may still be added to.
  pure subroutine solve_lower(self, inner, border)
    class(body_stiffness), intent(in) :: self
    real(wp), contiguous, intent(inout) :: inner(:, :)    !! [order of the matrix, 1]
    real(wp), contiguous, intent(inout) :: border(:, :)   !! [border, 1]

    inner = inner/self%unit
    border = border/self%unit - matmul(transpose(self%coupling), inner)
    call self%matrix%solve_lower(inner)
  end subroutine solve_lower

  !> The second half. Of the inner rows those before `first` are not wanted.
  pure subroutine solve_upper(self, inner, border, first)
    class(body_stiffness), intent(in) :: self
    real(wp), contiguous, intent(inout) :: inner(:, :)   !! [order of the matrix, 1]
    real(wp), contiguous, intent(inout) :: border(:, :)   !! [border, 1]
    integer, intent(in) :: first   !! row that is wanted

    call self%matrix%solve_upper(inner, first)
    if (size(border) == 0) return
    call cholesky_solve(self%schur, border)
    inner = inner - matmul(self%coupling, border)
  end subroutine solve_upper
end module epcont_assembly_stiffness
