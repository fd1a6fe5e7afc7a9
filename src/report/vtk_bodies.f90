!> The bodies and all that is known of their nodes and elements, for ParaView.
module epcont_report_vtk_bodies
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_model_model, only: model_type
  use epcont_report_run, only: run_results
  use epcont_report_vtk_grid, only: new_vtk_grid, vtk_cells, vtk_grid
  implicit none
  private
  public :: write_vtk_bodies

contains

  !> DECK.vtu: nodes that belong to elements are the points, in the order of the deck; elements are the cells.
  subroutine write_vtk_bodies(run, path, error)
    type(run_results), intent(in) :: run                  !! what is known of the run
    character(len=*), intent(in) :: path                  !! of the file
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written
    type(vtk_grid) :: grid
    integer, allocatable :: node(:)
    integer :: i

    associate (model => run%model)
      node = pack([(i, i=1, model%nodes)], has_element(model))
      call new_vtk_grid(path, run%outcome%status, model%x(:, node), cells_of(model, node), grid, error)
      if (allocated(error)) return
      call put_node_results(run, node, grid)
      call put_element_results(run, grid)
    end associate
    call grid%finish(error)
  end subroutine write_vtk_bodies

  subroutine put_node_results(run, node, grid)
    type(run_results), intent(in) :: run
    integer, intent(in) :: node(:)   !! of each point
    type(vtk_grid), intent(inout) :: grid
    real(wp), allocatable :: force(:, :)

    force = pair_forces(run%model, run%answer%contact%force)
    call grid%begin_point_data('Vectors="displacement"')
    call grid%put('node_id', run%model%node_id(node))
    call grid%put('displacement', run%answer%displacement(:, node))
    call grid%put('contact_force', force(:, node))
    call grid%put('reaction', run%answer%reaction(:, node))
  end subroutine put_node_results

  subroutine put_element_results(run, grid)
    type(run_results), intent(in) :: run
    type(vtk_grid), intent(inout) :: grid

    call grid%begin_cell_data('Scalars="equivalent_stress"')
    call grid%put('element_id', run%model%element_id)
    call grid%put('body', run%model%body(run%model%connectivity(1, :)))
    call grid%put('property_id', run%model%property_id(run%model%section))
    call grid%put('material_id', run%model%material_id(run%model%section))
    call grid%put('stress', run%answer%stress)
    call grid%put('equivalent_stress', run%answer%equivalent_stress)
    call grid%put('max_equivalent_stress', run%answer%largest_stress)
    call grid%put('equivalent_strain', run%answer%equivalent_strain)
    call grid%put('secant_modulus', run%answer%secant_modulus)
    call grid%put('yielded', merge(1, 0, run%answer%plastic))
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
