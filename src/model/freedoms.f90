!> Dependent DOFs (RBE2), SUPORT DOFs, the bodies that elements and ties make of
!> nodes, and the rigid-body displacement that supports prescribe to a whole body. This is subtracted before
!> the body is solved and added afterwards, like the displacement of free rigid-body modes: it causes no
!> strain, but strains computed from it would lose digits.
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

  !> A rigid-body displacement is subtracted if all supports of a body follow it, up to this fraction of the
  !! displacement.
  real(wp), parameter :: follows = 1.0e-2_wp

contains

  !> Apply a tie, if it is possible.
  pure subroutine tie_freedom(model, k, tie, found)
    type(model_type), intent(inout) :: model   !! the model
    integer, intent(in) :: k                   !! position of the tie
    type(dof_tie), intent(in) :: tie
    type(findings), intent(inout) :: found     !! errors are added
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

  !> Explain why a DOF cannot depend on that of another node, with a remedy; empty if it can.
  pure subroutine why_not_tied(model, c, node, leader, why, remedy)
    type(model_type), intent(in) :: model      !! the model
    integer, intent(in) :: c, node             !! direction and node of the DOF
    integer, intent(in) :: leader              !! the master node
    character(len=:), allocatable, intent(out) :: why, remedy
    integer :: at

    why = ''
    remedy = ''
    at = leader
    do while (model%constraints%leader(c, at) /= at .and. at /= node)
      at = model%constraints%leader(c, at)
    end do
    if (at == node) then
      why = ' would depend on itself'
      remedy = 'let it depend on another node'
    else if (model%constraints%leader(c, node) /= node .or. model%constraints%sum_of(c, node) > 0) then
      why = ' depends on another RBE2 already'
      remedy = 'use one master node for each DOF'
    else if (model%constraints%held(c, node)) then
      why = ' is fixed by a support too'
      remedy = 'fix GN '//text_of(model%mesh%node_id(leader))//' instead'
    end if
  end subroutine why_not_tied

  !> Resolve chains of ties: afterwards no master DOF depends on another DOF.
  pure subroutine follow_to_the_end(leader)
    integer, intent(inout) :: leader(:, :)   !! master node of each DOF, itself if it is not tied [2, nodes]
    integer :: c, node

    do node = 1, size(leader, 2)
      do c = 1, directions
        do while (leader(c, leader(c, node)) /= leader(c, node))
          leader(c, node) = leader(c, leader(c, node))
        end do
      end do
    end do
  end subroutine follow_to_the_end

  !> Check that a SUPORT DOF is not fixed.
  pure subroutine check_reference(model, c, node, found)
    type(model_type), intent(in) :: model      !! the model
    integer, intent(in) :: c, node             !! direction and node of the DOF
    type(findings), intent(inout) :: found     !! errors are added
    logical :: is_free

    if (c == angle) then
      is_free = .not. model%constraints%platen(findloc(model%constraints%platen%leader, node, dim=1))%held
    else
      is_free = .not. model%constraints%is_held(c, node) .and. &
        model%constraints%leader(c, node) == node .and. &
                model%constraints%sum_of(c, node) == 0
    end if
    if (.not. is_free) call found%add_error(of_reference, node, c, ': '//freedom(model, c, node)// &
      ' is fixed by a support or depends on an RBE2', 'use a DOF that is not fixed')
  end subroutine check_reference

  !> Text of a DOF for messages: `direction 1 of GRID 17`.
  pure function freedom(model, c, node) result(text)
    type(model_type), intent(in) :: model   !! the model
    integer, intent(in) :: c, node          !! direction and node of the DOF; or `angle` and master node
    character(len=:), allocatable :: text

    text = 'direction '//text_of(merge(6, c, c == angle))//' of '//model%name_of(of_node, node)
  end function freedom

  !> Find sets of connected nodes: by elements, and if `by_ties`, also by ties. The latter are the bodies.
  pure subroutine join_nodes(model, by_ties, set, sets)
    type(model_type), intent(in) :: model   !! the model
    logical, intent(in) :: by_ties   !! RBE2 connects nodes too
    integer, allocatable, intent(out) :: set(:)   !! set of each node [nodes]
    integer, intent(out) :: sets                  !! number of sets
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

  !> Connect the nodes of rotating platens, of equations and of springs.
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

  !> Find the prescribed rigid-body displacement of each node, and the rest of the prescribed displacements.
  pure subroutine find_travels(model)
    type(model_type), intent(inout) :: model   !! the model
    logical :: moved(model%mesh%bodies)
    integer :: b, i

    model%loads%travel = spread(spread(0.0_wp, 1, directions), 2, model%mesh%nodes)
    model%loads%beyond_travel = model%loads%prescribed
    moved = .false.
    moved(pack(model%mesh%body, any(model%loads%prescribed /= 0.0_wp, dim=1))) = .true.
    do i = 1, size(model%constraints%equation)   ! an equation may contradict a rigid-body displacement
      moved(model%mesh%body(model%constraints%equation(i)%node(1))) = .false.
    end do
    do i = 1, size(model%constraints%spring)     ! a spring may get a force from it
      moved(model%mesh%body(maxval(model%constraints%spring(i)%node))) = .false.
    end do
    do b = 1, model%mesh%bodies
      if (moved(b)) call find_travel(model, pack([(i, i=1, model%mesh%nodes)], model%mesh%body == b))
    end do
  end subroutine find_travels

  !> Find the rigid-body displacement of a body if its supports fit one: u = shift + turn x (x - centre).
  !! Each direction has its own centre, so that the three are uncoupled.
  pure subroutine find_travel(model, node)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node(:)   !! nodes of the body
    real(wp), dimension(directions, size(node)) :: arm, travel, u
    !> Prescribed DOFs and SUPORT DOFs, which move by the approach only
    logical :: known(directions, size(node))
    real(wp) :: shift(directions), turn
    integer :: c

    known = model%constraints%held(:, node) .or. model%constraints%reference(:, node)
    u = model%loads%prescribed(:, node)
    do c = 1, directions
      shift(c) = mean(u(c, :), known(c, :))
      arm(c, :) = (2*c - 3)*(model%mesh%x(3 - c, node) - mean(model%mesh%x(3 - c, node), known(c, :)))
    end do
    turn = 0.0_wp   ! DOFs that an RBE2 makes equal do not fit a rotation
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

  !> Mean of the known values, exact if they are all equal; 0 if no value is known.
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
