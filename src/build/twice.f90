!> What is there twice and counts twice: pairs at one place, and elements on the same nodes.
module epcont_build_twice
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_build_elements, only: element_name, element_place
  use epcont_deck_card_kinds, only: card_bconp, card_cgap
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: refuse_pairs_twice, warn_of_elements_twice

  !> Normals of two CGAPs are one within 2.5 degrees: in a groove, whose walls stand at a larger angle, each has its force.
  real(wp), parameter :: parallel = 0.999_wp
  !> The normal of a CGAP is that of a line, which bends from node to node, within 45 degrees.
  real(wp), parameter :: one_face = sqrt(0.5_wp)
  !> Gaps that differ by less than this part of them, and of how far apart the nodes are, differ by rounding.
  real(wp), parameter :: equal = 1.0e-12_wp

contains

  !> Of two pairs at one place each bears a part of the force, and the pressure is that of a part.
  subroutine refuse_pairs_twice(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults
    type(incidence) :: around, lines   !! CGAPs at each node; pairs of lines in which a node stands on sides
    integer :: by_cgap, by_line, cgaps, first_cgap, first_line, k, other

    cgaps = deck%card(card_cgap)%count
    if (cgaps == 0) return
    around = new_incidence(model%pair_node(:, :cgaps), model%nodes)
    lines = new_incidence(reshape(model%row_node(model%row_start(cgaps + 1:model%pairs)), [1, model%pairs - cgaps]), model%nodes)
    by_cgap = 0
    by_line = 0
    do k = 1, cgaps
      other = cgap_like(model, around, k)
      if (other > 0) then
        by_cgap = by_cgap + 1
        if (by_cgap == 1) first_cgap = k
      end if
      other = line_pair_like(model, lines, cgaps, k)
      if (other > 0) then
        by_line = by_line + 1
        if (by_line == 1) first_line = k
      end if
    end do
    if (by_cgap > 0) call faults%add_error(deck%place(card_cgap, first_cgap, 1), deck%identity(card_cgap, first_cgap)// &
      ': joins the nodes of '//deck%identity(card_cgap, cgap_like(model, around, first_cgap))// &
      ' along the same normal, with the same gap: '// &
      'forces would be shared between the two'//as_many(by_cgap, 'CGAP'), 'one CGAP for two nodes and a normal')
    if (by_line > 0) call faults%add_error(deck%place(card_cgap, first_line, 1), deck%identity(card_cgap, first_line)// &
      ': joins nodes that '//contact_of(line_pair_like(model, lines, cgaps, first_line))//' joins along the same normal: '// &
      'forces would be shared between the two'//as_many(by_line, 'CGAP'), 'either CGAPs or a BCONP')

  contains

    !> The first BCONP of the contact that a pair is of.
    function contact_of(pair) result(name)
      integer, intent(in) :: pair
      character(len=:), allocatable :: name
      integer :: c

      do c = 1, size(model%line_contact) - 1
        if (pair <= model%line_contact(c)%last) exit
      end do
      name = deck%identity(card_bconp, findloc(nint(deck%card(card_bconp)%value(1, :)), model%line_contact(c)%bconp(1), dim=1))
    end function contact_of
  end subroutine refuse_pairs_twice

  !> `; so with 3 CGAPs more`; empty where there is one alone.
  pure function as_many(count, noun) result(text)
    integer, intent(in) :: count
    character(len=*), intent(in) :: noun
    character(len=:), allocatable :: text

    text = ''
    if (count == 2) text = '; so it is with 1 more '//noun
    if (count > 2) text = '; so it is with '//text_of(count - 1)//' more '//noun//'s'
  end function as_many

  !> The first CGAP before pair k that is between its nodes, along its normal, with its gap; 0: none.
  pure integer function cgap_like(model, around, k) result(other)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: k
    real(wp) :: apart
    integer :: i, node, way

    associate (a => model%pair_node(1, k), b => model%pair_node(2, k))
      ! At a node of the ground there may be thousands.
      node = merge(a, b, around%start(a + 1) - around%start(a) < around%start(b + 1) - around%start(b))
      do i = around%start(node), around%start(node + 1) - 1
        other = around%group(i)
        if (other == k) exit
        way = 0
        if (all(model%pair_node(:, other) == [a, b])) way = 1
        if (all(model%pair_node(:, other) == [b, a])) way = -1
        if (way*dot_product(model%normal(:, other), model%normal(:, k)) < parallel) cycle
        apart = norm2(model%x(:, b) - model%x(:, a)) + abs(model%initial_gap(k))
        if (abs(model%initial_gap(other) - model%initial_gap(k)) <= equal*apart) return
      end do
    end associate
    other = 0
  end function cgap_like

  !> The first pair of lines that joins the nodes of CGAP k along its normal; 0: none.
  pure integer function line_pair_like(model, lines, cgaps, k) result(pair)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: lines
    integer, intent(in) :: cgaps, k
    integer :: i, which

    do which = 1, 2
      associate (node => model%pair_node(which, k), other => model%pair_node(3 - which, k))
        do i = lines%start(node), lines%start(node + 1) - 1
          pair = cgaps + lines%group(i)
          if (all(model%row_node(model%row_start(pair) + 1:model%row_start(pair + 1) - 1) /= other)) cycle
          if (dot_product(model%normal(:, pair), model%normal(:, k))*merge(1, -1, which == 2) >= one_face) return
        end do
      end associate
    end do
    pair = 0
  end function line_pair_like

  !> Two elements on the same corners are as stiff as both: meant for laminae, and else a mesh read twice.
  subroutine warn_of_elements_twice(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults
    integer :: count, e, first

    count = 0
    first = 0
    do e = 1, model%elements
      if (element_like(model, e) == 0) cycle
      count = count + 1
      if (count == 1) first = e
    end do
    if (count == 0) return
    call faults%add_warning(element_place(deck, first), element_name(model, first)//' has the nodes of '// &
                            element_name(model, element_like(model, first))//': both count, one upon the other'// &
                            as_many(count, 'element'), 'one element, unless two laminae are meant')
  end subroutine warn_of_elements_twice

  !> The first element before one that has its corners; 0: none. Looked for where the fewest elements meet.
  pure integer function element_like(model, element) result(other)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element
    integer :: i, k, n, node

    n = model%corners(element)
    associate (corner => model%connectivity(:n, element), start => model%around%start)
      node = corner(minloc([(start(corner(k) + 1) - start(corner(k)), k=1, n)], dim=1))
      do i = start(node), start(node + 1) - 1
        other = model%around%group(i)
        if (other == element) exit
        if (model%corners(other) /= n) cycle
        if (all([(any(model%connectivity(:n, other) == corner(k)), k=1, n)])) return
      end do
    end associate
    other = 0
  end function element_like
end module epcont_build_twice
