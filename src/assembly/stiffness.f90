!> Stiffness of one body, assembled and factored: a band or fronts, and a border of the ties' free leaders.
!>
!>     K = [ K_bb  K_br ]   b: band or fronts,  r: border (few)
!>         [ K_rb  K_rr ]
!>
!> K_bb is factored alone; the border follows by its Schur complement S = K_rr - K_rb W, W = K_bb^-1 K_br.
module epcont_assembly_stiffness
  use epcont_assembly_strain_operator, only: strain_operator
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: assembled_matrix, probes, sparse_rows
  use epcont_linalg_dense, only: cholesky_factor, cholesky_solve
  use epcont_linalg_fronts, only: front_matrix
  use epcont_linalg_panels, only: panel_matrix
  use epcont_material_linear_law, only: linear_law
  use epcont_model_controls, only: solver_frontal
  use epcont_plan_joined_numbering, only: find_terms
  use epcont_plan_numbering, only: most_freedoms
  use epcont_plan_planned_model, only: planned_model
  !$ use omp_lib, only: omp_get_num_threads
  implicit none
  private
  public :: body_stiffness, spring_set

  !> Springs of joined bodies.
  type :: spring_set
    real(wp), allocatable :: stiffness(:)   !! [force/length] [springs]
    logical, allocatable :: changed(:)      !! it is not that of the last stiffness [springs]
    real(wp) :: norm = 0.0_wp               !! of the stiffness without any, in the 1-norm [force/length]
  end type spring_set

  type :: body_stiffness
    class(assembled_matrix), allocatable :: matrix   !! K_bb, then its factor
    real(wp), allocatable :: coupling(:, :)   !! K_br, then W [equations, border]
    real(wp), allocatable :: schur(:, :)      !! K_rr, then the factor of S [border, border]
    logical :: lacks_memory = .false.         !! there was not enough for K_bb
    real(wp) :: smallest_ratio = 1.0_wp       !! smallest pivot over its diagonal entry
    !> Estimate of the condition of K_bb in the 1-norm; 0: none has been made of this factor
    real(wp) :: condition = 0.0_wp
  contains
    procedure :: assemble
    procedure :: factor
    procedure :: is_sound
    procedure :: solve_lower
    procedure :: solve_upper
    procedure :: estimate_condition
  end type body_stiffness

contains

  !> Assemble the elements of a body, and factor what is complete on the way. Where only some elements have
  !! changed since it was factored, nothing is touched that does not depend on them.
  subroutine assemble(self, scene, operator, law, spring, b)
    class(body_stiffness), intent(inout) :: self
    type(planned_model), intent(in) :: scene         !! with the numbers of its equations
    type(strain_operator), intent(in) :: operator    !! strains of nodal displacements
    type(linear_law), intent(in) :: law              !! stresses of strains, and where that has changed since
    type(spring_set), intent(in) :: spring           !! of joined bodies
    integer, intent(in) :: b                         !! the body
    logical, allocatable :: stale(:)                 ! the equation is to be filled [-border:equations]

    associate (body => scene%numbering%body(b))
      allocate (stale(1 - size(body%tied%start):body%equations), source=.true.)
      stale(0) = .false.
      if (.not. allocated(self%matrix)) then
        call begin()
      else
        if (self%is_sound() .and. body%border == 0) call find_stale()
        call self%matrix%clear(stale(1:))
        deallocate (self%coupling, self%schur)
      end if
      allocate (self%coupling(body%equations, body%border), source=0.0_wp)
      allocate (self%schur(body%border, body%border), source=0.0_wp)
      self%lacks_memory = self%matrix%lacks_memory
      if (self%lacks_memory) return
      if (body%solver == solver_frontal) then
        call fill_fronts()
      else
        call fill(1, 1, size(body%part))
      end if
      if (.not. scene%numbering%joined) call add_springs()
    end associate

  contains

    !> Fill and factor the fronts, unit by unit, each after those below it, by the threads that are at hand:
    !! what is summed, and in which order, does not depend on them.
    subroutine fill_fronts()
      integer :: above, p
      integer, allocatable :: unit(:)   ! nothing but its addresses, of units and of none, counts
      logical :: deferred   ! one thread would begin with the last, far from where memory has been touched

      deferred = .false.
      !$ deferred = size(self%schur) == 0 .and. omp_get_num_threads() > 1
      associate (fronts => scene%numbering%body(b)%fronts)
        unit = [fronts%unit, 0]
        do p = 1, size(fronts%unit)
          if (fronts%unit(p) /= p .or. .not. stale(fronts%first(p))) cycle
          above = merge(fronts%parent(p), size(unit), fronts%parent(p) > 0)
          !$omp task firstprivate(p) depend(in: unit(above)) depend(inout: unit(p)) if(deferred)
          call fill_below(p)
          !$omp end task
        end do
        !$omp taskwait
        call fill(size(unit), fronts%first_element(size(unit)), size(scene%numbering%body(b)%part))
      end associate
    end subroutine fill_fronts

    !> Fill and factor a front, after those of its unit that are below it.
    recursive subroutine fill_below(p)
      integer, intent(in) :: p
      integer :: i

      associate (fronts => scene%numbering%body(b)%fronts)
        do i = fronts%below%start(p), fronts%below%start(p + 1) - 1
          associate (below => fronts%below%group(i))
            if (fronts%unit(below) /= below) call fill_below(below)
          end associate
        end do
        call fill(p, fronts%first_element(p), fronts%first_element(p + 1) - 1)
      end associate
    end subroutine fill_below

    !> Fill a part of the matrix with its elements and springs.
    subroutine fill(part, first, last)
      integer, intent(in) :: part, first, last
      integer :: e

      call self%matrix%open(part)
      do e = first, last
        associate (element => scene%numbering%body(b)%part(e))
          if (element <= scene%model%elements) then
            call add_element(element)
          else
            call add_spring(element - scene%model%elements)
          end if
        end associate
      end do
      call self%matrix%close(part)
    end subroutine fill

    subroutine add_element(element)
      integer, intent(in) :: element
      real(wp) :: k(most_freedoms**2)
      integer :: n, number(most_freedoms)

      number = scene%numbering%of_element(scene%model, element)
      n = directions*scene%model%node_count(element)
      if (scene%numbering%joined .and. any(number(:n) < 0)) then
        call add_sums(element, n, number(:n))
        return
      end if
      if (.not. any(stale(number(:n)))) return
      call operator%element_stiffness(scene%model, element, law, n, k)
      call scene%numbering%axes%turn_stiffness(scene%model%connectivity(:, element), n, k)
      call self%matrix%add(n, number, k)
      if (size(self%schur) > 0) call add_to_border(n, number, k, scene%numbering%body(b)%tied, self)
    end subroutine add_element

    !> The same where freedoms are sums of equations.
    subroutine add_sums(element, n, of_element)
      integer, intent(in) :: element, n, of_element(n)
      integer, allocatable :: freedom(:), number(:)
      real(wp), allocatable :: weight(:)
      real(wp) :: k(n, n)

      call find_terms(scene%numbering%body(1)%tied, of_element, number, freedom, weight)
      if (.not. any(stale(number))) return
      call operator%element_stiffness(scene%model, element, law, n, k)
      call self%matrix%add(size(number), number, k(freedom, freedom)* &
                           spread(weight, 2, size(weight))*spread(weight, 1, size(weight)))
    end subroutine add_sums

    subroutine add_spring(k)
      integer, intent(in) :: k

      associate (row => scene%numbering%body(b)%spring)
        associate (number => row%equation(row%start(k):row%start(k + 1) - 1), &
                   weight => row%weight(row%start(k):row%start(k + 1) - 1))
          if (spring%stiffness(k) <= 0.0_wp .or. .not. any(stale(number))) return
          call self%matrix%add(size(number), number, spring%stiffness(k)* &
                               spread(weight, 2, size(weight))*spread(weight, 1, size(weight)))
        end associate
      end associate
    end subroutine add_spring

    !> Springs of the scene, whose ends are in the border.
    subroutine add_springs()
      real(wp) :: row(size(self%schur, 1))
      integer :: e, i, k, number

      do k = 1, size(scene%model%spring)
        associate (own => scene%model%spring(k))
          if (scene%model%body(maxval(own%node)) /= b) cycle
          row = 0.0_wp
          do i = 1, 2
            number = 0
            if (own%node(i) > 0) number = scene%numbering%equation(own%component(i), own%node(i))
            if (number == 0) cycle
            associate (tied => scene%numbering%body(b)%tied)
              do e = tied%start(-number), tied%start(1 - number) - 1
                row(tied%equation(e)) = row(tied%equation(e)) + (2*i - 3)*tied%weight(e)
              end do
            end associate
          end do
          self%schur = self%schur + own%stiffness*spread(row, 1, size(row))*spread(row, 2, size(row))
        end associate
      end do
    end subroutine add_springs

    !> A matrix of zeros, of the kind that the plan has chosen.
    subroutine begin()
      type(front_matrix), allocatable :: fronts
      type(panel_matrix), allocatable :: panels

      associate (body => scene%numbering%body(b))
        associate (once => .not. (body%can_yield .or. scene%numbering%joined), &
                   trailing => merge(body%contact_equations, 0, body%contact_last))
          if (body%solver == solver_frontal) then
            allocate (fronts)
            call fronts%begin(body%fronts, once, trailing)
            call move_alloc(fronts, self%matrix)
          else
            allocate (panels)
            call panels%begin(body%panels, trailing)
            call move_alloc(panels, self%matrix)
          end if
        end associate
      end associate
    end subroutine begin

    !> The equations of elements and springs that have changed.
    subroutine find_stale()
      integer, allocatable :: freedom(:), term(:)
      real(wp), allocatable :: weight(:)
      integer :: e, i, number(most_freedoms)

      stale = .false.
      associate (element => scene%numbering%body(b)%element, first => scene%model%first_point)
        do e = 1, size(element)
          if (.not. any(law%changed(first(element(e)):first(element(e) + 1) - 1))) cycle
          number = scene%numbering%of_element(scene%model, element(e))
          do i = 1, size(number)
            stale(number(i)) = number(i) > 0
          end do
          if (.not. scene%numbering%joined .or. all(number >= 0)) cycle
          call find_terms(scene%numbering%body(1)%tied, number, term, freedom, weight)
          stale(term) = .true.
        end do
      end associate
      if (.not. allocated(spring%changed)) return
      associate (row => scene%numbering%body(b)%spring)
        do e = 1, size(spring%changed)
          if (spring%changed(e)) stale(row%equation(row%start(e):row%start(e + 1) - 1)) = .true.
        end do
      end associate
    end subroutine find_stale
  end subroutine assemble

  !> Add an element matrix to the coupling and the border, by what its freedoms are there.
  pure subroutine add_to_border(n, number, k, tied, stiffness)
    integer, intent(in) :: n, number(n)
    real(wp), intent(in) :: k(n, n)
    type(sparse_rows), intent(in) :: tied
    type(body_stiffness), intent(inout) :: stiffness
    integer :: e, f, i, j

    do j = 1, n
      if (number(j) >= 0) cycle
      do e = tied%start(-number(j)), tied%start(1 - number(j)) - 1
        associate (coupling => stiffness%coupling(:, tied%equation(e)), &
                   schur => stiffness%schur(:, tied%equation(e)), weight => tied%weight(e))
          do i = 1, n
            if (number(i) > 0) coupling(number(i)) = coupling(number(i)) + weight*k(i, j)
            if (number(i) >= 0) cycle
            do f = tied%start(-number(i)), tied%start(1 - number(i)) - 1
              schur(tied%equation(f)) = schur(tied%equation(f)) + weight*tied%weight(f)*k(i, j)
            end do
          end do
        end associate
      end do
    end do
  end subroutine add_to_border

  !> Factor the matrix, then the Schur complement of the border.
  subroutine factor(self)
    class(body_stiffness), intent(inout) :: self
    real(wp), allocatable :: coupled(:, :)
    integer :: at, info

    self%smallest_ratio = 0.0_wp
    self%condition = 0.0_wp
    if (self%lacks_memory) return
    call self%matrix%factor(self%smallest_ratio, at)
    if (self%smallest_ratio == 0.0_wp .or. size(self%schur) == 0) return
    coupled = self%coupling
    call self%matrix%solve(self%coupling)
    self%schur = self%schur - matmul(transpose(coupled), self%coupling)
    call cholesky_factor(self%schur, info)
    if (info /= 0) self%smallest_ratio = 0.0_wp
  end subroutine factor

  !> Is the factor one that can be solved with?
  pure logical function is_sound(self)
    class(body_stiffness), intent(in) :: self

    is_sound = self%smallest_ratio > epsilon(1.0_wp)
  end function is_sound

  !> The first half of a solve for one right-hand side, in place: what has it behind it may still be added to.
  subroutine solve_lower(self, inner, border)
    class(body_stiffness), intent(in) :: self
    real(wp), contiguous, intent(inout) :: inner(:, :)    !! [order of the matrix, 1]
    real(wp), contiguous, intent(inout) :: border(:, :)   !! [border, 1]

    border = border - matmul(transpose(self%coupling), inner)
    call self%matrix%solve_lower(inner)
  end subroutine solve_lower

  !> The second half. Of the inner rows those before `first` are not wanted.
  subroutine solve_upper(self, inner, border, first)
    class(body_stiffness), intent(in) :: self
    real(wp), contiguous, intent(inout) :: inner(:, :)   !! [order of the matrix, 1]
    real(wp), contiguous, intent(inout) :: border(:, :)   !! [border, 1]
    integer, intent(in) :: first   !! row that is wanted

    call self%matrix%solve_upper(inner, first)
    if (size(border) == 0) return
    call cholesky_solve(self%schur, border)
    inner = inner - matmul(self%coupling, border)
  end subroutine solve_upper

  !> Estimate the condition in the 1-norm, if that has not been done with this factor, by two solves with two
  !! columns each: of the norm of the inverse a lower bound, seldom below a third of it. By Higham and Tisseur
  !! (SIAM J. Matrix Anal. Appl. 21 (2000) 1185): a factor takes longer to read than to use, so `dlacn2`, one
  !! column in each of five solves, takes two and a half times as long for the same figure.
  subroutine estimate_condition(self)
    class(body_stiffness), intent(inout) :: self
    real(wp) :: x(self%matrix%order, 2), border(size(self%schur, 1), 2), inverse_norm

    if (self%condition > 0.0_wp) return
    x = probes(self%matrix%order)
    call solve()
    inverse_norm = maxval(sum(abs(x), dim=1))
    x = sign(1.0_wp, x)   ! the inverse is symmetric: the sum of a row is that of a column
    call solve()
    self%condition = max(1.0_wp, self%matrix%norm*maxval([inverse_norm, abs(x)]))

  contains

    subroutine solve()
      border = 0.0_wp
      call self%solve_lower(x, border)
      call self%solve_upper(x, border, 1)
    end subroutine solve
  end subroutine estimate_condition
end module epcont_assembly_stiffness
