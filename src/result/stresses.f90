!> Stresses of the elements and reactions of the supports.
module epcont_result_stresses
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference
  use epcont_material_elasticity, only: equivalent_stress
  use epcont_material_material_law, only: point_state
  use epcont_model_model, only: model_type
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: recover_stresses, place_of_point, first_largest

contains

  !> Fill in stresses, strains, moduli and reactions. `applied` are the nodal forces of loads and pairs [2,
  !! nodes].
  pure subroutine recover_stresses(model, linear, applied, answer)
    type(model_type), intent(in) :: model
    type(linear_problem), intent(in) :: linear
    real(wp), intent(in) :: applied(:, :)
    type(answer_type), intent(inout) :: answer
    type(point_state) :: point
    real(wp), allocatable :: mises(:)   !! at each point
    real(wp) :: modulus, share, whole
    integer :: e, p

    call clear_elements(model%elements, answer)
    mises = [(equivalent_stress(answer%point_stress(:, p)), p=1, model%points)]
    do e = 1, model%elements
      associate (law => linear%materials%section(model%section(e))%law, first => model%first_point(e), &
                 last => model%first_point(e + 1) - 1)
        whole = sum(linear%operator%volume(first:last))
        answer%largest_stress(e) = maxval(mises(first:last))
        answer%largest_at(e) = first - 1 + first_largest(mises(first:last))
        do p = first, last
          if (allocated(answer%point)) then
            point = answer%point(p)
          else
            call law%update(answer%strain(:, p), point_state(), point)
          end if
          modulus = law%young
          if (point%yielded) modulus = 1.0_wp/(1.0_wp/point%modulus + law%shift)
          share = linear%operator%volume(p)/whole
          answer%stress(:, e) = answer%stress(:, e) + share*answer%point_stress(:, p)
          answer%equivalent_stress(e) = answer%equivalent_stress(e) + share*mises(p)
          answer%equivalent_strain(e) = answer%equivalent_strain(e) + share*point%total
          answer%secant_modulus(e) = answer%secant_modulus(e) + share*modulus
          answer%plastic(e) = answer%plastic(e) .or. point%yielded
          answer%beyond(e) = answer%beyond(e) .or. point%beyond
        end do
      end associate
    end do
    answer%reaction = reactions(model, linear%operator%nodal_forces(model, answer%point_stress), applied)
  end subroutine recover_stresses

  !> Nothing yet of any element.
  pure subroutine clear_elements(elements, answer)
    integer, intent(in) :: elements
    type(answer_type), intent(inout) :: answer

    if (.not. allocated(answer%stress)) then
      allocate (answer%stress(4, elements), answer%equivalent_stress(elements), answer%equivalent_strain(elements))
      allocate (answer%secant_modulus(elements), answer%plastic(elements), answer%beyond(elements))
      allocate (answer%largest_stress(elements), answer%largest_at(elements))
    end if
    answer%stress = 0.0_wp
    answer%equivalent_stress = 0.0_wp
    answer%equivalent_strain = 0.0_wp
    answer%secant_modulus = 0.0_wp
    answer%plastic = .false.
    answer%beyond = .false.
  end subroutine clear_elements

  !> Where the largest of some stresses is; of equal ones, but for rounding, the first.
  pure integer function first_largest(stress) result(k)
    real(wp), intent(in) :: stress(:)

    k = findloc(stress >= maxval(stress)*(1.0_wp - least_difference), .true., dim=1)
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
