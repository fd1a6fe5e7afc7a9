!> Numbers of the equations of each body: a narrow band, with the contact freedoms last.
module epcont_plan_numbering
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_front_layout, only: front_layout, new_front_layout
  use epcont_linalg_panel_layout, only: gram_operations, panel_operations
  use epcont_model_controls, only: solver_auto, solver_band, solver_frontal
  use epcont_model_model, only: model_type
  use epcont_plan_dissection, only: dissect, dissection
  implicit none
  private
  public :: body_numbering, numbering_type, number_equations

  !> Operations that a band takes from which on SOLVER AUTO is FRONTAL: there both are level, on compact bodies (7 000 nodes of two
  !! cylinders) and on long ones, on elastic ones and on those that yield.
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
    real(wp) :: operations = 0.0_wp        !! of factor and flexibility
    integer, allocatable :: reach(:)       !! the last equation that each is coupled with [equations], of solver_band
    integer :: half_bandwidth = 0
    integer :: border = 0                  !! leaders of ties that nothing holds, kept out of the band
  end type body_numbering

  !> Nodes in levels: each level has the neighbours of the one before.
  type :: level_order
    integer, allocatable :: node(:)
    integer :: levels = 0
  end type level_order

  type :: numbering_type
    !> Equation of each freedom in its body: positive in the band, negative in the border, 0 held. [2, nodes]
    integer, allocatable :: equation(:, :)
    type(body_numbering), allocatable :: body(:)
  end type numbering_type

contains

  pure function number_equations(model) result(numbering)
    type(model_type), intent(in) :: model
    type(numbering_type) :: numbering
    integer, allocatable :: order(:), element_order(:), element_body(:)
    logical, allocatable :: at_contact(:)
    integer :: b, first, last, e_first, e_last

    allocate (at_contact(model%nodes), source=.false.)
    at_contact(model%row_node) = .true.
    order = sorted_order(model%body)
    element_body = model%body(model%connectivity(1, :))
    element_order = sorted_order(element_body)
    allocate (numbering%body(model%bodies))
    allocate (numbering%equation(2, model%nodes), source=0)
    first = 1
    e_first = 1
    do b = 1, model%bodies
      last = first - 1 + count_run(model%body(order(first:)), b)
      e_last = e_first - 1 + count_run(element_body(element_order(e_first:)), b)
      associate (body => numbering%body(b))
        body%element = element_order(e_first:e_last)
        call choose_numbers(model, order(first:last), at_contact, numbering%equation, body)
      end associate
      first = last + 1
      e_first = e_last + 1
    end do
  end function number_equations

  !> How many keys at the front equal `key`.
  pure integer function count_run(keys, key)
    integer, intent(in) :: keys(:), key

    count_run = findloc(keys == key, .false., dim=1) - 1
    if (count_run < 0) count_run = size(keys)
  end function count_run

  !> Number a body for the solver that the deck asks for, or that which is faster.
  pure subroutine choose_numbers(model, nodes, at_contact, equation, body)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    logical, intent(in) :: at_contact(:)
    integer, intent(inout) :: equation(:, :)
    type(body_numbering), intent(inout) :: body

    body%can_yield = any(model%can_yield(body%element))
    if (size(body%element) == 0) then
      call number_nodes(model, at_contact, nodes, equation, body)
      call find_reach(model, equation, body)
    else if (model%controls%solver == solver_frontal) then
      call number_fronts(model, nodes, at_contact, equation, body)
    else
      call number_band(model, nodes, at_contact, equation, body)
    end if
  end subroutine choose_numbers

  !> Number a body for nested fronts, the contact nodes in the last of them. It is parted along x, along y and along the distance
  !! from the contact, in elements: there they are the smallest, mostly, and what lies around it has the shortest edge.
  pure subroutine number_fronts(model, nodes, at_contact, equation, body)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    logical, intent(in) :: at_contact(:)
    integer, intent(inout) :: equation(:, :)
    type(body_numbering), intent(inout) :: body
    type(level_order) :: outward
    type(dissection) :: found
    real(wp), allocatable :: coordinate(:, :)
    integer, allocatable :: first(:), roots(:)
    integer :: c, i, p

    roots = pack(nodes, at_contact(nodes))
    if (size(roots) == 0) roots = nodes(:1)
    outward = sweep(model, roots, nodes)
    allocate (coordinate(3, model%nodes))
    do i = 1, size(nodes)
      coordinate(:2, nodes(i)) = model%x(:, nodes(i))
      coordinate(3, outward%node(i)) = i
    end do
    found = dissect(coordinate, model%connectivity, model%around, body%element, nodes, at_contact)
    call number_nodes(model, at_contact, found%node, equation, body)
    if (body%equations == 0) then
      call find_reach(model, equation, body)
      return
    end if
    body%solver = solver_frontal
    body%contact_last = .true.
    ! A front's equations follow on one another, and some fronts have none.
    allocate (first(size(found%first)))
    first(1) = 1
    do p = 1, size(found%first) - 1
      first(p + 1) = first(p)
      associate (node => found%node(found%first(p):found%first(p + 1) - 1))
        do c = 1, 2
          first(p + 1) = first(p + 1) + count(equation(c, node) > 0 .and. model%leader(c, node) == node)
        end do
      end associate
    end do
    body%fronts = new_front_layout([pack(first(:size(first) - 1), first(2:) > first(:size(first) - 1)), body%equations + 1], &
                                   element_numbers(model, equation, body))
    body%operations = body%fronts%operations() + real(body%contact_equations, wp)**3
    ! What is assembled together stands together in memory.
    body%element = body%element(body%fronts%element)
  end subroutine number_fronts

  !> Equations of the elements of a body, x and y of their nodes in turn, zeros behind [any, elements].
  pure function element_numbers(model, equation, body) result(numbers)
    type(model_type), intent(in) :: model
    integer, intent(in) :: equation(:, :)
    type(body_numbering), intent(in) :: body
    integer, allocatable :: numbers(:, :)
    integer :: e, i

    allocate (numbers(2*maxval(model%order(body%element)), size(body%element)), source=0)
    do e = 1, size(body%element)
      do i = 1, model%order(body%element(e))
        numbers(2*i - 1:2*i, e) = equation(:, model%connectivity(i, body%element(e)))
      end do
    end do
  end function element_numbers

  !> Reverse Cuthill-McKee order of a body. Its levels are rooted at the contact nodes so that these come last: then the
  !! trailing block of the factor alone gives the flexibility. Or, where that widens the band by more than forward
  !! substitution of all pairs costs, they are rooted at the body's far end. Where even that band is a wide one, fronts are taken.
  pure subroutine number_band(model, nodes, at_contact, equation, body)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    logical, intent(in) :: at_contact(:)
    integer, intent(inout) :: equation(:, :)
    type(body_numbering), intent(inout) :: body
    type(body_numbering) :: plain
    type(level_order) :: order
    integer, allocatable :: numbers(:, :)

    order = sweep(model, nodes(:1), nodes)
    if (model%controls%solver == solver_auto .and. least_operations(order) > many_operations) then
      call number_fronts(model, nodes, at_contact, equation, body)
      return
    end if
    order = sweep(model, order%node(size(nodes):), nodes)
    order = sweep(model, order%node(size(nodes):), nodes)
    ! The contact comes late in the reversed order, and with it what yields: what stands before is factored once.
    if (mean_place(order%node, at_contact) > 0.5_wp) order = sweep(model, order%node(size(nodes):), nodes)
    plain = body
    call number_nodes(model, at_contact, order%node(size(nodes):1:-1), equation, plain)
    call find_reach(model, equation, plain)
    plain%contact_last = .false.
    plain%operations = panel_operations(plain%reach)
    if (model%controls%solver == solver_auto .and. plain%operations > many_operations) then
      call number_fronts(model, nodes, at_contact, equation, body)
      return
    else if (.not. any(at_contact(nodes))) then
      body = plain
      return
    end if
    plain%operations = plain%operations + gram_operations(plain%reach, begins(equation, pack(plain%node, at_contact(plain%node))))
    numbers = equation(:, nodes)
    ! The roots stand in the order of the sweep from the far end, which runs along the contact.
    order = sweep(model, pack(order%node, at_contact(order%node)), nodes)
    call number_nodes(model, at_contact, order%node(size(nodes):1:-1), equation, body)
    call find_reach(model, equation, body)
    body%operations = panel_operations(body%reach) + real(body%contact_equations, wp)**3
    if (body%operations <= plain%operations) return
    equation(:, nodes) = numbers
    body = plain
  end subroutine number_band

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

    mean_place = sum(pack([(real(i, wp), i=1, size(order))], marked(order)))/(max(1, count(marked(order)))*real(size(order), wp))
  end function mean_place

  !> First equations of the nodes of pairs, ascending.
  pure function begins(equation, nodes)
    integer, intent(in) :: equation(:, :), nodes(:)
    integer, allocatable :: begins(:)
    integer :: i

    begins = [(maxval(equation(:, nodes(i))), i=1, size(nodes))]
    begins = pack(begins, begins > 0)
    begins = begins(sorted_order(begins))
  end function begins

  !> Breadth-first order from `roots`, at each node its new neighbours by their number of elements. Nodes that
  !! elements do not join to the roots (an RBE2 does) start sweeps of their own.
  pure type(level_order) function sweep(model, roots, nodes) result(order)
    type(model_type), intent(in) :: model
    integer, intent(in) :: roots(:), nodes(:)
    integer, allocatable :: found(:)
    logical, allocatable :: seen(:)
    integer :: at, end_of_level, filled, first, k, n, next

    allocate (order%node(size(nodes)), found(0))
    allocate (seen(size(model%body)), source=.false.)
    filled = size(roots)
    order%node(:filled) = roots
    seen(roots) = .true.
    at = 0
    end_of_level = 0
    next = 1
    do while (at < size(nodes))
      at = at + 1
      if (at > filled) then
        do while (seen(nodes(next)))
          next = next + 1
        end do
        filled = at
        order%node(at) = nodes(next)
        seen(nodes(next)) = .true.
      end if
      if (at > end_of_level) then
        order%levels = order%levels + 1
        end_of_level = filled
      end if
      n = order%node(at)
      first = filled + 1
      do k = model%around%start(n), model%around%start(n + 1) - 1
        associate (e => model%around%group(k))
          call add_new(model%connectivity(:model%order(e), e), seen, order%node, filled)
        end associate
      end do
      if (filled > first) then
        found = order%node(first:filled)
        order%node(first:filled) = found(sorted_order(model%around%start(found + 1) - model%around%start(found)))
      end if
    end do
  end function sweep

  !> Put the nodes not seen yet at the end of the order.
  pure subroutine add_new(node, seen, order, filled)
    integer, intent(in) :: node(:)
    logical, intent(inout) :: seen(:)
    integer, intent(inout) :: order(:), filled
    integer :: c

    do c = 1, size(node)
      if (seen(node(c))) cycle
      seen(node(c)) = .true.
      filled = filled + 1
      order(filled) = node(c)
    end do
  end subroutine add_new

  !> Number the freedoms of one body along the order of its nodes. A tied freedom has its leader's number; a
  !! leader that is free goes to the border, so that the band never sees a whole line of nodes on one freedom.
  pure subroutine number_nodes(model, at_contact, order, equation, body)
    type(model_type), intent(in) :: model
    logical, intent(in) :: at_contact(:)
    integer, intent(in) :: order(:)                      !! of its nodes
    integer, intent(inout) :: equation(:, :)
    type(body_numbering), intent(inout) :: body
    integer :: c, i, node

    body%node = order
    body%border = 0
    body%equations = 0
    body%contact_equations = 0
    do i = 1, size(order)
      equation(:, order(i)) = 0
    end do
    do i = 1, size(body%node)
      node = body%node(i)
      do c = 1, 2
        associate (leader => model%leader(c, node))
          if (leader == node .or. model%held(c, leader) .or. model%reference(c, leader)) cycle
          if (equation(c, leader) < 0) cycle
          body%border = body%border + 1
          equation(c, leader) = -body%border
        end associate
      end do
    end do
    do i = 1, size(body%node)
      node = body%node(i)
      do c = 1, 2
        if (model%leader(c, node) /= node) then
          equation(c, node) = equation(c, model%leader(c, node))
        else if (.not. (model%held(c, node) .or. model%reference(c, node)) .and. equation(c, node) == 0) then
          body%equations = body%equations + 1
          equation(c, node) = body%equations
          if (at_contact(node)) body%contact_equations = body%contact_equations + 1
        end if
      end do
    end do
    body%first_contact = body%equations + 1
    do i = 1, size(body%node)
      associate (own => equation(:, body%node(i)))
        if (at_contact(body%node(i))) body%first_contact = min(body%first_contact, minval(own, mask=own > 0))
      end associate
    end do
  end subroutine number_nodes

  !> The last equation that each is coupled with.
  pure subroutine find_reach(model, equation, body)
    type(model_type), intent(in) :: model
    integer, intent(in) :: equation(:, :)
    type(body_numbering), intent(inout) :: body
    integer :: c, e, highest, i

    body%reach = [(e, e=1, body%equations)]
    do e = 1, size(body%element)
      associate (node => model%connectivity(:, body%element(e)), n => model%order(body%element(e)))
        highest = 0
        do i = 1, n
          highest = max(highest, equation(1, node(i)), equation(2, node(i)))
        end do
        do i = 1, n
          do c = 1, 2
            associate (number => equation(c, node(i)))
              if (number > 0) body%reach(number) = max(body%reach(number), highest)
            end associate
          end do
        end do
      end associate
    end do
    body%half_bandwidth = 0
    if (body%equations > 0) body%half_bandwidth = maxval(body%reach - [(e, e=1, body%equations)])
  end subroutine find_reach
end module epcont_plan_numbering
