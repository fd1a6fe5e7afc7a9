!> Springs, RBE2 and MPC for the certificate: from the data of the cards (master nodes, lever arms,
!> coefficients), not from the solver's sums.
module epcont_certificate_tied
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: linear_equation, turning_platen
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_springs, check_ties, gather_ties, longest_arms

contains

  !> Add the forces of springs at their ends.
  pure subroutine check_springs(model, displacement, residual, sizes, stored)
    type(model_type), intent(in) :: model         !! model
    real(wp), intent(in) :: displacement(:, :)    !! [length] [directions, nodes]
    real(wp), intent(inout) :: residual(:, :)     !! forces are added [force] [directions, nodes]
    real(wp), intent(inout) :: sizes(:)           !! absolute forces are added, except rounding [force]
                                                  !! [nodes]
    real(wp), intent(inout) :: stored             !! spring energy is added [force*length]
    real(wp) :: apart, pull, u(2)
    integer :: i, k

    do k = 1, size(model%constraints%spring)
      associate (node => model%constraints%spring(k)%node, c => model%constraints%spring(k)%component)
        u = 0.0_wp
        do i = 1, 2
          if (node(i) > 0) u(i) = displacement(c(i), node(i))
        end do
        apart = u(2) - u(1)
        pull = model%constraints%spring(k)%stiffness*apart
        stored = stored + pull*apart
        do i = 1, 2
          if (node(i) == 0) cycle
          residual(c(i), node(i)) = residual(c(i), node(i)) + merge(-pull, pull, i == 1)
          if (abs(apart) > cancelled*maxval(abs(u))) sizes(node(i)) = sizes(node(i)) + abs(pull)
        end do
      end associate
    end do
  end subroutine check_springs

  !> Move the forces on dependent DOFs to their master DOFs, which may depend on others.
  pure subroutine gather_ties(model, residual, torque)
    type(model_type), intent(in) :: model         !! model
    real(wp), intent(inout) :: residual(:, :)     !! [force] [directions, nodes]
    real(wp), intent(out) :: torque(:)            !! on rotating platens [force*length] [platens]
    integer :: c, k, leader, node
    logical :: handed

    torque = 0.0_wp
    do
      handed = .false.
      do node = 1, model%mesh%nodes
        do c = 1, directions
          leader = model%constraints%leader(c, node)
          if (leader == node) cycle
          residual(c, leader) = residual(c, leader) + residual(c, node)
          residual(c, node) = 0.0_wp
        end do
      end do
      do k = 1, size(model%constraints%platen)
        call gather_platen(model, model%constraints%platen(k), residual, torque(k), handed)
      end do
      do k = 1, size(model%constraints%equation)
        call gather_equation(model%constraints%equation(k), residual, handed)
      end do
      if (.not. handed) exit
    end do
  end subroutine gather_ties

  !> Move the forces on dependent nodes of a rotating platen, and their moment, to its master node.
  pure subroutine gather_platen(model, platen, residual, torque, handed)
    type(model_type), intent(in) :: model
    type(turning_platen), intent(in) :: platen
    real(wp), intent(inout) :: residual(:, :), torque
    logical, intent(inout) :: handed              !! a force was moved
    real(wp) :: arm(directions)
    integer :: i

    do i = 1, size(platen%follower)
      associate (force => residual(:, platen%follower(i)))
        if (all(force == 0.0_wp)) cycle
        arm = model%mesh%x(:, platen%follower(i)) - model%mesh%x(:, platen%leader)
        torque = torque + arm(1)*force(2) - arm(2)*force(1)
        residual(:, platen%leader) = residual(:, platen%leader) + force
        force = 0.0_wp
        handed = .true.
      end associate
    end do
  end subroutine gather_platen

  !> Move the force on the dependent DOF of an equation to the other DOFs.
  pure subroutine gather_equation(equation, residual, handed)
    type(linear_equation), intent(in) :: equation
    real(wp), intent(inout) :: residual(:, :)
    logical, intent(inout) :: handed
    real(wp) :: force
    integer :: i

    force = residual(equation%component(1), equation%node(1))
    residual(equation%component(1), equation%node(1)) = 0.0_wp
    handed = handed .or. force /= 0.0_wp
    do i = 2, size(equation%node)
      associate (at => residual(equation%component(i), equation%node(i)))
        at = at - equation%coefficient(i)/equation%coefficient(1)*force
      end associate
    end do
  end subroutine gather_equation

  !> Check the positions of dependent nodes against their master node and one rotation angle, from the
  !! farthest of them, and check the equations.
  pure subroutine check_ties(model, displacement, turn, apart)
    type(model_type), intent(in) :: model         !! model
    real(wp), intent(in) :: displacement(:, :)    !! [length] [directions, nodes]
    real(wp), intent(out) :: turn(:)              !! rotation angles [rad] [platens]
    real(wp), intent(out) :: apart                !! largest violation / largest displacement
    integer :: i, k

    apart = 0.0_wp
    do k = 1, size(turn)
      call check_platen(model, model%constraints%platen(k), displacement, turn(k), apart)
    end do
    do k = 1, size(model%constraints%equation)
      associate (given => model%constraints%equation(k))
        apart = max(apart, abs(sum([(given%coefficient(i)*displacement(given%component(i), given%node(i)), &
                                     i=1, size(given%node))]))/sum(abs(given%coefficient)))
      end associate
    end do
    if (apart > 0.0_wp) apart = apart/maxval(abs(displacement))
  end subroutine check_ties

  !> Check the dependent nodes of one platen.
  pure subroutine check_platen(model, platen, displacement, turn, apart)
    type(model_type), intent(in) :: model
    type(turning_platen), intent(in) :: platen
    real(wp), intent(in) :: displacement(:, :)
    real(wp), intent(out) :: turn
    real(wp), intent(inout) :: apart
    real(wp), dimension(directions, size(platen%follower)) :: arm, moved
    integer :: far

    arm = model%mesh%x(:, platen%follower) - spread(model%mesh%x(:, platen%leader), 2, size(platen%follower))
    moved = displacement(:, platen%follower) - &
            spread(displacement(:, platen%leader), 2, size(platen%follower))
    far = maxloc(sum(arm**2, dim=1), dim=1)
    turn = (arm(1, far)*moved(2, far) - arm(2, far)*moved(1, far))/sum(arm(:, far)**2)
    apart = max(apart, maxval(abs(moved(1, :) + turn*arm(2, :))), maxval(abs(moved(2, :) - turn*arm(1, :))))
  end subroutine check_platen

  !> Find the longest lever arm of each rotating platen [length] [platens].
  pure function longest_arms(model) result(length)
    type(model_type), intent(in) :: model         !! model
    real(wp) :: length(size(model%constraints%platen))
    integer :: i, k

    do k = 1, size(length)
      associate (platen => model%constraints%platen(k))
        length(k) = maxval([(norm2(model%mesh%x(:, platen%follower(i)) - model%mesh%x(:, platen%leader)), &
                             i=1, size(platen%follower))])
      end associate
    end do
  end function longest_arms
end module epcont_certificate_tied
