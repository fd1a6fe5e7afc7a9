!> The rigid motion that supports prescribe to a body as a whole. It is taken off before the body is solved
!> and added afterwards, as the motions are that supports leave free: it strains nothing, and strains would
!> lose their digits in it.
module epcont_model_travel
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: same_place, travel_rounding
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_travels

  !> A motion is taken off where all supports of a body follow it but for this part of the largest prescribed
  !! displacement.
  real(wp), parameter :: follows = 1.0e-2_wp

contains

  !> Set the travel of each node, and what supports prescribe beyond it.
  pure subroutine find_travels(model)
    type(model_type), intent(inout) :: model   !! the scene
    logical :: moved(model%bodies)
    integer :: b, i

    allocate (model%travel(2, model%nodes), source=0.0_wp)
    model%beyond_travel = model%prescribed
    moved = .false.
    do i = 1, model%nodes
      if (any(model%prescribed(:, i) /= 0.0_wp)) moved(model%body(i)) = .true.
    end do
    do b = 1, model%bodies
      if (moved(b)) call find_travel(model, pack([(i, i=1, model%nodes)], model%body == b))
    end do
  end subroutine find_travels

  !> The motion of one body that fits best, if it fits: u = shift + turn x (x - centre), with a centre of its
  !! own for each direction, so that the three do not depend on each other.
  pure subroutine find_travel(model, node)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node(:)   !! of the body
    real(wp), dimension(2, size(node)) :: arm, travel, u
    !> What is prescribed, and the SUPORT freedoms: these move by the approach alone
    logical :: known(2, size(node))
    real(wp) :: shift(2), turn
    integer :: c

    known = model%held(:, node) .or. model%reference(:, node)
    u = model%prescribed(:, node)
    do c = 1, 2
      shift(c) = mean(u(c, :), known(c, :))
      arm(c, :) = (2*c - 3)*(model%x(3 - c, node) - mean(model%x(3 - c, node), known(c, :)))
    end do
    turn = 0.0_wp   ! freedoms that an RBE2 makes equal are not those of a body that turns
    if (model%has_rings()) then
      shift(1) = 0.0_wp
    else if (sum(arm**2, mask=known) > same_place**2*maxval(arm**2) .and. .not. model%is_tied(node)) then
      turn = sum(arm*(u - spread(shift, 2, size(node))), mask=known)/sum(arm**2, mask=known)
    end if
    travel = spread(shift, 2, size(node)) + turn*arm
    if (maxval(abs(u - travel), mask=known) > follows*maxval(abs(u), mask=known)) return
    model%travel(:, node) = travel
    model%beyond_travel(:, node) = merge(u - travel, 0.0_wp, known .and. &
                                         abs(u - travel) > travel_rounding*maxval(abs(u)))
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
end module epcont_model_travel
