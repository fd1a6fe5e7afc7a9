!> Stresses of the elements and reactions of the supports, from the displacements.
module epcont_result_stresses
  use epcont_base_kinds, only: wp
  use epcont_element_tria3, only: tria3_strain_matrix
  use epcont_material_elasticity, only: axial_stress, equivalent_stress, material_matrix
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: recover_stresses

contains

  !> Fill in stresses, equivalent stress and strain, and reactions. `applied` are the nodal forces of loads and
  !! pairs [2, nodes].
  pure subroutine recover_stresses(model, applied, answer)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: applied(:, :)
    type(answer_type), intent(inout) :: answer
    real(wp), allocatable :: unbalanced(:, :)
    real(wp) :: b(3, 6), stress(3), force(6)
    integer :: c, e, k, node, s

    allocate (answer%stress(4, model%elements), answer%equivalent_stress(model%elements))
    allocate (answer%equivalent_strain(model%elements))
    unbalanced = -applied
    do e = 1, model%elements
      s = model%section(e)
      b = tria3_strain_matrix(model%corners(e))
      stress = matmul(material_matrix(model, e), matmul(b, reshape(answer%displacement(:, model%corner(:, e)), [6])))
      answer%stress(:, e) = [stress(1), stress(2), axial_stress(model%poisson(s), model%plane_strain(s), stress), stress(3)]
      answer%equivalent_stress(e) = equivalent_stress(stress, answer%stress(3, e))
      answer%equivalent_strain(e) = answer%equivalent_stress(e)/model%young(s)
      force = model%thickness(s)*model%area(e)*matmul(transpose(b), stress)
      do k = 1, 3
        unbalanced(:, model%corner(k, e)) = unbalanced(:, model%corner(k, e)) + force(2*k - 1:2*k)
      end do
    end do
    allocate (answer%reaction(2, model%nodes), source=0.0_wp)
    do node = 1, model%nodes
      do c = 1, 2
        associate (leader => model%leader(c, node))
          if (model%held(c, leader)) answer%reaction(c, leader) = answer%reaction(c, leader) + unbalanced(c, node)
        end associate
      end do
    end do
  end subroutine recover_stresses
end module epcont_result_stresses
