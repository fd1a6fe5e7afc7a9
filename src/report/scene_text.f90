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
  use epcont_report_layout, only: figure
  use epcont_report_names, only: first_grid, grid_name, point_name
  use epcont_report_number, only: estimate_number
  implicit none
  private
  public :: scene_fault, scene_warning, list_scene

  !> What a scene is warned of, in the order of the warnings.
  integer, parameter, public :: body_in_itself = 1   !! a body passes through itself
  integer, parameter, public :: beyond_mirror = 2    !! a body passes a line at which it ends and is held
  integer, parameter, public :: overlap_drawn = 3    !! bodies overlap as drawn, with no pair to close that
  integer, parameter, public :: much_overlap = 4     !! bodies lie in each other by much, but allowed
  integer, parameter, public :: much_gap = 5         !! a pair presses across as wide a gap
  integer, parameter, public :: side_changed = 6     !! a side turns or stretches too far
  integer, parameter, public :: sides_slid = 7       !! sides slide too far along each other where they press
  integer, parameter, public :: scene_warnings = 7

  !> Depths that differ by less than this part are not told apart.
  real(wp), parameter :: deeper = 1.1_wp

  !> Sentences about a place; `told` fills in what stands in braces.
  character(len=*), parameter :: &
    lies_in = 'the body of {body} lies {depth} deep in that of {other body}, '// &
              'at {point} on {side}, behind {other side}', &
    is_off = 'at {point} on {side} is {depth} off {other side}', &
    by_much = '{share} % of the largest displacement, {moved}: ', &
    limit = '; {allowed} is allowed', &
    mending = '. What may mend it: '

contains

  !> What speaks against a scene that is not sound.
  pure function scene_fault(model, scene) result(text)
    type(model_type), intent(in) :: model   !! the model
    type(scene_type), intent(in) :: scene   !! as the certificate has it
    character(len=:), allocatable :: text

    if (scene%axis%node > 0) then
      text = 'a ring is pressed to a radius below 0: '//beyond(model, scene%axis)// &
             '; where displacements are small radii stay above 0'
      return
    end if
    select case (maxloc([scene%inside%ratio, scene%apart%ratio, scene%beside%ratio, scene%passed%ratio], &
                        dim=1))
    case (1)
      text = told('bodies pass through each other: '//lies_in//limit, model, scene, scene%inside)
      if (scene%deepest%depth > deeper*scene%inside%depth) text = text// &
        told(' (deepest, {depth}, they are at {point}, where {allowed} is allowed)', &
             model, scene, scene%deepest)
      text = text//mending//remedy(model, scene%inside)
    case (2)
      text = 'pair '//text_of(model%pair_id(scene%apart%pair))// &
             told(' presses across a gap: '//is_off//limit//mending// &
             'pairs of nodes, or lines, that face each other', model, scene, scene%apart)
    case (3)
      text = 'pair '//text_of(model%pair_id(scene%beside%pair))//told(' presses beside the other body: '// &
             'at {point} on {side} is {depth} beside the end of {other side}'//limit//mending// &
             'bodies drawn where they come to, or longer ones: contact is that of undeformed places', &
             model, scene, scene%beside)
    case default
      text = told('bodies pass through each other on their way: {passing} of the body of {body} goes '// &
                  'through that of {other body}, {depth} deep at {point}, behind {other side}'// &
                  limit//mending, model, scene, scene%passed)// &
             remedy(model, scene%passed)//', or loads and supports that move it another way'
    end select
  end function scene_fault

  !> What is to be known of a scene though it may be sound; empty: nothing.
  pure function scene_warning(model, scene, about) result(text)
    type(model_type), intent(in) :: model   !! the model
    type(scene_type), intent(in) :: scene   !! as the certificate has it
    integer, intent(in) :: about            !! one of the warnings above
    character(len=:), allocatable :: text

    text = ''
    select case (about)
    case (body_in_itself)
      if (scene%itself%ratio > 1.0_wp) text = told('a body passes through itself: it lies {depth} deep, '// &
        'at {point} on {side}, behind {other side}'//limit, model, scene, scene%itself)
    case (beyond_mirror)
      if (scene%mirror%node > 0) text = 'a body passes through its mirror image: '// &
        beyond(model, scene%mirror)// &
        ', to which its body is held; no harm where that is no line of symmetry'
    case (overlap_drawn)
      if (scene%drawn%ratio > 1.0_wp) &
        text = told('bodies overlap as drawn, with no pair between them there: '//lies_in, &
                    model, scene, scene%drawn)
    case (much_overlap)
      if (scene%sound() .and. scene%deep%ratio > 1.0_wp) &
        text = told('bodies lie in each other by '//by_much//lies_in//finer(scene%deep), &
                    model, scene, scene%deep)
    case (much_gap)
      if (scene%sound() .and. scene%wide%ratio > 1.0_wp) &
        text = told('a pair presses across a gap of '//by_much//is_off//finer(scene%wide), &
                    model, scene, scene%wide)
    case (side_changed)
      if (scene%change > largest_change) text = 'displacements are not small: '// &
        side_name(model, scene%changed_side)// &
        ' is turned or stretched by '//short_real(scene%change)
    case (sides_slid)
      if (scene%slid%ratio > 1.0_wp) &
        text = told('displacements are not small: bodies that press on each other slide by {depth} along '// &
                    'each other, at {point} on {side}, where sides are {length} long; contact is that of '// &
                    'undeformed places', model, scene, scene%slid)
    end select
  end function scene_warning

  !> What would mend that much: sides so short that they leave no more than is not told. (Depths shrink with
  !! the sides at corners, faster elsewhere.)
  pure function finer(place) result(sentence)
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: sentence

    sentence = '; sides of about {finer} there would leave 10 %'
    if (place%moving) sentence = '; turns and slides there are not small'
  end function finer

  !> A sentence about a place, filled in.
  pure function told(sentence, model, scene, place) result(text)
    character(len=*), intent(in) :: sentence
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text
    integer :: brace, from

    text = ''
    from = 1
    do
      brace = from + index(sentence(from:), '{') - 1
      if (brace < from) exit
      text = text//sentence(from:brace - 1)
      from = brace + index(sentence(brace:), '}')
      text = text//word_for(sentence(brace + 1:from - 2), model, scene, place)
    end do
    text = text//sentence(from:)
  end function told

  !> What stands in a sentence for one of the names in braces.
  pure function word_for(name, model, scene, place) result(text)
    character(len=*), intent(in) :: name
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text

    select case (name)
    case ('point')
      text = point_name(place%x)
    case ('depth')
      text = short_real(place%depth)
    case ('allowed')
      text = short_real(place%allowed)
    case ('side')
      text = side_name(model, place%side)
    case ('other side')
      text = side_name(model, place%other)
    case ('body')
      text = body_name(model, place%side)
    case ('other body')
      text = body_name(model, place%other)
    case ('passing')
      text = model%name_of(of_element, model%body_outline%element(place%side))
      if (place%node > 0) text = grid_name(model, place%node)
    case ('length')
      text = short_real(longest_side(model, place))
    case ('finer')
      text = short_real(longest_side(model, place)/place%ratio)
    case ('share')
      text = text_of(nint(100.0_wp*place%depth/scene%moved))
    case default
      text = short_real(scene%moved)
    end select
  end function word_for

  !> Where a node is that is beyond a line.
  pure function beyond(model, place) result(text)
    type(model_type), intent(in) :: model
    type(beyond_place), intent(in) :: place
    character(len=:), allocatable :: text

    text = grid_name(model, place%node)//' comes '//short_real(place%depth)//' beyond '// &
           merge('x', 'y', place%component == 1)//' = '//short_real(place%line)
  end function beyond

  !> A side of the outlines by its ends.
  pure function side_name(model, side) result(name)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    character(len=:), allocatable :: name

    associate (outline => model%body_outline)
      name = 'side '//grid_name(model, outline%node(1, side))//' to '// &
             text_of(model%node_id(outline%node(2, side)))// &
             ' of '//model%name_of(of_element, outline%element(side))
    end associate
  end function side_name

  !> The body that a side belongs to, by its first node.
  pure function body_name(model, side) result(name)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    character(len=:), allocatable :: name

    associate (outline => model%body_outline)
      name = first_grid(model, outline%part_of == outline%part(side))
    end associate
  end function body_name

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
      text = 'a BCONP between BLSEG '//text_of(model%line(lines(1))%id)//' and BLSEG '// &
             text_of(model%line(lines(2))%id)
    else if (any(lines > 0)) then
      text = 'a BLSEG along '//side_name(model, merge(place%other, place%side, lines(1) > 0))// &
             ', and a BCONP between it and BLSEG '//text_of(model%line(maxval(lines))%id)
    else
      text = 'a BLSEG along each of the two sides, and a BCONP between the lines'
      if (is_mate(find_mates(model), model%body_outline%node(:, place%side), &
                  model%body_outline%part(place%other))) &
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

  !> Length of the longer of the two sides at a place, as drawn [length].
  pure real(wp) function longest_side(model, place) result(longest)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place

    associate (node => model%body_outline%node(:2, [place%side, place%other]))
      longest = maxval(norm2(model%x(:, node(2, :)) - model%x(:, node(1, :)), dim=1))
    end associate
  end function longest_side

  !> The lines of the certificate.
  subroutine list_scene(file, model, scene)
    type(text_file), intent(in) :: file     !! the listing
    type(model_type), intent(in) :: model   !! the model
    type(scene_type), intent(in) :: scene   !! as the certificate has it

    if (.not. scene%looked_through) return
    call list_ratio('bodies in each other, of what is allowed', scene%inside)
    call list_larger('  at the deepest place, of what is allowed', scene%deepest, scene%inside)
    if (scene%passed%side > 0) call list_ratio('  on their way through each other', scene%passed)
    if (model%pairs == 0) return
    call list_ratio('pressed across a gap, of what is allowed', scene%apart)
    call list_larger('  at the widest place, of what is allowed', scene%widest, scene%apart)
    if (scene%beside%ratio >= little) call list_ratio('  beside the other body', scene%beside)

  contains

    !> The largest depth, where it is not that of the worst place.
    subroutine list_larger(name, largest, worst)
      character(len=*), intent(in) :: name
      type(overlap_place), intent(in) :: largest, worst

      if (largest%ratio >= little .and. largest%depth > deeper*worst%depth) call list_ratio(name, largest)
    end subroutine list_larger

    !> A depth, over what is allowed; and where.
    subroutine list_ratio(name, place)
      character(len=*), intent(in) :: name
      type(overlap_place), intent(in) :: place

      if (place%ratio < little) then
        call figure(file, name, '< '//short_real(little))
      else
        call figure(file, name, estimate_number(place%ratio), &
                    '   '//short_real(place%depth)//' at '//point_name(place%x))
      end if
    end subroutine list_ratio
  end subroutine list_scene
end module epcont_report_scene_text
