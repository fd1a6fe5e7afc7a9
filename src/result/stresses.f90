!> Stresses of the elements and reactions of the supports.
module epcont_result_stresses
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference
  use epcont_element_element_kind, only: most_points
  use epcont_element_kinematics, only: components, directions
  use epcont_material_curve, only: curve_value, deviatoric_curve, new_curve
  use epcont_material_elasticity, only: elasticity, equivalent_stress
  use epcont_material_material_law, only: point_state
  use epcont_model_arrays, only: angle
  use epcont_model_controls, only: uniaxial_curve
  use epcont_model_model, only: model_type
  use epcont_model_springs, only: spring_forces
  use epcont_model_ties, only: platen_angle
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_result_answer, only: answer_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: recover_stresses, place_of_point, first_largest

contains

  !> Fill in stresses, strains, moduli and reactions.
  subroutine recover_stresses(model, linear, applied, answer)
    type(model_type), intent(in) :: model        !! model
    type(linear_problem), intent(in) :: linear     !! of the last solve
    real(wp), intent(in) :: applied(:, :)        !! nodal forces of loads and contact [force] [2, nodes]
    type(answer_type), intent(inout) :: answer   !! with its state
    real(wp), allocatable :: force(:, :)   ! internal forces at the nodes [force] [2, nodes]
    real(wp) :: shortfall
    integer :: c, e, leader, node

    associate (n => model%mesh%elements)
      if (.not. allocated(answer%stress)) &
        allocate (answer%stress(components, n), answer%equivalent_stress(n), answer%equivalent_strain(n), &
                  answer%secant_modulus(n), answer%largest_stress(n), answer%largest_at(n), &
                  answer%plastic(n), answer%beyond(n))
    end associate
    shortfall = 0.0_wp
    if (allocated(answer%plastic_strain)) deallocate (answer%plastic_strain)
    if (model%controls%by_increments .and. linear%materials%yields) &
      allocate (answer%plastic_strain(5, model%mesh%elements), source=0.0_wp)
    !$omp parallel do num_threads(threads_over(model%mesh%elements)) reduction(max:shortfall)
    do e = 1, model%mesh%elements
      call recover_element(model, linear, e, answer, shortfall)
    end do
    !$omp end parallel do
    answer%shortfall = shortfall
    force = linear%operator%nodal_forces(model, answer%point_stress)
    if (size(model%constraints%spring) > 0) force = force + spring_forces(model, answer%deformation)
    answer%reaction = spread([0.0_wp, 0.0_wp], 2, model%mesh%nodes)
    answer%moment = spread(0.0_wp, 1, size(model%constraints%platen))
    answer%angle = [(platen_angle(model, node, answer%displacement), node=1, size(model%constraints%platen))]
    do node = 1, model%mesh%nodes
      do c = 1, directions
        if (model%constraints%sum_of(c, node) > 0) then
          call add_to_terms(model%constraints%sum_of(c, node), force(c, node) - applied(c, node))
        else
          leader = model%constraints%leader(c, node)
          if (model%constraints%held(c, leader)) &
            answer%reaction(c, leader) = answer%reaction(c, leader) + force(c, node) - applied(c, node)
        end if
      end do
    end do

  contains

    !> Move the force on a dependent DOF to those of its master DOFs that are fixed.
    subroutine add_to_terms(row, force)
      integer, intent(in) :: row
      real(wp), intent(in) :: force
      integer :: i

      do i = 1, size(model%constraints%sum(row)%node)
        associate (c => model%constraints%sum(row)%component(i), at => model%constraints%sum(row)%node(i), &
                   share => model%constraints%sum(row)%coefficient(i)*force)
          if (c == angle) then
            if (model%constraints%platen(at)%held) answer%moment(at) = answer%moment(at) + share
          else if (model%constraints%held(c, at)) then
            answer%reaction(c, at) = answer%reaction(c, at) + share
          end if
        end associate
      end do
    end subroutine add_to_terms
  end subroutine recover_stresses

  !> Find stresses of one element: means over its points, and the largest stress.
  pure subroutine recover_element(model, linear, e, answer, shortfall)
    type(model_type), intent(in) :: model
    type(linear_problem), intent(in) :: linear
    integer, intent(in) :: e
    type(answer_type), intent(inout) :: answer
    real(wp), intent(inout) :: shortfall   !! largest part by which (2-4) leaves a stress below the curve
    type(point_state) :: point
    real(wp) :: mises(most_points), modulus, share, whole
    integer :: p

    associate (law => linear%materials%section(model%mesh%section(e)), first => model%mesh%first_point(e), &
               last => model%mesh%first_point(e + 1) - 1, volume => linear%operator%volume)
      answer%stress(:, e) = 0.0_wp
      answer%equivalent_stress(e) = 0.0_wp
      answer%equivalent_strain(e) = 0.0_wp
      answer%secant_modulus(e) = 0.0_wp
      answer%plastic(e) = .false.
      answer%beyond(e) = .false.
      whole = sum(volume(first:last))
      do p = first, last
        mises(p - first + 1) = equivalent_stress(answer%point_stress(:, p))
      end do
      answer%largest_at(e) = first - 1 + first_largest(mises(:last - first + 1))
      answer%largest_stress(e) = maxval(mises(:last - first + 1))
      do p = first, last
        modulus = law%young
        point%total = mises(p - first + 1)/modulus
        if (allocated(answer%point)) point = answer%point(p)
        if (point%plastic) then   ! from the curve; stress over strain if there are several increments
          modulus = 1.0_wp/(1.0_wp/point%modulus + law%shift)
          if (allocated(linear%materials%committed)) modulus = mises(p - first + 1)/point%total
        end if
        share = volume(p)/whole
        answer%stress(:, e) = answer%stress(:, e) + share*answer%point_stress(:, p)
        answer%equivalent_stress(e) = answer%equivalent_stress(e) + share*mises(p - first + 1)
        answer%equivalent_strain(e) = answer%equivalent_strain(e) + share*point%total
        answer%secant_modulus(e) = answer%secant_modulus(e) + share*modulus
        if (allocated(answer%plastic_strain)) then
          associate (history => law%history_after(linear%materials%history(p), point))
            answer%plastic_strain(:, e) = answer%plastic_strain(:, e) + &
                                          share*[history%strain, history%accumulated]
          end associate
        end if
        answer%plastic(e) = answer%plastic(e) .or. point%plastic
        answer%beyond(e) = answer%beyond(e) .or. point%beyond
        if (model%controls%paper_ratio) &
          shortfall = max(shortfall, below_curve(model%sections%curve(model%mesh%section(e)), &
                                                 law%elasticity, point))
      end do
    end associate
  end subroutine recover_element

  !> Find the part by which (2-4) leaves a stress below the curve.
  pure real(wp) function below_curve(uniaxial, elastic, point) result(part)
    type(uniaxial_curve), intent(in) :: uniaxial
    type(elasticity), intent(in) :: elastic
    type(point_state), intent(in) :: point
    type(deviatoric_curve) :: curve   ! without (2-4)
    type(curve_value) :: on_curve

    curve = new_curve(uniaxial, elastic, .false.)
    on_curve = curve%at_strain(point%deviatoric)
    part = 1.0_wp - point%modulus/on_curve%modulus
  end function below_curve

  !> Find the largest of some stresses; if equal up to rounding, the first.
  pure integer function first_largest(stress) result(k)
    real(wp), intent(in) :: stress(:)   !! [stress] [any]

    k = findloc(stress >= maxval(stress)*(1.0_wp - least_difference), .true., dim=1)
  end function first_largest

  !> Find the coordinates of an integration point [length].
  pure function place_of_point(model, point) result(x)
    type(model_type), intent(in) :: model   !! model
    integer, intent(in) :: point            !! its number
    real(wp) :: x(directions)

    associate (e => model%mesh%point_element(point), &
               kind => model%mesh%kinds(model%mesh%kind(model%mesh%point_element(point))))
      x = matmul(model%mesh%coordinates(e), kind%values(:kind%nodes, point - model%mesh%first_point(e) + 1))
    end associate
  end function place_of_point
end module epcont_result_stresses
