!> Bodies that pass through each other, in words: where, how deep, and what would mend it.
module epcont_messages_scene_text
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_certificate_scene, only: beyond_place, largest_change, overlap_place, overlaps_type
  use epcont_contact_geometry_mates, only: find_mates, is_mate
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_finding, only: of_element, of_node
  use epcont_model_model, only: model_type
  use epcont_messages_names, only: first_grid, point_name
  implicit none
  private
  public :: scene_sentence

  !> What a sentence is about: why a scene is not sound; or what is warned of, in the order of the warnings.
  integer, parameter, public :: &
    unsound = 0, &
    body_in_itself = 1, &   !! a body passes through itself
    beyond_mirror = 2, &    !! a body passes a line at which it ends and is held
    much_overlap = 3, &     !! bodies lie in each other by much, but allowed
    much_gap = 4, &         !! a pair presses across as wide a gap
    side_changed = 5, &     !! a side turns or stretches too far
    sides_slid = 6, &       !! sides slide too far along each other where they press
    scene_warnings = 6

  !> Depths that differ by less than this part are not told apart.
  real(wp), parameter, public :: deeper = 1.1_wp

  !> Sentences about a place; `word_for` says what stands for the names in braces.
  character(len=*), parameter :: &
    lies_in = 'the body of {body} lies {depth} deep in that of {other body}, '// &
              'at {point} on {side}, behind {other side}', &
    is_off = 'at {point} on {side} is {depth} off {other side}', &
    by_much = '{share} % of the largest displacement, {moved}: ', &
    mending = '; {allowed} is allowed. What may mend it: '

  character(len=*), parameter :: warning(scene_warnings) = [character(len=300) :: &
    'a body passes through itself: it lies {depth} deep, at {point} on {side}, behind {other side}; '// &
    '{allowed} is allowed', &
    'a body passes through its mirror image: {beyond}, to which its body is held; '// &
    'no harm where that is no line of symmetry', &
    'bodies lie in each other by '//by_much//lies_in//'{finer}', &
    'a pair presses across a gap of '//by_much//is_off//'{finer}', &
    'displacements are not small: {changed side} is turned or stretched by {change}', &
    'displacements are not small: bodies that press on each other slide by {depth} along each other, '// &
    'at {point} on {side}, where sides are {length} long; contact is that of undeformed places']

  !> Of bodies in each other, pairs apart or beside the other body, bodies that passed, rings beyond the axis.
  character(len=*), parameter :: fault(5) = [character(len=300) :: &
    'bodies pass through each other: '//lies_in//'; {allowed} is allowed{deepest}. '// &
    'What may mend it: {remedy}', &
    'pair {pair} presses across a gap: '//is_off//mending//'pairs of nodes, or lines, that face each other', &
    'pair {pair} presses beside the other body: at {point} on {side} is {depth} beside the end of '// &
    '{other side}'//mending//'bodies drawn where they come to, or longer ones: '// &
    'contact is that of undeformed places', &
    'bodies pass through each other on their way: {passing} of the body of {body} goes through that of '// &
    '{other body}, {depth} deep at {point}, behind {other side}'//mending// &
    '{remedy}, or loads and supports that move it another way', &
    'a ring is pressed to a radius below 0: {beyond}; where displacements are small radii stay above 0']

contains

  !> What speaks against a scene, or is to be known of it though it may be sound; empty: nothing.
  pure function scene_sentence(model, scene, about) result(text)
    type(model_type), intent(in) :: model   !! the model
    type(overlaps_type), intent(in) :: scene   !! as the certificate has it
    integer, intent(in) :: about            !! one of the subjects above
    character(len=:), allocatable :: text
    type(overlap_place) :: place, faulty(4), warned(scene_warnings)
    type(beyond_place) :: farthest
    logical :: speaks(scene_warnings)
    integer :: worst

    if (about == unsound) then
      faulty = [scene%inside, scene%apart, scene%beside, scene%passed]
      worst = maxloc(faulty%ratio, dim=1)
      place = faulty(worst)
      farthest = scene%axis
      text = told(fault(merge(5, worst, scene%axis%node > 0)))
      return
    end if
    warned = [scene%itself, overlap_place(), scene%deep, scene%wide, overlap_place(), scene%slid]
    speaks = warned%ratio > 1.0_wp
    if (.not. scene%sound()) speaks([much_overlap, much_gap]) = .false.
    speaks(beyond_mirror) = scene%mirror%node > 0
    speaks(side_changed) = scene%change > largest_change
    place = warned(about)
    farthest = scene%mirror
    text = ''
    if (speaks(about)) text = told(warning(about))

  contains

    !> A sentence about the place, filled in.
    pure function told(sentence) result(text)
      character(len=*), intent(in) :: sentence
      character(len=:), allocatable :: text
      integer :: brace, from

      text = ''
      from = 1
      do
        brace = from + index(sentence(from:), '{') - 1
        if (brace < from) exit
        text = text//sentence(from:brace - 1)
        from = brace + index(sentence(brace:), '}')
        text = text//word_for(sentence(brace + 1:from - 2))
      end do
      text = text//trim(sentence(from:))
    end function told

    !> What stands in a sentence for one of the names in braces.
    pure function word_for(name) result(text)
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: text

      text = ''
      select case (name)
      case ('point')
        text = point_name(place%x)
      case ('depth')
        text = short_real(place%depth)
      case ('allowed')
        text = short_real(place%allowed)
      case ('side')
        text = side_name(place%side)
      case ('other side')
        text = side_name(place%other)
      case ('body')
        text = body_name(place%side)
      case ('other body')
        text = body_name(place%other)
      case ('pair')
        text = text_of(model%pair_id(place%pair))
      case ('passing')
        text = model%name_of(of_element, model%body_outline%element(place%side))
        if (place%node > 0) text = model%name_of(of_node, place%node)
      case ('length')
        text = short_real(longest_side())
      case ('share')
        text = text_of(nint(100.0_wp*place%depth/scene%moved))
      case ('moved')
        text = short_real(scene%moved)
      case ('finer')   ! depths shrink with the sides at corners, faster elsewhere; what is left is not told
        text = '; sides of about '//short_real(longest_side()/place%ratio)//' there would leave 10 %'
        if (place%moving) text = '; turns and slides there are not small'
      case ('deepest')
        if (scene%deepest%depth > deeper*place%depth) &
          text = ' (deepest, '//short_real(scene%deepest%depth)//', they are at '// &
                 point_name(scene%deepest%x)//', where '//short_real(scene%deepest%allowed)//' is allowed)'
      case ('remedy')
        text = remedy([place%side, place%other])
      case ('beyond')
        text = model%name_of(of_node, farthest%node)//' comes '//short_real(farthest%depth)//' beyond '// &
               merge('x', 'y', farthest%component == 1)//' = '//short_real(farthest%line)
      case ('changed side')
        text = side_name(scene%changed_side)
      case ('change')
        text = short_real(scene%change)
      end select
    end function word_for

    !> A side of the outlines by its ends.
    pure function side_name(side) result(name)
      integer, intent(in) :: side
      character(len=:), allocatable :: name

      name = 'side '//model%name_of(of_node, model%body_outline%node(1, side))//' to '// &
             text_of(model%node_id(model%body_outline%node(2, side)))// &
             ' of '//model%name_of(of_element, model%body_outline%element(side))
    end function side_name

    !> The body that a side belongs to, by its first node.
    pure function body_name(side) result(name)
      integer, intent(in) :: side
      character(len=:), allocatable :: name

      name = first_grid(model, model%body_outline%part_of == model%body_outline%part(side))
    end function body_name

    !> Length of the longer of the two sides at the place, as drawn [length].
    pure real(wp) function longest_side() result(longest)
      associate (node => model%body_outline%node(:2, [place%side, place%other]))
        longest = maxval(norm2(model%x(:, node(2, :)) - model%x(:, node(1, :)), dim=1))
      end associate
    end function longest_side

    !> What would keep the bodies apart at two sides of theirs.
    pure function remedy(side) result(text)
      integer, intent(in) :: side(2)
      character(len=:), allocatable :: text
      logical :: of_slave(2), of_master(2)
      integer :: k, line(2)

      do k = size(model%line_contact), 1, -1
        of_slave = are_of(model%line_contact(k)%slave, side)
        of_master = are_of(model%line_contact(k)%master, side)
        if (.not. any(of_slave .and. of_master([2, 1]))) cycle
        text = 'shorter sides of both lines there'
        if (of_master(1)) text = 'SLAVE and MASTER of BCONP '//text_of(model%line_contact(k)%bconp(1))// &
                                 ' exchanged, or '//text
        return
      end do
      line = 0
      do k = 1, size(model%line)
        where ([any(model%line(k)%side == side(1)), any(model%line(k)%side == side(2))]) line = k
      end do
      if (all(line > 0)) then
        text = 'a BCONP between BLSEG '//text_of(model%line(line(1))%id)//' and BLSEG '// &
               text_of(model%line(line(2))%id)
      else if (any(line > 0)) then
        text = 'a BLSEG along '//side_name(side(minloc(line, dim=1)))// &
               ', and a BCONP between it and BLSEG '//text_of(model%line(maxval(line))%id)
      else
        text = 'a BLSEG along each of the two sides, and a BCONP between the lines'
        if (is_mate(find_mates(model), model%body_outline%node(:, side(1)), &
                    model%body_outline%part(side(2)))) text = 'more CGAPs there, or '//text
      end if
    end function remedy

    !> Which of two sides of the bodies' outlines belong to a line.
    pure function are_of(line, side)
      class(boundary_line), intent(in) :: line
      integer, intent(in) :: side(2)
      logical :: are_of(2)
      integer :: k

      are_of = [(any(line%segment(1, :) == model%body_outline%node(1, side(k)) .and. &
                     line%element == model%body_outline%element(side(k))), k=1, 2)]
    end function are_of
  end function scene_sentence
end module epcont_messages_scene_text
