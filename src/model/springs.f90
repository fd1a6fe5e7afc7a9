!> Springs between two freedoms, or one and the ground.
module epcont_model_springs
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: spring_forces, spring_stretch

contains

  !> By how much the second end of a spring moves beyond the first [length].
  pure real(wp) function spring_stretch(model, k, displacement) result(stretch)
    type(model_type), intent(in) :: model        !! the scene
    integer, intent(in) :: k                     !! which spring
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    integer :: i

    stretch = 0.0_wp
    do i = 1, 2
      associate (node => model%spring(k)%node(i), c => model%spring(k)%component(i))
        if (node > 0) stretch = stretch + (2*i - 3)*displacement(c, node)
      end associate
    end do
  end function spring_stretch

  !> Forces that nodes must exert on all springs to hold them [force] [2, nodes].
  pure function spring_forces(model, displacement) result(force)
    type(model_type), intent(in) :: model        !! the scene
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), allocatable :: force(:, :)
    real(wp) :: pull
    integer :: i, k

    allocate (force(size(displacement, 1), size(displacement, 2)), source=0.0_wp)
    do k = 1, size(model%spring)
      pull = model%spring(k)%stiffness*spring_stretch(model, k, displacement)
      do i = 1, 2
        associate (node => model%spring(k)%node(i), c => model%spring(k)%component(i))
          if (node > 0) force(c, node) = force(c, node) + (2*i - 3)*pull
        end associate
      end do
    end do
  end function spring_forces
end module epcont_model_springs
