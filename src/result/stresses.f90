!> Stresses of the elements and reactions of the supports.
module epcont_result_stresses
  use epcont_assembly_strain_operator, only: strain_operator
  use epcont_base_kinds, only: wp
  use epcont_material_elasticity, only: equivalent_stress
  use epcont_material_material_law, only: point_state
  use epcont_material_scene_materials, only: scene_materials
  use epcont_model_model, only: model_type
  use epcont_plasticity_scene_state, only: scene_state
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: recover_stresses, place_of_point, first_largest

  !> Stresses that differ by less than this part are the same.
  real(wp), parameter :: same = 1.0e-9_wp

contains

  !> Fill in stresses, strains, moduli and reactions. `applied` are the nodal forces of loads and pairs [2, nodes].
  pure subroutine recover_stresses(model, operator, materials, state, applied, answer)
    type(model_type), intent(in) :: model
    type(strain_operator), intent(in) :: operator
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: state
    real(wp), intent(in) :: applied(:, :)
    type(answer_type), intent(inout) :: answer
    type(point_state) :: point
    real(wp), allocatable :: mises(:)   !! at each point
    real(wp) :: modulus, share, whole
    integer :: e, p

    allocate (answer%point_stress, source=state%stress)
    allocate (answer%stress(4, model%elements), answer%equivalent_stress(model%elements), source=0.0_wp)
    allocate (answer%equivalent_strain(model%elements), answer%secant_modulus(model%elements), source=0.0_wp)
    allocate (answer%plastic(model%elements), answer%beyond(model%elements), source=.false.)
    allocate (answer%largest_stress(model%elements), answer%largest_at(model%elements))
    mises = [(equivalent_stress(state%stress(:, p)), p=1, model%points)]
    do e = 1, model%elements
      associate (law => materials%section(model%section(e))%law, first => model%first_point(e), &
                 last => model%first_point(e + 1) - 1)
        whole = sum(operator%volume(first:last))
        answer%largest_stress(e) = maxval(mises(first:last))
        answer%largest_at(e) = first - 1 + first_largest(mises(first:last))
        do p = first, last
          if (allocated(state%point)) then
            point = state%point(p)
          else
            call law%update(state%strain(:, p), point_state(), point)
          end if
          modulus = law%young
          if (point%yielded) modulus = 1.0_wp/(1.0_wp/point%modulus + law%shift)
          share = operator%volume(p)/whole
          answer%stress(:, e) = answer%stress(:, e) + share*state%stress(:, p)
          answer%equivalent_stress(e) = answer%equivalent_stress(e) + share*mises(p)
          answer%equivalent_strain(e) = answer%equivalent_strain(e) + share*point%total
          answer%secant_modulus(e) = answer%secant_modulus(e) + share*modulus
          answer%plastic(e) = answer%plastic(e) .or. point%yielded
          answer%beyond(e) = answer%beyond(e) .or. point%beyond
        end do
      end associate
    end do
    answer%reaction = reactions(model, operator%nodal_forces(model, state%stress), applied)
  end subroutine recover_stresses

  !> Where the largest of some stresses is; of equal ones, but for rounding, the first.
  pure integer function first_largest(stress) result(k)
    real(wp), intent(in) :: stress(:)

    k = findloc(stress >= maxval(stress)*(1.0_wp - same), .true., dim=1)
  end function first_largest

  !> Coordinates of an integration point [length].
  pure function place_of_point(model, point) result(x)
    type(model_type), intent(in) :: model
    integer, intent(in) :: point
    real(wp) :: x(2)

    associate (e => model%point_element(point))
      x = matmul(model%coordinates(e), model%kinds(model%kind(e))%values(:model%order(e), point - model%first_point(e) + 1))
    end associate
  end function place_of_point

  !> What the supports must hold [force] [2, nodes].
  pure function reactions(model, force, applied) result(reaction)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: force(:, :)     !! that the elements need at the nodes [2, nodes]
    real(wp), intent(in) :: applied(:, :)
    real(wp), allocatable :: reaction(:, :)
    integer :: c, node

    allocate (reaction(2, model%nodes), source=0.0_wp)
    do node = 1, model%nodes
      do c = 1, 2
        associate (leader => model%leader(c, node))
          if (model%held(c, leader)) reaction(c, leader) = reaction(c, leader) + force(c, node) - applied(c, node)
        end associate
      end do
    end do
  end function reactions
end module epcont_result_stresses
