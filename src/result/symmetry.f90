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

  !> Is a pair, at which its line ends, on a line of symmetry? Its node is held along the boundary there, and
  !! so is the other body where it ends at the same line, or all over if it is rigid; a body that goes on
  !! beyond the line is not mirrored. One of the two is held along the boundary alone: one held all over, or
  !! tied by RBE2, does not tell.
  pure logical function is_on_symmetry(model, pair, node, side)
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: pair, node       !! of the boundary there
    real(wp), intent(in) :: side            !! length of the longest side at the node [length]
    logical :: ends, guided, rigid
    integer :: along, i

    is_on_symmetry = .false.
    associate (n => model%normal(:, pair))
      along = merge(1, 2, abs(n(2)) > abs(n(1)))
      if (abs(n(3 - along)) <= along_line) return
    end associate
    if (.not. is_held(node)) return
    ends = .false.
    guided = is_guided(node)
    rigid = .true.
    do i = model%row_start(pair), model%row_start(pair + 1) - 1
      associate (other => model%row_node(i))
        if (other == node) cycle
        rigid = rigid .and. is_held(other)
        if (.not. is_held(other) .or. abs(model%x(along, other) - model%x(along, node)) > beside*side) cycle
        ends = .true.
        guided = guided .or. is_guided(other)
      end associate
    end do
    is_on_symmetry = guided .and. (ends .or. rigid)

  contains

    pure logical function is_held(node)
      integer, intent(in) :: node

      is_held = model%held(along, model%leader(along, node))
    end function is_held

    !> Is a node held by itself along the boundary, and free across it?
    pure logical function is_guided(node)
      integer, intent(in) :: node

      is_guided = model%held(along, node) .and. .not. model%held(3 - along, model%leader(3 - along, node))
    end function is_guided
  end function is_on_symmetry
end module epcont_result_symmetry
