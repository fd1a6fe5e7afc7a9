!> The boundary in contact, its pressures and gaps, for ParaView.
module epcont_report_vtk_contact
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  use epcont_report_run, only: run_results
  use epcont_report_vtk_grid, only: new_vtk_grid, vtk_cells, vtk_grid, vtk_line, vtk_vertex
  use epcont_result_contact_line, only: contact_line, find_contact_line
  implicit none
  private
  public :: write_vtk_contact

contains

  !> DECK.contact.vtu: pairs are the points, each at its node of the boundary, in the order of the deck; cells
  !! are the lines between neighbours, and the points of pairs that have none.
  subroutine write_vtk_contact(run, path, error)
    type(run_results), intent(in) :: run                  !! what is known of the run
    character(len=*), intent(in) :: path                  !! of the file
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written
    type(contact_line) :: line
    type(vtk_cells) :: cells
    type(vtk_grid) :: grid

    line = find_contact_line(run%model)
    cells = cells_of(line)
    call new_vtk_grid(path, run%outcome%status, run%model%x(:, line%node), cells, grid, error)
    if (allocated(error)) return
    call put_pair_results(run, line%node, grid)
    call grid%begin_cell_data('Scalars="bconp"')
    call grid%put('bconp', contact_ids(run%model, cells%point(cells%last)))
    call grid%finish(error)
  end subroutine write_vtk_contact

  subroutine put_pair_results(run, node, grid)
    type(run_results), intent(in) :: run
    integer, intent(in) :: node(:)   !! of the boundary at each pair
    type(vtk_grid), intent(inout) :: grid
    real(wp) :: force(2, run%model%pairs)
    integer :: k, zone(run%model%pairs)

    do k = 1, run%model%pairs
      force(:, k) = run%answer%contact%force(k)*run%model%normal(:, k)
      if (node(k) /= run%model%pair_node(2, k)) force(:, k) = -force(:, k)
    end do
    zone = 0
    do k = 1, size(run%answer%zones)
      zone(run%answer%zones(k)%pairs) = k
    end do
    call grid%begin_point_data('Scalars="pressure" Vectors="displacement"')
    call grid%put('pair_id', run%model%pair_id)
    call grid%put('node_a', run%model%node_id(run%model%pair_node(1, :)))
    call grid%put('node_b', run%model%node_id(run%model%pair_node(2, :)))
    call grid%put('displacement', run%answer%displacement(:, node))
    call grid%put('contact_force', force)
    call grid%put('pressure', max(0.0_wp, run%answer%pressure))
    call grid%put('has_pressure', merge(1, 0, run%answer%pressure >= 0.0_wp))
    call grid%put('gap', run%answer%contact%gap)
    call grid%put('touching', merge(1, 0, run%answer%contact%touching))
    call grid%put('zone', zone)
  end subroutine put_pair_results

  !> Lines between neighbouring pairs, then pairs that have no neighbour.
  pure function cells_of(line) result(cells)
    type(contact_line), intent(in) :: line
    type(vtk_cells) :: cells
    integer, allocatable :: alone(:)
    integer :: i, k, other, pairs, segment(2, 2*size(line%node)), segments
    logical :: joined(size(line%node))

    pairs = size(line%node)
    joined = .false.
    segments = 0
    do k = 1, pairs
      do i = 1, 2
        other = line%neighbour(i, k)
        if (other == 0) cycle
        if (any(line%neighbour(:, other) == k)) then
          if (other < k) cycle   ! there is this line already
        else if (count(line%node == line%node(other)) > 1) then
          cycle                  ! at a corner: the node's pair on the other face
        end if
        segments = segments + 1
        segment(:, segments) = [k, other]
        joined([k, other]) = .true.
      end do
    end do
    alone = pack([(k, k=1, pairs)], .not. joined)
    cells%kind = [spread(vtk_line, 1, segments), spread(vtk_vertex, 1, size(alone))]
    cells%last = [(2*k, k=1, segments), (2*segments + k, k=1, size(alone))]
    cells%point = [segment(:, :segments), alone]
  end function cells_of

  !> BCONP of pairs; 0 of a CGAP.
  pure function contact_ids(model, pair) result(id)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair(:)
    integer :: c, id(size(pair))

    id = 0
    do c = 1, size(model%line_contact)
      associate (contact => model%line_contact(c))
        where (pair >= contact%first .and. pair <= contact%last) id = contact%bconp(1)
      end associate
    end do
  end function contact_ids
end module epcont_report_vtk_contact
