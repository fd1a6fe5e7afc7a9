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
    !> Slave edges that are shorter than the master edges by more than this factor: pressures were found to be
    !! wrong by 3 % and more.
    finer = 1.3_wp, &
    !> Master edges that are longer by this factor cannot follow the slave: if few of them are in contact,
    !! approaches are wrong as well.
    far_coarser = 4.0_wp, &
    !> Gaps between curves with chords as edges are exact to this fraction of the height of the curves above
    !! the chords; and cards with eight columns have about this many digits.
    curve_error = 0.01_wp, digits = 1.0e-7_wp, &
    !> Two contacts at a node are on one face if their normals differ by at most 45 degrees; smaller weights
    !! in a row do not count for a node.
    one_face = sqrt(0.5_wp), least_weight = 1.0e-3_wp

contains

  !> Warn of errors in one contact.
  subroutine warn_of_contact(model, contact, faces, found)
    type(model_type), intent(in) :: model        !! the model
    type(line_contact), intent(in) :: contact    !! the contact of lines
    type(faces_type), intent(in) :: faces        !! projections of the slave nodes
    type(findings), intent(inout) :: found       !! errors are added

    call warn_of_overlap()
    call warn_of_finer_slave()
    call warn_of_thicker_slave()

  contains

    !> Give one warning for all overlaps: shrink fits have many. Overlaps that may come from chords of curves
    !! or from cards with eight columns do not count.
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
                             'give gaps of 0.0 or more, unless you mean an interference fit')
    end subroutine warn_of_overlap

    !> Warn of a finer slave. Slave nodes carry the pressure. If they are closer than the master nodes, they
    !! show the facets of the master, whose edges bend at nodes only.
    subroutine warn_of_finer_slave()
      character(len=:), allocatable :: advice, text
      real(wp) :: sides(2)

      sides = facing_sides()
      if (sides(1)*finer >= sides(2)) return
      if (sides(1)*far_coarser < sides(2)) then
        text = 'pressures and approaches will be those of facets'
        advice = 'mesh both lines with edges of similar length'
      else
        text = 'pressures will show these as facets'
        advice = 'exchange SLAVE and MASTER, or mesh both lines with edges of similar length'
      end if
      call found%add_warning(of_couple, contact%couple(1), 2, ': edges of the slave line are '// &
                             short_real(sides(2)/sides(1))// &
                             ' times shorter than their opposite edges: '//text, advice)
    end subroutine warn_of_finer_slave

    !> Lengths, from node to node, of the slave edges and of their opposite edges, summed where the lines are
    !! nearest. An edge whose ends are fixed, or move together, does not bend and is
    !! not counted.
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

    !> Warn of a thicker slave. Pressure is force per area of the slave; a thinner master does not cover it.
    subroutine warn_of_thicker_slave()
      real(wp) :: thickness(2)

      if (model%has_rings()) return
      thickness = [maxval(model%sections%thickness(model%mesh%section(contact%slave%element))), &
                   minval(model%sections%thickness(model%mesh%section(contact%master%element)))]
      if (thickness(1)*(1.0_wp - digits) > thickness(2)) &
        call found%add_warning(of_couple, contact%couple(1), 2, ': the slave is '// &
                               short_real(thickness(1))//' thick, the master '//short_real(thickness(2))// &
                               ': pressures are forces by the slave''s area, of which the master covers '// &
                               'a part', 'exchange SLAVE and MASTER')
    end subroutine warn_of_thicker_slave
  end subroutine warn_of_contact

  !> Distance between consecutive nodes of an edge [length].
  pure real(wp) function node_distance(line, side)
    type(boundary_line), intent(in) :: line
    integer, intent(in) :: side

    node_distance = line%chord_length(side)/merge(2, 1, line%segment(3, side) > 0)
  end function node_distance

  !> Largest height of the curves over a line's edges above the chords [length].
  pure real(wp) function largest_rise(line)
    type(boundary_line), intent(in) :: line
    integer :: i

    largest_rise = maxval([(line%chord_length(i)*norm2(line%normal(:, 2, i) - line%normal(:, 1, i)), &
                            i=1, size(line%element))])/8.0_wp
  end function largest_rise

  !> Warn of a node that is slave in one contact and master in another, on the same face: neither contact
  !! uses the edges of the other, so that the distribution of pressures is arbitrary.
  subroutine warn_of_both_ways(model, found)
    type(model_type), intent(in) :: model   !! the model
    type(findings), intent(inout) :: found   !! errors are added
    !> Contact of each pair (0: CGAP); pair of each node as slave, 0 if absent
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
                             ' belongs to its MASTER and to the SLAVE of '// &
                             model%name_of(of_couple, model%contact%line_contact(other)%couple(1))// &
                             ': pressures beside it are wrong, by a quarter if both are in contact', &
                             'exchange SLAVE and MASTER of one of the two: lines that continue '// &
                             'each other are one contact')
    end do

  contains

    !> Position in the rows of N of the first such node of the master of contact c; 0 if absent.
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
