!> What is not as it seems of contacts of lines: overlaps, slaves finer than their masters, nodes with a part
!> in two contacts.
module epcont_contact_geometry_line_warnings
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_contact_geometry_faces, only: faces_type
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_finding, only: findings, of_couple, of_node
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: warn_of_both_ways, warn_of_contact

  real(wp), parameter :: &
    !> Slave sides shorter than the others by more than this factor: beyond it pressures were seen to be off
    !! by 3 % and more.
    finer = 1.3_wp, &
    !> Sides so many times longer than those of the slave cannot follow it: where little of them touches,
    !! approaches are off as well.
    far_coarser = 4.0_wp, &
    !> Gaps of curves over sides that are chords are exact to this part of how high the curves rise above
    !! them; and coordinates have so many digits where a card has eight columns.
    curve_error = 0.01_wp, digits = 1.0e-7_wp, &
    !> Normals of two contacts at a node are of one face within 45 degrees; less than so much of a row says
    !! nothing of a node.
    one_face = sqrt(0.5_wp), least_weight = 1.0e-3_wp

contains

  !> What is not as it seems of one contact.
  subroutine warn_of_contact(model, contact, faces, found)
    type(model_type), intent(in) :: model        !! the scene
    type(line_contact), intent(in) :: contact    !! the contact of lines
    type(faces_type), intent(in) :: faces        !! what the slave's nodes face
    type(findings), intent(inout) :: found       !! what is wrong with it is added

    call warn_of_overlap()
    call warn_of_finer_slave()
    call warn_of_thicker_slave()

  contains

    !> One warning for all overlaps: shrink fits have many. What curves over chords, and cards of eight
    !! columns, leave is none.
    subroutine warn_of_overlap()
      character(len=:), allocatable :: others
      integer :: deepest, overlaps
      real(wp) :: least

      least = digits*maxval(abs(contact%slave%x)) + &
              curve_error*(largest_rise(contact%slave) + largest_rise(contact%master))
      overlaps = count(model%contact%initial_gap(contact%first:contact%last) < -least)
      if (overlaps == 0) return
      deepest = contact%first - 1 + minloc(model%contact%initial_gap(contact%first:contact%last), dim=1)
      others = ''
      if (overlaps > 1) others = '; '//text_of(overlaps)//' nodes overlap'
      call found%add_warning(of_couple, contact%couple(1), 1, ': the initial gap at '// &
                             model%name_of(of_node, model%contact%pair_node(2, deepest))//' is '// &
                             short_real(model%contact%initial_gap(deepest))//others, &
                             'gaps of 0.0 or more, unless a fit is meant')
    end subroutine warn_of_overlap

    !> Pressures are carried by the slave's nodes. Where these are closer than the nodes of the master, whose
    !! sides bend at nodes alone, they show its facets.
    subroutine warn_of_finer_slave()
      character(len=:), allocatable :: advice, text
      real(wp) :: sides(2)

      sides = facing_sides()
      if (sides(1)*finer >= sides(2)) return
      if (sides(1)*far_coarser < sides(2)) then
        text = 'pressures and approaches will be those of facets'
        advice = 'lines of about the same fineness'
      else
        text = 'pressures will show these as facets'
        advice = 'SLAVE and MASTER exchanged, or lines of about the same fineness'
      end if
      call found%add_warning(of_couple, contact%couple(1), 2, ': sides of the slave line are '// &
                             short_real(sides(2)/sides(1))// &
                             ' times shorter than those that they face: '//text, advice)
    end subroutine warn_of_finer_slave

    !> Lengths, from node to node, of the slave's sides and of those that they face, summed up where the lines
    !! are nearest to each other. A side whose ends are held, or move as one, does not bend at all, and does
    !! not count.
    pure function facing_sides() result(length)
      real(wp) :: length(2), nearest
      integer :: k, s

      nearest = minval(faces%row%gap)
      length = 0.0_wp
      do s = 1, size(contact%slave%element)
        if (model%constraints%is_rigid(contact%slave%segment(:2, s))) cycle
        do k = 1, 2
          if (faces%row_of(k, s) == 0) cycle
          associate (row => faces%row(faces%row_of(k, s)))
            if (row%gap > nearest + contact%slave%chord_length(s)) cycle
            if (model%constraints%is_rigid(contact%master%segment(:2, row%segment))) cycle
            length = length + [node_distance(contact%slave, s), node_distance(contact%master, row%segment)]
          end associate
        end do
      end do
    end function facing_sides

    !> Pressures are forces by the area of the slave, which a thinner master does not cover.
    subroutine warn_of_thicker_slave()
      real(wp) :: thickness(2)

      if (model%has_rings()) return
      thickness = [maxval(model%sections%thickness(model%mesh%section(contact%slave%element))), &
                   minval(model%sections%thickness(model%mesh%section(contact%master%element)))]
      if (thickness(1)*(1.0_wp - digits) > thickness(2)) &
        call found%add_warning(of_couple, contact%couple(1), 2, ': the slave is '// &
                               short_real(thickness(1))//' thick, the master '//short_real(thickness(2))// &
                               ': pressures are forces by the slave''s area, of which the master covers '// &
                               'a part', 'SLAVE and MASTER exchanged')
    end subroutine warn_of_thicker_slave
  end subroutine warn_of_contact

  !> From one node of a side to the next [length].
  pure real(wp) function node_distance(line, side)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: side

    node_distance = line%chord_length(side)/merge(2, 1, line%segment(3, side) > 0)
  end function node_distance

  !> How high the curves over a line's sides rise above its chords, at most [length].
  pure real(wp) function largest_rise(line)
    type(boundary_line), intent(in) :: line
    integer :: i

    largest_rise = maxval([(line%chord_length(i)*norm2(line%normal(:, 2, i) - line%normal(:, 1, i)), &
                            i=1, size(line%element))])/8.0_wp
  end function largest_rise

  !> A node that is slave in one contact and master in another, on the same face: neither knows of the sides
  !! that the other has beside it, whose pressures are shared by chance.
  subroutine warn_of_both_ways(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    !> Of each pair, 0: given alone; the pair of each node as slave, 0: none
    integer :: contact(model%contact%pairs), slave(model%mesh%nodes)
    logical :: told(size(model%contact%line_contact))
    integer :: c, i, other, pair

    if (size(told) < 2) return
    contact = 0
    slave = 0
    do c = 1, size(told)
      associate (first => model%contact%line_contact(c)%first, &
                 last => model%contact%line_contact(c)%first_of_master - 1)
        contact(first:last) = c
        slave(model%contact%row_node(model%contact%row_start(first:last))) = [(pair, pair=first, last)]
      end associate
    end do
    told = .false.
    do c = 1, size(told)
      if (.not. told(c)) i = first_both_ways()
      if (told(c) .or. i == 0) cycle
      other = contact(slave(model%contact%row_node(i)))
      told(other) = .true.
      call found%add_warning(of_couple, model%contact%line_contact(c)%couple(1), 3, ': '// &
                             model%name_of(of_node, model%contact%row_node(i))// &
                             ' is of its MASTER, and of the SLAVE of '// &
                             model%name_of(of_couple, model%contact%line_contact(other)%couple(1))// &
                             ': pressures beside it are off, by a quarter where both touch', &
                             'SLAVE and MASTER of one of the two exchanged: lines that go on in each '// &
                             'other are one contact')
    end do

  contains

    !> Where the rows of N have the first such node of the master of contact c; 0: nowhere.
    pure integer function first_both_ways() result(i)
      integer :: k

      do k = model%contact%line_contact(c)%first, model%contact%line_contact(c)%first_of_master - 1
        do i = model%contact%row_start(k) + 1, model%contact%row_start(k + 1) - 1
          associate (other => slave(model%contact%row_node(i)))
            if (other == 0 .or. abs(model%contact%row_weight(i)) < least_weight) cycle
            if (contact(other) /= c .and. &
                dot_product(model%contact%normal(:, k), model%contact%normal(:, other)) <= -one_face) return
          end associate
        end do
      end do
      i = 0
    end function first_both_ways
  end subroutine warn_of_both_ways
end module epcont_contact_geometry_line_warnings
