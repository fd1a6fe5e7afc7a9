!> Contacts of lines: bodies and their outlines, couples of lines that belong together, their pairs, and
!> warnings about these.
module epcont_contact_geometry_line_contacts
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_sorting, only: is_first
  use epcont_base_text, only: text_of
  use epcont_contact_geometry_balance, only: balance_pairs
  use epcont_contact_geometry_faces, only: faces_type
  use epcont_contact_geometry_free_sides, only: find_outline
  use epcont_contact_geometry_line_pairs, only: add_pairs, end_pairs
  use epcont_contact_geometry_line_sides, only: find_line_sides
  use epcont_contact_geometry_line_warnings, only: warn_of_both_ways, warn_of_contact
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_plane, only: extent_of
  use epcont_model_finding, only: findings, of_couple, of_line
  use epcont_model_freedoms, only: join_nodes
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_line_contacts

  real(wp), parameter :: &
    !> Default search distance, in lengths of the longest edge of the two
    !! lines.
    default_search = 2.0_wp, &
    !> If nothing is found, the search distance is multiplied by this factor until it exceeds the size of the
    !! model.
    widening = 4.0_wp

contains

  !> Find bodies, their outlines, and the pairs of all contacts of lines, which follow the single pairs.
  !! Elements, supports, ties and single pairs are complete. If there have been errors, there are no outlines,
  !! and only lines and couples are checked.
  subroutine find_line_contacts(model, found)
    type(model_type), intent(inout) :: model   !! the model
    type(findings), intent(inout) :: found   !! errors are added
    integer, allocatable :: number(:)   ! contact of each couple
    logical :: used(0:size(model%contact%line))
    type(line_contact) :: contact
    type(faces_type) :: faces
    integer :: c, contacts, i

    if (found%errors == 0) then   ! only correct elements have outlines
      call join_nodes(model, .true., model%mesh%body, model%mesh%bodies)
      model%mesh%body_outline = find_outline(model, found)
    end if
    call find_line_sides(model, found)
    used = [.false., model%contact%line%is_named]
    do i = 1, size(model%contact%couple)
      used(model%contact%couple(i)%line) = .true.
      if (all(model%contact%couple(i)%line > 0)) call check_couple()
    end do
    do i = 1, size(model%contact%line)
      if (.not. used(i)) call found%add_warning(of_line, i, 1, ': no BCONP names it', &
          'add a BCONP with it as SLAVE or MASTER, or remove the line')
    end do
    contacts = 0
    if (found%errors == 0) call join_couples()
    if (found%errors > 0) contacts = 0
    allocate (model%contact%line_contact(contacts))
    do c = 1, contacts
      contact = new_contact(model, pack([(i, i=1, size(number))], number == c))
      call find_pairs(model, found, contact, faces)
      model%contact%line_contact(c) = contact
    end do
    if (contacts > 0) call end_pairs(model)
    if (found%errors > 0) return
    call balance_pairs(model)
    call warn_of_both_ways(model, found)

  contains

    !> Check a couple: a line does not touch itself, and two lines are in one contact only, since each
    !! contact would carry a part of the forces.
    subroutine check_couple()
      integer :: k

      associate (slave => model%contact%couple(i)%line(1), master => model%contact%couple(i)%line(2))
        if (slave == master) then
          call found%add_error(of_couple, i, 3, ': SLAVE and MASTER are one line', 'give another BLSEG')
          return
        else if (overlap(slave, master)) then
          call found%add_error(of_couple, i, 3, ': SLAVE and MASTER share edges of elements', &
                               'give lines without a common edge')
          return
        end if
        do k = 1, i - 1
          associate (line => model%contact%couple(k)%line)
            if (any(line == 0)) cycle
            if (.not. (overlap(slave, line(2)) .and. overlap(master, line(1))) .and. &
                any(line /= [slave, master])) cycle
          end associate
          call found%add_error(of_couple, i, 2, ': its lines are those of '//model%name_of(of_couple, k)// &
                               ': forces would be shared between the two', &
                               'keep one BCONP for two lines: contact is exact either way')
          return
        end do
      end associate
    end subroutine check_couple

    !> Do two lines have an edge in common?
    pure logical function overlap(a, b)
      integer, intent(in) :: a, b

      overlap = a == b
      if (.not. overlap .and. meet(a, b)) overlap = &
        have_common(model%contact%line(a)%side, model%contact%line(b)%side)
    end function overlap

    !> Do two lines have a node in common? Most do not, which their boxes show quickly.
    pure logical function meet(a, b)
      integer, intent(in) :: a, b

      meet = a == b
      associate (one => model%contact%line(a), other => model%contact%line(b))
        if (meet .or. any(one%box(:, 1) > other%box(:, 2)) .or. any(other%box(:, 1) > one%box(:, 2))) return
        meet = have_common(one%node, other%node)
      end associate
    end function meet

    !> Join couples into one contact if their lines continue each other: one slave against several masters, or
    !! both lines meet.
    subroutine join_couples()
      type(partition) :: sets
      integer :: i, k

      sets = new_partition(size(model%contact%couple))
      do i = 2, size(model%contact%couple)
        do k = 1, i - 1
          associate (one => model%contact%couple(i)%line, other => model%contact%couple(k)%line)
            if (.not. meet(one(1), other(1))) cycle
            if (overlap(one(1), other(1)) .or. meet(one(2), other(2))) call sets%join(i, k)
          end associate
        end do
      end do
      call sets%numbers(number, contacts)
      associate (friction => model%contact%couple%friction)
        do i = 2, size(friction)
          k = findloc(number(:i - 1), number(i), dim=1)
          if (k == 0) cycle
          if (abs(friction(i) - friction(k)) > 0.0_wp) call found%add_error(of_couple, i, 1, &
            ': its lines continue those of '//model%name_of(of_couple, k)//', whose friction differs', &
            'give both the same friction, or lines that do not meet')
        end do
      end associate
    end subroutine join_couples
  end subroutine find_line_contacts

  !> Make the contact of some couples, without pairs.
  pure type(line_contact) function new_contact(model, couples) result(contact)
    type(model_type), intent(in) :: model
    integer, intent(in) :: couples(:)
    integer :: k

    contact%couple = couples
    associate (couple => model%contact%couple(couples))
      contact%bconp = couple%id
      contact%slave_id = model%contact%line(once(couple%line(1)))%id
      contact%master_id = model%contact%line(once(couple%line(2)))%id
      contact%slave = sides_of(couple%line(1))
      contact%master = sides_of(couple%line(2))
    end associate
    contact%friction = model%contact%couple(couples(1))%friction
    contact%search = model%controls%search
    if (contact%search == 0.0_wp) contact%search = default_search* &
      maxval([(contact%slave%chord_length(k), k=1, size(contact%slave%element)), &
              (contact%master%chord_length(k), k=1, size(contact%master%element))])
    allocate (contact%came_near(0))

  contains

    !> Edges of some lines, each once.
    pure type(boundary_line) function sides_of(lines)
      integer, intent(in) :: lines(:)
      integer :: k

      sides_of = model%contact%boundary%pick(once([(model%contact%line(lines(k))%side, k=1, size(lines))]))
    end function sides_of
  end function new_contact

  !> Find the pairs of a contact, with growing search distance until there is one, and the warnings.
  subroutine find_pairs(model, found, contact, faces)
    type(model_type), intent(inout) :: model
    type(findings), intent(inout) :: found
    type(line_contact), intent(inout) :: contact
    type(faces_type), intent(inout) :: faces

    do
      call add_pairs(model, contact, faces)
      if (contact%last >= contact%first) exit
      if (contact%search > sum(extent_of(model%mesh%x(:, model%mesh%around%members())))) then
        call found%add_error(of_couple, contact%couple(1), 1, &
          ': no node of BLSEG '//text_of(contact%slave_id(1))//' faces an edge of BLSEG '// &
          text_of(contact%master_id(1)), 'give boundaries of two bodies that face each other')
        return
      end if
      contact%search = widening*contact%search
    end do
    call warn_of_contact(model, contact, faces, found)
  end subroutine find_pairs

  !> Have two lists a number in common?
  pure logical function have_common(a, b)
    integer, intent(in) :: a(:), b(:)

    have_common = .not. all(is_first([once(a), once(b)]))
  end function have_common

  !> Remove repeated numbers; the order stays.
  pure function once(numbers)
    integer, intent(in) :: numbers(:)
    integer, allocatable :: once(:)

    once = pack(numbers, is_first(numbers))
  end function once
end module epcont_contact_geometry_line_contacts
