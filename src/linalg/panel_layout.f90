!> Panels of a variable-band matrix: where each begins and ends, the memory they take and the operations.
module epcont_linalg_panel_layout
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: find_panels, panel_entries, panel_operations, gram_operations

  !> Columns of a panel, as a part of the mean height, and at least and at most.
  integer, parameter :: heights_a_width = 4, least_width = 16, most_width = 64

contains

  !> Panels of a matrix: where each begins, and its last row.
  pure subroutine find_panels(reach, width, first, last)
    integer, intent(in) :: reach(:)
    integer, intent(out) :: width
    integer, allocatable, intent(out) :: first(:), last(:)
    integer(i8) :: heights
    integer :: p, panels

    heights = 0
    do p = 1, size(reach)
      heights = heights + (reach(p) - p + 1)
    end do
    width = int(heights/max(1, size(reach)))/heights_a_width
    width = min(most_width, max(least_width, width - mod(width, 8)))
    panels = (size(reach) + width - 1)/width
    first = [(1 + (p - 1)*width, p=1, panels), size(reach) + 1]
    allocate (last(panels))
    do p = 1, panels
      last(p) = max(first(p + 1) - 1, maxval(reach(first(p):first(p + 1) - 1)))
      if (p > 1) then
        if (last(p - 1) >= first(p)) last(p) = max(last(p), last(p - 1))
      end if
    end do
  end subroutine find_panels

  !> Entries that a matrix takes.
  pure integer(i8) function panel_entries(reach) result(entries)
    integer, intent(in) :: reach(:)
    integer, allocatable :: first(:), last(:)
    integer :: p, width

    call find_panels(reach, width, first, last)
    entries = 0
    do p = 1, size(last)
      entries = entries + int(last(p) - first(p) + 1, i8)*(first(p + 1) - first(p))
    end do
  end function panel_entries

  !> Operations that its factorization takes.
  pure real(wp) function panel_operations(reach) result(operations)
    integer, intent(in) :: reach(:)
    integer, allocatable :: first(:), last(:)
    integer :: p, width

    call find_panels(reach, width, first, last)
    operations = 0.0_wp
    do p = 1, size(last)
      operations = operations + real(first(p + 1) - first(p), wp)*real(last(p) - first(p) + 1, wp)**2
    end do
  end function panel_operations

  !> Operations of `add_gram` for columns that begin at these equations, ascending.
  pure real(wp) function gram_operations(reach, begins) result(operations)
    integer, intent(in) :: reach(:), begins(:)
    integer, allocatable :: first(:), last(:)
    integer :: active, p, width

    call find_panels(reach, width, first, last)
    operations = 0.0_wp
    active = 0
    do p = 1, size(last)
      do while (active < size(begins))
        if (begins(active + 1) >= first(p + 1)) exit
        active = active + 1
      end do
      operations = operations + real(width, wp)*active*(2.0_wp*(last(p) - first(p) + 1) + active)
    end do
  end function gram_operations
end module epcont_linalg_panel_layout
