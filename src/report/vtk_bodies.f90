!> The bodies and all that is known of their nodes and elements, for ParaView.
module epcont_report_vtk_bodies
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_model_model, only: model_type
  use epcont_report_vtk_grid, only: new_vtk_grid, vtk_cells, vtk_grid
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: write_vtk_bodies

contains

  !> DECK.vtu: nodes that belong to elements are the points, in the order of the deck; elements are the cells.
  subroutine write_vtk_bodies(stem, model, answer, status, error)
    character(len=*), intent(in) :: stem
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    integer, intent(in) :: status   !! exit status of the run
    type(error_type), allocatable, intent(out) :: error
    type(vtk_grid) :: grid
    integer, allocatable :: node(:)
    integer :: i

    node = pack([(i, i=1, model%nodes)], has_element(model))
    call new_vtk_grid(stem//'.vtu', status, model%x(:, node), cells_of(model, node), grid, error)
    if (allocated(error)) return
    call put_node_results(model, answer, node, grid)
    call put_element_results(model, answer, grid)
    call grid%finish(error)
  end subroutine write_vtk_bodies

  subroutine put_node_results(model, answer, node, grid)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    integer, intent(in) :: node(:)   !! of each point
    type(vtk_grid), intent(inout) :: grid
    real(wp), allocatable :: force(:, :)

    force = pair_forces(model, answer%contact%force)
    call grid%begin_point_data('Vectors="displacement"')
    call grid%integers('node_id', model%node_id(node))
    call grid%vectors('displacement', answer%displacement(:, node))
    call grid%vectors('contact_force', force(:, node))
    call grid%vectors('reaction', answer%reaction(:, node))
  end subroutine put_node_results

  subroutine put_element_results(model, answer, grid)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(vtk_grid), intent(inout) :: grid

    call grid%begin_cell_data('Scalars="equivalent_stress"')
    call grid%integers('element_id', model%element_id)
    call grid%integers('body', model%body(model%connectivity(1, :)))
    call grid%integers('property_id', model%property_id(model%section))
    call grid%integers('material_id', model%material_id(model%section))
    call grid%tensors('stress', answer%stress)
    call grid%reals('equivalent_stress', answer%equivalent_stress)
    call grid%reals('max_equivalent_stress', answer%largest_stress)
    call grid%reals('equivalent_strain', answer%equivalent_strain)
    call grid%reals('secant_modulus', answer%secant_modulus)
    call grid%integers('yielded', merge(1, 0, answer%plastic))
  end subroutine put_element_results

  !> Which nodes belong to elements.
  pure function has_element(model) result(has)
    type(model_type), intent(in) :: model
    logical :: has(model%nodes)
    integer :: e

    has = .false.
    do e = 1, model%elements
      has(model%connectivity(:model%order(e), e)) = .true.
    end do
  end function has_element

  !> The elements; VTK has their nodes in the order that the model has.
  pure function cells_of(model, node) result(cells)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node(:)   !! of each point
    type(vtk_cells) :: cells
    integer, allocatable :: point(:)   !! of each node
    integer :: e, i

    allocate (point(model%nodes), source=0)
    point(node) = [(i, i=1, size(node))]
    allocate (cells%kind(model%elements), cells%last(model%elements), cells%point(sum(model%order)))
    i = 0
    do e = 1, model%elements
      cells%kind(e) = model%kinds(model%kind(e))%vtk
      cells%last(e) = i + model%order(e)
      cells%point(i + 1:cells%last(e)) = point(model%connectivity(:model%order(e), e))
      i = cells%last(e)
    end do
  end function cells_of
end module epcont_report_vtk_bodies
