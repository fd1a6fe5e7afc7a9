!> Contacts of lines from BCONP: which lines go together, and what there is to say of the pairs that come of them.
module epcont_build_line_contacts
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: text_of
  use epcont_build_line_warnings, only: warn_of_both_ways, warn_of_finer_slave, warn_of_overlap, warn_of_thicker_slave
  use epcont_build_reference, only: check_unique, index_of_ids, resolve
  use epcont_contact_geometry_line_pairs, only: add_pairs, faces_type, find_faces
  use epcont_deck_card_kinds, only: card_bconp, card_blseg
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_geometry_boxed_line, only: new_boxed_line
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: build_line_contacts

  !> Where nothing is said of it, a side is looked for within this many times the longest side of the two lines.
  real(wp), parameter :: default_search = 2.0_wp
  !> If nothing is found, within this many times as much, again and again, until more than the scene is looked through.
  real(wp), parameter :: widening = 4.0_wp

contains

  !> Add the pairs of all contacts of lines behind those of CGAP.
  subroutine build_line_contacts(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    integer, allocatable :: line(:, :), number(:)   !! slave and master of each BCONP; the contact that it is of
    integer :: c, contacts
    logical :: sound

    ! Without sound elements there is no boundary to look at.
    sound = faults%error_count() == 0
    call check_unique(deck, [card_bconp], faults)
    call read_contacts(deck, model, line, faults)
    if (faults%error_count() > 0 .or. .not. sound) then
      allocate (model%line_contact(0))
      return
    end if
    call join_contacts(model, line, number, contacts)
    allocate (model%line_contact(contacts))
    do c = 1, contacts
      call set_lines(deck, model, line, pack_of(number, c), model%line_contact(c))
      call find_pairs(deck, minloc(abs(number - c), dim=1), model, model%line_contact(c), faults)
    end do
    if (faults%error_count() == 0) call warn_of_both_ways(deck, number, model, faults)
  end subroutine build_line_contacts

  !> Members of a set, in their order.
  pure function pack_of(number, set) result(members)
    integer, intent(in) :: number(:), set
    integer, allocatable :: members(:)
    integer :: i

    members = pack([(i, i=1, size(number))], number == set)
  end function pack_of

  !> The lines that each BCONP names.
  subroutine read_contacts(deck, model, line, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    integer, allocatable, intent(out) :: line(:, :)
    type(diagnostics), intent(inout) :: faults
    type(id_index) :: lines
    logical :: used(size(model%line))
    integer :: i

    lines = index_of_ids(deck, card_blseg)
    used = .false.
    associate (bconp => deck%card(card_bconp))
      allocate (line(2, bconp%count), source=0)
      do i = 1, bconp%count
        call resolve(deck, card_bconp, i, 2, lines, 'BLSEG', faults, line(1, i))
        call resolve(deck, card_bconp, i, 3, lines, 'BLSEG', faults, line(2, i))
        used(pack(line(:, i), line(:, i) > 0)) = .true.
        if (any(line(:, i) == 0)) cycle
        call check_lines(deck, i, model, line, faults)
      end do
    end associate
    do i = 1, size(used)
      if (.not. used(i)) call faults%add_warning(deck%place(card_blseg, i, 1), deck%identity(card_blseg, i)// &
                              ': no BCONP names it', 'a BCONP with it as SLAVE or MASTER, or no such line')
    end do
  end subroutine read_contacts

  !> A line does not touch itself, and two lines touch once: of two contacts each would bear a part of the forces.
  subroutine check_lines(deck, i, model, line, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    integer, intent(in) :: line(:, :)
    type(diagnostics), intent(inout) :: faults
    integer :: k

    associate (slave => line(1, i), master => line(2, i))
      if (slave == master) then
        call faults%add_error(deck%place(card_bconp, i, 3), deck%identity(card_bconp, i)// &
                              ': SLAVE and MASTER are one line', 'another BLSEG')
        return
      else if (overlap(model, slave, master)) then
        call faults%add_error(deck%place(card_bconp, i, 3), deck%identity(card_bconp, i)// &
                              ': SLAVE and MASTER share sides of elements', 'lines without a side in common')
        return
      end if
      do k = 1, i - 1
        if (any(line(:, k) == 0)) cycle
        if (.not. (overlap(model, slave, line(2, k)) .and. overlap(model, master, line(1, k))) .and. &
            any(line(:, k) /= line(:, i))) cycle
        call faults%add_error(deck%place(card_bconp, i, 2), deck%identity(card_bconp, i)//': its lines are those of '// &
                              deck%identity(card_bconp, k)//': forces would be shared between the two', &
                              'one BCONP for two lines: contact is exact either way')
        return
      end do
    end associate
  end subroutine check_lines

  !> Do two lines have a side in common?
  pure logical function overlap(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b
    logical, allocatable :: on(:)

    overlap = a == b
    if (overlap .or. .not. allocated(model%boundary%element)) return
    if (are_apart(model, a, b)) return
    allocate (on(size(model%boundary%element)), source=.false.)
    on(model%line(a)%side) = .true.
    overlap = any(on(model%line(b)%side))
  end function overlap

  !> Do two lines have a node in common?
  pure logical function meet(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b
    logical, allocatable :: on(:)

    meet = a == b
    if (meet .or. are_apart(model, a, b)) return
    allocate (on(model%nodes), source=.false.)
    on([model%boundary%segment(:2, model%line(a)%side)]) = .true.
    meet = any(on([model%boundary%segment(:2, model%line(b)%side)]))
  end function meet

  !> Do the boxes round two lines, of many that there may be, tell that they do not meet?
  pure logical function are_apart(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b

    associate (one => model%line(a)%box, other => model%line(b)%box)
      are_apart = any(one(:, 1) > other(:, 2)) .or. any(other(:, 1) > one(:, 2))
    end associate
  end function are_apart

  !> Contacts whose lines go on in each other are one: of one slave against several masters, or where both meet.
  pure subroutine join_contacts(model, line, number, contacts)
    type(model_type), intent(in) :: model
    integer, intent(in) :: line(:, :)
    integer, allocatable, intent(out) :: number(:)   !! of the contact that each BCONP is of
    integer, intent(out) :: contacts
    type(partition) :: sets
    integer :: i, k

    sets = new_partition(size(line, 2))
    do i = 2, size(line, 2)
      do k = 1, i - 1
        if (.not. meet(model, line(1, i), line(1, k))) cycle
        if (overlap(model, line(1, i), line(1, k)) .or. meet(model, line(2, i), line(2, k))) call sets%join(i, k)
      end do
    end do
    call sets%numbers(number, contacts)
  end subroutine join_contacts

  !> All sides of the slaves, and of the masters, each once.
  subroutine set_lines(deck, model, line, cards, contact)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(in) :: model
    integer, intent(in) :: line(:, :)
    integer, intent(in) :: cards(:)             !! the BCONPs of the contact
    type(line_contact), intent(inout) :: contact

    contact%bconp = nint(deck%card(card_bconp)%value(1, cards))
    contact%slave_id = model%line(once(line(1, cards)))%id
    contact%master_id = model%line(once(line(2, cards)))%id
    contact%slave = new_boxed_line(model%boundary%pick(sides_of(model, once(line(1, cards)))))
    contact%master = new_boxed_line(model%boundary%pick(sides_of(model, once(line(2, cards)))))
    contact%search = deck%parameter_value('SEARCH', default_search*max(contact%slave%longest(), contact%master%longest()))
    allocate (contact%came_near(0))
  end subroutine set_lines

  !> Sides of some lines, each once.
  pure function sides_of(model, lines) result(sides)
    type(model_type), intent(in) :: model
    integer, intent(in) :: lines(:)
    integer, allocatable :: sides(:)
    integer :: k

    sides = model%line(lines(1))%side
    if (size(lines) == 1) return
    sides = once([sides, (model%line(lines(k))%side, k=2, size(lines))])
  end function sides_of

  !> Each number once, in the order in which they come.
  pure function once(numbers)
    integer, intent(in) :: numbers(:)
    integer, allocatable :: once(:)
    logical :: met(maxval(numbers))
    integer :: k, n

    allocate (once(size(numbers)))
    met = .false.
    n = 0
    do k = 1, size(numbers)
      if (met(numbers(k))) cycle
      met(numbers(k)) = .true.
      n = n + 1
      once(n) = numbers(k)
    end do
    once = once(:n)
  end function once

  !> The pairs of a contact, looked for ever farther until there is one; and the warnings. BCONP i is the first of it.
  subroutine find_pairs(deck, i, model, contact, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(inout) :: model
    type(line_contact), intent(inout) :: contact
    type(diagnostics), intent(inout) :: faults
    type(faces_type) :: faces
    real(wp) :: most

    most = sum(maxval(model%x, dim=2) - minval(model%x, dim=2))
    do
      call find_faces(contact, model%boundary, faces)
      call add_pairs(faces, model, contact)
      if (contact%last >= contact%first) exit
      if (contact%search > most) then
        call add_nothing_faced(deck, i, contact, faces%same_way, faults)
        return
      end if
      contact%search = widening*contact%search
    end do
    call warn_of_overlap(deck, i, model, contact, faults)
    call warn_of_finer_slave(deck, i, model, contact, faces, faults)
    call warn_of_thicker_slave(deck, i, model, contact, faults)
  end subroutine find_pairs

  subroutine add_nothing_faced(deck, i, contact, same_way, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: same_way
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: remedy, what

    what = deck%identity(card_bconp, i)//': no node of BLSEG '//text_of(contact%slave_id(1))// &
           ' faces a side of BLSEG '//text_of(contact%master_id(1))
    remedy = 'lines that face each other'
    if (same_way > 0) then
      what = what//'; '//text_of(same_way)//' of them near sides that look the same way'
      remedy = 'boundaries of two bodies that face each other'
    end if
    call faults%add_error(deck%place(card_bconp, i, 1), what, remedy)
  end subroutine add_nothing_faced
end module epcont_build_line_contacts
