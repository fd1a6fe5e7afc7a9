!> Numbers of the equations of each body: a narrow band, with the contact freedoms last, or nested fronts.
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
  implicit none
  private
  public :: body_numbering, numbering_type, number_equations

  !> Operations that a band takes from which on SOLVER AUTO is FRONTAL: there both are level, on compact
  !! bodies (7 000 nodes of two cylinders) and on long ones, on elastic ones and on those that yield.
  real(wp), parameter, public :: many_operations = 2.0e8_wp
  !> Operations of the flexibility by a band from which on it may be FRONTAL for their sake, if fronts take
  !! fewer in all. Measured with factor and numbering, on two strips of 50 to 800 pairs, 4 to 14 elements
  !! high: level at 1e7, 1.2 times as fast at 3e7, 1.5 at 1e8, 2.4 at 2e9.
  real(wp), parameter, public :: many_of_flexibility = 2.0e7_wp

  !> One body's system of equations.
  type :: body_numbering
    integer, allocatable :: node(:)        !! its nodes, in the order of the equations
    integer, allocatable :: element(:)     !! its elements
    integer, allocatable :: part(:)        !! front by front, elements, and springs, numbered behind them
    type(sparse_rows) :: spring            !! of joined bodies, each a row
    integer :: equations = 0               !! in the band
    integer :: contact_equations = 0       !! of these, those that gaps depend on
    logical :: contact_last = .true.       !! the contact equations are the last ones
    integer :: first_contact = 1           !! the first of them; behind the last equation where there is none
    logical :: can_yield = .false.
    integer :: solver = solver_band        !! or solver_frontal
    type(front_layout) :: fronts           !! of solver_frontal
    type(panel_layout) :: panels           !! of solver_band
    real(wp) :: operations = 0.0_wp        !! of factor and flexibility
    integer :: half_bandwidth = 0
    integer :: border = 0                  !! leaders of ties that nothing holds, kept out of the band
    !> What freedoms of negative numbers are, sums of those in the border; the first are each one of these
    type(sparse_rows) :: tied
  end type body_numbering

  type :: numbering_type
    logical :: joined = .false.            !! all bodies are one system, which pairs join
    type(contact_axes) :: axes             !! along which the freedoms are, and what gaps want of them
    !> Equation of each freedom in its body: positive in the band, 0 held, negative a row of its `tied`; that
    !! of a tied freedom is its leader's, and never positive. [directions, nodes]
    integer, allocatable :: equation(:, :)
    type(body_numbering), allocatable :: body(:)   !! [bodies], or one where they are joined
  contains
    procedure :: of_element
  end type numbering_type

  !> Operations that finding F takes where what gaps depend on comes last, over the cube of these equations:
  !! of its inverse, or of right-hand sides and their product (`linalg/staircase.f90`), 2/3, and what copies
  !! take of the time (1.5e-11 s times the cube in all, of 1 000 to 3 000).
  real(wp), parameter :: of_inversion = 1.0_wp

  !> Freedoms of an element.
  integer, parameter, public :: most_freedoms = directions*most_nodes

  !> Nodes in levels: each level has the neighbours of the one before.
  type :: level_order
    integer, allocatable :: node(:)
    integer :: levels = 0
  end type level_order

contains

  !> Number all bodies, each for the solver that the deck asks for, or that which is faster.
  function number_equations(model, joined) result(numbering)
    type(model_type), intent(in) :: model   !! the scene
    logical, intent(in) :: joined           !! all bodies as one
    type(numbering_type) :: numbering
    type(incidence) :: elements, nodes
    integer, allocatable :: own(:)             ! nodes of the body that is being numbered
    !> The freedom has a support, or SUPORT; an equation of its own, perhaps in the border [directions, nodes]
    logical, allocatable, dimension(:, :) :: fixed, free
    logical, allocatable :: stands_last(:)     ! gaps depend on all free freedoms of the node [nodes]
    logical :: seen(model%nodes)               ! in a sweep, of the nodes of the body
    integer :: b, i

    allocate (numbering%equation(directions, model%nodes), source=0)
    fixed = model%held .or. model%reference
    free = .not. fixed .and. model%sum_of == 0 .and. &
           model%leader == spread([(i, i=1, model%nodes)], 1, directions)
    numbering%axes = new_contact_axes(model, fixed)
    stands_last = numbering%axes%pair > 0 .and. .not. any(free .and. .not. numbering%axes%wanted, dim=1)
    nodes = new_incidence(reshape(model%body, [1, model%nodes]), model%bodies)
    elements = model%elements_of_bodies()
    numbering%joined = joined
    allocate (numbering%body(merge(1, model%bodies, joined)))
    if (joined) call number_all(numbering%body(1))
    do b = 1, merge(0, model%bodies, joined)
      own = nodes%of(b)
      associate (body => numbering%body(b))
        body%element = elements%of(b)
        body%can_yield = any(model%can_yield(body%element))
        if (size(body%element) == 0) then
          call number_panels(own, body)
        else if (model%controls%solver == solver_frontal) then
          call number_fronts(body)
        else
          call number_band(body)
        end if
        body%part = body%element
      end associate
    end do

  contains

    !> Number all bodies as one. No gap is asked for any part of the inverse.
    subroutine number_all(all)
      type(body_numbering), intent(inout) :: all
      integer, allocatable :: first(:)
      integer :: angles(size(model%platen))

      call numbering%axes%ask_nothing()
      call number_joined(model, numbering%equation, angles, all%tied, all%node, first, all%first_contact)
      all%spring = spring_rows(model, numbering%equation, angles, all%tied)
      all%element = [(i, i=1, model%elements)]
      all%equations = first(size(first)) - 1
      all%can_yield = any(model%can_yield(all%element))
      all%solver = solver_frontal
      all%fronts = new_front_layout(first, numbers_of(all%element), &
                                    incidence(all%spring%start, all%spring%equation))
      all%operations = all%fronts%operations()
      all%part = all%fronts%element
      all%element = pack(all%part, all%part <= model%elements)
    end subroutine number_all

    !> Equations of some elements, zeros behind [any, elements].
    function numbers_of(element) result(numbers)
      integer, intent(in) :: element(:)
      integer, allocatable :: number(:), numbers(:, :)
      integer :: i, most

      most = directions*maxval(model%node_count(element))
      if (numbering%joined) most = maxval([most, (size(numbers_of_one(element(i))), i=1, size(element))])
      allocate (numbers(most, size(element)), source=0)
      do i = 1, size(element)
        number = numbers_of_one(element(i))
        numbers(:size(number), i) = number
      end do
    end function numbers_of

    !> Those of one; if its freedoms are sums, of joined bodies, the equations that these are sums of.
    function numbers_of_one(element) result(number)
      integer, intent(in) :: element
      integer, allocatable :: freedom(:), number(:)
      real(wp), allocatable :: weight(:)

      number = numbering%of_element(model, element)
      number = number(:directions*model%node_count(element))
      if (numbering%joined .and. any(number < 0)) &
        call find_terms(numbering%body(1)%tied, (number), number, freedom, weight)
    end function numbers_of_one

    !> Number a body for nested fronts, freedoms that gaps depend on in the last of them. It is parted along
    !! x, y, their diagonals and the distance from the contact, in elements: there they are the smallest.
    subroutine number_fronts(body)
      type(body_numbering), intent(inout) :: body
      type(level_order) :: outward
      type(dissection) :: found
      real(wp) :: distance(model%nodes)
      integer, allocatable :: first(:), roots(:)
      integer :: i, others

      roots = pack(own, numbering%axes%pair(own) > 0)
      if (size(roots) == 0) roots = own(:1)
      outward = sweep(roots)
      distance(outward%node) = [(real(i, wp), i=1, size(own))]
      found = dissect(model, distance, own, stands_last)
      body%contact_last = .true.
      body%solver = solver_frontal
      call number_nodes(found%node, body)
      if (body%equations == 0) then
        body%solver = solver_band
        call number_panels(found%node, body)
        return
      end if
      ! Some fronts have no equations; the last has the contact's.
      allocate (first(size(found%first) + 1), source=1)
      do i = 2, size(found%first)
        associate (node => found%node(found%first(i - 1):found%first(i) - 1))
          others = count(numbering%equation(:, node) > 0 .and. .not. numbering%axes%wanted(:, node))
        end associate
        first(i) = first(i - 1) + others
      end do
      first(size(first)) = body%equations + 1
      body%fronts = new_front_layout(pack(first, [first(2:) > first(:size(first) - 1), .true.]), &
                                     numbers_of(body%element))
      body%operations = body%fronts%operations() + of_inversion*real(body%contact_equations, wp)**3
      body%element = body%element(body%fronts%element)
    end subroutine number_fronts

    !> Number a body for a band, in reverse Cuthill-McKee order. Its levels are rooted at the contact nodes so
    !! that what gaps want of these can come last: then the trailing block of the factor alone gives the
    !! flexibility. Or, where that widens the band by more than forward substitution of all pairs costs, they
    !! are rooted at the body's far end. Where even that band is a wide one, fronts are taken; so they are
    !! where the flexibility makes much work, if with them it is less: for long contacts of slender bodies.
    subroutine number_band(body)
      type(body_numbering), intent(inout) :: body
      type(body_numbering) :: band
      integer, allocatable :: equation(:, :)
      type(level_order) :: order
      logical :: may_choose
      integer :: i, n

      n = size(own)
      may_choose = model%controls%solver == solver_auto
      order = sweep(own(:1))
      ! All levels of the same width: no band of a body so deep is narrower.
      if (may_choose .and. 2.0_wp*n*(2.0_wp*n/order%levels)**2 > many_operations) then
        call number_fronts(body)
        return
      end if
      order = sweep(order%node(n:))
      order = sweep(order%node(n:))
      ! The contact comes late in the reversed order, and with it what yields: what stands before is factored
      ! once.
      associate (place => pack([(real(i, wp), i=1, n)], numbering%axes%pair(order%node) > 0))
        if (sum(place) > 0.5_wp*size(place)*n) order = sweep(order%node(n:))
      end associate
      body%contact_last = .false.
      call number_panels(order%node(n:1:-1), body)
      body%operations = body%panels%operations()
      if (may_choose .and. body%operations > many_operations) then
        call number_fronts(body)
      else if (any(numbering%axes%pair(own) > 0)) then
        ! The roots stand in the order of the sweep from the far end, which runs along the contact.
        call root_at_contact(pack(order%node, numbering%axes%pair(order%node) > 0), body)
        if (.not. may_choose .or. body%operations - body%panels%operations() <= many_of_flexibility) return
        band = body
        equation = numbering%equation(:, own)
        call number_fronts(body)
        if (body%operations <= band%operations) return
        numbering%equation(:, own) = equation
        body = band
      end if
    end subroutine number_band

    !> Number a body anew so that the contact comes last, if that takes fewer operations or is asked for.
    subroutine root_at_contact(roots, body)
      integer, intent(in) :: roots(:)       !! nodes at contact
      type(body_numbering), intent(inout) :: body
      type(body_numbering) :: plain
      type(level_order) :: order
      integer, allocatable :: begins(:), equation(:, :)

      begins = maxval(numbering%equation(:, roots), dim=1)
      body%operations = body%operations + body%panels%compliance_operations(pack(begins, begins > 0))
      plain = body
      equation = numbering%equation(:, own)
      order = sweep(roots)
      body%contact_last = .true.
      call number_panels(order%node(size(own):1:-1), body)
      body%operations = body%panels%operations() + of_inversion*real(body%contact_equations, wp)**3
      if (model%controls%by_inversion .or. body%operations <= plain%operations) return
      numbering%equation(:, own) = equation
      body = plain
    end subroutine root_at_contact

    !> Breadth-first order of a body's nodes from `roots`, at each node its new neighbours by their number of
    !! elements. Nodes that elements do not join to the roots (an RBE2 does) start sweeps of their own.
    type(level_order) function sweep(roots) result(order)
      integer, intent(in) :: roots(:)
      integer, allocatable :: found(:)
      integer :: at, e, end_of_level, filled, first, k, next

      allocate (order%node(size(own)))
      seen(own) = .false.
      filled = size(roots)
      order%node(:filled) = roots
      seen(roots) = .true.
      end_of_level = 0
      next = 1
      do at = 1, size(own)
        if (at > filled) then
          do while (seen(own(next)))
            next = next + 1
          end do
          call add_new(own(next:next), seen, order%node, filled)
        end if
        if (at > end_of_level) then
          order%levels = order%levels + 1
          end_of_level = filled
        end if
        first = filled + 1
        do k = model%around%start(order%node(at)), model%around%start(order%node(at) + 1) - 1
          e = model%around%group(k)
          call add_new(model%connectivity(:model%node_count(e), e), seen, order%node, filled)
        end do
        if (filled > first) then
          found = order%node(first:filled)
          order%node(first:filled) = found(sorted_order(model%around%start(found + 1) - &
              model%around%start(found)))
        end if
      end do
    end function sweep

    !> Number the freedoms of a body along an order of its nodes; those that gaps depend on, if they are to be
    !! last, in that of a narrow band too, and of fronts in that of their pairs: then the inverse of their
    !! block is in the order of the gaps.
    subroutine number_nodes(order, body)
      integer, intent(in) :: order(:)
      type(body_numbering), intent(inout) :: body   !! whether they are to be last, and the solver, are known
      integer, allocatable :: contact(:)

      body%node = order
      body%equations = 0
      call number_border(model, order, numbering%equation, body%border, body%tied)
      contact = pack(order, numbering%axes%pair(order) > 0)
      if (body%contact_last) then
        call number_freedoms(order, [.false.], body)
        if (body%solver == solver_frontal) contact = contact(sorted_order(numbering%axes%pair(contact)))
        call number_freedoms(contact, [.true.], body)
      else
        call number_freedoms(order, [.false., .true.], body)
      end if
      associate (at_contact => pack(numbering%equation(:, contact), numbering%axes%wanted(:, contact)))
        body%contact_equations = count(at_contact > 0)
        body%first_contact = minval([at_contact, body%equations + 1], mask=[at_contact, 1] > 0)
      end associate
    end subroutine number_nodes

    !> Number the freedoms of some nodes that are free and not in the border.
    subroutine number_freedoms(node, wanted, body)
      integer, intent(in) :: node(:)
      logical, intent(in) :: wanted(:)   !! those that gaps depend on, those that they do not, or both
      type(body_numbering), intent(inout) :: body
      integer :: c, i

      do i = 1, size(node)
        do c = 1, directions
          if (.not. free(c, node(i)) .or. numbering%equation(c, node(i)) < 0) cycle
          if (all(numbering%axes%wanted(c, node(i)) .neqv. wanted)) cycle
          body%equations = body%equations + 1
          numbering%equation(c, node(i)) = body%equations
        end do
      end do
    end subroutine number_freedoms

    !> The same for a band, with its panels, as far down as each equation is coupled.
    subroutine number_panels(order, body)
      integer, intent(in) :: order(:)
      type(body_numbering), intent(inout) :: body
      integer, allocatable :: profile(:)
      integer :: e, i, last, number(most_freedoms)

      call number_nodes(order, body)
      profile = [(i, i=1, body%equations)]
      do e = 1, size(body%element)
        number = numbering%of_element(model, body%element(e))
        last = maxval(number)
        do i = 1, most_freedoms
          if (number(i) > 0) profile(number(i)) = max(profile(number(i)), last)
        end do
      end do
      body%half_bandwidth = maxval([profile - [(i, i=1, body%equations)], 0])
      body%panels = new_panel_layout(profile)
    end subroutine number_panels
  end function number_equations

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

  !> Equations of an element, x and y of its nodes in turn, zeros behind.
  pure function of_element(self, model, element) result(number)
    class(numbering_type), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: element             !! its number
    integer :: number(most_freedoms)
    integer :: i

    number = 0
    do i = 1, model%node_count(element)
      number(directions*(i - 1) + 1:directions*i) = self%equation(:, model%connectivity(i, element))
    end do
  end function of_element
end module epcont_plan_numbering
