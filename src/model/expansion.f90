!> What temperatures would strain the bodies by, were they free to.
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

  !> Free strains of all points: expansion times what the temperature is above that of reference, between the
  !! nodes as displacements are; the mean of it where an element has the mean of its change of volume.
  pure subroutine find_free_strains(model)
    type(model_type), intent(inout) :: model   !! the scene, with its elements
    type(integration_point) :: point(most_points)
    integer :: e

    if (allocated(model%free_strain)) deallocate (model%free_strain)
    if (.not. allocated(model%temperature)) return
    allocate (model%free_strain(model%points), source=0.0_wp)
    do e = 1, model%elements
      associate (s => model%section(e), node => model%connectivity(:model%node_count(e), e), &
                 kind => model%kinds(model%kind(e)), &
                 strain => model%free_strain(model%first_point(e):model%first_point(e + 1) - 1))
        if (model%expansion(s) == 0.0_wp) cycle
        strain = model%expansion(s)*matmul(model%temperature(node) - model%reference_temperature(s), &
                                           kind%values(:kind%nodes, :kind%points))
        if (.not. kind%mean_dilatation .or. model%kinematics(s) == plane_stress) cycle
        call evaluate_points(kind, model%x(:, node), model%kinematics(s), model%thickness(s), &
                             point(:kind%points))
        strain = dot_product(strain, point(:kind%points)%volume)/sum(point(:kind%points)%volume)
      end associate
    end do
    if (all(model%free_strain == 0.0_wp)) deallocate (model%free_strain)
  end subroutine find_free_strains
end module epcont_model_expansion
