!> Contacts of lines: which couples go together, and what there is to say of the pairs that come of them.
module epcont_contact_geometry_line_contacts
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_text, only: text_of
  use epcont_contact_geometry_faces, only: faces_type, find_faces
  use epcont_contact_geometry_line_pairs, only: add_pairs
  use epcont_contact_geometry_line_sides, only: find_line_sides
  use epcont_contact_geometry_line_warnings, only: warn_of_both_ways, warn_of_finer_slave, warn_of_overlap, &
                                                   warn_of_thicker_slave
  use epcont_model_finding, only: findings, of_couple, of_line
  use epcont_model_model, only: line_contact, model_type
  implicit none
  private
  public :: find_line_contacts

  !> Where nothing is said of it, a side is looked for within this many times the longest side of the two
  !! lines.
  real(wp), parameter :: default_search = 2.0_wp
  !> If nothing is found, within this many times as much, again and again, until more than the scene is looked
  !! through.
  real(wp), parameter :: widening = 4.0_wp

contains

  !> Add the pairs of all contacts of lines behind those that are given one by one. Lines and couples are
  !! known by their nodes and lines; where there were errors before, there is no boundary to look at, and
  !! these alone are checked.
  pure subroutine find_line_contacts(model, found)
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: c
    logical :: sound

    sound = found%errors == 0
    call find_line_sides(model, sound, found)
    sound = sound .and. found%errors == 0
    call check_couples(model, found)
    if (.not. sound .or. found%errors > 0) then
      allocate (model%line_contact(0))
      return
    end if
    call join_couples(model)
    do c = 1, size(model%line_contact)
      call set_lines(model, model%line_contact(c))
      call find_pairs(model, c, found)
    end do
    if (found%errors == 0) call warn_of_both_ways(model, found)
  end subroutine find_line_contacts

  !> Of all couples and lines.
  pure subroutine check_couples(model, found)
    type(model_type), intent(in) :: model
    type(findings), intent(inout) :: found
    logical :: used(0:size(model%line))
    integer :: i

    used = .false.
    do i = 1, size(model%couple)
      used(model%couple(i)%line) = .true.
      if (all(model%couple(i)%line > 0)) call check_couple(model, i, found)
    end do
    do i = 1, size(model%line)
      if (.not. used(i)) call found%add_warning(of_line, i, 1, ': no BCONP names it', &
                                                'a BCONP with it as SLAVE or MASTER, or no such line')
    end do
  end subroutine check_couples

  !> A line does not touch itself, and two lines touch once: of two contacts each would bear a part of the
  !! forces.
  pure subroutine check_couple(model, i, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i
    type(findings), intent(inout) :: found
    integer :: k

    associate (slave => model%couple(i)%line(1), master => model%couple(i)%line(2))
      if (slave == master) then
        call found%add_error(of_couple, i, 3, ': SLAVE and MASTER are one line', 'another BLSEG')
        return
      else if (overlap(model, slave, master)) then
        call found%add_error(of_couple, i, 3, ': SLAVE and MASTER share sides of elements', &
                             'lines without a side in common')
        return
      end if
      do k = 1, i - 1
        associate (line => model%couple(k)%line)
          if (any(line == 0)) cycle
          if (.not. (overlap(model, slave, line(2)) .and. overlap(model, master, line(1))) .and. &
              any(line /= [slave, master])) cycle
        end associate
        call found%add_error(of_couple, i, 2, ': its lines are those of '//model%name_of(of_couple, k)// &
                             ': forces would be shared between the two', &
                             'one BCONP for two lines: contact is exact either way')
        return
      end do
    end associate
  end subroutine check_couple

  !> Do two lines have a side in common?
  pure logical function overlap(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b

    overlap = a == b
    if (overlap .or. are_apart(model, a, b)) return
    overlap = have_common(model%line(a)%side, model%line(b)%side)
  end function overlap

  !> Do two lines have a node in common?
  pure logical function meet(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b

    meet = a == b
    if (meet .or. are_apart(model, a, b)) return
    associate (ends => model%boundary%segment(:2, :))
      meet = have_common([ends(:, model%line(a)%side)], [ends(:, model%line(b)%side)])
    end associate
  end function meet

  !> Is a number, from 1 on, in both lists?
  pure logical function have_common(a, b)
    integer, intent(in) :: a(:), b(:)
    logical, allocatable :: in_a(:)

    allocate (in_a(max(maxval(a), maxval(b), 0)), source=.false.)
    in_a(a) = .true.
    have_common = any(in_a(b))
  end function have_common

  !> Do the boxes round two lines, of many that there may be, tell that they do not meet?
  pure logical function are_apart(model, a, b)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b

    associate (one => model%line(a)%box, other => model%line(b)%box)
      are_apart = any(one(:, 1) > other(:, 2)) .or. any(other(:, 1) > one(:, 2))
    end associate
  end function are_apart

  !> Couples whose lines go on in each other are one contact: of one slave against several masters, or where
  !! both meet.
  pure subroutine join_couples(model)
    type(model_type), intent(inout) :: model
    type(partition) :: sets
    integer, allocatable :: number(:)   ! of the contact that each couple is of
    integer :: c, contacts, i, k

    sets = new_partition(size(model%couple))
    do i = 2, size(model%couple)
      do k = 1, i - 1
        associate (one => model%couple(i)%line, other => model%couple(k)%line)
          if (.not. meet(model, one(1), other(1))) cycle
          if (overlap(model, one(1), other(1)) .or. meet(model, one(2), other(2))) call sets%join(i, k)
        end associate
      end do
    end do
    call sets%numbers(number, contacts)
    allocate (model%line_contact(contacts))
    do c = 1, contacts
      model%line_contact(c)%couple = pack([(i, i=1, size(number))], number == c)
    end do
  end subroutine join_couples

  !> All sides of the slaves, and of the masters, each once.
  pure subroutine set_lines(model, contact)
    type(model_type), intent(in) :: model
    type(line_contact), intent(inout) :: contact
    integer, allocatable :: master(:), slave(:)
    integer :: i

    associate (couple => model%couple(contact%couple))
      contact%bconp = couple%id
      slave = once(couple%line(1))
      master = once(couple%line(2))
    end associate
    contact%slave_id = model%line(slave)%id
    contact%master_id = model%line(master)%id
    contact%slave = model%boundary%pick(sides_of(model, slave))
    contact%master = model%boundary%pick(sides_of(model, master))
    contact%search = model%controls%search
    if (contact%search == 0.0_wp) contact%search = default_search*max( &
    maxval([(contact%slave%chord_length(i),i=1,size(contact%slave%element))]),&
    maxval([(contact%master%chord_length(i),i=1,size(contact%master%element))]))
    allocate (contact%came_near(0))
  end subroutine set_lines

  !> Sides of some lines, each once.
  pure function sides_of(model, lines) result(sides)
    type(model_type), intent(in) :: model
    integer, intent(in) :: lines(:)
    integer, allocatable :: sides(:)
    integer :: k

    sides = once([(model%line(lines(k))%side, k=1, size(lines))])
  end function sides_of

  !> Each number once, in the order in which they come.
  pure function once(numbers)
    integer, intent(in) :: numbers(:)
    integer, allocatable :: once(:)
    logical :: first(size(numbers)), met(maxval(numbers))
    integer :: k

    met = .false.
    do k = 1, size(numbers)
      first(k) = .not. met(numbers(k))
      met(numbers(k)) = .true.
    end do
    once = pack(numbers, first)
  end function once

  !> The pairs of a contact, looked for ever farther until there is one; and the warnings.
  pure subroutine find_pairs(model, c, found)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(findings), intent(inout) :: found
    type(line_contact) :: contact
    type(faces_type) :: faces
    real(wp) :: most

    most = sum(maxval(model%x, dim=2) - minval(model%x, dim=2))
    contact = model%line_contact(c)
    do
      call find_faces(contact, model%boundary, faces)
      call add_pairs(faces, model, contact)
      if (contact%last >= contact%first) exit
      if (contact%search > most) then
        call add_nothing_faced(contact, faces%same_way, found)
        return
      end if
      contact%search = widening*contact%search
    end do
    model%line_contact(c) = contact
    call warn_of_overlap(model, contact, found)
    call warn_of_finer_slave(model, contact, faces, found)
    call warn_of_thicker_slave(model, contact, found)
  end subroutine find_pairs

  pure subroutine add_nothing_faced(contact, same_way, found)
    type(line_contact), intent(in) :: contact
    integer, intent(in) :: same_way      !! nodes of the slave that are near sides which look the same way
    type(findings), intent(inout) :: found
    character(len=:), allocatable :: remedy, what

    what = ': no node of BLSEG '//text_of(contact%slave_id(1))//' faces a side of BLSEG '// &
           text_of(contact%master_id(1))
    remedy = 'lines that face each other'
    if (same_way > 0) then
      what = what//'; '//text_of(same_way)//' of them near sides that look the same way'
      remedy = 'boundaries of two bodies that face each other'
    end if
    call found%add_error(of_couple, contact%couple(1), 1, what, remedy)
  end subroutine add_nothing_faced
end module epcont_contact_geometry_line_contacts
