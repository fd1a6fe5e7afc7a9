!> DOFs that are sums of others: nodes of an RBE2 whose master node rotates, and MPC equations.
!> DOFs that equal one other DOF (RBE2 without rotation) have a master node instead of a sum.
module epcont_model_ties
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle, linear_equation
  use epcont_model_finding, only: findings, of_equation, of_node, of_platen
  use epcont_model_freedoms, only: freedom, why_not_tied
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: add_moment, check_equation, complete_ties, platen_angle, turn_followers

contains

  !> Make the nodes of a platen depend on its master node, if possible.
  subroutine turn_followers(model, platen, found)
    type(model_type), intent(inout) :: model   !! the model; other nodes are removed from the platen
    integer, intent(in) :: platen              !! index of the rotating platen
    type(findings), intent(inout) :: found     !! errors are added
    character(len=:), allocatable :: remedy, why
    logical, allocatable :: follows(:)
    integer :: c, i

    associate (node => model%constraints%platen(platen)%follower)
      allocate (follows(size(node)), source=.true.)
      do i = 1, size(node)
        do c = 1, directions
          call why_not_tied(model, c, node(i), model%constraints%platen(platen)%leader, why, remedy)
          if (len(why) == 0) cycle
          call found%add_error(of_platen, platen, -i, ': '//freedom(model, c, node(i))//why, remedy)
          follows(i) = .false.
          exit
        end do
        if (follows(i)) model%constraints%sum_of(:, node(i)) = 1   ! a placeholder until the rows exist
      end do
    end associate
    model%constraints%platen(platen)%follower = pack(model%constraints%platen(platen)%follower, follows)
  end subroutine turn_followers

  !> Check that the first DOF of an equation can depend on the others.
  subroutine check_equation(model, k, found)
    type(model_type), intent(inout) :: model   !! the model; the DOF is marked
    integer, intent(in) :: k                   !! index of the equation
    type(findings), intent(inout) :: found     !! errors are added
    character(len=:), allocatable :: why

    associate (c => model%constraints%equation(k)%component(1), node => model%constraints%equation(k)%node(1))
      why = ''
      if (model%constraints%equation(k)%coefficient(1) == 0.0_wp) then
        why = ' has the coefficient 0.0'
      else if (model%constraints%sum_of(c, node) > 0 .or. model%constraints%leader(c, node) /= node) then
        why = ' depends on an RBE2 or another MPC already'
      else if (model%constraints%held(c, node)) then
        why = ' is fixed by a support'
      else if (model%constraints%reference(c, node)) then
        why = ' is a SUPORT DOF'
      end if
      if (len(why) > 0) call found%add_error(of_equation, k, -1, ': '//freedom(model, c, node)//why// &
        ', and cannot depend on the others', 'put a DOF first that no other card fixes or moves')
      model%constraints%sum_of(c, node) = 1
    end associate
  end subroutine check_equation

  !> Write each of these DOFs as a sum of independent DOFs. (Chains of ties are already resolved.)
  subroutine complete_ties(model, found)
    type(model_type), intent(inout) :: model   !! the model
    type(findings), intent(inout) :: found     !! equations with circular dependence are added
    integer :: c, i

    call list_rows(model, found)
    call resolve_rows(model, found)
    associate (constraints => model%constraints)
      do i = 1, model%mesh%nodes
        do c = 1, directions
          if (constraints%leader(c, i) /= i) &
            constraints%sum_of(c, i) = constraints%sum_of(c, constraints%leader(c, i))
        end do
      end do
    end associate
  end subroutine complete_ties

  !> List the rows of the nodes of platens, u = u of the master node + angle x arm, then those of the
  !! equations, as they are given.
  subroutine list_rows(model, found)
    type(model_type), intent(inout) :: model
    type(findings), intent(inout) :: found
    real(wp) :: arm(directions)
    integer :: i, k, rows
    logical :: turns

    model%constraints%sum_of = spread([0, 0], 2, model%mesh%nodes)
    rows = directions*sum([(size(model%constraints%platen(k)%follower), k=1, size(model%constraints%platen))])
    allocate (model%constraints%sum(rows + size(model%constraints%equation)))
    rows = 0
    do k = 1, size(model%constraints%platen)
      associate (platen => model%constraints%platen(k))
        turns = .false.
        do i = 1, size(platen%follower)
          arm = model%mesh%x(:, platen%follower(i)) - model%mesh%x(:, platen%leader)
          turns = turns .or. any(arm /= 0.0_wp)
          call add_row(1, platen%follower(i), [1, angle], [platen%leader, k], [1.0_wp, -arm(2)])
          call add_row(2, platen%follower(i), [2, angle], [platen%leader, k], [1.0_wp, arm(1)])
        end do
        if (.not. turns) call found%add_error(of_node, platen%leader, 0, &
          ': rotates, and no node that depends on it is anywhere else', 'give a GM at another point')
      end associate
    end do
    do k = 1, size(model%constraints%equation)
      associate (given => model%constraints%equation(k), &
                 first_one => model%constraints%equation(k)%coefficient(1))
        ! A first coefficient of 0.0 has been reported; avoid the division by it.
        call add_row(given%component(1), given%node(1), given%component(2:), given%node(2:), &
                     -given%coefficient(2:)/merge(1.0_wp, first_one, first_one == 0.0_wp))
      end associate
    end do

  contains

    !> Add a row for one DOF, with its terms.
    subroutine add_row(c, follower, component, node, weight)
      integer, intent(in) :: c, follower, component(:), node(:)
      real(wp), intent(in) :: weight(:)

      rows = rows + 1
      model%constraints%sum_of(c, follower) = rows
      model%constraints%sum(rows)%component = component
      model%constraints%sum(rows)%node = node
      model%constraints%sum(rows)%coefficient = weight
    end subroutine add_row
  end subroutine list_rows

  !> Replace each term that is a sum by the terms of that sum.
  subroutine resolve_rows(model, found)
    type(model_type), intent(inout) :: model
    type(findings), intent(inout) :: found
    integer, parameter :: untouched = 0, begun = 1, done = 2
    integer :: k, state(size(model%constraints%sum))

    state = untouched
    do k = 1, size(state)
      if (state(k) == untouched) call resolve(k)
    end do

  contains

    recursive subroutine resolve(k)
      integer, intent(in) :: k
      type(linear_equation) :: given, whole
      integer :: c, i, j, node

      state(k) = begun
      given = model%constraints%sum(k)
      allocate (whole%component(0), whole%node(0), whole%coefficient(0))
      do i = 1, size(given%node)
        c = given%component(i)
        node = given%node(i)
        j = 0
        if (c /= angle) then
          node = model%constraints%leader(c, node)
          j = model%constraints%sum_of(c, node)
        end if
        if (j > 0) then
          if (state(j) == untouched) call resolve(j)
          if (state(j) == begun) then
            ! The row may be that of a platen; a circle has an equation, and these are the last rows.
            call found%add_error(of_equation, size(model%constraints%equation) - size(state) + &
                                 findloc(state, begun, dim=1, back=.true.), 0, ': '// &
                                 freedom(model, c, node)//' would depend on itself', &
                                 'remove the circle of equations')
            model%constraints%sum_of(c, node) = 0
            j = 0
          end if
        end if
        if (j == 0) then
          whole%component = [whole%component, c]
          whole%node = [whole%node, node]
          whole%coefficient = [whole%coefficient, given%coefficient(i)]
        else
          associate (sum => model%constraints%sum(j))
            whole%component = [whole%component, sum%component]
            whole%node = [whole%node, sum%node]
            whole%coefficient = [whole%coefficient, given%coefficient(i)*sum%coefficient]
          end associate
        end if
      end do
      model%constraints%sum(k) = whole
      state(k) = done
    end subroutine resolve
  end subroutine resolve_rows

  !> Apply a moment at a rotating platen as forces: on the dependent nodes, normal and proportional to their
  !! arms, and on the master node the negative of their sum.
  pure subroutine add_moment(model, platen, moment, load)
    type(model_type), intent(in) :: model     !! the model
    integer, intent(in) :: platen             !! index of the rotating platen
    real(wp), intent(in) :: moment            !! counter-clockwise [force*length]
    real(wp), intent(inout) :: load(:, :)     !! forces are added [force] [2, nodes]
    real(wp) :: arm(directions, size(model%constraints%platen(platen)%follower)), force(directions), squares
    integer :: i

    associate (follower => model%constraints%platen(platen)%follower, &
               leader => model%constraints%platen(platen)%leader)
      arm = model%mesh%x(:, follower) - spread(model%mesh%x(:, leader), 2, size(follower))
      squares = sum(arm**2)
      do i = 1, size(follower)
        force = moment/squares*[-arm(2, i), arm(1, i)]
        load(:, follower(i)) = load(:, follower(i)) + force
        load(:, leader) = load(:, leader) - force
      end do
    end associate
  end subroutine add_moment

  !> Angle of a platen from the displacements of its dependent nodes [radian].
  pure real(wp) function platen_angle(model, platen, displacement) result(turn)
    type(model_type), intent(in) :: model        !! the model
    integer, intent(in) :: platen                !! index of the rotating platen
    real(wp), intent(in) :: displacement(:, :)   !! [length] [2, nodes]
    real(wp), dimension(directions) :: arm, moved
    real(wp) :: squares
    integer :: i

    turn = 0.0_wp
    squares = 0.0_wp
    associate (follower => model%constraints%platen(platen)%follower, &
               leader => model%constraints%platen(platen)%leader)
      do i = 1, size(follower)
        arm = model%mesh%x(:, follower(i)) - model%mesh%x(:, leader)
        moved = displacement(:, follower(i)) - displacement(:, leader)
        turn = turn + arm(1)*moved(2) - arm(2)*moved(1)
        squares = squares + sum(arm**2)
      end do
    end associate
    turn = turn/squares
  end function platen_angle
end module epcont_model_ties
