!> Contact pairs from BCONP: each node of the slave line against the side of the master line that it faces.
module epcont_model_line_pairs
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: short_real, text_of
  use epcont_deck_card_kinds, only: card_bconp, card_blseg
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_boundary_line, only: boundary_line, facing_place
  use epcont_model_model, only: line_contact, model_type
  use epcont_model_reference, only: check_unique, index_of_ids, resolve
  implicit none
  private
  public :: build_line_pairs

  !> Where nothing is said of it, a side is looked for within this many times the longest side of the two lines.
  real(wp), parameter :: default_search = 2.0_wp
  !> A gap below so many roundings of the coordinates is none.
  real(wp), parameter :: roundings = 16.0_wp*epsilon(1.0_wp)
  !> Gaps that differ by less than this part of the search are equal: at a corner the better normal decides.
  real(wp), parameter :: equal = 1.0e-9_wp

  !> What a node of the slave line faces.
  type :: facing_type
    type(facing_place) :: place
    integer :: node = 0, segment = 0
  end type facing_type

contains

  !> Add the pairs of all line contacts behind those of CGAP.
  subroutine build_line_pairs(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(facing_type), allocatable :: facing(:)
    type(id_index) :: lines
    logical, allocatable :: used(:)
    integer :: i, same_way

    call check_unique(deck, [card_bconp], faults)
    lines = index_of_ids(deck, card_blseg)
    allocate (used(size(model%line)), source=.false.)
    associate (bconp => deck%card(card_bconp))
      allocate (model%line_contact(bconp%count))
      do i = 1, bconp%count
        associate (contact => model%line_contact(i))
          contact%id = nint(bconp%value(1, i))
          call resolve(deck, card_bconp, i, 2, lines, 'BLSEG', faults, contact%slave)
          call resolve(deck, card_bconp, i, 3, lines, 'BLSEG', faults, contact%master)
          if (contact%slave == 0 .or. contact%master == 0) cycle
          used([contact%slave, contact%master]) = .true.
          if (contact%slave == contact%master) then
            call faults%add_error(deck%place(card_bconp, i, 3), deck%identity(card_bconp, i)// &
                                  ': SLAVE and MASTER are one line', 'another BLSEG')
            cycle
          end if
          associate (slave => model%line(contact%slave), master => model%line(contact%master))
            if (size(slave%element) == 0 .or. size(master%element) == 0) cycle   ! said of the line
            contact%search = deck%parameter_value('SEARCH', default_search*max(slave%longest(), master%longest()))
            call find_facing(model, slave, master, contact%search, facing, same_way)
          end associate
          if (size(facing) == 0) call add_nothing_faced(deck, i, model, same_way, faults)
          call add_pairs(facing, model, contact)
          call warn_of_overlap(deck, i, model, contact, faults)
        end associate
      end do
    end associate
    do i = 1, size(used)
      if (.not. used(i)) call faults%add_warning(deck%place(card_blseg, i, 1), deck%identity(card_blseg, i)// &
                              ': no BCONP names it', 'a BCONP with it as SLAVE or MASTER, or no such line')
    end do
  end subroutine build_line_pairs

  !> What the nodes of one line face of another, in their order along the line. `same_way` counts those near sides
  !! that look the same way only.
  pure subroutine find_facing(model, slave, master, search, facing, same_way)
    type(model_type), intent(in) :: model
    type(boundary_line), intent(in) :: slave, master
    real(wp), intent(in) :: search
    type(facing_type), allocatable, intent(out) :: facing(:)
    integer, intent(out) :: same_way
    type(facing_type) :: best
    integer, parameter :: in_turn(3) = [1, 3, 2]
    integer :: found, k, s, turn, which
    logical :: wrong

    allocate (facing(3*size(slave%element)))
    found = 0
    same_way = 0
    do s = 1, size(slave%element)
      do turn = 1, 3
        which = in_turn(turn)
        if (slave%segment(which, s) == 0) cycle
        if (which == 2 .and. (s < size(slave%element) .or. slave%closed)) cycle   ! the next side's start
        best%node = slave%segment(which, s)
        call find_nearest(model, best%node, slave%outward(s, which), master, search, best, wrong)
        if (wrong) same_way = same_way + 1
        if (.not. best%place%found) cycle
        found = found + 1
        facing(found) = best
      end do
    end do
    facing = [(facing(k), k=1, found)]
  end subroutine find_facing

  !> The side of the master line that a node faces nearest by. `wrong`: there is none, but one near it that looks the
  !! same way.
  pure subroutine find_nearest(model, node, outward, master, search, best, wrong)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    real(wp), intent(in) :: outward(2)
    type(boundary_line), intent(in) :: master
    real(wp), intent(in) :: search
    type(facing_type), intent(inout) :: best
    logical, intent(out) :: wrong
    type(facing_place) :: place
    real(wp) :: reach, better
    integer :: i

    best%place = facing_place()
    wrong = .false.
    associate (x => model%x(:, node))
      do i = 1, size(master%element)
        if (any(master%segment(:, i) == node)) cycle
        associate (a => master%x(:, 1, i), b => master%x(:, 2, i))
          reach = search + norm2(b - a)
          if (any(abs(x - 0.5_wp*(a + b)) > reach)) cycle
        end associate
        place = master%face(i, x)
        if (.not. place%found .or. abs(place%gap) > search) cycle
        if (dot_product(place%normal, outward) >= 0.0_wp) then
          wrong = .true.
          cycle
        end if
        if (best%place%found) then
          better = abs(best%place%gap) - abs(place%gap)
          if (better < -equal*search) cycle
          if (better <= equal*search .and. &
              dot_product(place%normal, outward) >= dot_product(best%place%normal, outward)) cycle
        end if
        best%place = place
        best%segment = i
      end do
      if (abs(best%place%gap) <= roundings*maxval(abs(x))) best%place%gap = 0.0_wp
    end associate
    wrong = wrong .and. .not. best%place%found
  end subroutine find_nearest

  !> Append pairs, with their rows of N: the node is B, the side's nodes are A.
  subroutine add_pairs(facing, model, contact)
    type(facing_type), intent(in) :: facing(:)
    type(model_type), intent(inout) :: model
    type(line_contact), intent(inout) :: contact
    integer, allocatable :: nodes(:)
    real(wp), allocatable :: weights(:)
    integer :: i, k, n

    allocate (nodes(4*size(facing)), weights(4*size(facing)))
    contact%first = model%pairs + 1
    n = 0
    associate (slave => model%line(contact%slave), master => model%line(contact%master))
      do i = 1, size(facing)
        associate (place => facing(i)%place, side => master%segment(:, facing(i)%segment))
          n = n + 1
          nodes(n) = facing(i)%node
          weights(n) = 1.0_wp
          do k = 1, 3
            if (place%share(k) == 0.0_wp) cycle
            n = n + 1
            nodes(n) = side(k)
            weights(n) = -place%share(k)
          end do
          model%row_start = [model%row_start, size(model%row_node) + n + 1]
          model%pair_node = reshape([model%pair_node, side(maxloc(place%share, dim=1)), facing(i)%node], &
                                    [2, model%pairs + i])
        end associate
      end do
      contact%left_out = 2*size(slave%element) + merge(0, 1, slave%closed) - count(slave%segment(3, :) == 0) - size(facing)
    end associate
    model%pair_id = [model%pair_id, model%node_id(facing%node)]
    model%normal = reshape([model%normal, (facing(i)%place%normal, i=1, size(facing))], [2, model%pairs + size(facing)])
    model%initial_gap = [model%initial_gap, facing%place%gap]
    model%row_node = [model%row_node, nodes(:n)]
    model%row_weight = [model%row_weight, weights(:n)]
    model%pairs = model%pairs + size(facing)
    contact%last = model%pairs
  end subroutine add_pairs

  subroutine add_nothing_faced(deck, i, model, same_way, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    integer, intent(in) :: same_way
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: remedy, what

    associate (contact => model%line_contact(i))
      what = deck%identity(card_bconp, i)//': no node of BLSEG '//text_of(model%line(contact%slave)%id)// &
             ' faces a side of BLSEG '//text_of(model%line(contact%master)%id)//' within '//short_real(contact%search)
      remedy = 'lines that face each other, or a larger PARAM SEARCH'
      if (same_way > 0) then
        what = what//'; '//text_of(same_way)//' lie near sides that look the same way'
        remedy = 'boundaries of two bodies that face each other'
      end if
    end associate
    call faults%add_error(deck%place(card_bconp, i, 1), what, remedy)
  end subroutine add_nothing_faced

  !> One warning for all overlaps: shrink fits have many.
  subroutine warn_of_overlap(deck, i, model, contact, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: others
    integer :: deepest, overlaps

    associate (gap => model%initial_gap(contact%first:contact%last))
      overlaps = count(gap < 0.0_wp)
      if (overlaps == 0) return
      deepest = contact%first - 1 + minloc(gap, dim=1)
    end associate
    others = ''
    if (overlaps > 1) others = '; '//text_of(overlaps)//' nodes overlap'
    call faults%add_warning(deck%place(card_bconp, i, 1), deck%identity(card_bconp, i)//': the initial gap at GRID '// &
                            text_of(model%pair_id(deepest))//' is '//short_real(model%initial_gap(deepest))//others, &
                            'gaps of 0.0 or more, unless a fit is meant')
  end subroutine warn_of_overlap
end module epcont_model_line_pairs
