!> Sentences about bodies that penetrate each other: where, how deep, and what may help.
module epcont_messages_scene_text
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_certificate_scene, only: beyond_place, largest_change, overlap_place, overlaps_type
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_finding, only: of_element, of_node
  use epcont_model_model, only: model_type
  use epcont_messages_names, only: first_grid, point_name
  implicit none
  private
  public :: scene_sentence

  !> Subject of a sentence: why a model is not sound, or a warning, in the order of the warnings.
  integer, parameter, public :: &
    unsound = 0, &
    body_in_itself = 1, &   !! a body passes through itself
    beyond_mirror = 2, &    !! a body passes a line at which it ends and is held
    much_overlap = 3, &     !! large but allowed penetration
    much_gap = 4, &         !! contact force across a large gap
    side_changed = 5, &     !! a side turns or stretches too far
    sides_slid = 6, &       !! sides slide too far along each other where they press
    scene_warnings = 6

  character(len=*), parameter, public :: large_displacements = &
    'displacements too large for small-displacement theory: '
  character(len=*), parameter :: may_help = ' is allowed. Possible fix: '

  !> Words for a place where bodies penetrate each other, or where a pair presses across a gap.
  type :: place_words
    character(len=:), allocatable :: depth, allowed
    character(len=:), allocatable :: at                        !! point, and the edge on which it is
    character(len=:), allocatable :: other_side                !! the edge of the other body
    character(len=:), allocatable :: body, other_body
    character(len=:), allocatable :: penetration, distance     !! clauses
  end type place_words

contains

  !> Write the sentence about one subject. It is empty if there is nothing to say.
  pure function scene_sentence(model, scene, about) result(text)
    type(model_type), intent(in) :: model      !! the model
    type(overlaps_type), intent(in) :: scene   !! findings of the certificate
    integer, intent(in) :: about               !! one of the subjects above
    character(len=:), allocatable :: text

    text = ''
    select case (about)
    case (unsound)
      text = fault(model, scene)
    case (beyond_mirror)
      if (scene%mirror%node > 0) &
        text = 'a body passes through its mirror image: '//beyond(model, scene%mirror)// &
               ', on which its body is fixed; ignore this unless it is a line of symmetry'
    case (side_changed)
      if (scene%change > largest_change) &
        text = large_displacements//side_name(model, scene%changed_side)// &
               ' is rotated or stretched by '//short_real(scene%change)
    case (body_in_itself)
      if (scene%itself%ratio > 1.0_wp) text = place_warning(model, scene, about, scene%itself)
    case (much_overlap)
      if (scene%deep%ratio > 1.0_wp .and. scene%sound()) text = place_warning(model, scene, about, scene%deep)
    case (much_gap)
      if (scene%wide%ratio > 1.0_wp .and. scene%sound()) text = place_warning(model, scene, about, scene%wide)
    case (sides_slid)
      if (scene%slid%ratio > 1.0_wp) text = place_warning(model, scene, about, scene%slid)
    end select
  end function scene_sentence

  !> Write a warning about a place.
  pure function place_warning(model, scene, about, place) result(text)
    type(model_type), intent(in) :: model
    type(overlaps_type), intent(in) :: scene
    integer, intent(in) :: about
    type(overlap_place), intent(in) :: place
    character(len=:), allocatable :: text, by_much, finer
    type(place_words) :: word

    word = words_of(model, place)
    by_much = text_of(nint(100.0_wp*place%depth/scene%moved))//' % of the largest displacement, '// &
              short_real(scene%moved)//': '
    ! Depths shrink with the edges at corners, and faster elsewhere. Sliding and rotation do not shrink.
    finer = '; shorter edges there reduce it'
    if (place%moving) finer = '; rotation or sliding there is large'
    select case (about)
    case (body_in_itself)
      text = 'a body penetrates itself by '//word%depth//', at '//word%at//', behind '// &
             word%other_side//'; '//word%allowed//' is allowed'
    case (much_overlap)
      text = 'bodies penetrate each other by '//by_much//word%penetration//finer
    case (much_gap)
      text = 'a pair carries a force across a gap of '//by_much//word%distance//finer
    case default
      text = large_displacements//'bodies in contact slide by '//word%depth//' along each other, at '// &
             word%at//'; contact uses the undeformed shape'
    end select
  end function place_warning

  !> Write why a model is not sound, and what may help.
  pure function fault(model, scene) result(text)
    type(model_type), intent(in) :: model
    type(overlaps_type), intent(in) :: scene
    character(len=:), allocatable :: passing, text
    type(overlap_place) :: faulty(4), place
    type(place_words) :: word
    integer :: worst

    if (scene%axis%node > 0) then
      text = 'an axisymmetric body reaches a radius below 0: '//beyond(model, scene%axis)// &
             '; small displacements keep radii positive'
      return
    end if
    faulty = [scene%inside, scene%apart, scene%beside, scene%passed]
    worst = maxloc(faulty%ratio, dim=1)
    place = faulty(worst)
    word = words_of(model, place)
    text = ''
    if (worst == 2 .or. worst == 3) &
      text = 'pair '//text_of(model%contact%pair_id(place%pair))//' carries a force '
    select case (worst)
    case (1)
      text = 'bodies pass through each other: '//word%penetration//'; '//word%allowed//may_help// &
             remedy(model, [place%side, place%other])
    case (2)
      text = text//'across a gap: '//word%distance//'; '//word%allowed//may_help// &
             'give pairs of nodes, or lines, that face each other'
    case (3)
      text = text//'beside the other body: at '//word%at//' is '//word%depth//' beside the end of '// &
             word%other_side//'; '//word%allowed//may_help//'draw the bodies in their final positions, '// &
             'or make them longer: contact uses the undeformed shape'
    case (4)
      passing = model%name_of(of_element, model%mesh%body_outline%element(place%side))
      if (place%node > 0) passing = model%name_of(of_node, place%node)
      text = 'bodies pass through each other on their way: '//passing//' of the body of '//word%body// &
             ' goes through that of '//word%other_body//', '//word%depth//' deep, at '// &
             point_name(place%x)//', behind '//word%other_side//'; '//word%allowed//may_help// &
             remedy(model, [place%side, place%other])//', or change the loads and supports that move it'
    end select
  end function fault

  !> Find the words for a place.
  pure type(place_words) function words_of(model, place) result(word)
    type(model_type), intent(in) :: model
    type(overlap_place), intent(in) :: place

    word%depth = short_real(place%depth)
    word%allowed = short_real(place%allowed)
    word%at = point_name(place%x)//' on '//side_name(model, place%side)
    word%other_side = side_name(model, place%other)
    associate (outline => model%mesh%body_outline)
      word%body = first_grid(model, outline%part_of == outline%part(place%side))
      word%other_body = first_grid(model, outline%part_of == outline%part(place%other))
    end associate
    word%penetration = 'the body of '//word%body//' penetrates the body of '//word%other_body//' by '// &
                       word%depth//', at '//word%at//', behind '//word%other_side
    word%distance = 'at '//word%at//' is '//word%depth//' off '//word%other_side
  end function words_of

  !> Write how far a node is displaced beyond a line.
  pure function beyond(model, place) result(text)
    type(model_type), intent(in) :: model
    type(beyond_place), intent(in) :: place
    character(len=:), allocatable :: text

    text = model%name_of(of_node, place%node)//' comes '//short_real(place%depth)//' beyond '// &
           merge('x', 'y', place%component == 1)//' = '//short_real(place%line)
  end function beyond

  !> Name an edge of the outlines by its ends.
  pure function side_name(model, side) result(name)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side
    character(len=:), allocatable :: name

    associate (outline => model%mesh%body_outline)
      name = 'edge '//model%name_of(of_node, outline%node(1, side))//' to '// &
             text_of(model%mesh%node_id(outline%node(2, side)))//' of '// &
             model%name_of(of_element, outline%element(side))
    end associate
  end function side_name

  !> Name cards that would keep the bodies apart at two of their edges.
  pure function remedy(model, side) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: side(2)
    character(len=:), allocatable :: text
    integer :: k

    text = 'add a BLSEG along each of the two edges and a BCONP between the lines, or CGAPs'
    do k = 1, size(model%contact%line_contact)
      associate (couple => model%contact%line_contact(k))
        if (any(are_of(model, couple%slave, side) .and. are_of(model, couple%master, side([2, 1])))) &
          text = 'exchange SLAVE and MASTER of BCONP '//text_of(couple%bconp(1))// &
                 ', or use shorter edges on both lines there'
      end associate
    end do
  end function remedy

  !> Which of two edges of the outlines belong to a line?
  pure function are_of(model, line, side)
    type(model_type), intent(in) :: model
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: side(2)
    logical :: are_of(2)
    integer :: k

    are_of = [(any(line%segment(1, :) == model%mesh%body_outline%node(1, side(k)) .and. &
                   line%element == model%mesh%body_outline%element(side(k))), k=1, 2)]
  end function are_of
end module epcont_messages_scene_text
