!> What came of the lines in contact, for the plan: pairs, nodes left out, corners.
module epcont_report_line_plan
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_model_model, only: line_contact, model_type
  use epcont_report_layout, only: newline
  implicit none
  private
  public :: lines_text

  !> Contacts that are told of one by one, and corners of each line.
  integer, parameter :: most = 20, most_corners = 8

contains

  !> All contacts of lines.
  pure function lines_text(model) result(text)
    type(model_type), intent(in) :: model
    character(len=:), allocatable :: text
    integer :: k

    text = ''
    do k = 1, min(most, size(model%line_contact))
      text = text//contact_text(model, model%line_contact(k))
    end do
    if (size(model%line_contact) > most) &
      text = text//'  and '//plural(size(model%line_contact) - most, 'further contact')//' of lines'//newline
  end function lines_text

  !> One of them.
  pure function contact_text(model, contact) result(text)
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    character(len=:), allocatable :: text

    text = '  BCONP '//list_of(contact%bconp)//': nodes of BLSEG '//list_of(contact%slave_id)// &
           ' against sides of BLSEG '//list_of(contact%master_id)//': '// &
           plural(contact%last - contact%first + 1, 'pair')//', initial gaps '// &
           short_real(minval(model%initial_gap(contact%first:contact%last)))//' to '// &
           short_real(maxval(model%initial_gap(contact%first:contact%last)))
    if (contact%nodes_left_out > 0) text = text//'; left out, since they face nothing within '//short_real(contact%search)// &
                                           ': '//plural(contact%nodes_left_out, 'node')
    text = text//newline
    if (contact%last >= contact%first_of_master) &
      text = text//'    of these nodes of BLSEG '//list_of(contact%master_id)//' that stand on sides of the former: '// &
             text_of(contact%last - contact%first_of_master + 1)//newline
    if (contact%is_wider .or. size(contact%came_near) > 0) &
      text = text//'    solved anew, with nodes that came near'//newline
    text = text//corner_text(model, contact%slave, contact%slave_id)//corner_text(model, contact%master, contact%master_id)
  end function contact_text

  !> Numbers with commas.
  pure function list_of(numbers) result(text)
    integer, intent(in) :: numbers(:)
    character(len=:), allocatable :: text
    integer :: k

    text = text_of(numbers(1))
    do k = 2, size(numbers)
      text = text//', '//text_of(numbers(k))
    end do
  end function list_of

  !> The corners of lines: where a face ends, and nothing is smoothed.
  pure function corner_text(model, line, id) result(text)
    type(model_type), intent(in) :: model
    class(boundary_line), intent(in) :: line
    integer, intent(in) :: id(:)
    character(len=:), allocatable :: text
    integer, allocatable :: node(:)
    integer :: k

    node = pack(line%segment(1, :), line%corner(1, :) .and. .not. line%mirrored(1, :))
    node = [node, pack(line%segment(2, :), line%corner(2, :) .and. .not. line%mirrored(2, :) .and. line%neighbour(2, :) == 0)]
    text = ''
    if (size(node) == 0) return
    text = '    corners of BLSEG '//list_of(id)//': GRID '//list_of(model%node_id(node(:min(size(node), most_corners))))
    k = size(node) - most_corners
    if (k > 0) text = text//', and '//text_of(k)//' more'
    text = text//newline
  end function corner_text
end module epcont_report_line_plan
