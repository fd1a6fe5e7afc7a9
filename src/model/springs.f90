!> Springs between two DOFs, or between a DOF and the ground.
module epcont_model_springs
  use epcont_base_kinds, only: wp
  use epcont_model_finding, only: findings, of_spring
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_spring_ends, spring_forces, spring_stretch

contains

  !> Check that a spring has at least one end at a DOF, and that its ends differ.
  subroutine check_spring_ends(model, found)
    type(model_type), intent(in) :: model    !! the model
    type(findings), intent(inout) :: found   !! errors are added
    integer :: bare, grounded   ! end without a direction; with the direction of the ground, 0 if absent
    integer :: k

    do k = 1, size(model%constraints%spring)
      associate (node => model%constraints%spring(k)%node, component => model%constraints%spring(k)%component)
        grounded = findloc(node == 0 .and. component > 0, .true., dim=1)
        bare = findloc(node > 0 .and. component == 0, .true., dim=1)
        if (all(node == 0)) then
          call found%add_error(of_spring, k, 0, ': has no node', &
                               'give a node and its direction at one end; 0 or blank is the ground')
        else if (grounded > 0) then
          call found%add_error(of_spring, k, grounded, ': has a direction at the ground', &
                               'write 0 or blank, or give its node')
        else if (bare > 0) then
          call found%add_error(of_spring, k, bare, ': has no direction there', 'give direction 1 or 2')
        else if (node(1) == node(2) .and. component(1) == component(2)) then
          call found%add_error(of_spring, k, 0, ': has both ends at one DOF', 'use two DOFs')
        end if
      end associate
    end do
  end subroutine check_spring_ends

  !> Elongation of a spring: displacement of its second end minus that of its first end [length].
  pure real(wp) function spring_stretch(model, k, displacement) result(stretch)
    type(model_type), intent(in) :: model        !! the model
    integer, intent(in) :: k                     !! index of the spring
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    integer :: i

    stretch = 0.0_wp
    do i = 1, 2
      associate (node => model%constraints%spring(k)%node(i), c => model%constraints%spring(k)%component(i))
        if (node > 0) stretch = stretch + (2*i - 3)*displacement(c, node)
      end associate
    end do
  end function spring_stretch

  !> Forces of the nodes on all springs [force] [2, nodes].
  pure function spring_forces(model, displacement) result(force)
    type(model_type), intent(in) :: model        !! the model
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), allocatable :: force(:, :)
    real(wp) :: pull
    integer :: i, k

    allocate (force(size(displacement, 1), size(displacement, 2)), source=0.0_wp)
    do k = 1, size(model%constraints%spring)
      pull = model%constraints%spring(k)%stiffness*spring_stretch(model, k, displacement)
      do i = 1, 2
        associate (node => model%constraints%spring(k)%node(i), c => model%constraints%spring(k)%component(i))
          if (node > 0) force(c, node) = force(c, node) + (2*i - 3)*pull
        end associate
      end do
    end do
  end function spring_forces
end module epcont_model_springs
