!> Equation numbers of each body: a narrow band, with the contact DOFs last if possible, or nested fronts.
module epcont_plan_numbering
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_element_element_kind, only: most_nodes
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_linalg_front_layout, only: front_layout, new_front_layout
  use epcont_linalg_panel_layout, only: new_panel_layout, panel_layout
  use epcont_model_controls, only: solver_auto, solver_band, solver_frontal
  use epcont_model_model, only: model_type
  use epcont_plan_border, only: number_border
  use epcont_plan_contact_axes, only: contact_axes, new_contact_axes
  use epcont_plan_dissection, only: dissect, dissection
  use epcont_plan_joined_numbering, only: find_terms, number_joined, spring_rows
  use epcont_plan_level_order, only: level_order, sweep
  implicit none
  private
  public :: body_numbering, numbering_type, number_equations

  !> SOLVER AUTO uses FRONTAL if a band takes more operations. At this number both take the same time, for
  !! compact bodies (two cylinders with 7 000 nodes) and long ones, elastic or yielding.
  real(wp), parameter, public :: many_operations = 2.0e8_wp
  !> SOLVER AUTO also uses FRONTAL if the flexibility with a band takes more operations than this, and fronts
  !! take fewer in all. Measured with factor and numbering, on two strips with 50 to 800 pairs, 4 to 14
  !! elements high: equal at 1e7, 1.2 times as fast at 3e7, 1.5 at 1e8, 2.4 at 2e9.
  real(wp), parameter, public :: many_of_flexibility = 2.0e7_wp

  !> System of equations of one body.
  type :: body_numbering
    integer, allocatable :: node(:)        !! its nodes, in the order of the equations
    integer, allocatable :: element(:)     !! its elements
    integer, allocatable :: part(:)        !! elements and springs (numbered after the elements) by fronts
    type(sparse_rows) :: spring            !! of joined bodies, one row for each
    integer :: equations = 0               !! without the border
    integer :: contact_equations = 0       !! number of equations that gaps depend on
    logical :: contact_last = .true.       !! the contact equations are the last ones
    integer :: first_contact = 1           !! first contact equation; equations + 1 if the body has none
    logical :: can_yield = .false.
    integer :: solver = solver_band        !! or solver_frontal
    type(front_layout) :: fronts           !! of solver_frontal
    type(panel_layout) :: panels           !! of solver_band
    real(wp) :: operations = 0.0_wp        !! of factor and flexibility
    integer :: half_bandwidth = 0
    integer :: border = 0                  !! number of free master DOFs, which are kept out of the band
    !> Sums that DOFs with negative numbers are, of DOFs in the border; the first rows are each one of these
    type(sparse_rows) :: tied
  end type body_numbering

  type :: numbering_type
    logical :: joined = .false.            !! all bodies form one system, joined by pairs
    type(contact_axes) :: axes             !! directions of the DOFs, and DOFs that gaps depend on
    !> Equation of each DOF in its body: positive in the band or the fronts; 0 if fixed; minus a row of
    !! `tied`. A tied DOF has the number of its master, which is never positive. [directions, nodes]
    integer, allocatable :: equation(:, :)
    type(body_numbering), allocatable :: body(:)   !! [bodies], or one if they are joined
  contains
    procedure :: of_element
  end type numbering_type

  !> Operations of the flexibility if the contact equations are last, divided by the cube of their number. The
  !! inverse, or right-hand sides and their product (`linalg/staircase.f90`), take 2/3; copies take the rest
  !! of the time (1.5e-11 s times the cube in all, for 1 000 to 3 000 equations).
  real(wp), parameter :: of_inversion = 1.0_wp

  !> DOFs of an element.
  integer, parameter, public :: most_freedoms = directions*most_nodes

  !> A numbering that is being made.
  type, extends(numbering_type) :: numberer
    logical, allocatable :: free(:, :)      !! the DOF has an unknown of its own [directions, nodes]
    logical, allocatable :: stands_last(:)  !! gaps depend on all free DOFs of the node [nodes]
    integer, allocatable :: own(:)          !! nodes of the body that is being numbered
    logical, allocatable :: seen(:)         !! work space of sweeps [nodes]
  contains
    procedure :: number_all
    procedure :: number_body
    procedure :: number_fronts
    procedure :: number_band
    procedure :: root_at_contact
    procedure :: number_nodes
    procedure :: number_freedoms
    procedure :: number_panels
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
    logical :: fixed(directions, model%mesh%nodes)
    integer :: b, i

    allocate (work%equation(directions, model%mesh%nodes), source=0)
    allocate (work%body(merge(1, model%mesh%bodies, joined)), work%seen(model%mesh%nodes))
    fixed = model%constraints%held .or. model%constraints%reference
    work%free = .not. fixed .and. model%constraints%sum_of == 0 .and. &
                model%constraints%leader == spread([(i, i=1, model%mesh%nodes)], 1, directions)
    work%axes = new_contact_axes(model, fixed)
    work%stands_last = work%axes%pair > 0 .and. .not. any(work%free .and. .not. work%axes%wanted, dim=1)
    if (joined) then
      call work%number_all(model)
    else
      nodes = new_incidence(reshape(model%mesh%body, [1, model%mesh%nodes]), model%mesh%bodies)
      elements = model%mesh%elements_of_bodies()
      do b = 1, model%mesh%bodies
        work%own = nodes%of(b)
        work%body(b)%element = elements%of(b)
        call work%number_body(model, b)
      end do
    end if
    numbering%joined = joined
    numbering%axes = work%axes
    call move_alloc(work%equation, numbering%equation)
    call move_alloc(work%body, numbering%body)
  end function number_equations

  !> Number all bodies as one. No part of the inverse is needed for gaps.
  subroutine number_all(self, model)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, allocatable :: first(:)
    integer :: angles(size(model%constraints%platen)), i

    self%joined = .true.
    call self%axes%ask_nothing()
    associate (all => self%body(1))
      call number_joined(model, self%equation, angles, all%tied, all%node, first, all%first_contact)
      all%spring = spring_rows(model, self%equation, angles, all%tied)
      all%element = [(i, i=1, model%mesh%elements)]
      all%equations = first(size(first)) - 1
      all%can_yield = any(model%can_yield(all%element))
      all%solver = solver_frontal
      all%fronts = new_front_layout(first, self%equations_of(model, 1))
      all%operations = all%fronts%operations()
      all%part = all%fronts%element
      all%element = pack(all%part, all%part <= model%mesh%elements)
    end associate
  end subroutine number_all

  !> Number one body.
  subroutine number_body(self, model, b)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b

    self%body(b)%can_yield = any(model%can_yield(self%body(b)%element))
    if (size(self%body(b)%element) == 0) then
      call self%number_panels(model, b, (self%own))
    else if (model%controls%solver == solver_frontal) then
      call self%number_fronts(model, b)
    else
      call self%number_band(model, b)
    end if
    self%body(b)%part = self%body(b)%element
  end subroutine number_body

  !> Number a body for nested fronts; DOFs that gaps depend on are in the last front. The body is dissected
  !! along x, y, their diagonals and the distance from the contact, measured in elements, which are smallest
  !! there.
  subroutine number_fronts(self, model, b)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    type(level_order) :: outward
    type(dissection) :: found
    real(wp) :: distance(model%mesh%nodes)
    integer, allocatable :: first(:), roots(:)
    integer :: i, others

    roots = pack(self%own, self%axes%pair(self%own) > 0)
    if (size(roots) == 0) roots = self%own(:1)
    call sweep(model, self%own, roots, self%seen, outward)
    distance(outward%node) = [(real(i, wp), i=1, size(self%own))]
    found = dissect(model, distance, self%own, self%stands_last)
    self%body(b)%contact_last = .true.
    self%body(b)%solver = solver_frontal
    call self%number_nodes(model, b, found%node)
    if (self%body(b)%equations == 0) then
      self%body(b)%solver = solver_band
      call self%number_panels(model, b, found%node)
      return
    end if
    ! Some fronts have no equations. The last front has the contact equations.
    allocate (first(size(found%first) + 1), source=1)
    do i = 2, size(found%first)
      associate (node => found%node(found%first(i - 1):found%first(i) - 1))
        others = count(self%equation(:, node) > 0 .and. .not. self%axes%wanted(:, node))
      end associate
      first(i) = first(i - 1) + others
    end do
    associate (body => self%body(b))
      first(size(first)) = body%equations + 1
      body%fronts = new_front_layout(pack(first, [first(2:) > first(:size(first) - 1), .true.]), &
                                     self%equations_of(model, b))
      body%operations = body%fronts%operations() + of_inversion*real(body%contact_equations, wp)**3
      body%element = body%element(body%fronts%element)
    end associate
  end subroutine number_fronts

  !> Number a body for a band, in reverse Cuthill-McKee order. If its levels are rooted at the contact nodes,
  !! the contact DOFs can come last, and the trailing block of the factor gives the flexibility. If this
  !! widens the band by more than forward substitution of all pairs costs, the levels are rooted at the far
  !! end of the body. If the band is wide even then, or if the flexibility takes much work and less with
  !! fronts (long contacts of slender bodies), fronts are used.
  subroutine number_band(self, model, b)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    type(body_numbering) :: band
    integer, allocatable :: equation(:, :)
    type(level_order) :: order
    logical :: may_choose
    integer :: i, n

    n = size(self%own)
    may_choose = model%controls%solver == solver_auto
    call sweep(model, self%own, self%own(:1), self%seen, order)
    ! No band of a body with this number of levels is narrower than that of levels with equal widths.
    if (may_choose .and. 2.0_wp*n*(2.0_wp*n/order%levels)**2 > many_operations) then
      call self%number_fronts(model, b)
      return
    end if
    call sweep(model, self%own, [order%node(n)], self%seen, order)
    call sweep(model, self%own, [order%node(n)], self%seen, order)
    ! The contact, and with it the yielding elements, is late in the reversed order: the part before is
    ! factored once.
    associate (place => pack([(real(i, wp), i=1, n)], self%axes%pair(order%node) > 0))
      if (sum(place) > 0.5_wp*size(place)*n) call sweep(model, self%own, [order%node(n)], self%seen, order)
    end associate
    self%body(b)%contact_last = .false.
    call self%number_panels(model, b, order%node(n:1:-1))
    self%body(b)%operations = self%body(b)%panels%operations()
    if (may_choose .and. self%body(b)%operations > many_operations) then
      call self%number_fronts(model, b)
    else if (any(self%axes%pair(self%own) > 0)) then
      ! The roots have the order of the sweep from the far end, which runs along the contact.
      call self%root_at_contact(model, b, pack(order%node, self%axes%pair(order%node) > 0))
      band = self%body(b)
      if (.not. may_choose .or. band%operations - band%panels%operations() <= many_of_flexibility) return
      equation = self%equation(:, self%own)
      call self%number_fronts(model, b)
      if (self%body(b)%operations <= band%operations) return
      self%equation(:, self%own) = equation
      self%body(b) = band
    end if
  end subroutine number_band

  !> Number a body again with the contact last, if that takes fewer operations or is requested.
  subroutine root_at_contact(self, model, b, roots)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    integer, intent(in) :: roots(:)       !! contact nodes
    type(body_numbering) :: plain
    type(level_order) :: order
    integer, allocatable :: begins(:), equation(:, :)

    begins = maxval(self%equation(:, roots), dim=1)
    plain = self%body(b)
    plain%operations = plain%operations + plain%panels%compliance_operations(pack(begins, begins > 0))
    equation = self%equation(:, self%own)
    call sweep(model, self%own, roots, self%seen, order)
    self%body(b)%contact_last = .true.
    call self%number_panels(model, b, order%node(size(self%own):1:-1))
    associate (body => self%body(b))
      body%operations = body%panels%operations() + of_inversion*real(body%contact_equations, wp)**3
      if (model%controls%by_inversion .or. body%operations <= plain%operations) return
    end associate
    self%equation(:, self%own) = equation
    self%body(b) = plain
  end subroutine root_at_contact

  !> Number the DOFs of a body in an order of its nodes. If the contact DOFs are to be last, they have this
  !! order too; with fronts, that of their pairs: then the inverse of their block has the order of the gaps.
  subroutine number_nodes(self, model, b, order)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b                 !! has a solver, and says whether contact DOFs are last
    integer, intent(in) :: order(:)
    integer, allocatable :: contact(:)
    integer :: equations

    associate (body => self%body(b))
      body%node = order
      equations = 0
      call number_border(model, order, self%equation, body%border, body%tied)
      contact = pack(order, self%axes%pair(order) > 0)
      if (body%contact_last) then
        call self%number_freedoms(order, [.false.], equations)
        if (body%solver == solver_frontal) contact = contact(sorted_order(self%axes%pair(contact)))
        call self%number_freedoms(contact, [.true.], equations)
      else
        call self%number_freedoms(order, [.false., .true.], equations)
      end if
      body%equations = equations
      associate (at_contact => pack(self%equation(:, contact), self%axes%wanted(:, contact)))
        body%contact_equations = count(at_contact > 0)
        body%first_contact = minval([at_contact, equations + 1], mask=[at_contact, 1] > 0)
      end associate
    end associate
  end subroutine number_nodes

  !> Number the DOFs of some nodes that are free and not in the border.
  subroutine number_freedoms(self, node, wanted, equations)
    class(numberer), intent(inout) :: self
    integer, intent(in) :: node(:)
    logical, intent(in) :: wanted(:)   !! number the DOFs that gaps depend on, the other DOFs, or both
    integer, intent(inout) :: equations
    integer :: c, i

    do i = 1, size(node)
      do c = 1, directions
        if (.not. self%free(c, node(i)) .or. self%equation(c, node(i)) < 0) cycle
        if (all(self%axes%wanted(c, node(i)) .neqv. wanted)) cycle
        equations = equations + 1
        self%equation(c, node(i)) = equations
      end do
    end do
  end subroutine number_freedoms

  !> Number a body for a band, with panels that reach down to the last equation coupled with each.
  subroutine number_panels(self, model, b, order)
    class(numberer), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: b
    integer, intent(in) :: order(:)
    integer, allocatable :: profile(:)
    integer :: e, i, last, number(most_freedoms)

    call self%number_nodes(model, b, order)
    associate (body => self%body(b))
      profile = [(i, i=1, body%equations)]
      do e = 1, size(body%element)
        number = self%of_element(model, body%element(e))
        last = maxval(number)
        do i = 1, most_freedoms
          if (number(i) > 0) profile(number(i)) = max(profile(number(i)), last)
        end do
      end do
      body%half_bandwidth = maxval([profile - [(i, i=1, body%equations)], 0])
      body%panels = new_panel_layout(profile)
    end associate
  end subroutine number_panels

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
      if (self%joined .and. any(own < 0)) call find_terms(self%body(1)%tied, number(:n), own, freedom, weight)
      if (last + size(own) > size(equations%group)) equations%group = [equations%group, equations%group, own]
      equations%group(last + 1:last + size(own)) = own
      last = last + size(own)
    end do
    equations%start(element + 1) = last + 1
    equations%group = equations%group(:last)
    if (.not. self%joined) return
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
