!> Thermal strains of unconstrained bodies.
module epcont_model_expansion
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_points
  use epcont_element_integration_point, only: evaluate_points, integration_point
  use epcont_element_kinematics, only: plane_stress
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_free_strains

contains

  !> Thermal strains of all points: expansion times temperature difference, interpolated as
  !! displacements are; the mean over the element if it uses the mean change of volume.
  pure subroutine find_free_strains(model)
    type(model_type), intent(inout) :: model   !! the model, with its elements
    type(integration_point) :: point(most_points)
    integer :: e

    if (allocated(model%loads%free_strain)) deallocate (model%loads%free_strain)
    if (.not. allocated(model%loads%rise)) return
    allocate (model%loads%free_strain(model%mesh%points), source=0.0_wp)
    do e = 1, model%mesh%elements
      associate (s => model%mesh%section(e), node => model%mesh%connectivity(:model%mesh%node_count(e), e), &
                 kind => model%mesh%kinds(model%mesh%kind(e)), &
                 strain => model%loads%free_strain(model%mesh%first_point(e):model%mesh%first_point(e + 1) - &
                                                   1))
        if (model%sections%expansion(s) == 0.0_wp) cycle
        strain = model%sections%expansion(s)*matmul(model%loads%rise(:kind%nodes, e), &
                                                    kind%values(:kind%nodes, :kind%points))
        if (.not. kind%mean_dilatation .or. model%sections%kinematics(s) == plane_stress) cycle
        call evaluate_points(kind, model%mesh%x(:, node), model%sections%kinematics(s), &
                             model%sections%thickness(s), &
                             point(:kind%points))
        strain = dot_product(strain, point(:kind%points)%volume)/sum(point(:kind%points)%volume)
      end associate
    end do
    if (all(model%loads%free_strain == 0.0_wp)) deallocate (model%loads%free_strain)
  end subroutine find_free_strains
end module epcont_model_expansion
