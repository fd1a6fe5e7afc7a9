!> The boundary of all bodies as contact takes it: the sides of their outlines, with normals and corners.
module epcont_contact_geometry_boundary
  use epcont_base_kinds, only: wp
  use epcont_geometry_boundary_line, only: boundary_line
  use epcont_geometry_corners, only: find_normals
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_boundary

contains

  !> All sides, numbered as those of the outlines.
  pure function find_boundary(model) result(line)
    type(model_type), intent(in) :: model   !! the scene
    type(boundary_line) :: line
    integer :: i, k

    associate (outline => model%body_outline)
      line%segment = outline%node
      line%element = outline%element
      line%neighbour = transpose(reshape([outline%before, outline%after], [outline%sides, 2]))
      allocate (line%x(2, 3, outline%sides), source=0.0_wp)
      do i = 1, outline%sides
        do k = 1, 3
          if (line%segment(k, i) > 0) line%x(:, k, i) = model%x(:, line%segment(k, i))
        end do
      end do
      call find_normals(line, reshape([(held_directions(model, line%segment(:2, i)), i=1, outline%sides)], &
                                      [2, outline%sides]), &
                        model%controls%corner)
    end associate
  end function find_boundary

  !> The direction in which each node, or what it is tied to, is held: 0 none, 3 both.
  pure function held_directions(model, node) result(direction)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node(2)
    integer :: direction(2)
    integer :: c, k

    do k = 1, 2
      direction(k) = sum([(merge(c, 0, model%held(c, model%leader(c, node(k)))), c=1, 2)])
    end do
  end function held_directions
end module epcont_contact_geometry_boundary
