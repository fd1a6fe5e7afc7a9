!> Patches of elements for the recovery of strains at a node. A patch is the elements of one section around
!> the node, since strains jump at material boundaries. A node between sections has one recovery point in each
!> of them. At the boundary of a section the elements around the neighbours are added, since elements on one
!> side only do not determine the gradient.
module epcont_accuracy_patches
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: new_patch_table, patch_table, wide_patch

  !> Initial size of the list of elements in a patch.
  integer, parameter :: most_at_first = 64

  type :: patch_table
    integer :: places = 0
    integer, allocatable :: node(:)        !! of each recovery point [places]
    !> Recovery points of the nodes of an element, then 0 [most_nodes, elements]
    integer, allocatable :: place(:, :)
    type(incidence) :: around              !! elements at each recovery point
    logical, allocatable :: inside(:)      !! elements surround the point [places]
    type(incidence) :: of_body             !! recovery points of each body
    integer, allocatable :: own(:)         !! number of each point among those of its body [places]
    !> Number of polynomials that reach a mid-side node, two of each of its elements; 0: corner [places]
    integer, allocatable :: fits(:)
    !> Number of sampling points before those of each element, in its body [elements]
    integer, allocatable :: before(:)
    integer, allocatable, private :: first_sample(:)   !! of each body, and one more [bodies + 1]
    real(wp), allocatable, private :: sample(:, :)     !! sampling points, body by body [length] [2, any]
  contains
    procedure :: points_of
  end type patch_table

contains

  !> Number the recovery points of a model.
  function new_patch_table(model) result(table)
    type(model_type), intent(in) :: model   !! model
    type(patch_table) :: table
    logical :: free(0:model%mesh%nodes)   ! on an outline
    integer :: e, p

    call split_places(table%place, table%node)
    table%places = size(table%node)
    if (table%places == model%mesh%nodes) then
      table%around = model%mesh%around
    else
      table%around = new_incidence(table%place, table%places)
    end if
    free = .false.
    free([model%mesh%body_outline%node]) = .true.
    associate (full => model%mesh%around%start, own => table%around%start, node => table%node)
      table%inside = [(.not. free(node(p)) .and. own(p + 1) - own(p) == full(node(p) + 1) - full(node(p)), &
                       p=1, table%places)]
    end associate
    table%of_body = new_incidence(reshape(model%mesh%body(table%node), [1, table%places]), model%mesh%bodies)
    call number_own()
    allocate (table%fits(table%places), source=0)
    do e = 1, model%mesh%elements
      associate (middles => table%place(model%mesh%corners(e) + 1:model%mesh%node_count(e), e))
        table%fits(middles) = table%fits(middles) + 2
      end associate
    end do
    call place_samples(model, table)

  contains

    !> Number the recovery points of each body.
    subroutine number_own()
      integer :: b, k

      allocate (table%own(table%places))
      do b = 1, model%mesh%bodies
        associate (first => table%of_body%start(b))
          do k = first, table%of_body%start(b + 1) - 1
            table%own(table%of_body%group(k)) = k - first + 1
          end do
        end associate
      end do
    end subroutine number_own

    !> Split nodes into one recovery point for each section; the point in the first section has the node's
    !! number.
    subroutine split_places(place, node)
      integer, allocatable, intent(out) :: place(:, :), node(:)   !! of each element, of each recovery point
      integer, allocatable :: next(:), section(:)   !! of each point: next point of its node, its section
      integer :: at, e, k, places

      place = model%mesh%connectivity
      node = [(k, k=1, model%mesh%nodes)]
      if (all(model%mesh%section == model%mesh%section(1))) return
      node = [node, spread(0, 1, size(place))]
      allocate (next(size(node)), source=0)
      places = model%mesh%nodes
      section = [(minval(model%mesh%section(model%mesh%around%of(k))), k=1, places), node(places + 1:)]
      do e = 1, model%mesh%elements
        do k = 1, model%mesh%node_count(e)
          at = place(k, e)
          do while (section(at) /= model%mesh%section(e))
            if (next(at) == 0) then
              places = places + 1
              next(at) = places
              section(places) = model%mesh%section(e)
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

  !> Place the sampling points of all elements.
  subroutine place_samples(model, table)
    type(model_type), intent(in) :: model   !! model
    type(patch_table), intent(inout) :: table
    type(incidence) :: elements
    real(wp) :: share(most_nodes)   ! of the nodes in the position of a point
    integer :: b, i, k, last

    elements = model%mesh%elements_of_bodies()
    allocate (table%before(model%mesh%elements), table%first_sample(model%mesh%bodies + 1), &
              table%sample(2, sum(model%mesh%kinds(model%mesh%kind)%samples)))
    last = 0
    do b = 1, model%mesh%bodies
      table%first_sample(b) = last + 1
      do i = elements%start(b), elements%start(b + 1) - 1
        associate (e => elements%group(i))
          table%before(e) = last + 1 - table%first_sample(b)
          associate (kind => model%mesh%kinds(model%mesh%kind(e)))
            do k = 1, kind%samples
              last = last + 1
              share(:kind%nodes) = merge(1.0_wp/kind%nodes, kind%sample_values(:kind%nodes, k), &
                                         kind%degree == 1)
              table%sample(:, last) = matmul(model%mesh%coordinates(e), share(:kind%nodes))
            end do
          end associate
        end associate
      end do
    end do
    table%first_sample(b) = last + 1
  end subroutine place_samples

  !> Sampling points of a body [length] [2, any].
  pure function points_of(self, b) result(x)
    class(patch_table), intent(in) :: self
    integer, intent(in) :: b
    real(wp), allocatable :: x(:, :)

    x = self%sample(:, self%first_sample(b):self%first_sample(b + 1) - 1)
  end function points_of

  !> Find the elements around a recovery point and around the corners of these elements.
  pure subroutine wide_patch(model, table, place, patch)
    type(model_type), intent(in) :: model             !! model
    type(patch_table), intent(in) :: table            !! of its elements
    integer, intent(in) :: place                      !! number of the point
    integer, allocatable, intent(out) :: patch(:)     !! elements
    integer, allocatable :: found(:)
    integer :: count, i, j, k

    associate (start => table%around%start, group => table%around%group)
      allocate (found(most_at_first))
      count = 0
      do i = start(place), start(place + 1) - 1
        do k = 1, model%mesh%corners(group(i))
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
