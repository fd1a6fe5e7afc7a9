!> Lines of symmetry, at which half of a scene ends.
module epcont_result_symmetry
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: is_on_symmetry

  !> A normal is across a line of symmetry where this part of it, or more, is along the line.
  real(wp), parameter :: along_line = 0.9_wp
  !> A node of the other body is on the same line of symmetry within this part of a side.
  real(wp), parameter :: beside = 1.0e-3_wp

contains

  !> Is a pair, at which its line ends, on a line of symmetry? Its node is held along the boundary there; where that is so all
  !! over a rigid body, held or tied by RBE2, the node of the other body tells that lies on the same line.
  pure logical function is_on_symmetry(model, pair, node, side)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair, node
    real(wp), intent(in) :: side   !! length of the longest side at the node [length]
    integer :: along, i

    is_on_symmetry = .false.
    associate (n => model%normal(:, pair))
      along = merge(1, 2, abs(n(2)) > abs(n(1)))
      if (abs(n(3 - along)) <= along_line) return
    end associate
    if (.not. model%held(along, model%leader(along, node))) return
    is_on_symmetry = is_guided(model, node, along)
    do i = model%row_start(pair), model%row_start(pair + 1) - 1
      if (is_on_symmetry) return
      associate (other => model%row_node(i))
        is_on_symmetry = is_guided(model, other, along) .and. abs(model%x(along, other) - model%x(along, node)) <= beside*side
      end associate
    end do
  end function is_on_symmetry

  !> Is a node held by itself in one direction, and free in the other?
  pure logical function is_guided(model, node, direction)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, direction

    is_guided = model%held(direction, node) .and. .not. model%held(3 - direction, model%leader(3 - direction, node))
  end function is_guided
end module epcont_result_symmetry
