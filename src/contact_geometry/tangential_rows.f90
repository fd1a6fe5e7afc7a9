!> Rows of N for friction: the nodes and weights of a gap row, along the tangent.
module epcont_contact_geometry_tangential_rows
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: add_tangential_rows

  !> Part of the weights of a pair that can move along the tangent. A node on a line of symmetry has less, of
  !! nodes beside the one opposite; friction would carry mu R there, on supports.
  real(wp), parameter :: least_share = 0.01_wp

contains

  !> Append a tangential row for each pair with friction, after the rows of the pairs. If the normal is along
  !! y, the tangent is along x. A pair whose nodes never move along the tangent, such as one on a line of
  !! symmetry, has no such row: its friction force would be undetermined.
  pure subroutine add_tangential_rows(model)
    type(model_type), intent(inout) :: model   !! with the rows of its pairs only
    integer, allocatable :: entry(:), start(:)
    real(wp), allocatable :: tangent(:, :)
    integer :: e, j, k

    associate (contact => model%contact)
      do k = 1, size(contact%line_contact)
        associate (lines => contact%line_contact(k))
          contact%friction = [contact%friction(:lines%first - 1), &
                              spread(lines%friction, 1, lines%last + 1 - lines%first)]
        end associate
      end do
      tangent = reshape([(contact%normal(2, k), -contact%normal(1, k), k=1, contact%pairs)], &
                        [directions, contact%pairs])
      contact%sliding = pack([(k, k=1, contact%pairs)], contact%friction > 0.0_wp .and. &
                             [(can_slide(model, k, tangent(:, k)), k=1, contact%pairs)])
      contact%slipped = spread(0.0_wp, 1, size(contact%sliding))
      if (size(contact%sliding) == 0) return
      associate (first => contact%row_start(:contact%pairs), next => contact%row_start(2:))
        entry = [(e, e=1, contact%row_start(contact%pairs + 1) - 1), &
                 ((e, e=first(contact%sliding(j)), next(contact%sliding(j)) - 1), j=1, size(contact%sliding))]
        start = contact%row_start(:contact%pairs + 1)
        do j = 1, size(contact%sliding)
          start = [start, start(size(start)) + next(contact%sliding(j)) - first(contact%sliding(j))]
        end do
      end associate
      contact%row_start = start
      contact%row_node = contact%row_node(entry)
      contact%row_weight = contact%row_weight(entry)
      contact%normal = reshape([contact%normal(:, :contact%pairs), tangent(:, contact%sliding)], &
                               [directions, size(start) - 1])
    end associate
  end subroutine add_tangential_rows

  !> Can more than a small share of a pair's weights move along the tangent in some load case?
  pure logical function can_slide(model, pair, tangent)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    real(wp), intent(in) :: tangent(directions)
    real(wp) :: moving, share, whole
    integer :: c, e

    moving = 0.0_wp
    whole = 0.0_wp
    do e = model%contact%row_start(pair), model%contact%row_start(pair + 1) - 1
      do c = 1, directions
        share = abs(model%contact%row_weight(e)*tangent(c))
        whole = whole + share
        associate (leader => model%constraints%leader(c, model%contact%row_node(e)))
          if (.not. model%constraints%still(c, leader)) moving = moving + share
        end associate
      end do
    end do
    can_slide = moving > least_share*whole
  end function can_slide
end module epcont_contact_geometry_tangential_rows
