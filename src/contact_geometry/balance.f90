!> Removes moments that pairs of lines would have by error: force and counterforce lie on one line, and in
!> round contact all these lines meet in one point.
!>
!> A pin turns freely in its hole. If normals miss the centre by the rounding of a deck, or the master weights
!> are centred beside the node because chords replace a circle, contact would resist that rotation with
!> tiny lever arms, and the pin would rotate until it comes loose.
module epcont_contact_geometry_balance
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: coincident, rounded_off
  use epcont_geometry_plane, only: cross_product, unit
  use epcont_model_contact_rows, only: line_contact
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: balance_pairs

  !> Normals have a centre if they turn by at least 20 degrees: variance of their directions at this angle.
  real(wp), parameter :: least_turn = 0.01_wp

contains

  !> Balance the pairs of lines, except at nodes where a line of symmetry may cut a body: there the other half
  !! balances them. Contacts with the same centre, inside and outside of a ring, share one centre.
  subroutine balance_pairs(model)
    type(model_type), intent(inout) :: model   !! the model, with all its pairs
    real(wp) :: centre(2, size(model%contact%line_contact))   ! of round contacts [length]
    logical :: cut(model%mesh%nodes)
    integer :: c, centres, i, k

    if (size(model%contact%line_contact) == 0) return
    cut = .false.
    associate (line => model%contact%boundary)
      associate (node => pack(line%segment(:2, :), line%mirrored .or. line%corner))
        cut(node) = model%constraints%is_held(1, node) .or. model%constraints%is_held(2, node)
      end associate
    end associate
    centres = 0
    do c = 1, size(model%contact%line_contact)
      associate (contact => model%contact%line_contact(c), b => model%contact%pair_node(2, :))
        associate (pairs => pack([(k, k=contact%first, contact%last)], &
                                 .not. cut(b(contact%first:contact%last))))
          call turn_normals(contact, pairs)
          do i = 1, size(pairs)
            call move_weights(pairs(i))
          end do
        end associate
      end associate
    end do

  contains

    !> Make the normals of a contact's pairs meet in one point, if those of the slave nodes nearly do. A slave
    !! that is round itself, in a round hollow, keeps its own normals, as it may rotate.
    subroutine turn_normals(contact, pairs)
      type(line_contact), intent(in) :: contact
      integer, intent(in) :: pairs(:)
      real(wp) :: away(2), middle(2), outward(2, model%mesh%nodes), own(2), own_radius, radius
      integer, allocatable :: turned(:)
      integer :: side

      turned = pack(pairs, pairs < contact%first_of_master)
      associate (node => model%contact%pair_node(2, turned), normal => model%contact%normal(:, turned))
        call find_centre(model%mesh%x(:, node), normal, middle, radius)
        if (radius == 0.0_wp) return
        do side = 1, size(contact%slave%element)
          do k = 1, merge(3, 2, contact%slave%segment(3, side) > 0)
            outward(:, contact%slave%segment(k, side)) = contact%slave%normal(:, k, side)
          end do
        end do
        call find_centre(model%mesh%x(:, node), outward(:, node), own, own_radius)
        if (own_radius > 0.0_wp .and. &
            all(sum(normal*(model%mesh%x(:, node) - spread(middle, 2, size(node))), dim=1) < 0.0_wp)) then
          middle = own
          turned = pairs
        end if
      end associate
      do k = 1, centres
        if (norm2(centre(:, k) - middle) <= coincident*radius) exit
      end do
      if (k > centres) centre(:, k) = middle
      centres = max(centres, k)
      do i = 1, size(turned)
        away = model%mesh%x(:, model%contact%pair_node(2, turned(i))) - centre(:, k)
        model%contact%normal(:, turned(i)) = sign(1.0_wp, &
          dot_product(model%contact%normal(:, turned(i)), away))*unit(away)
      end do
    end subroutine turn_normals

    !> Shift master weights along the boundary so that the counterforce lies on the line of the
    !! force.
    subroutine move_weights(pair)
      integer, intent(in) :: pair
      real(wp), allocatable :: along(:), much(:)   ! of master nodes: positions on the boundary; weights
      real(wp) :: lever, width
      integer :: k

      associate (first => model%contact%row_start(pair) + 1, last => model%contact%row_start(pair + 1) - 1, &
                 normal => model%contact%normal(:, pair))
        associate (weight => model%contact%row_weight(first:last), node => model%contact%row_node(first:last))
          along = [(cross_product(normal, model%mesh%x(:, node(k)) - model%mesh%x(:, &
            model%contact%pair_node(2, pair))), &
                    k=1, size(node))]
          lever = dot_product(weight, along)
          much = abs(weight)/sum(abs(weight))
          along = along - dot_product(much, along)
          width = dot_product(much, along**2)
          if (width <= 0.0_wp .or. abs(lever) <= rounded_off*sqrt(width)) return
          weight = weight - lever/width*much*along
          model%contact%pair_node(1, pair) = node(minloc(weight, dim=1, &
                                                         mask=node /= model%contact%pair_node(2, pair)))
        end associate
      end associate
    end subroutine move_weights
  end subroutine balance_pairs

  !> Point where lines meet, up to the position error of a line, and the least distance of the given points
  !! from it; 0: they do not meet.
  pure subroutine find_centre(x, direction, centre, radius)
    real(wp), intent(in) :: x(:, :), direction(:, :)   !! a point on each line [length] [2, lines]
    real(wp), intent(out) :: centre(2), radius         !! [length]
    real(wp) :: across(2, size(x, 2)), matrix(2, 2), right(2), determinant

    radius = 0.0_wp
    across(1, :) = -direction(2, :)
    across(2, :) = direction(1, :)
    matrix = matmul(across, transpose(across))
    determinant = matrix(1, 1)*matrix(2, 2) - matrix(1, 2)**2
    if (determinant <= least_turn*size(x, 2)**2) return   ! the trace is the number of lines
    right = matmul(across, levers_about(x(:, 1)))
    centre = x(:, 1) + [cross_product(right, matrix(:, 2)), cross_product(matrix(:, 1), right)]/determinant
    radius = minval(norm2(x - spread(centre, 2, size(x, 2)), dim=1))
    if (maxval(abs(levers_about(centre))) > coincident*radius) radius = 0.0_wp

  contains

    !> Distances of the lines from a point.
    pure function levers_about(place) result(lever)
      real(wp), intent(in) :: place(2)
      real(wp) :: lever(size(x, 2))

      lever = sum(across*(x - spread(place, 2, size(x, 2))), dim=1)
    end function levers_about
  end subroutine find_centre
end module epcont_contact_geometry_balance
