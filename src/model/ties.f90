!> DOFs that are sums of others: nodes of an RBE2 whose master node rotates, and MPC equations.
!> DOFs that equal one other DOF (RBE2 without rotation) have a master node instead of a sum.
module epcont_model_ties
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle
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
    integer, parameter :: untouched = 0, begun = 1, done = 2
    integer, allocatable :: state(:), equation(:)
    integer, allocatable :: first(:), component(:), node(:)   ! terms on the cards
    real(wp), allocatable :: weight(:)
    integer :: c, i, k, last, rows

    model%constraints%sum_of = spread([0, 0], 2, model%mesh%nodes)
    rows = directions*sum([(size(model%constraints%platen(k)%follower), k=1, &
                            size(model%constraints%platen))]) + size(model%constraints%equation)
    allocate (first(rows + 1), source=1)
    allocate (equation(rows), state(rows), source=untouched)
    allocate (model%constraints%sum%first(rows), model%constraints%sum%last(rows), source=0)
    last = 0
    rows = 0
    k = 2*size(state) + sum([(size(model%constraints%equation(k)%node), k=1, &
                              size(model%constraints%equation))])
    allocate (component(k), node(k), weight(k))
    do k = 1, size(model%constraints%platen)
      call add_platen()
      if (size(model%constraints%platen(k)%follower) > 0) then
        if (any(model%mesh%x(:, model%constraints%platen(k)%follower) /= &
                spread(model%mesh%x(:, model%constraints%platen(k)%leader), 2, &
                       size(model%constraints%platen(k)%follower)))) cycle
      end if
      call found%add_error(of_node, model%constraints%platen(k)%leader, 0, &
                           ': rotates, and no node that depends on it is'// &
                           ' anywhere else', 'give a GM at another point')
    end do
    do k = 1, size(model%constraints%equation)
      associate (given => model%constraints%equation(k), &
                 first_one => model%constraints%equation(k)%coefficient(1))
        ! A first coefficient of 0.0 has been reported; avoid the division by it.
        call add_row(given%component(1), given%node(1), given%component(2:), given%node(2:), &
                     -given%coefficient(2:)/merge(1.0_wp, first_one, first_one == 0.0_wp))
        equation(rows) = k
      end associate
    end do
    call make_room(last, k, model)
    do k = 1, rows
      if (state(k) == untouched) call resolve(k)
    end do
    call make_room(last, last, model)
    do i = 1, model%mesh%nodes
      do c = 1, directions
        if (model%constraints%leader(c, i) /= i) model%constraints%sum_of(c, i) = &
          model%constraints%sum_of(c, model%constraints%leader(c, i))
      end do
    end do

  contains

    !> Add u = u of the master node + angle x arm.
    subroutine add_platen()
      real(wp) :: arm(directions)
      integer :: j

      associate (platen => model%constraints%platen(k))
        do j = 1, size(platen%follower)
          arm = model%mesh%x(:, platen%follower(j)) - model%mesh%x(:, platen%leader)
          call add_row(1, platen%follower(j), [1, angle], [platen%leader, k], [1.0_wp, -arm(2)])
          call add_row(2, platen%follower(j), [2, angle], [platen%leader, k], [1.0_wp, arm(1)])
        end do
      end associate
    end subroutine add_platen

    !> Add a row for one DOF, with its terms.
    subroutine add_row(c, follower, components, nodes, weights)
      integer, intent(in) :: c, follower, components(:), nodes(:)
      real(wp), intent(in) :: weights(:)

      rows = rows + 1
      model%constraints%sum_of(c, follower) = rows
      first(rows + 1) = first(rows) + size(nodes)
      associate (from => first(rows), to => first(rows + 1) - 1)
        component(from:to) = components
        node(from:to) = nodes
        weight(from:to) = weights
      end associate
    end subroutine add_row

    !> Replace each term that is a sum by the terms of that sum.
    recursive subroutine resolve(row)
      integer, intent(in) :: row
      integer :: i, j

      state(row) = begun
      do i = first(row), first(row + 1) - 1
        if (component(i) == angle) cycle
        node(i) = model%constraints%leader(component(i), node(i))
        j = model%constraints%sum_of(component(i), node(i))
        if (j == 0) cycle
        if (state(j) == begun) then
          ! The row may be that of a platen; a circle has an equation.
          call found%add_error(of_equation, maxval(equation, mask=state == begun), 0, ': '// &
                               freedom(model, component(i), node(i))//' would depend on itself', &
                               'remove the circle of equations')
          model%constraints%sum_of(component(i), node(i)) = 0
        else if (state(j) == untouched) then
          call resolve(j)
        end if
      end do
      call put_terms(first, component, node, weight, row, model, last)
      state(row) = done
    end subroutine resolve
  end subroutine complete_ties

  !> Add the independent terms of a DOF.
  subroutine put_terms(first, component, node, weight, row, model, last)
    integer, intent(in) :: first(:), component(:), node(:), row
    real(wp), intent(in) :: weight(:)
    type(model_type), intent(inout) :: model
    integer, intent(inout) :: last
    integer :: i, j

    model%constraints%sum%first(row) = last + 1
    do i = first(row), first(row + 1) - 1
      j = 0
      if (component(i) /= angle) j = model%constraints%sum_of(component(i), node(i))
      if (j == 0) then
        call put([component(i)], [node(i)], [weight(i)])
      else
        associate (from => model%constraints%sum%first(j), to => model%constraints%sum%last(j))
          call put([model%constraints%sum%component(from:to)], [model%constraints%sum%node(from:to)], &
                   weight(i)*model%constraints%sum%weight(from:to))
        end associate
      end if
    end do
    model%constraints%sum%last(row) = last

  contains

    subroutine put(components, nodes, weights)
      integer, intent(in) :: components(:), nodes(:)
      real(wp), intent(in) :: weights(:)

      if (last + size(nodes) > size(model%constraints%sum%node)) call make_room(last, &
        2*(last + size(nodes)), model)
      model%constraints%sum%component(last + 1:last + size(nodes)) = components
      model%constraints%sum%node(last + 1:last + size(nodes)) = nodes
      model%constraints%sum%weight(last + 1:last + size(nodes)) = weights
      last = last + size(nodes)
    end subroutine put
  end subroutine put_terms

  !> Make space for more terms after the present ones.
  subroutine make_room(last, terms, model)
    integer, intent(in) :: last, terms
    type(model_type), intent(inout) :: model
    integer :: new_component(terms), new_node(terms)
    real(wp) :: new_weight(terms)

    if (last > 0) then
      new_component(:last) = model%constraints%sum%component(:last)
      new_node(:last) = model%constraints%sum%node(:last)
      new_weight(:last) = model%constraints%sum%weight(:last)
    end if
    model%constraints%sum%component = new_component
    model%constraints%sum%node = new_node
    model%constraints%sum%weight = new_weight
  end subroutine make_room

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
