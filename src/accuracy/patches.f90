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

  pure function new_patch_table(model) result(table)
    type(model_type), intent(in) :: model
    type(patch_table) :: table
    integer, allocatable :: turn(:)
    integer :: corners, e, k

    table%place = model%connectivity
    table%places = model%nodes
    table%node = [(k, k=1, model%nodes)]
    call split_places(model, table)
    table%around = new_incidence(table%place, table%places)
    ! Around a place inside, the corner after it in one element is the corner before it in another.
    allocate (turn(table%places), source=0)
    do e = 1, model%elements
      corners = model%corners(e)
      associate (place => table%place(:, e))
        do k = 1, corners
          turn(place(k)) = turn(place(k)) + place(mod(k, corners) + 1) - place(mod(k + corners - 2, corners) + 1)
        end do
      end associate
    end do
    table%inside = turn == 0
  end function new_patch_table

  !> A node has one place for each section that it belongs to, the first of which is the node's own number.
  pure subroutine split_places(model, table)
    type(model_type), intent(in) :: model
    type(patch_table), intent(inout) :: table
    integer, allocatable :: next(:), node(:), section(:)   !! of each place the next place of its node, its node, its section
    integer :: at, e, k

    if (all(model%section == model%section(1))) return
    allocate (next(size(model%connectivity) + model%nodes), source=0)
    node = next
    section = next
    node(:model%nodes) = table%node
    do e = 1, model%elements
      do k = 1, model%order(e)
        at = table%place(k, e)
        if (section(at) == 0) section(at) = model%section(e)
        do while (section(at) /= model%section(e))
          if (next(at) == 0) then
            table%places = table%places + 1
            next(at) = table%places
            section(next(at)) = model%section(e)
            node(next(at)) = model%connectivity(k, e)
          end if
          at = next(at)
        end do
        table%place(k, e) = at
      end do
    end do
    table%node = node(:table%places)
  end subroutine split_places

  !> The elements around a place and around the corners of these; `seen` is the last place that each was taken
  !! for.
  pure subroutine wide_patch(model, table, place, seen, patch, count)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: place
    integer, intent(inout) :: seen(:)                !! [elements]
    integer, allocatable, intent(inout) :: patch(:)  !! room for them
    integer, intent(out) :: count
    integer :: e, f, i, j, k

    count = 0
    do i = table%around%start(place), table%around%start(place + 1) - 1
      e = table%around%group(i)
      do k = 1, model%corners(e)
        associate (corner => table%place(k, e))
          do j = table%around%start(corner), table%around%start(corner + 1) - 1
            f = table%around%group(j)
            if (seen(f) == place) cycle
            seen(f) = place
            count = count + 1
            if (count > size(patch)) patch = [patch, patch]
            patch(count) = f
          end do
        end associate
      end do
    end do
  end subroutine wide_patch
end module epcont_accuracy_patches
