!> Which elements tell of the strain at a node: those around it of one section, since strains jump where
!> materials change. A node where sections meet has a place in each of them. A place at the boundary of its
!> section has elements on one side only, too few to tell how the strain changes: the elements around its
!> neighbours are added there.
module epcont_accuracy_patches
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: new_patch_table, patch_table, wide_patch

  !> Elements that a patch has room for at first.
  integer, parameter :: most_at_first = 64

  type :: patch_table
    integer :: places = 0
    integer, allocatable :: node(:)        !! of each place [places]
    !> Of each node of an element, 0 where it has no more [most_nodes, elements]
    integer, allocatable :: place(:, :)
    type(incidence) :: around              !! elements at each place
    logical, allocatable :: inside(:)      !! elements go all around the place [places]
    type(incidence) :: of_body             !! places of each body
    integer, allocatable :: own(:)         !! number of each place among those of its body [places]
  end type patch_table

contains

  !> The places of a scene.
  function new_patch_table(model) result(table)
    type(model_type), intent(in) :: model   !! the scene
    type(patch_table) :: table
    logical :: free(0:model%nodes)   ! on an outline
    integer :: p

    call split_places(table%place, table%node)
    table%places = size(table%node)
    if (table%places == model%nodes) then
      table%around = model%around
    else
      table%around = new_incidence(table%place, table%places)
    end if
    free = .false.
    free([model%body_outline%node]) = .true.
    associate (full => model%around%start, own => table%around%start, node => table%node)
      table%inside = [(.not. free(node(p)) .and. own(p + 1) - own(p) == full(node(p) + 1) - full(node(p)), &
                       p=1, table%places)]
    end associate
    table%of_body = new_incidence(reshape(model%body(table%node), [1, table%places]), model%bodies)
    call number_own()

  contains

    !> Number the places of each body.
    subroutine number_own()
      integer :: b, k

      allocate (table%own(table%places))
      do b = 1, model%bodies
        associate (first => table%of_body%start(b))
          do k = first, table%of_body%start(b + 1) - 1
            table%own(table%of_body%group(k)) = k - first + 1
          end do
        end associate
      end do
    end subroutine number_own

    !> A node has one place for each section that it belongs to; that of the first section is the node's own
    !! number.
    subroutine split_places(place, node)
      integer, allocatable, intent(out) :: place(:, :), node(:)   !! of each element, of each place
      integer, allocatable :: next(:), section(:)   !! of each place the next place of its node, its section
      integer :: at, e, k, places

      place = model%connectivity
      node = [(k, k=1, model%nodes)]
      if (all(model%section == model%section(1))) return
      node = [node, spread(0, 1, size(place))]
      allocate (next(size(node)), source=0)
      places = model%nodes
      section = [(minval(model%section(model%around%of(k))), k=1, places), node(places + 1:)]
      do e = 1, model%elements
        do k = 1, model%node_count(e)
          at = place(k, e)
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
  pure subroutine wide_patch(model, table, place, patch)
    type(model_type), intent(in) :: model             !! the scene
    type(patch_table), intent(in) :: table            !! of its elements
    integer, intent(in) :: place                      !! which place
    integer, allocatable, intent(out) :: patch(:)     !! elements
    integer, allocatable :: found(:)
    integer :: count, i, j, k

    associate (start => table%around%start, group => table%around%group)
      allocate (found(most_at_first))
      count = 0
      do i = start(place), start(place + 1) - 1
        do k = 1, model%corners(group(i))
          associate (corner => table%place(k, group(i)))
            do j = start(corner), start(corner + 1) - 1
              if (any(found(:count) == group(j))) cycle
              if (count == size(found)) found = [found, found]
              count = count + 1
              found(count) = group(j)
            end do
          end associate
        end do
      end do
    end associate
    patch = found(:count)
  end subroutine wide_patch
end module epcont_accuracy_patches
