!> Stiffness of one body, assembled and factored: a band or fronts, and a border of the free master DOFs of
!> ties.
!>
!>     K = [ K_bb  K_br ]   b: band or fronts,  r: border (few)
!>         [ K_rb  K_rr ]
!>
!> Only K_bb is factored; the border follows from its Schur complement S = K_rr - K_rb W, W = K_bb^-1 K_br.
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
  use epcont_plan_numbering, only: body_numbering, most_freedoms
  use epcont_plan_planned_model, only: planned_model
  !$ use omp_lib, only: omp_get_num_threads
  implicit none
  private
  public :: body_stiffness, spring_set

  !> Springs of joined bodies.
  type :: spring_set
    real(wp), allocatable :: stiffness(:)   !! [force/length] [springs]
    logical, allocatable :: changed(:)      !! differs from that of the last factor [springs]
    real(wp) :: norm = 0.0_wp               !! of the stiffness without springs, in the 1-norm [force/length]
  end type spring_set

  type :: body_stiffness
    class(assembled_matrix), allocatable :: matrix   !! K_bb, then its factor
    real(wp), allocatable :: coupling(:, :)   !! K_br, then W [equations, border]
    real(wp), allocatable :: schur(:, :)      !! K_rr, then the factor of S [border, border]
    logical :: lacks_memory = .false.         !! the memory was too small for K_bb
    real(wp) :: smallest_ratio = 1.0_wp       !! smallest pivot over its diagonal entry
    !> Estimated condition of K_bb in the 1-norm; 0 if it has not been estimated for this factor
    real(wp) :: condition = 0.0_wp
  contains
    procedure :: assemble
    procedure, private :: begin
    procedure :: factor
    procedure :: is_sound
    procedure :: solve_lower
    procedure :: solve_upper
    procedure :: estimate_condition
  end type body_stiffness

  !> Assembly of one body.
  type :: assembly
    class(body_stiffness), pointer :: stiffness => null()
    type(planned_model), pointer :: scene => null()
    type(body_numbering), pointer :: numbers => null()
    type(strain_operator), pointer :: operator => null()
    type(linear_law), pointer :: law => null()
    type(spring_set), pointer :: spring => null()
    logical, allocatable :: stale(:)   ! the equation is to be filled [1 - rows of tied - 1:equations]
  contains
    procedure :: find_stale
    procedure :: fill_fronts
    procedure :: fill_below
    procedure :: fill
    procedure :: add_element
    procedure :: add_sums
    procedure :: add_spring
    procedure :: add_springs
  end type assembly

contains

  !> Assemble the elements of a body, and factor fronts as soon as they are complete. If only some elements
  !! have changed since the last factorization, the independent part of the factor stays.
  subroutine assemble(self, scene, operator, law, spring, b)
    class(body_stiffness), intent(inout), target :: self
    type(planned_model), intent(in), target :: scene        !! with equation numbers
    type(strain_operator), intent(in), target :: operator   !! strains of nodal displacements
    type(linear_law), intent(in), target :: law             !! with marks where it has changed
    type(spring_set), intent(in), target :: spring          !! of joined bodies
    integer, intent(in) :: b                                !! the body
    type(assembly) :: work

    work%stiffness => self
    work%scene => scene
    work%numbers => scene%numbering%body(b)
    work%operator => operator
    work%law => law
    work%spring => spring
    associate (body => scene%numbering%body(b))
      allocate (work%stale(1 - size(body%tied%start):body%equations), source=.true.)
      work%stale(0) = .false.
      if (.not. allocated(self%matrix)) then
        call self%begin(body, .not. (body%can_yield .or. scene%numbering%joined))
      else
        if (self%is_sound() .and. body%border == 0) call work%find_stale()
        call self%matrix%clear(work%stale(1:))
        deallocate (self%coupling, self%schur)
      end if
      allocate (self%coupling(body%equations, body%border), source=0.0_wp)
      allocate (self%schur(body%border, body%border), source=0.0_wp)
      self%lacks_memory = self%matrix%lacks_memory
      if (self%lacks_memory) return
      if (body%solver == solver_frontal) then
        ! In a task of its own: libgomp leaks the dependences of tasks that a thread makes outside of tasks.
        !$omp task shared(work) if(.false.)
        call work%fill_fronts()
        !$omp end task
      else
        call work%fill(1, 1, size(body%part))
      end if
      if (.not. scene%numbering%joined) call work%add_springs(b)
    end associate
  end subroutine assemble

  !> Begin a matrix of zeros of the kind chosen by the plan.
  subroutine begin(self, body, once)
    class(body_stiffness), intent(inout) :: self
    type(body_numbering), intent(in) :: body
    logical, intent(in) :: once   !! it is factored only once
    type(front_matrix), allocatable :: fronts
    type(panel_matrix), allocatable :: panels

    associate (trailing => merge(body%contact_equations, 0, body%contact_last))
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
  end subroutine begin

  !> Find the equations of elements and springs that have changed.
  subroutine find_stale(self)
    class(assembly), intent(inout) :: self
    integer, allocatable :: freedom(:), term(:)
    real(wp), allocatable :: weight(:)
    integer :: e, i, number(most_freedoms)

    self%stale = .false.
    associate (element => self%numbers%element, first => self%scene%model%mesh%first_point)
      do e = 1, size(element)
        if (.not. any(self%law%changed(first(element(e)):first(element(e) + 1) - 1))) cycle
        number = self%scene%numbering%of_element(self%scene%model, element(e))
        do i = 1, size(number)
          self%stale(number(i)) = number(i) > 0
        end do
        if (.not. self%scene%numbering%joined .or. all(number >= 0)) cycle
        call find_terms(self%numbers%tied, number, term, freedom, weight)
        self%stale(term) = .true.
      end do
    end associate
    if (.not. allocated(self%spring%changed)) return
    associate (row => self%numbers%spring)
      do e = 1, size(self%spring%changed)
        if (self%spring%changed(e)) self%stale(row%equation(row%start(e):row%start(e + 1) - 1)) = .true.
      end do
    end associate
  end subroutine find_stale

  !> Fill and factor the fronts, unit by unit, children first. The threads share the units; the order of all
  !! sums does not depend on the number of threads.
  subroutine fill_fronts(self)
    class(assembly), intent(inout) :: self
    integer :: above, p
    integer, allocatable :: unit(:)   ! only the addresses of its elements are used: of units, and of no unit
    logical :: deferred   ! a single thread would begin with the last unit, far from memory in the cache

    deferred = .false.
    !$ deferred = size(self%stiffness%schur) == 0 .and. omp_get_num_threads() > 1
    associate (fronts => self%numbers%fronts)
      unit = [fronts%unit, 0]
      do p = 1, size(fronts%unit)
        if (fronts%unit(p) /= p .or. .not. self%stale(fronts%first(p))) cycle
        above = merge(fronts%parent(p), size(unit), fronts%parent(p) > 0)
        !$omp task shared(self) firstprivate(p) depend(in: unit(above)) depend(inout: unit(p)) if(deferred)
        call self%fill_below(p)
        !$omp end task
      end do
      !$omp taskwait
      call self%fill(size(unit), fronts%first_element(size(unit)), size(self%numbers%part))
    end associate
  end subroutine fill_fronts

  !> Fill and factor a front, after its children in the same unit.
  recursive subroutine fill_below(self, p)
    class(assembly), intent(inout) :: self
    integer, intent(in) :: p
    integer :: i

    associate (fronts => self%numbers%fronts)
      do i = fronts%below%start(p), fronts%below%start(p + 1) - 1
        associate (below => fronts%below%group(i))
          if (fronts%unit(below) /= below) call self%fill_below(below)
        end associate
      end do
      call self%fill(p, fronts%first_element(p), fronts%first_element(p + 1) - 1)
    end associate
  end subroutine fill_below

  !> Fill a part of the matrix with its elements and springs.
  subroutine fill(self, part, first, last)
    class(assembly), intent(inout) :: self
    integer, intent(in) :: part, first, last
    integer :: e

    call self%stiffness%matrix%open(part)
    do e = first, last
      associate (element => self%numbers%part(e), elements => self%scene%model%mesh%elements)
        if (element <= elements) call self%add_element(element)
        if (element > elements) call self%add_spring(element - elements)
      end associate
    end do
    call self%stiffness%matrix%close(part)
  end subroutine fill

  subroutine add_element(self, element)
    class(assembly), intent(inout) :: self
    integer, intent(in) :: element
    real(wp) :: k(most_freedoms**2)
    integer :: n, number(most_freedoms)

    associate (model => self%scene%model, numbering => self%scene%numbering)
      number = numbering%of_element(model, element)
      n = directions*model%mesh%node_count(element)
      if (numbering%joined .and. any(number(:n) < 0)) then
        call self%add_sums(element, n, number(:n))
        return
      end if
      if (.not. any(self%stale(number(:n)))) return
      call self%operator%element_stiffness(model, element, self%law, n, k)
      call numbering%axes%turn_stiffness(model%mesh%connectivity(:, element), n, k)
      call self%stiffness%matrix%add(n, number, k)
      if (size(self%stiffness%schur) > 0) call add_to_border(n, number, k, self%numbers%tied, self%stiffness)
    end associate
  end subroutine add_element

  !> Add an element with DOFs that are sums of equations.
  subroutine add_sums(self, element, n, of_element)
    class(assembly), intent(inout) :: self
    integer, intent(in) :: element, n, of_element(n)
    integer, allocatable :: freedom(:), number(:)
    real(wp), allocatable :: weight(:)
    real(wp) :: k(n, n)

    call find_terms(self%numbers%tied, of_element, number, freedom, weight)
    if (.not. any(self%stale(number))) return
    call self%operator%element_stiffness(self%scene%model, element, self%law, n, k)
    call self%stiffness%matrix%add(size(number), number, k(freedom, freedom)* &
                                   spread(weight, 2, size(weight))*spread(weight, 1, size(weight)))
  end subroutine add_sums

  !> Add a spring of joined bodies.
  subroutine add_spring(self, k)
    class(assembly), intent(inout) :: self
    integer, intent(in) :: k

    associate (row => self%numbers%spring)
      associate (number => row%equation(row%start(k):row%start(k + 1) - 1), &
                 weight => row%weight(row%start(k):row%start(k + 1) - 1))
        if (self%spring%stiffness(k) <= 0.0_wp .or. .not. any(self%stale(number))) return
        call self%stiffness%matrix%add(size(number), number, self%spring%stiffness(k)* &
                                       spread(weight, 2, size(weight))*spread(weight, 1, size(weight)))
      end associate
    end associate
  end subroutine add_spring

  !> Add the springs of the model, whose ends are in the border.
  subroutine add_springs(self, b)
    class(assembly), intent(inout) :: self
    integer, intent(in) :: b
    real(wp) :: row(size(self%stiffness%schur, 1))
    integer :: e, i, k, number

    do k = 1, size(self%scene%model%constraints%spring)
      associate (own => self%scene%model%constraints%spring(k), schur => self%stiffness%schur, &
                 tied => self%numbers%tied)
        if (self%scene%model%mesh%body(maxval(own%node)) /= b) cycle
        row = 0.0_wp
        do i = 1, 2
          number = 0
          if (own%node(i) > 0) number = self%scene%numbering%equation(own%component(i), own%node(i))
          if (number == 0) cycle
          do e = tied%start(-number), tied%start(1 - number) - 1
            row(tied%equation(e)) = row(tied%equation(e)) + (2*i - 3)*tied%weight(e)
          end do
        end do
        schur = schur + own%stiffness*spread(row, 1, size(row))*spread(row, 2, size(row))
      end associate
    end do
  end subroutine add_springs

  !> Add an element matrix to the coupling and the border.
  pure subroutine add_to_border(n, number, k, tied, stiffness)
    integer, intent(in) :: n, number(n)
    real(wp), intent(in) :: k(n, n)
    type(sparse_rows), intent(in) :: tied
    class(body_stiffness), intent(inout) :: stiffness
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

  !> Is the factor usable?
  pure logical function is_sound(self)
    class(body_stiffness), intent(in) :: self

    is_sound = self%smallest_ratio > epsilon(1.0_wp)
  end function is_sound

  !> Forward substitution, in place. Results of several forward substitutions may be added.
  subroutine solve_lower(self, inner, border)
    class(body_stiffness), intent(in) :: self
    real(wp), contiguous, intent(inout) :: inner(:, :)    !! [order of the matrix, 1]
    real(wp), contiguous, intent(inout) :: border(:, :)   !! [border, 1]

    border = border - matmul(transpose(self%coupling), inner)
    call self%matrix%solve_lower(inner)
  end subroutine solve_lower

  !> Backward substitution. Inner rows before `first` are not needed.
  subroutine solve_upper(self, inner, border, first)
    class(body_stiffness), intent(in) :: self
    real(wp), contiguous, intent(inout) :: inner(:, :)   !! [order of the matrix, 1]
    real(wp), contiguous, intent(inout) :: border(:, :)   !! [border, 1]
    integer, intent(in) :: first   !! row that is needed

    call self%matrix%solve_upper(inner, first)
    if (size(border) == 0) return
    call cholesky_solve(self%schur, border)
    inner = inner - matmul(self%coupling, border)
  end subroutine solve_upper

  !> Estimate the condition in the 1-norm with two solves for two columns each, once for a factor. The norm of
  !! the inverse is a lower bound, seldom below a third (Higham and Tisseur, SIAM J. Matrix Anal. Appl. 21
  !! (2000) 1185). `dlacn2` takes five solves for one column, which take 2.5 times as long because reading the
  !! factor dominates.
  subroutine estimate_condition(self)
    class(body_stiffness), intent(inout) :: self
    real(wp) :: x(self%matrix%order, 2), border(size(self%schur, 1), 2), inverse_norm

    if (self%condition > 0.0_wp) return
    x = probes(self%matrix%order)
    call solve()
    inverse_norm = maxval(sum(abs(x), dim=1))
    x = sign(1.0_wp, x)   ! the inverse is symmetric: sums of rows are sums of columns
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
