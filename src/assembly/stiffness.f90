!> Stiffness of one body, assembled and factored, in a band or in fronts.
module epcont_assembly_stiffness
  use epcont_assembly_strain_operator, only: strain_operator
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: assembled_matrix, probes
  use epcont_linalg_fronts, only: front_matrix
  use epcont_linalg_panels, only: panel_matrix
  use epcont_material_linear_law, only: linear_law
  use epcont_model_controls, only: solver_frontal
  use epcont_plan_sums, only: find_terms
  use epcont_plan_numbering, only: body_numbering, most_freedoms
  use epcont_plan_planned_model, only: planned_model
  !$ use omp_lib, only: omp_get_num_threads
  implicit none
  private
  public :: body_stiffness, spring_set

  !> Springs of the model; those of joined bodies include springs of pairs and SUPORT DOFs.
  type :: spring_set
    real(wp), allocatable :: stiffness(:)   !! [force/length] [springs]
    !> Differs from that of the last factor; not allocated if no stiffness ever changes [springs]
    logical, allocatable :: changed(:)
    !> 1-norm of the stiffness of joined bodies without springs; 0 if bodies are not joined [force/length]
    real(wp) :: norm = 0.0_wp
  end type spring_set

  type :: body_stiffness
    class(assembled_matrix), allocatable :: matrix   !! the stiffness, then its factor
    logical :: lacks_memory = .false.         !! the memory was too small for it
    real(wp) :: smallest_ratio = 1.0_wp       !! smallest pivot over its diagonal entry
    !> Estimated condition in the 1-norm; 0 if it has not been estimated for this factor
    real(wp) :: condition = 0.0_wp
  contains
    procedure :: assemble
    procedure, private :: begin
    procedure :: factor
    procedure :: is_sound
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
  end type assembly

contains

  !> Assemble the elements of a body, and factor fronts as soon as they are complete. If only some elements
  !! have changed since the last factorization, the independent part of the factor stays.
  subroutine assemble(self, scene, operator, law, spring, b)
    class(body_stiffness), intent(inout), target :: self
    type(planned_model), intent(in), target :: scene        !! with equation numbers
    type(strain_operator), intent(in), target :: operator   !! strains of nodal displacements
    type(linear_law), intent(in), target :: law             !! with marks where it has changed
    type(spring_set), intent(in), target :: spring          !! springs of its parts
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
        if (self%is_sound()) call work%find_stale()
        call self%matrix%clear(work%stale(1:))
      end if
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
    end associate
  end subroutine assemble

  !> Begin a matrix of zeros of the kind chosen by the plan.
  subroutine begin(self, body, once)
    class(body_stiffness), intent(inout) :: self
    type(body_numbering), intent(in) :: body
    logical, intent(in) :: once   !! it is factored only once
    type(front_matrix), allocatable :: fronts
    type(panel_matrix), allocatable :: panels

    if (body%solver == solver_frontal) then
      allocate (fronts)
      call fronts%begin(body%fronts, once, body%contact_equations)
      call move_alloc(fronts, self%matrix)
    else
      allocate (panels)
      call panels%begin(body%panels, body%contact_equations)
      call move_alloc(panels, self%matrix)
    end if
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
        if (all(number >= 0)) cycle
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
    !$ deferred = omp_get_num_threads() > 1
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

    associate (model => self%scene%model)
      number = self%scene%numbering%of_element(model, element)
      n = directions*model%mesh%node_count(element)
      if (any(number(:n) < 0)) then
        call self%add_sums(element, n, number(:n))
        return
      end if
      if (.not. any(self%stale(number(:n)))) return
      call self%operator%element_stiffness(model, element, self%law, n, k)
      call self%stiffness%matrix%add(n, number, k)
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

  !> Factor the matrix.
  subroutine factor(self)
    class(body_stiffness), intent(inout) :: self
    integer :: at

    self%smallest_ratio = 0.0_wp
    self%condition = 0.0_wp
    if (.not. self%lacks_memory) call self%matrix%factor(self%smallest_ratio, at)
  end subroutine factor

  !> Is the factor usable?
  pure logical function is_sound(self)
    class(body_stiffness), intent(in) :: self

    is_sound = self%smallest_ratio > epsilon(1.0_wp)
  end function is_sound

  !> Estimate the condition in the 1-norm with two solves for two columns each, once for a factor. The norm of
  !! the inverse is a lower bound, seldom below a third (Higham and Tisseur, SIAM J. Matrix Anal. Appl. 21
  !! (2000) 1185). `dlacn2` takes five solves for one column, which take 2.5 times as long because reading the
  !! factor dominates.
  subroutine estimate_condition(self)
    class(body_stiffness), intent(inout) :: self
    real(wp) :: x(self%matrix%order, 2), inverse_norm

    if (self%condition > 0.0_wp) return
    x = probes(self%matrix%order)
    call self%matrix%solve(x)
    inverse_norm = maxval(sum(abs(x), dim=1))
    x = sign(1.0_wp, x)   ! the inverse is symmetric: sums of rows are sums of columns
    call self%matrix%solve(x)
    self%condition = max(1.0_wp, self%matrix%norm*maxval([inverse_norm, abs(x)]))
  end subroutine estimate_condition
end module epcont_assembly_stiffness
