!> Nodes that pairs connect with another body.
module epcont_contact_geometry_mates
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_mates, is_mate

  integer, parameter :: several = -1   !! more than one

contains

  !> Part of the outline that pairs connect each node with, 0 if absent [nodes].
  pure function find_mates(model) result(mate)
    type(model_type), intent(in) :: model   !! the model
    integer, allocatable :: mate(:)
    integer :: i, k, other

    allocate (mate(model%mesh%nodes), source=0)
    do k = 1, model%contact%pairs
      associate (ends => model%mesh%body_outline%part_of(model%contact%pair_node(:, k)))
        if (ends(1) == ends(2)) cycle
        do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
          associate (node => model%contact%row_node(i))
            other = merge(ends(1), ends(2), model%mesh%body_outline%part_of(node) == ends(2))
            if (other == 0 .or. mate(node) == other) cycle
            mate(node) = merge(other, several, mate(node) == 0)
          end associate
        end do
      end associate
    end do
  end function find_mates

  !> Is one of these nodes connected with a part?
  pure logical function is_mate(mate, node, part)
    integer, intent(in) :: mate(:), node(:), part   !! mates of all nodes; these nodes, or 0; the part

    associate (own => mate(pack(node, node > 0)))
      is_mate = any(own == part .or. own == several)
    end associate
  end function is_mate
end module epcont_contact_geometry_mates
