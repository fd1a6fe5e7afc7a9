!> Compare stresses of elements with strains found from displacements alone, and find nodal forces from the
!> work of the stresses in unit displacements.
module epcont_certificate_element_checks
  use epcont_base_kinds, only: wp
  use epcont_certificate_free_expansion, only: expansion_type, free_strains
  use epcont_certificate_increment_work, only: point_energies
  use epcont_certificate_unit_strains, only: strain_by, unit_strains
  use epcont_certificate_yielding, only: replayed_history, return_to_curve, stress_on_curve, &
      von_mises_stress
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_kinematics, only: axisymmetric, components, directions, plane_stress
  use epcont_model_model, only: model_type
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: checked_elements, check_elements, ratio

  !> Results of some consecutive elements.
  type :: checked_elements
    real(wp), allocatable :: force(:, :, :)   !! on their nodes [force] [directions, nodes, elements]
    real(wp), allocatable :: work(:)          !! of the stresses [points]
    real(wp) :: strained = 0.0_wp             !! volume times the largest strain [length**3]
    real(wp) :: off_curve = 0.0_wp, motion_strain = 0.0_wp, lost_stress = 0.0_wp   !! as in the certificate
    real(wp) :: rounding_stress = 0.0_wp, stress_roundings = 0.0_wp
    type(expansion_type) :: expansion
    type(replayed_history), allocatable :: history(:)   !! flow theory: after the increment [points]
    type(point_energies) :: energy                      !! flow theory
  end type checked_elements

  !> Strains and volumes at an element's integration points.
  type :: element_points
    real(wp) :: unit(components, directions, most_nodes, most_points)   !! strains by unit displacements
    real(wp) :: volume(most_points), free(most_points)                  !! and thermal strains
  end type element_points

contains

  !> Check some consecutive elements.
  subroutine check_elements(model, answer, largest_stress, range, slope, part, before)
    type(model_type), intent(in) :: model       !! the model
    type(answer_type), intent(in) :: answer     !! its displacements, deformations and stresses
    real(wp), intent(in) :: largest_stress      !! reference for stresses [stress]
    integer, intent(in) :: range(2)             !! numbers of the first and last element
    real(wp), intent(in) :: slope(directions, most_nodes, most_points, *)   !! of each element type
    type(checked_elements), intent(out) :: part
    !> Flow theory: history before the increment [points]
    type(replayed_history), intent(in), optional :: before(:)
    type(element_points) :: points
    real(wp) :: force(directions)
    integer :: c, e, k, p

    allocate (part%force(directions, size(model%mesh%connectivity, 1), range(1):range(2)), source=0.0_wp)
    allocate (part%work(model%mesh%first_point(range(1)):model%mesh%first_point(range(2) + 1) - 1))
    if (present(before)) allocate (part%history, source=before(lbound(part%work, 1):ubound(part%work, 1)))
    do e = range(1), range(2)
      call unit_strains(model, e, slope(:, :, :, model%mesh%kind(e)), points%unit, points%volume)
      call free_strains(model, e, model%loads%rise, points%volume, points%free)
      associate (stress => answer%point_stress(:, &
                                               model%mesh%first_point(e):model%mesh%first_point(e + 1) - 1))
        call check_points(model, answer, largest_stress, e, points, part)
        call part%expansion%add_element(model%sections%young(model%mesh%section(e)), stress, &
          points%unit(:, :, :model%mesh%node_count(e), :), points%volume, &
          inelastic_strains(points%free(:size(stress, 2)), part, model%mesh%first_point(e)))
        do k = 1, model%mesh%node_count(e)
          do p = 1, size(stress, 2)
            do c = 1, directions
              force(c) = points%volume(p)*dot_product(stress(:, p), points%unit(:, c, k, p))
            end do
            part%force(:, k, e) = part%force(:, k, e) + force
          end do
        end do
      end associate
    end do
  end subroutine check_elements

  !> Thermal and plastic strains of an element [components, points].
  pure function inelastic_strains(free, part, first) result(strain)
    real(wp), intent(in) :: free(:)             !! thermal, along each axis [points]
    type(checked_elements), intent(in) :: part
    integer, intent(in) :: first                !! number of its first point
    real(wp) :: strain(components, size(free))
    integer :: p

    do p = 1, size(free)
      strain(:, p) = free(p)*[1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp]
      if (allocated(part%history)) &
        strain(:, p) = strain(:, p) + part%history(first + p - lbound(part%work, 1))%plastic
    end do
  end function inelastic_strains

  !> Check the integration points of an element.
  subroutine check_points(model, answer, largest_stress, e, points, part)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    real(wp), intent(in) :: largest_stress
    integer, intent(in) :: e
    type(element_points), intent(in) :: points
    type(checked_elements), intent(inout) :: part
    real(wp), dimension(directions, most_nodes) :: motion, u
    real(wp) :: largest, farthest, rounding, strain(components)   ! strain by `u`, and rigid-body displacement
                                                                  ! with `motion`
    real(wp) :: on_curve(components)   ! stress of the material
    real(wp) :: reached                ! largest stress; at least the yield stress if the point has yielded
    type(replayed_history) :: before   ! flow theory: the increment
    integer :: k, n, node, p
    logical :: moves, ring

    n = model%mesh%node_count(e)
    ring = model%sections%kinematics(model%mesh%section(e)) == axisymmetric
    do k = 1, n
      node = model%mesh%connectivity(k, e)
      u(:, k) = answer%deformation(:, node)
      motion(:, k) = answer%displacement(:, node) - u(:, k)
    end do
    moves = any(motion(:, :n) /= 0.0_wp)
    largest = maxval(abs(u(:, :n)))
    farthest = maxval(abs(motion(:, :n)) + abs(u(:, :n)))
    do p = 1, model%mesh%kinds(model%mesh%kind(e))%points
      ! Rounding error of a strain by unit displacements.
      rounding = epsilon(1.0_wp)*maxval(abs(points%unit(:, :, :n, p)))
      strain = strain_by(n, u, points%unit(1, 1, 1, p), ring)
      associate (point => model%mesh%first_point(e) + p - 1)
        part%work(point) = points%volume(p)*dot_product(answer%point_stress(:, point), strain)
        part%strained = part%strained + points%volume(p)*maxval(abs(strain))
        strain(:3) = strain(:3) - points%free(p)
        reached = largest_stress
        associate (section => model%mesh%section(e))
          if (.not. allocated(part%history)) then
            on_curve = stress_on_curve(model, section, strain)
          else
            associate (history => part%history(point - lbound(part%work, 1) + 1), &
                       curve => model%sections%curve(section))
              before = history
              if (.not. allocated(curve%strain) .or. curve%elastic) then
                on_curve = stress_on_curve(model, section, strain)
              else
                call return_to_curve(model, section, strain, history, on_curve)
                if (history%hardened > 0.0_wp) reached = max(reached, curve%stress(2))
              end if
              history%stress = on_curve
              history%free = points%free(p)
              call part%energy%add_point(model, section, points%volume(p), strain, before, history)
            end associate
          end if
          call check_stress(model, reached, section, on_curve, answer%point_stress(:, point), &
                            rounding*largest, part)
        end associate
      end associate
      if (.not. moves) cycle
      strain = strain_by(n, motion, points%unit(1, 1, 1, p), ring)
      rounding = rounding*farthest
      part%motion_strain = max(part%motion_strain, ratio(maxval(abs(strain)), rounding))
    end do
  end subroutine check_points

  !> Find the stress error, relative. If the material yields, it is the larger of two: the von Mises stress of
  !! the difference over the stress on the curve (at least the yield stress, if stresses reach it), and the
  !! difference of the mean stresses, which are elastic, over the largest stress. (In plane stress they are
  !! not, and the first one contains them.) If the material is elastic, it is the largest difference over the
  !! largest stress. Stress errors by rounding of strains have the same references.
  subroutine check_stress(model, largest_stress, section, on_curve, stress, rounding, part)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: largest_stress   !! reference [stress]
    integer, intent(in) :: section
    real(wp), intent(in) :: on_curve(components), stress(components)   !! of the material; of the answer
    real(wp), intent(in) :: rounding         !! rounding error of the strain
    type(checked_elements), intent(inout) :: part
    real(wp) :: apart(components), off, scale, stiffest

    apart = stress - on_curve
    scale = largest_stress
    off = ratio(maxval(abs(apart)), largest_stress)
    if (allocated(model%sections%curve(section)%strain)) then
      scale = max(von_mises_stress(on_curve), min(model%sections%curve(section)%stress(2), largest_stress))
      off = ratio(von_mises_stress(apart), scale)
      if (model%sections%kinematics(section) /= plane_stress) &
        off = max(off, ratio(abs(sum(apart(:3)))/3.0_wp, largest_stress))
    end if
    part%off_curve = max(part%off_curve, off)
    ! Stress over strain along one axis if lateral strain is fixed: far above E if Poisson's ratio is close to
    ! 0.5.
    associate (young => model%sections%young(section), nu => model%sections%poisson(section))
      stiffest = young
      if (model%sections%kinematics(section) /= plane_stress) &
        stiffest = young*(1.0_wp - nu)/((1.0_wp + nu)*(1.0_wp - 2.0_wp*nu))
      part%lost_stress = max(part%lost_stress, ratio(young*rounding, scale), &
                             ratio(stiffest*rounding, largest_stress))
      part%rounding_stress = max(part%rounding_stress, stiffest*rounding)
      part%stress_roundings = max(part%stress_roundings, &
                                  ratio(maxval(abs([stress, on_curve])), stiffest*rounding))
    end associate
  end subroutine check_stress

  !> a/b; 0 if both are 0 or a is negative; finite unless a or b is NaN.
  elemental real(wp) function ratio(a, b)
    real(wp), intent(in) :: a, b

    ratio = 0.0_wp
    if (.not. a <= 0.0_wp) ratio = a/max(b, tiny(b)*max(a, 1.0_wp))
  end function ratio
end module epcont_certificate_element_checks
