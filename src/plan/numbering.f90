!> Equation numbers of each body: a narrow band, with the contact DOFs last if possible, or nested fronts.
module epcont_plan_numbering
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_linalg_front_layout, only: front_layout, new_front_layout
  use epcont_linalg_panel_layout, only: new_panel_layout, panel_layout
  use epcont_model_arrays, only: angle
  use epcont_model_controls, only: solver_auto, solver_band, solver_frontal
  use epcont_model_model, only: model_type
  use epcont_plan_dissection, only: dissect, dissection
  use epcont_plan_level_order, only: level_order, sweep
  use epcont_plan_sums, only: find_sums, find_terms, find_wanted, followed_nodes, &
      spring_rows
  implicit none
  private
  public :: body_numbering, numbering_type, number_equations

  !> SOLVER AUTO uses FRONTAL if a band takes more operations. At this number both take the same time, for
  !! compact bodies (two cylinders with 7 000 nodes) and long ones, elastic or yielding.
  real(wp), parameter, public :: many_operations = 2.0e8_wp
  !> SOLVER AUTO also uses FRONTAL if a long contact makes the band so wide that it takes more operations than
  !! this, and than this multiple of those of the narrowest band and of the fronts. (Strips with 50 to 800
  !! pairs, 4 to 14 elements high: the same time at 1e7, 1.5 times as fast at 1e8; fronts need some time to be
  !! found.)
  real(wp), parameter :: many_of_contact = 2.0e7_wp, times_faster = 4.0_wp

  !> System of equations of one body.
  type :: body_numbering
    integer, allocatable :: node(:)        !! its nodes, in the order of the equations
    integer, allocatable :: element(:)     !! its elements
    integer, allocatable :: part(:)        !! elements and springs (numbered after the elements) by fronts
    type(sparse_rows) :: spring            !! of fronts, one row for each
    integer :: equations = 0
    integer :: contact_equations = 0       !! number of equations that gaps depend on, which are the last
    !> First of the contact equations, or of the fronts that pairs act on if bodies are joined; equations + 1
    !! if the body has none
    integer :: first_contact = 1
    logical :: can_yield = .false.
    logical :: is_tied = .false.           !! several DOFs may share an equation, or it has springs
    integer :: solver = solver_band        !! or solver_frontal
    type(front_layout) :: fronts           !! of solver_frontal
    type(panel_layout) :: panels           !! of solver_band
    real(wp) :: operations = 0.0_wp        !! of factor and flexibility
    integer :: half_bandwidth = 0
    type(sparse_rows) :: tied              !! DOFs that are sums of equations
  end type body_numbering

  type :: numbering_type
    logical :: joined = .false.            !! all bodies form one system, joined by pairs
    !> Equation of each DOF in its body: positive; 0 if fixed; minus a row of `tied` if it is a sum
    !! [directions, nodes]
    integer, allocatable :: equation(:, :)
    type(body_numbering), allocatable :: body(:)   !! [bodies], or one if they are joined
  contains
    procedure :: of_element
  end type numbering_type

  !> Operations of the flexibility, divided by the cube of the number of contact equations, which are last.
  real(wp), parameter :: of_inversion = 1.0_wp

  !> DOFs of an element.
  integer, parameter, public :: most_freedoms = directions*most_nodes

  !> A numbering that is being made. The DOFs of a node are x, y, and the angle of the platens that it leads.
  type, extends(numbering_type) :: numberer
    logical, allocatable :: free(:, :)      !! the DOF has an unknown of its own [angle, nodes]
    logical, allocatable :: wanted(:, :)    !! gaps depend on the DOF, and it is numbered last [angle, nodes]
    integer, allocatable :: pair(:)         !! first pair of each node; 0 if it has no pair [nodes]
    logical, allocatable :: leads(:)        !! DOFs of other nodes depend on the node [nodes]
    integer, allocatable :: angles(:)       !! equation of each platen's angle; 0 if it is not free [platens]
    integer, allocatable :: own(:)          !! nodes of the body that is being numbered
    logical, allocatable :: seen(:)         !! work space of sweeps [nodes]
  contains
    procedure :: number_body
    procedure :: number_fronts
    procedure :: number_by_fronts
    procedure :: number_band
    procedure :: number_panels
    procedure :: number_freedoms
    procedure :: number_last
    procedure :: equations_of
  end type numberer

contains

  !> Number all bodies, each for the solver that the deck requests, or for the faster one.
  function number_equations(model, joined) result(numbering)
    type(model_type), intent(in) :: model
    logical, intent(in) :: joined           !! all bodies as one system
    type(numbering_type) :: numbering
    type(numberer) :: work
    type(incidence) :: elements, nodes      ! elements and nodes of each body
    integer :: b, i

    allocate (work%equation(directions, model%mesh%nodes), work%pair(model%mesh%nodes), source=0)
    allocate (work%body(merge(1, model%mesh%bodies, joined)), work%seen(model%mesh%nodes))
    allocate (work%free(angle, model%mesh%nodes), work%wanted(angle, model%mesh%nodes), source=.false.)
    work%joined = joined
    associate (ties => model%constraints)
      work%angles = spread(0, 1, size(ties%platen))
      work%free(:directions, :) = .not. (ties%held .or. ties%reference .and. .not. joined) .and. &
        ties%sum_of == 0 .and. ties%leader == spread([(i, i=1, model%mesh%nodes)], 1, directions)
      work%free(angle, pack(ties%platen%leader, .not. ties%platen%held .and. &
                            (joined .or. .not. ties%platen%reference))) = .true.
    end associate
    work%leads = followed_nodes(model)
    if (joined) then
      work%own = [(i, i=1, model%mesh%nodes)]
      work%body(1)%element = [(i, i=1, model%mesh%elements)]
      call work%number_body(model, 1)
    else
      call find_wanted(model, work%pair, work%wanted)
      nodes = new_incidence(reshape(model%mesh%body, [1, model%mesh%nodes]), model%mesh%bodies)
      elements = model%mesh%elements_of_bodies()
      do b = 1, model%mesh%bodies
        work%own = nodes%of(b)
        work%body(b)%element = elements%of(b)
        call work%number_body(model, b)
      end do
    end if
    numbering%joined = joined
    call move_alloc(work%equation, numbering%equation)
    call move_alloc(work%body, numbering%body)
  end function number_equations

  !> Number one body, or all bodies as one.
  subroutine number_body(self, model, b)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b

    associate (body => self%body(b))
      body%can_yield = any(model%can_yield(body%element))
      body%is_tied = self%joined .or. any(self%leads(self%own))
      if (size(body%element) == 0) then
        call self%number_panels(model, b, (self%own))
      else if (self%joined .or. model%controls%solver == solver_frontal) then
        call self%number_fronts(model, b)
      else
        call self%number_band(model, b)
      end if
    end associate
  end subroutine number_body

  !> Number a body for nested fronts; DOFs that gaps depend on are in the last front, with the master DOFs,
  !! which are coupled with whole lines of nodes. The body is dissected along x, y, their diagonals and the
  !! distance from the contact, measured in elements, which are smallest there.
  subroutine number_fronts(self, model, b)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    type(level_order) :: outward
    type(incidence), allocatable :: pairs   ! of each node, if they join bodies
    real(wp) :: distance(model%mesh%nodes)
    integer, allocatable :: first(:), roots(:)
    integer :: i

    if (self%joined) then
      distance = 2.0_wp*model%mesh%x(1, :) + model%mesh%x(2, :)
      pairs = new_incidence(model%contact%nodes_of_rows(), model%mesh%nodes)
    else
      roots = pack(self%own, self%pair(self%own) > 0)
      if (size(roots) == 0) roots = self%own(:1)
      call sweep(model, self%own, roots, self%seen, outward)
      distance(outward%node) = [(real(i, wp), i=1, size(self%own))]
    end if
    call self%number_by_fronts(model, b, dissect(model, distance, self%own, self%leads .or. &
      any(self%wanted, dim=1) .and. .not. any(self%free .and. .not. self%wanted, dim=1), pairs), first)
    if (self%body(b)%equations == 0) then
      call self%number_panels(model, b, (self%own))
      return
    end if
    associate (body => self%body(b))
      body%solver = solver_frontal
      body%fronts = new_front_layout(first, self%equations_of(model, b))
      body%operations = body%fronts%operations() + of_inversion*real(body%contact_equations, wp)**3
      body%part = body%part(body%fronts%element)
      body%element = pack(body%part, body%part <= model%mesh%elements)
    end associate
  end subroutine number_fronts

  !> Number the DOFs of a body front by front. If bodies are joined, the fronts into which no DOFs of pairs
  !! and SUPORT are eliminated are first.
  subroutine number_by_fronts(self, model, b, found, first)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    type(dissection), intent(in) :: found
    integer, allocatable, intent(out) :: first(:)    !! equation of each front, and one more [fronts + 1]
    logical :: acted(model%mesh%nodes)   ! pairs or SUPORT act on the node
    integer, allocatable :: order(:)
    integer :: apart, i, p

    acted = any(model%constraints%reference, dim=1) .and. self%joined
    if (self%joined) acted(model%contact%row_node) = .true.
    associate (acts => [(any(acted(found%node(found%below(p):found%first(p + 1) - 1))), &
                         p=1, size(found%below))])
      order = [pack([(p, p=1, size(acts))], .not. acts), pack([(p, p=1, size(acts))], acts)]
      apart = count(.not. acts)
    end associate
    associate (body => self%body(b), from => found%first(order), to => found%first(order + 1) - 1)
      body%node = [((found%node(i), i=from(p), to(p)), p=1, size(order))]
      allocate (first(size(order) + 1))
      body%equations = 0
      do p = 1, size(order)
        first(p) = body%equations + 1
        if (p == apart + 1) body%first_contact = first(p)
        call self%number_freedoms(model, found%node(from(p):to(p)), .false., body%equations)
      end do
      call self%number_last(model, b, pack(body%node, any(self%wanted(:, body%node), dim=1)))
      first(size(first)) = body%equations + 1
      first = pack(first, [first(2:) > first(:size(order)), .true.])
    end associate
  end subroutine number_by_fronts

  !> Number a body for a band, in reverse Cuthill-McKee order, with levels rooted at the contact nodes: then
  !! the trailing block of the factor gives the flexibility, and yielding elements, which are near the
  !! contact, are late. If this takes many operations, fronts are used, or the method with fewer operations.
  subroutine number_band(self, model, b)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    type(body_numbering) :: band
    integer, allocatable :: equation(:, :), roots(:)
    type(level_order) :: order
    logical :: may_choose
    real(wp) :: least   ! no band of a body with this number of levels takes fewer operations
    integer :: n

    n = size(self%own)
    may_choose = model%controls%solver == solver_auto
    call sweep(model, self%own, self%own(:1), self%seen, order)
    call sweep(model, self%own, [order%node(n)], self%seen, order)
    least = 2.0_wp*n*(2.0_wp*n/order%levels)**2
    if (may_choose .and. least > many_operations) then
      call self%number_fronts(model, b)
      return
    end if
    call sweep(model, self%own, [order%node(n)], self%seen, order)
    ! The roots have the order of the sweep from the far end, which runs along the contact.
    roots = pack(order%node, self%pair(order%node) > 0)
    if (size(roots) > 0) call sweep(model, self%own, roots, self%seen, order)
    call self%number_panels(model, b, order%node(n:1:-1))
    if (.not. may_choose .or. self%body(b)%operations <= max(many_of_contact, times_faster*least)) return
    band = self%body(b)
    equation = self%equation(:, self%own)
    call self%number_fronts(model, b)
    if (band%operations > min(many_operations, times_faster*self%body(b)%operations)) return
    self%equation(:, self%own) = equation
    self%body(b) = band
  end subroutine number_band

  !> Number a body for a band, with panels that reach down to the last equation coupled with each.
  subroutine number_panels(self, model, b, order)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    integer, intent(in) :: order(:)   !! nodes of the body
    type(incidence) :: equations      ! of elements and springs
    integer, allocatable :: profile(:)
    integer :: e, i

    associate (body => self%body(b))
      body%node = order
      body%equations = 0
      call self%number_freedoms(model, order, .false., body%equations)
      call self%number_last(model, b, order)
      equations = self%equations_of(model, b)
      profile = [(i, i=1, body%equations)]
      do e = 1, size(body%part)
        associate (number => equations%of(e))
          do i = 1, size(number)
            if (number(i) > 0) profile(number(i)) = max(profile(number(i)), maxval(number))
          end do
        end associate
      end do
      body%half_bandwidth = maxval([profile - [(i, i=1, body%equations)], 0])
      body%panels = new_panel_layout(profile)
      body%operations = body%panels%operations() + of_inversion*real(body%contact_equations, wp)**3
    end associate
  end subroutine number_panels

  !> Number the free DOFs of some nodes.
  subroutine number_freedoms(self, model, node, wanted, equations)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: node(:)
    logical, intent(in) :: wanted      !! number the DOFs that gaps depend on, otherwise the other DOFs
    integer, intent(inout) :: equations
    integer :: c, i, k

    do i = 1, size(node)
      do c = 1, directions
        if (.not. self%free(c, node(i)) .or. (self%wanted(c, node(i)) .neqv. wanted)) cycle
        equations = equations + 1
        self%equation(c, node(i)) = equations
      end do
      if (.not. self%free(angle, node(i)) .or. (self%wanted(angle, node(i)) .neqv. wanted)) cycle
      do k = 1, size(self%angles)
        associate (platen => model%constraints%platen(k))
          if (platen%leader /= node(i) .or. platen%held .or. platen%reference .and. .not. self%joined) cycle
        end associate
        equations = equations + 1
        self%angles(k) = equations
      end do
    end do
  end subroutine number_freedoms

  !> Number the DOFs that gaps depend on; then give all other DOFs of the body their equation or their sum,
  !! and list elements and springs.
  subroutine number_last(self, model, b, contact)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    integer, intent(in) :: contact(:)   !! nodes with such DOFs, in their order; others are ignored
    integer :: i

    associate (body => self%body(b), ties => model%constraints)
      if (.not. self%joined) body%first_contact = body%equations + 1
      call self%number_freedoms(model, contact, .true., body%equations)
      if (.not. self%joined) body%contact_equations = body%equations + 1 - body%first_contact
      call find_sums(model, self%own, self%angles, self%equation, body%tied)
      do i = 1, size(self%own)
        self%equation(:, self%own(i)) = [self%equation(1, ties%leader(1, self%own(i))), &
                                         self%equation(2, ties%leader(2, self%own(i)))]
      end do
      body%spring = spring_rows(model, self%joined, self%own, self%equation, self%angles, body%tied)
      body%part = [body%element, (model%mesh%elements + i, i=1, size(body%spring%start) - 1)]
    end associate
  end subroutine number_last

  !> Equations of the elements of a body, then of its springs. If the DOFs of an element are sums, these are
  !! the equations in the sums.
  function equations_of(self, model, b) result(equations)
    class(numberer), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    type(incidence) :: equations
    integer, allocatable :: freedom(:), own(:)
    real(wp), allocatable :: weight(:)
    integer :: e, element, last, n, number(most_freedoms)

    element = size(self%body(b)%element)
    allocate (equations%start(element + 1), equations%group(most_freedoms*element))
    last = 0
    do e = 1, element
      equations%start(e) = last + 1
      n = directions*model%mesh%node_count(self%body(b)%element(e))
      number = self%of_element(model, self%body(b)%element(e))
      own = number(:n)
      if (any(own < 0)) call find_terms(self%body(b)%tied, number(:n), own, freedom, weight)
      if (last + size(own) > size(equations%group)) equations%group = [equations%group, equations%group, own]
      equations%group(last + 1:last + size(own)) = own
      last = last + size(own)
    end do
    equations%start(element + 1) = last + 1
    equations%group = equations%group(:last)
    associate (spring => self%body(b)%spring)
      equations = incidence([equations%start, last + spring%start(2:)], [equations%group, spring%equation])
    end associate
  end function equations_of

  !> Equations of an element, x and y of its nodes in turn, then zeros.
  pure function of_element(self, model, element) result(number)
    class(numbering_type), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: element             !! its number
    integer :: number(most_freedoms)
    integer :: i

    number = 0
    do i = 1, model%mesh%node_count(element)
      number(directions*(i - 1) + 1:directions*i) = self%equation(:, model%mesh%connectivity(i, element))
    end do
  end function of_element
end module epcont_plan_numbering
