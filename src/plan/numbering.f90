!> Numbers of the equations of each body: a narrow band, with the contact freedoms last, or nested fronts.
module epcont_plan_numbering
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_element_element_kind, only: most_nodes
  use epcont_linalg_front_layout, only: front_layout, new_front_layout
  use epcont_linalg_panel_layout, only: new_panel_layout, panel_layout
  use epcont_model_controls, only: solver_auto, solver_band, solver_frontal
  use epcont_model_model, only: model_type
  use epcont_plan_dissection, only: dissect, dissection
  implicit none
  private
  public :: body_numbering, numbering_type, number_equations

  !> Operations that a band takes from which on SOLVER AUTO is FRONTAL: there both are level, on compact
  !! bodies (7 000 nodes of two cylinders) and on long ones, on elastic ones and on those that yield.
  real(wp), parameter, public :: many_operations = 2.0e8_wp

  !> One body's system of equations.
  type :: body_numbering
    integer, allocatable :: node(:)        !! its nodes, in the order of the equations
    integer, allocatable :: element(:)     !! its elements
    integer :: equations = 0               !! in the band
    integer :: contact_equations = 0       !! of these at nodes of pairs
    logical :: contact_last = .true.       !! the contact equations are the last ones
    integer :: first_contact = 1           !! the first of them; behind the last equation where there is none
    logical :: can_yield = .false.
    integer :: solver = solver_band        !! or solver_frontal
    type(front_layout) :: fronts           !! of solver_frontal
    type(panel_layout) :: panels           !! of solver_band
    real(wp) :: operations = 0.0_wp        !! of factor and flexibility
    integer :: half_bandwidth = 0
    integer :: border = 0                  !! leaders of ties that nothing holds, kept out of the band
  end type body_numbering

  type :: numbering_type
    !> Equation of each freedom in its body: positive in the band, negative in the border, 0 held. [2, nodes]
    integer, allocatable :: equation(:, :)
    logical, allocatable :: at_contact(:)  !! the node is one of a pair [nodes]
    type(body_numbering), allocatable :: body(:)
  contains
    procedure :: of_element
  end type numbering_type

  !> Nodes in levels: each level has the neighbours of the one before.
  type :: level_order
    integer, allocatable :: node(:)
    integer :: levels = 0
  end type level_order

contains

  !> Number all bodies, each for the solver that the deck asks for, or that which is faster.
  pure function number_equations(model) result(numbering)
    type(model_type), intent(in) :: model   !! the scene
    type(numbering_type) :: numbering
    type(incidence) :: elements, nodes
    integer :: b

    allocate (numbering%at_contact(model%nodes), source=.false.)
    numbering%at_contact(model%row_node) = .true.
    allocate (numbering%equation(2, model%nodes), source=0)
    nodes = new_incidence(reshape(model%body, [1, model%nodes]), model%bodies)
    elements = new_incidence(reshape(model%body(model%connectivity(1, :)), [1, model%elements]), model%bodies)
    allocate (numbering%body(model%bodies))
    do b = 1, model%bodies
      associate (body => numbering%body(b))
        body%node = nodes%group(nodes%start(b):nodes%start(b + 1) - 1)
        body%element = elements%group(elements%start(b):elements%start(b + 1) - 1)
        body%can_yield = any(model%can_yield(body%element))
        if (size(body%element) == 0) then
          call number_nodes(model, (body%node), numbering, b)
          call find_panels(model, numbering, b)
        else if (model%controls%solver == solver_frontal) then
          call number_fronts(model, numbering, b)
        else
          call number_band(model, numbering, b)
        end if
      end associate
    end do
  end function number_equations

  !> Number a body for nested fronts, the contact nodes in the last of them. It is parted along x, along y and
  !! along the distance from the contact, in elements: there they are the smallest, mostly, and what lies
  !! around it has the shortest edge.
  pure subroutine number_fronts(model, numbering, b)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(inout) :: numbering
    integer, intent(in) :: b
    type(level_order) :: outward
    type(dissection) :: found
    real(wp) :: distance(model%nodes)
    integer, allocatable :: first(:), roots(:)
    integer :: i, p

    associate (body => numbering%body(b))
      roots = pack(body%node, numbering%at_contact(body%node))
      if (size(roots) == 0) roots = body%node(:1)
      outward = sweep(model, roots, body%node)
      do i = 1, size(outward%node)
        distance(outward%node(i)) = i
      end do
      found = dissect(model, distance, body%element, body%node, numbering%at_contact)
      call number_nodes(model, found%node, numbering, b)
      if (body%equations == 0) then
        call find_panels(model, numbering, b)
        return
      end if
      body%solver = solver_frontal
      body%contact_last = .true.
      ! A front's equations follow on one another, and some fronts have none.
      allocate (first(size(found%first)), source=1)
      do p = 1, size(first) - 1
        associate (node => found%node(found%first(p):found%first(p + 1) - 1))
          first(p + 1) = first(p) + count(numbering%equation(:, node) > 0 .and. &
                                          model%leader(:, node) == spread(node, 1, 2))
        end associate
      end do
      body%fronts = new_front_layout(pack(first, [first(2:) > first(:size(first) - 1), .true.]), &
                                     element_numbers(model, numbering, b))
      body%operations = body%fronts%operations() + real(body%contact_equations, wp)**3
      ! What is assembled together stands together in memory.
      body%element = body%element(body%fronts%element)
    end associate
  end subroutine number_fronts

  !> Equations of an element, x and y of its nodes in turn, zeros behind.
  pure function of_element(self, model, element) result(number)
    class(numbering_type), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: element             !! its number
    integer :: number(2*most_nodes)
    integer :: i

    number = 0
    do i = 1, model%order(element)
      number(2*i - 1:2*i) = self%equation(:, model%connectivity(i, element))
    end do
  end function of_element

  !> The same of all elements of a body [any, elements].
  pure function element_numbers(model, numbering, b) result(numbers)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    integer, intent(in) :: b
    integer, allocatable :: numbers(:, :)
    integer :: e, number(2*most_nodes)

    associate (element => numbering%body(b)%element)
      allocate (numbers(2*maxval(model%order(element)), size(element)))
      do e = 1, size(element)
        number = numbering%of_element(model, element(e))
        numbers(:, e) = number(:size(numbers, 1))
      end do
    end associate
  end function element_numbers

  !> Reverse Cuthill-McKee order of a body. Its levels are rooted at the contact nodes so that these come
  !! last: then the trailing block of the factor alone gives the flexibility. Or, where that widens the band
  !! by more than forward substitution of all pairs costs, they are rooted at the body's far end. Where even
  !! that band is a wide one, fronts are taken.
  pure subroutine number_band(model, numbering, b)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(inout) :: numbering
    integer, intent(in) :: b
    type(level_order) :: order
    integer, allocatable :: nodes(:)

    nodes = numbering%body(b)%node
    order = sweep(model, nodes(:1), nodes)
    if (model%controls%solver == solver_auto .and. least_operations(order) > many_operations) then
      call number_fronts(model, numbering, b)
      return
    end if
    order = sweep(model, order%node(size(nodes):), nodes)
    order = sweep(model, order%node(size(nodes):), nodes)
    ! The contact comes late in the reversed order, and with it what yields: what stands before is factored
    ! once.
    if (mean_place(order%node, numbering%at_contact) > 0.5_wp) then
      order = sweep(model, order%node(size(nodes):), nodes)
    end if
    call number_nodes(model, order%node(size(nodes):1:-1), numbering, b)
    call find_panels(model, numbering, b)
    associate (body => numbering%body(b))
      body%contact_last = .false.
      body%operations = body%panels%operations()
      if (model%controls%solver == solver_auto .and. body%operations > many_operations) then
        body%node = nodes
        call number_fronts(model, numbering, b)
      else if (any(numbering%at_contact(nodes))) then
        ! The roots stand in the order of the sweep from the far end, which runs along the contact.
        call root_at_contact(model, nodes, pack(order%node, numbering%at_contact(order%node)), numbering, b)
      end if
    end associate
  end subroutine number_band

  !> Number a body anew so that the contact comes last, if that takes fewer operations.
  pure subroutine root_at_contact(model, nodes, roots, numbering, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)       !! of the body
    integer, intent(in) :: roots(:)       !! of these at contact
    type(numbering_type), intent(inout) :: numbering
    integer, intent(in) :: b
    type(body_numbering) :: plain
    type(level_order) :: order
    integer, allocatable :: begins(:), equation(:, :)

    associate (body => numbering%body(b))
      begins = maxval(numbering%equation(:, roots), dim=1)
      body%operations = body%operations + body%panels%compliance_operations(pack(begins, begins > 0))
      plain = body
      equation = numbering%equation(:, nodes)
      order = sweep(model, roots, nodes)
      call number_nodes(model, order%node(size(nodes):1:-1), numbering, b)
      call find_panels(model, numbering, b)
      body%contact_last = .true.
      body%operations = body%panels%operations() + real(body%contact_equations, wp)**3
      if (body%operations <= plain%operations) return
      numbering%equation(:, nodes) = equation
      body = plain
    end associate
  end subroutine root_at_contact

  !> Operations of a band that is as narrow as it can be for a body so deep: all levels of the same width.
  pure real(wp) function least_operations(order)
    type(level_order), intent(in) :: order

    least_operations = 2.0_wp*size(order%node)*(2.0_wp*size(order%node)/max(1, order%levels))**2
  end function least_operations

  !> Mean place of the marked nodes in an order, from 0 to 1; 0 where there is none.
  pure real(wp) function mean_place(order, marked)
    integer, intent(in) :: order(:)
    logical, intent(in) :: marked(:)
    integer :: i

    associate (places => pack([(real(i, wp), i=1, size(order))], marked(order)))
      mean_place = sum(places)/(max(1, size(places))*real(size(order), wp))
    end associate
  end function mean_place

  !> Breadth-first order from `roots`, at each node its new neighbours by their number of elements. Nodes that
  !! elements do not join to the roots (an RBE2 does) start sweeps of their own.
  pure type(level_order) function sweep(model, roots, nodes) result(order)
    type(model_type), intent(in) :: model
    integer, intent(in) :: roots(:), nodes(:)
    integer, allocatable :: found(:)
    logical :: seen(model%nodes)
    integer :: at, end_of_level, filled, first, k, next

    allocate (order%node(size(nodes)))
    seen = .false.
    filled = size(roots)
    order%node(:filled) = roots
    seen(roots) = .true.
    end_of_level = 0
    next = 1
    do at = 1, size(nodes)
      if (at > filled) then
        do while (seen(nodes(next)))
          next = next + 1
        end do
        call add_new(nodes(next:next), seen, order%node, filled)
      end if
      if (at > end_of_level) then
        order%levels = order%levels + 1
        end_of_level = filled
      end if
      first = filled + 1
      do k = model%around%start(order%node(at)), model%around%start(order%node(at) + 1) - 1
        associate (e => model%around%group(k))
          call add_new(model%connectivity(:model%order(e), e), seen, order%node, filled)
        end associate
      end do
      if (filled > first) then
        found = order%node(first:filled)
        associate (elements => model%around%start(found + 1) - model%around%start(found))
          order%node(first:filled) = found(sorted_order(elements))
        end associate
      end if
    end do
  end function sweep

  !> Put the nodes not seen yet at the end of the order.
  pure subroutine add_new(node, seen, order, filled)
    integer, intent(in) :: node(:)
    logical, intent(inout) :: seen(:)
    integer, intent(inout) :: order(:), filled
    integer :: i

    do i = 1, size(node)
      if (seen(node(i))) cycle
      seen(node(i)) = .true.
      filled = filled + 1
      order(filled) = node(i)
    end do
  end subroutine add_new

  !> Number the freedoms of one body along the order of its nodes. A tied freedom has its leader's number; a
  !! leader that is free goes to the border, so that the band never sees a whole line of nodes on one freedom.
  pure subroutine number_nodes(model, order, numbering, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: order(:)                      !! of its nodes
    type(numbering_type), intent(inout) :: numbering
    integer, intent(in) :: b
    integer :: c, i

    associate (body => numbering%body(b), equation => numbering%equation)
      body%node = order
      body%equations = 0
      body%contact_equations = 0
      equation(:, body%node) = 0
      call number_border(model, body, equation)
      do i = 1, size(body%node)
        associate (node => body%node(i))
          do c = 1, 2
            if (model%leader(c, node) /= node) then
              equation(c, node) = equation(c, model%leader(c, node))
            else if (equation(c, node) == 0 .and. .not. is_fixed(model, c, node)) then
              body%equations = body%equations + 1
              equation(c, node) = body%equations
              if (.not. numbering%at_contact(node)) cycle
              body%contact_equations = body%contact_equations + 1
              if (body%contact_equations == 1) body%first_contact = body%equations
            end if
          end do
        end associate
      end do
      if (body%contact_equations == 0) body%first_contact = body%equations + 1
    end associate
  end subroutine number_nodes

  !> Number the free leaders of ties.
  pure subroutine number_border(model, body, equation)
    type(model_type), intent(in) :: model
    type(body_numbering), intent(inout) :: body
    integer, intent(inout) :: equation(:, :)
    integer :: c, i

    body%border = 0
    do i = 1, size(body%node)
      do c = 1, 2
        associate (leader => model%leader(c, body%node(i)))
          if (leader == body%node(i) .or. is_fixed(model, c, leader) .or. equation(c, leader) < 0) cycle
          body%border = body%border + 1
          equation(c, leader) = -body%border
        end associate
      end do
    end do
  end subroutine number_border

  !> Has a freedom a support, or SUPORT?
  pure logical function is_fixed(model, c, node)
    type(model_type), intent(in) :: model
    integer, intent(in) :: c, node

    is_fixed = model%held(c, node) .or. model%reference(c, node)
  end function is_fixed

  !> The panels of a body, as far down as each equation is coupled.
  pure subroutine find_panels(model, numbering, b)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(inout) :: numbering
    integer, intent(in) :: b
    integer, allocatable :: profile(:)
    integer :: e, i, number(2*most_nodes)

    associate (body => numbering%body(b))
      profile = [(i, i=1, body%equations)]
      do e = 1, size(body%element)
        number = numbering%of_element(model, body%element(e))
        associate (highest => maxval(number))
          do i = 1, size(number)
            if (number(i) > 0) profile(number(i)) = max(profile(number(i)), highest)
          end do
        end associate
      end do
      body%half_bandwidth = maxval([profile - [(i, i=1, body%equations)], 0])
      body%panels = new_panel_layout(profile)
    end associate
  end subroutine find_panels
end module epcont_plan_numbering
