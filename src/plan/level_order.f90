!> Breadth-first order of the nodes of a body: each level has the neighbours of the level before.
module epcont_plan_level_order
  use epcont_base_incidence, only: add_new
  use epcont_base_sorting, only: sorted_order
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: level_order, sweep

  type :: level_order
    integer, allocatable :: node(:)
    integer :: levels = 0
  end type level_order

contains

  !> Order the nodes of a body from some roots; the new neighbours of a node follow by their number of
  !! elements. Nodes that no element joins to the roots (but an RBE2 does) start sweeps of their own.
  pure subroutine sweep(model, own, roots, seen, order)
    type(model_type), intent(in) :: model
    integer, intent(in) :: own(:)                !! nodes of the body
    integer, intent(in) :: roots(:)              !! some of them
    logical, intent(inout) :: seen(:)            !! work space [all nodes]
    type(level_order), intent(out) :: order
    integer, allocatable :: found(:)
    integer :: at, e, end_of_level, filled, first, k, next

    allocate (order%node(size(own)))
    seen(own) = .false.
    filled = 0
    call add_new(roots, 1, seen, order%node, filled)
    end_of_level = 0
    next = 1
    do at = 1, size(own)
      if (at > filled) then
        do while (seen(own(next)))
          next = next + 1
        end do
        call add_new(own(next:next), 1, seen, order%node, filled)
      end if
      if (at > end_of_level) then
        order%levels = order%levels + 1
        end_of_level = filled
      end if
      first = filled + 1
      do k = model%mesh%around%start(order%node(at)), model%mesh%around%start(order%node(at) + 1) - 1
        e = model%mesh%around%group(k)
        call add_new(model%mesh%connectivity(:model%mesh%node_count(e), e), 1, seen, order%node, filled)
      end do
      if (filled > first) then
        found = order%node(first:filled)
        order%node(first:filled) = found(sorted_order(model%mesh%around%start(found + 1) - &
            model%mesh%around%start(found)))
      end if
    end do
  end subroutine sweep
end module epcont_plan_level_order
