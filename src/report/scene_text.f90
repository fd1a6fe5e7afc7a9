!> Bodies that pass through each other, in words: where, how deep, and what would mend it.
module epcont_report_scene_text
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_certificate_scene, only: beyond_place, largest_change, little, overlap_place, scene_type
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_finding, only: of_element
  use epcont_model_model, only: model_type
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: figure, right
  use epcont_report_number, only: estimate_number
  implicit none
  private
  public :: scene_fault, deep_text, wide_text, itself_text, mirror_text, drawn_text, slid_text, changed_text, list_scene

  !> Depths that differ by less than this part are not told apart.
  real(wp), parameter :: deeper = 1.1_wp

contains

  !> What speaks against a scene that is not sound.
  pure function scene_fault(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    if (scene%axis%node > 0) then
      text = 'a ring is pressed to a radius below 0: '//beyond(model, scene%axis)// &
             '; where displacements are small radii stay above 0'
      return
    end if
    select case (maxloc([scene%inside%ratio, scene%apart%ratio, scene%beside%ratio, scene%passed%ratio], dim=1))
    case (1)
      text = 'bodies pass through each other: '//inside(model, scene%inside)//'; '//short_real(scene%inside%allowed)// &
             ' is allowed'//deepest(scene)//'. What may mend it: '//remedy(model, scene%inside)
    case (2)
      text = 'pair '//text_of(model%pair_id(scene%apart%pair))//' presses across a gap: '//where_is(model, scene%apart)//' is '// &
             short_real(scene%apart%depth)//' off '//side_name(model, scene%apart%other)//'; '// &
             short_real(scene%apart%allowed)//' is allowed. What may mend it: pairs of nodes, or lines, that face each other'
    case (3)
      text = 'pair '//text_of(model%pair_id(scene%beside%pair))//' presses beside the other body: '// &
             where_is(model, scene%beside)//' is '//short_real(scene%beside%depth)//' beside the end of '// &
             side_name(model, scene%beside%other)//'; '//short_real(scene%beside%allowed)//' is allowed. What may mend it: '// &
             'bodies drawn where they come to, or longer ones: contact is that of undeformed places'
    case default
      text = 'bodies pass through each other on their way: '//passing(model, scene)//'; '//short_real(scene%passed%allowed)// &
             ' is allowed. What may mend it: '//remedy(model, scene%passed)// &
             ', or loads and supports that move it another way'
    end select
  end function scene_fault

  !> Which node goes through which body, and how deep it is on its way.
  pure function passing(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    associate (place => scene%passed)
      text = model%name_of(of_element, model%body_outline%element(place%side))
      if (scene%passed%node > 0) text = 'GRID '//text_of(model%node_id(scene%passed%node))
      text = text//' of the body of GRID '//first_node(model, place%side)// &
             ' goes through that of GRID '//first_node(model, place%other)//', '//short_real(place%depth)//' deep at '// &
             short_real(place%x(1))//' '//short_real(place%x(2))//', behind '//side_name(model, place%other)
    end associate
  end function passing

  !> The deepest place, where it is not the one that is worst by what is allowed.
  pure function deepest(scene) result(text)
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    associate (place => scene%deepest)
      if (place%depth > deeper*scene%inside%depth) text = ' (deepest, '//short_real(place%depth)//', they are at '// &
        short_real(place%x(1))//' '//short_real(place%x(2))//', where '//short_real(place%allowed)//' is allowed)'
    end associate
  end function deepest

  !> Where a node is that is beyond a line.
  pure function beyond(model, place) result(text)
    type(model_type), intent(in) :: model
    type(beyond_place), intent(in) :: place
    character(len=:), allocatable :: text

    text = 'GRID '//text_of(model%node_id(place%node))//' comes '//short_real(place%depth)//' beyond '// &
           merge('x', 'y', place%component == 1)//' = '//short_real(place%line)
  end function beyond

  !> Which body lies where in which, and how deep.
  pure function inside(model, place) result(text)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text

    text = 'the body of GRID '//first_node(model, place%side)//' lies '//short_real(place%depth)// &
           ' deep in that of GRID '//first_node(model, place%other)//', '//where_is(model, place)//', behind '// &
           side_name(model, place%other)
  end function inside

  !> The place and the side it is on.
  pure function where_is(model, place) result(text)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text

    text = 'at '//short_real(place%x(1))//' '//short_real(place%x(2))//' on '//side_name(model, place%side)
  end function where_is

  !> A side of the outlines by its ends.
  pure function side_name(model, side) result(name)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    character(len=:), allocatable :: name

    associate (outline => model%body_outline)
      name = 'side GRID '//text_of(model%node_id(outline%node(1, side)))//' to '// &
             text_of(model%node_id(outline%node(2, side)))//' of '//model%name_of(of_element, outline%element(side))
    end associate
  end function side_name

  !> Id of the first node of the body that a side belongs to.
  pure function first_node(model, side) result(id)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    character(len=:), allocatable :: id

    associate (outline => model%body_outline)
      id = text_of(minval(model%node_id, mask=outline%part_of == outline%part(side)))
    end associate
  end function first_node

  !> What would keep the bodies apart there.
  pure function remedy(model, place) result(text)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text
    integer :: c, lines(2)

    c = contact_of(model, place)
    lines = [line_of(model, place%side), line_of(model, place%other)]
    if (c > 0) then
      associate (contact => model%line_contact(c))
        text = 'shorter sides of both lines there'
        if (has_side(model, contact%master, place%side)) &
          text = 'SLAVE and MASTER of BCONP '//text_of(contact%bconp(1))//' exchanged, or '//text
      end associate
    else if (all(lines > 0)) then
      text = 'a BCONP between BLSEG '//text_of(model%line(lines(1))%id)//' and BLSEG '//text_of(model%line(lines(2))%id)
    else if (any(lines > 0)) then
      text = 'a BLSEG along '//side_name(model, merge(place%other, place%side, lines(1) > 0))// &
             ', and a BCONP between it and BLSEG '//text_of(model%line(maxval(lines))%id)
    else
      text = 'a BLSEG along each of the two sides, and a BCONP between the lines'
      if (is_mate(find_mates(model), model%body_outline%node(:, place%side), model%body_outline%part(place%other))) &
        text = 'more CGAPs there, or '//text
    end if
  end function remedy

  !> The contact of lines that has both sides of a place; 0: there is none.
  pure integer function contact_of(model, place) result(c)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place

    do c = size(model%line_contact), 1, -1
      associate (slave => model%line_contact(c)%slave, master => model%line_contact(c)%master)
        if (has_side(model, slave, place%side) .and. has_side(model, master, place%other)) return
        if (has_side(model, slave, place%other) .and. has_side(model, master, place%side)) return
      end associate
    end do
  end function contact_of

  !> A line that a side belongs to; 0: there is none.
  pure integer function line_of(model, side) result(line)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side

    do line = size(model%line), 1, -1
      if (any(model%line(line)%side == side)) return
    end do
  end function line_of

  !> Has a line this side of the bodies' outlines?
  pure logical function has_side(model, line, side)
    type(model_type), intent(in) :: model
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side

    has_side = any(line%segment(1, :) == model%body_outline%node(1, side) .and. &
                   line%element == model%body_outline%element(side))
  end function has_side

  !> A body that passes through itself; empty: none does.
  pure function itself_text(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    if (scene%itself%ratio > 1.0_wp) text = 'a body passes through itself: it lies '//short_real(scene%itself%depth)// &
      ' deep, '//where_is(model, scene%itself)//', behind '//side_name(model, scene%itself%other)//'; '// &
      short_real(scene%itself%allowed)//' is allowed'
  end function itself_text

  !> Bodies that lie in each other by much of what moves, allowed though it is; empty: none do.
  pure function deep_text(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    if (scene%sound() .and. scene%deep%ratio > 1.0_wp) text = 'bodies lie in each other by '// &
      part_of_moved(scene, scene%deep)//': '//inside(model, scene%deep)//'; '//coarse(model, scene%deep)
  end function deep_text

  !> The same of a gap across which a pair presses.
  pure function wide_text(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    if (scene%sound() .and. scene%wide%ratio > 1.0_wp) text = 'a pair presses across a gap of '// &
      part_of_moved(scene, scene%wide)//': '//where_is(model, scene%wide)//' is '//short_real(scene%wide%depth)//' off '// &
      side_name(model, scene%wide%other)//'; '//coarse(model, scene%wide)
  end function wide_text

  !> A depth, of the largest displacement.
  pure function part_of_moved(scene, place) result(text)
    type(scene_type), intent(in) :: scene
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text

    text = text_of(nint(100.0_wp*place%depth/scene%moved))//' % of the largest displacement, '//short_real(scene%moved)
  end function part_of_moved

  !> What would mend that: how long sides would be that leave no more than is not told. (Depths shrink with the sides at corners,
  !! faster elsewhere.)
  pure function coarse(model, place) result(text)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text

    text = 'turns and slides there are not small'
    if (.not. place%moving) text = 'sides of about '//short_real(longest_side(model, place)/place%ratio)//' there would leave 10 %'
  end function coarse

  !> Sides that slide too far along each other where they press; empty: none do.
  pure function slid_text(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    if (scene%slid%ratio > 1.0_wp) text = 'displacements are not small: bodies that press on each other slide by '// &
      short_real(scene%slid%depth)//' along each other, '//where_is(model, scene%slid)//', where sides are '// &
      short_real(longest_side(model, scene%slid))//' long; contact is that of undeformed places'
  end function slid_text

  !> Length of the longer of the two sides at a place, as drawn [length].
  pure real(wp) function longest_side(model, place) result(longest)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place

    associate (node => model%body_outline%node(:2, [place%side, place%other]))
      longest = maxval(norm2(model%x(:, node(2, :)) - model%x(:, node(1, :)), dim=1))
    end associate
  end function longest_side

  !> A body that passes a line at which it ends and is held; empty: none does.
  pure function mirror_text(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    if (scene%mirror%node > 0) text = 'a body passes through its mirror image: '//beyond(model, scene%mirror)// &
      ', to which its body is held; no harm where that is no line of symmetry'
  end function mirror_text

  !> Bodies that overlap as drawn, and have no pair to close that; empty: none do.
  pure function drawn_text(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    if (scene%drawn%ratio > 1.0_wp) text = 'bodies overlap as drawn, with no pair between them there: '//inside(model, scene%drawn)
  end function drawn_text

  !> A side that turns or stretches too far for small displacements; empty: none does.
  pure function changed_text(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    character(len=:), allocatable :: text

    text = ''
    if (scene%change > largest_change) text = 'displacements are not small: '//side_name(model, scene%changed_side)// &
      ' is turned or stretched by '//short_real(scene%change)
  end function changed_text

  !> The lines of the certificate.
  subroutine list_scene(file, model, scene)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene

    if (scene%looked_through) then
      call list_ratio('bodies in each other, of what is allowed', scene%inside)
      call list_larger('  at the deepest place, of what is allowed', scene%deepest, scene%inside)
      if (scene%passed%side > 0) call list_ratio('  on their way through each other', scene%passed)
      if (model%pairs > 0) then
        call list_ratio('pressed across a gap, of what is allowed', scene%apart)
        call list_larger('  at the widest place, of what is allowed', scene%widest, scene%apart)
        if (scene%beside%ratio >= little) call list_ratio('  beside the other body', scene%beside)
      end if
    end if

  contains

    !> The largest depth, where it is not that of the worst place.
    subroutine list_larger(name, largest, worst)
      character(len=*), intent(in) :: name
      type(overlap_place), intent(in) :: largest, worst

      if (largest%ratio >= little .and. largest%depth > deeper*worst%depth) call list_ratio(name, largest)
    end subroutine list_larger

    subroutine list_ratio(name, place)
      character(len=*), intent(in) :: name
      type(overlap_place), intent(in) :: place
      character(len=:), allocatable :: text

      text = right('< '//short_real(little), 13)
      if (place%ratio >= little) text = right(estimate_number(place%ratio), 13)//'   '//short_real(place%depth)// &
                                        ' at '//short_real(place%x(1))//' '//short_real(place%x(2))
      call figure(file, name, text)
    end subroutine list_ratio
  end subroutine list_scene
end module epcont_report_scene_text
