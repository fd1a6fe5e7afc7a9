!> Freedoms that follow others (RBE2), those of reference (SUPORT), the bodies that elements and ties make of
!> nodes, and the rigid motion that supports prescribe to a body as a whole. That is taken off before the
!> body is solved and added afterwards, as the motions are that supports leave free: it strains nothing, and
!> strains would lose their digits in it.
module epcont_model_freedoms
  use epcont_base_kinds, only: wp
  use epcont_base_partition, only: new_partition, partition
  use epcont_base_text, only: text_of
  use epcont_base_tolerances, only: cancelled, same_place
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle, dof_tie
  use epcont_model_finding, only: findings, of_node, of_reference, of_tie
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: freedom, tie_freedom, why_not_tied, follow_to_the_end, check_reference, join_nodes, find_travels

  !> A motion is taken off where all supports of a body follow it but for this part of the largest prescribed
  !! displacement.
  real(wp), parameter :: follows = 1.0e-2_wp

contains

  !> Apply a tie, if it is possible.
  pure subroutine tie_freedom(model, k, tie, found)
    type(model_type), intent(inout) :: model   !! the scene
    integer, intent(in) :: k                   !! position of the tie
    type(dof_tie), intent(in) :: tie
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    character(len=:), allocatable :: remedy, why

    associate (c => tie%component, node => tie%node, leader => tie%leader)
      call why_not_tied(model, c, node, leader, why, remedy)
      if (len(why) == 0) then
        model%constraints%leader(c, node) = leader
      else
        call found%add_error(of_tie, k, 0, ': '//freedom(model, c, node)//why, remedy)
      end if
    end associate
  end subroutine tie_freedom

  !> Why a freedom cannot follow that of another node, and what would be right; empty: it can.
  pure subroutine why_not_tied(model, c, node, leader, why, remedy)
    type(model_type), intent(in) :: model      !! the scene
    integer, intent(in) :: c, node             !! direction and node of the freedom
    integer, intent(in) :: leader              !! the node that it would follow
    character(len=:), allocatable, intent(out) :: why, remedy
    integer :: at

    why = ''
    remedy = ''
    at = leader
    do while (model%constraints%leader(c, at) /= at .and. at /= node)
      at = model%constraints%leader(c, at)
    end do
    if (at == node) then
      why = ' would follow itself'
      remedy = 'nodes that follow GN, without GN'
    else if (model%constraints%leader(c, node) /= node .or. model%constraints%sum_of(c, node) > 0) then
      why = ' follows another RBE2 already'
      remedy = 'one leader for each freedom'
    else if (model%constraints%held(c, node)) then
      why = ' is held by a support too'
      remedy = 'the support at GN '//text_of(model%mesh%node_id(leader))//' instead'
    end if
  end subroutine why_not_tied

  !> Chains of ties are followed to their ends: who leads follows nobody.
  pure subroutine follow_to_the_end(leader)
    integer, intent(inout) :: leader(:, :)   !! of each freedom, itself if it is not tied [2, nodes]
    integer :: c, node

    do node = 1, size(leader, 2)
      do c = 1, directions
        do while (leader(c, leader(c, node)) /= leader(c, node))
          leader(c, node) = leader(c, leader(c, node))
        end do
      end do
    end do
  end subroutine follow_to_the_end

  !> Check that a SUPORT DOF is free to move.
  pure subroutine check_reference(model, c, node, found)
    type(model_type), intent(in) :: model      !! the scene
    integer, intent(in) :: c, node             !! direction and node of the freedom
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    logical :: is_free

    if (c == angle) then
      is_free = .not. model%constraints%platen(findloc(model%constraints%platen%leader, node, dim=1))%held
    else
      is_free = .not. model%constraints%is_held(c, node) .and. &
        model%constraints%leader(c, node) == node .and. &
                model%constraints%sum_of(c, node) == 0
    end if
    if (.not. is_free) call found%add_error(of_reference, node, c, ': '//freedom(model, c, node)// &
      ' is held by a support or follows an RBE2', 'a freedom that is free to move')
  end subroutine check_reference

  !> A freedom as messages name it: `direction 1 of GRID 17`.
  pure function freedom(model, c, node) result(text)
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: c, node          !! direction and node of the freedom; or `angle`, and who turns
    character(len=:), allocatable :: text

    text = 'direction '//text_of(merge(6, c, c == angle))//' of '//model%name_of(of_node, node)
  end function freedom

  !> Sets of nodes that elements join, and ties if these are to count: then they are the bodies.
  pure subroutine join_nodes(model, by_ties, set, sets)
    type(model_type), intent(in) :: model   !! the scene
    logical, intent(in) :: by_ties   !! RBE2 joins too
    integer, allocatable, intent(out) :: set(:)   !! number of each node's [nodes]
    integer, intent(out) :: sets                  !! how many there are
    type(partition) :: joined
    integer :: c, i, k

    joined = new_partition(model%mesh%nodes)
    do i = 1, model%mesh%elements
      do k = 2, model%mesh%node_count(i)
        call joined%join(model%mesh%connectivity(1, i), model%mesh%connectivity(k, i))
      end do
    end do
    do i = 1, merge(model%mesh%nodes, 0, by_ties)
      do c = 1, directions
        call joined%join(i, model%constraints%leader(c, i))
      end do
    end do
    if (by_ties) call join_others(model, joined)
    call joined%numbers(set, sets)
  end subroutine join_nodes

  !> Join what follows a platen that turns, what an equation is of, and both ends of a spring.
  pure subroutine join_others(model, joined)
    type(model_type), intent(in) :: model
    type(partition), intent(inout) :: joined
    integer :: i, k

    do k = 1, size(model%constraints%platen)
      do i = 1, size(model%constraints%platen(k)%follower)
        call joined%join(model%constraints%platen(k)%leader, model%constraints%platen(k)%follower(i))
      end do
    end do
    do k = 1, size(model%constraints%equation)
      do i = 2, size(model%constraints%equation(k)%node)
        call joined%join(model%constraints%equation(k)%node(1), model%constraints%equation(k)%node(i))
      end do
    end do
    do k = 1, size(model%constraints%spring)
      if (all(model%constraints%spring(k)%node > 0)) call joined%join(model%constraints%spring(k)%node(1), &
                                                                      model%constraints%spring(k)%node(2))
    end do
  end subroutine join_others

  !> Set the travel of each node, and what supports prescribe beyond it.
  pure subroutine find_travels(model)
    type(model_type), intent(inout) :: model   !! the scene
    logical :: moved(model%mesh%bodies)
    integer :: b, i

    model%loads%travel = spread(spread(0.0_wp, 1, directions), 2, model%mesh%nodes)
    model%loads%beyond_travel = model%loads%prescribed
    moved = .false.
    moved(pack(model%mesh%body, any(model%loads%prescribed /= 0.0_wp, dim=1))) = .true.
    do i = 1, size(model%constraints%equation)   ! what it joins need not follow a rigid motion
      moved(model%mesh%body(model%constraints%equation(i)%node(1))) = .false.
    end do
    do i = 1, size(model%constraints%spring)     ! nor is a spring without force then
      moved(model%mesh%body(maxval(model%constraints%spring(i)%node))) = .false.
    end do
    do b = 1, model%mesh%bodies
      if (moved(b)) call find_travel(model, pack([(i, i=1, model%mesh%nodes)], model%mesh%body == b))
    end do
  end subroutine find_travels

  !> The motion of one body that fits best, if it fits: u = shift + turn x (x - centre), with a centre of its
  !! own for each direction, so that the three do not depend on each other.
  pure subroutine find_travel(model, node)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node(:)   !! of the body
    real(wp), dimension(directions, size(node)) :: arm, travel, u
    !> What is prescribed, and the SUPORT freedoms: these move by the approach alone
    logical :: known(directions, size(node))
    real(wp) :: shift(directions), turn
    integer :: c

    known = model%constraints%held(:, node) .or. model%constraints%reference(:, node)
    u = model%loads%prescribed(:, node)
    do c = 1, directions
      shift(c) = mean(u(c, :), known(c, :))
      arm(c, :) = (2*c - 3)*(model%mesh%x(3 - c, node) - mean(model%mesh%x(3 - c, node), known(c, :)))
    end do
    turn = 0.0_wp   ! freedoms that an RBE2 makes equal are not those of a body that turns
    if (model%has_rings()) then
      shift(1) = 0.0_wp
    else if (sum(arm**2, mask=known) > same_place**2*maxval(arm**2) .and. &
             .not. model%constraints%is_tied(node)) then
      turn = sum(arm*(u - spread(shift, 2, size(node))), mask=known)/sum(arm**2, mask=known)
    end if
    travel = spread(shift, 2, size(node)) + turn*arm
    if (maxval(abs(u - travel), mask=known) > follows*maxval(abs(u), mask=known)) return
    model%loads%travel(:, node) = travel
    model%loads%beyond_travel(:, node) = merge(u - travel, 0.0_wp, known .and. &
        abs(u - travel) > cancelled*maxval(abs(u)))
  end subroutine find_travel

  !> Mean of those values that are known, exact where they are all the same; 0 of none.
  pure real(wp) function mean(value, known)
    real(wp), intent(in) :: value(:)
    logical, intent(in) :: known(:)

    mean = 0.0_wp
    if (.not. any(known)) return
    associate (first => value(findloc(known, .true., dim=1)))
      mean = first + sum(value - first, mask=known)/count(known)
    end associate
  end function mean
end module epcont_model_freedoms
