!> Which elements tell of the strain at a node: those around it of one section, since strains jump where
!> materials change.
!>
!> A node where sections meet has a place in each of them. A place at the boundary of its section has elements
!> on one side only, too few to tell how the strain changes: the elements around its neighbours are added
!> there.
module epcont_accuracy_patches
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: patch_table, new_patch_table, wide_patch

  type :: patch_table
    integer :: places = 0
    integer, allocatable :: node(:)        !! of each place [places]
    integer, allocatable :: place(:, :)    !! of each node of an element, 0 where it has no more [most_nodes, elements]
    type(incidence) :: around              !! elements at each place
    logical, allocatable :: inside(:)      !! elements go all around the place [places]
  end type patch_table

contains

  !> The places of a scene.
  pure function new_patch_table(model) result(table)
    type(model_type), intent(in) :: model   !! the scene
    type(patch_table) :: table
    integer, allocatable :: turn(:)
    integer :: corners, e

    call split_places(table%place, table%node)
    table%places = size(table%node)
    table%around = new_incidence(table%place, table%places)
    ! Around a place inside, the corner after it in one element is the corner before it in another.
    allocate (turn(table%places), source=0)
    do e = 1, model%elements
      corners = model%corners(e)
      associate (place => table%place(:corners, e))
        turn(place) = turn(place) + cshift(place, 1) - cshift(place, -1)
      end associate
    end do
    table%inside = turn == 0

  contains

    !> A node has one place for each section that it belongs to, the first of which is the node's own number.
    pure subroutine split_places(place, node)
      integer, allocatable, intent(out) :: place(:, :), node(:)   !! of each element, of each place
      integer, allocatable :: next(:), section(:)   !! of each place the next place of its node, its section
      integer :: at, e, k, places

      place = model%connectivity
      node = [(k, k=1, model%nodes)]
      if (all(model%section == model%section(1))) return
      node = [node, spread(0, 1, size(place))]
      allocate (next(size(node)), section(size(node)), source=0)
      places = model%nodes
      do e = 1, model%elements
        do k = 1, model%order(e)
          at = place(k, e)
          if (section(at) == 0) section(at) = model%section(e)
          do while (section(at) /= model%section(e))
            if (next(at) == 0) then
              places = places + 1
              next(at) = places
              section(places) = model%section(e)
              node(places) = place(k, e)
            end if
            at = next(at)
          end do
          place(k, e) = at
        end do
      end do
      node = node(:places)
    end subroutine split_places
  end function new_patch_table

  !> The elements around a place and around the corners of these.
  pure subroutine wide_patch(model, table, place, seen, patch)
    type(model_type), intent(in) :: model             !! the scene
    type(patch_table), intent(in) :: table            !! of its elements
    integer, intent(in) :: place                      !! which place
    integer, intent(inout) :: seen(:)                 !! the last place that each element was taken for [elements]
    integer, allocatable, intent(out) :: patch(:)     !! elements
    integer :: i, j, k

    allocate (patch(0))
    associate (start => table%around%start, group => table%around%group)
      do i = start(place), start(place + 1) - 1
        do k = 1, model%corners(group(i))
          associate (corner => table%place(k, group(i)))
            do j = start(corner), start(corner + 1) - 1
              if (seen(group(j)) == place) cycle
              seen(group(j)) = place
              patch = [patch, group(j)]
            end do
          end associate
        end do
      end do
    end associate
  end subroutine wide_patch
end module epcont_accuracy_patches
