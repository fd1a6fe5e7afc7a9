!> Pairs that cannot do what pairs are for: found before solving, and warned of.
module epcont_build_pair_checks
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_build_elements, only: element_name
  use epcont_deck_card_kinds, only: card_bconp, card_cgap
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_geometry_plane, only: cross_product
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_pairs

  !> A normal within 60 degrees of a boundary's own goes its way.
  real(wp), parameter :: same_way = 0.5_wp
  !> Sides around a node whose normals cancel to this part of their lengths are all round it.
  real(wp), parameter :: closed = 1.0e-6_wp
  !> A component of a normal below this is rounding.
  real(wp), parameter :: no_component = 1.0e-9_wp

contains

  !> Warn of pairs that point the wrong way, that do not lie opposite each other, that can neither open nor close, and of
  !! six-node sides with half of them.
  subroutine check_pairs(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults
    real(wp) :: a(2), b(2)
    integer :: c, i, k, last

    if (model%pairs == 0) return
    last = deck%card(card_cgap)%count
    do k = 1, last
      a = boundary_normal(model, model%pair_node(1, k))
      b = boundary_normal(model, model%pair_node(2, k))
      associate (n => model%normal(:, k))
        if (dot_product(a, n) >= same_way .or. dot_product(b, n) <= -same_way) cycle
        if (dot_product(a, n) > -same_way .and. dot_product(b, n) < same_way) cycle
        call faults%add_warning(deck%place(card_cgap, k, 1), deck%identity(card_cgap, k)// &
                                ': its normal points the wrong way: into the body of GA, or out of that of GB', &
                                'GA and GB exchanged, or the x-axis of CID turned round')
      end associate
    end do
    call warn_of_sideways(deck, model, last, faults)
    call warn_of_held(deck, model, card_cgap, 1, 1, last, faults)
    do c = 1, size(model%line_contact)
      associate (contact => model%line_contact(c))
        i = findloc(nint(deck%card(card_bconp)%value(1, :)), contact%bconp(1), dim=1)
        call warn_of_held(deck, model, card_bconp, i, contact%first, contact%last, faults)
      end associate
    end do
    call warn_of_half_sides(deck, model, faults)
  end subroutine check_pairs

  !> One warning for all CGAPs whose two nodes, both of bodies, lie farther apart across the normal than a side there is long.
  subroutine warn_of_sideways(deck, model, last, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    integer, intent(in) :: last
    type(diagnostics), intent(inout) :: faults
    real(wp) :: side(model%nodes), sideways(last)
    character(len=:), allocatable :: others
    integer :: far, i

    side = 0.0_wp
    do i = 1, model%body_outline%sides
      associate (node => model%body_outline%node(:, i))
        associate (ends => node(:merge(3, 2, node(3) > 0)))
          side(ends) = max(side(ends), norm2(model%x(:, node(2)) - model%x(:, node(1))))
        end associate
      end associate
    end do
    do i = 1, last
      associate (a => model%pair_node(1, i), b => model%pair_node(2, i))
        sideways(i) = abs(cross_product(model%x(:, b) - model%x(:, a), model%normal(:, i)))
        if (min(side(a), side(b)) == 0.0_wp .or. sideways(i) <= max(side(a), side(b))) sideways(i) = 0.0_wp
      end associate
    end do
    if (all(sideways == 0.0_wp)) return
    far = maxloc(sideways, dim=1)
    others = ''
    if (count(sideways > 0.0_wp) > 1) others = '; so do '//text_of(count(sideways > 0.0_wp) - 1)//' more'
    call faults%add_warning(deck%place(card_cgap, far, 4), deck%identity(card_cgap, far)//': GA and GB lie '// &
                            short_real(sideways(far))//' apart along the contact, more than a side there ('// &
                            short_real(maxval(side(model%pair_node(:, far))))//')'//others, &
                            'nodes that lie opposite each other, or BLSEG lines with a BCONP between them')
  end subroutine warn_of_sideways

  !> A six-node side presses by its middle, with two thirds of the force, and its ends: where some of these have no pair, the side
  !! passes through what the others touch. A middle alone may be a point of support; two beside each other are none.
  subroutine warn_of_half_sides(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults
    type(incidence) :: around         ! CGAPs at each node
    logical, allocatable :: on_line(:)
    integer :: c, first, half, s
    logical :: at(3), beside(3)

    if (deck%card(card_cgap)%count == 0 .or. all(model%order /= 6)) return
    around = new_incidence(model%pair_node(:, :deck%card(card_cgap)%count), model%nodes)
    allocate (on_line(model%nodes), source=.false.)
    do c = 1, size(model%line_contact)
      on_line(pack(model%line_contact(c)%slave%segment, model%line_contact(c)%slave%segment > 0)) = .true.
      on_line(pack(model%line_contact(c)%master%segment, model%line_contact(c)%master%segment > 0)) = .true.
    end do
    half = 0
    associate (outline => model%body_outline)
      do s = 1, outline%sides
        if (outline%node(3, s) == 0) cycle
        if (on_line(outline%node(3, s)) .or. model%is_rigid(outline%node(:, s))) cycle
        at = has_pair(model, around, outline%node(:, s))
        if (at(3)) then
          if (any(at(:2))) cycle
          beside = has_pair(model, around, outline%node(:, outline%before(s))) .or. &
                   has_pair(model, around, outline%node(:, outline%after(s)))
          if (.not. beside(3)) cycle
        else if (.not. all(at(:2))) then
          cycle
        end if
        half = half + 1
        if (half == 1) first = s
      end do
      if (half > 0) call warn(outline%node(:, first), outline%element(first))
    end associate

  contains

    subroutine warn(node, element)
      integer, intent(in) :: node(3), element
      character(len=:), allocatable :: others, what
      integer :: k

      at = has_pair(model, around, node)
      k = around%group(around%start(node(merge(3, 1, at(3)))))
      if (at(3)) then
        what = ' at its middle, GRID '//text_of(model%node_id(node(3)))//', and none at its ends'
      else
        what = ' at both ends and none at its middle, GRID '//text_of(model%node_id(node(3)))
      end if
      others = ''
      if (half > 1) others = '; so it is with '//text_of(half - 1)//' more'
      call faults%add_warning(deck%place(card_cgap, k, 1), deck%identity(card_cgap, k)//': a side of '// &
                              element_name(model, element)//' has CGAPs'//what// &
                              ': it will pass through what it touches, and the pressures are wrong'//others, &
                              'CGAPs at all three nodes of the sides, or BLSEG and BCONP')
    end subroutine warn
  end subroutine warn_of_half_sides

  !> Have the nodes of a side a CGAP that presses on it?
  pure function has_pair(model, around, node)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: node(3)
    logical :: has_pair(3)
    real(wp) :: along(2), across(2)
    integer :: i, k

    has_pair = .false.
    if (node(3) == 0) return
    along = model%x(:, node(2)) - model%x(:, node(1))
    across = [along(2), -along(1)]/norm2(along)
    do k = 1, 3
      do i = around%start(node(k)), around%start(node(k) + 1) - 1
        has_pair(k) = abs(dot_product(across, model%normal(:, around%group(i)))) >= same_way
        if (has_pair(k)) exit
      end do
    end do
  end function has_pair

  !> Outward normal of the boundary at a node; zero inside a body, and where there is none.
  pure function boundary_normal(model, node) result(normal)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    real(wp) :: normal(2)
    real(wp) :: along(2), length
    integer :: e, i, k, side(3)

    normal = 0.0_wp
    length = 0.0_wp
    do i = model%around%start(node), model%around%start(node + 1) - 1
      e = model%around%group(i)
      do k = 1, model%corners(e)
        side = model%edge(e, k)
        if (all(side /= node)) cycle
        along = model%x(:, side(2)) - model%x(:, side(1))
        ! Of a side that two elements have, the normals cancel.
        normal = normal + [along(2), -along(1)]
        length = length + norm2(along)
      end do
    end do
    if (norm2(normal) > closed*length) then
      normal = normal/norm2(normal)
    else
      normal = 0.0_wp
    end if
  end function boundary_normal

  !> One warning for all pairs of a range whose nodes are held along the normal. `card` i is the first pair's, or that of
  !! their contact. A held overlap is no warning: the run will end with it.
  subroutine warn_of_held(deck, model, card, i, first, last, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    integer, intent(in) :: card, i, first, last
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: which
    integer :: held, k, row

    held = 0
    row = i
    do k = first, last
      if (.not. is_held(model, k)) cycle
      held = held + 1
      if (held > 1) cycle
      if (card == card_cgap) row = k
      which = deck%identity(card, row)
      if (card == card_bconp) which = which//': GRID '//text_of(model%pair_id(k))
    end do
    if (held == 0) return
    if (held > 1) which = which//', and '//text_of(held - 1)//' more'
    call faults%add_warning(deck%place(card, row, 1), which// &
                            ': can neither open nor close: the nodes on both sides are held along the normal', &
                            'a free node on one side, or no pair')
  end subroutine warn_of_held

  !> Are all nodes of a pair held along its normal, and do they not overlap?
  pure logical function is_held(model, pair)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    real(wp) :: gap
    integer :: c, i

    gap = model%initial_gap(pair)
    is_held = .false.
    do i = model%row_start(pair), model%row_start(pair + 1) - 1
      do c = 1, 2
        if (abs(model%normal(c, pair)) <= no_component) cycle
        associate (leader => model%leader(c, model%row_node(i)))
          if (.not. model%held(c, leader)) return
          gap = gap + model%row_weight(i)*model%normal(c, pair)*model%prescribed(c, leader)
        end associate
      end do
    end do
    is_held = gap >= 0.0_wp
  end function is_held
end module epcont_build_pair_checks
