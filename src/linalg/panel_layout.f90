!> Panels of a variable-band matrix: their columns and heights, memory and operations.
module epcont_linalg_panel_layout
  use epcont_base_kinds, only: i8, wp
  implicit none
  private
  public :: panel_layout, new_panel_layout

  !> Mean height over columns of a panel, and least and largest number of columns.
  integer, parameter :: heights_a_width = 4, least_width = 16, most_width = 64

  type :: panel_layout
    integer :: width = least_width       !! columns of a panel; the last may have fewer
    integer, allocatable :: first(:)     !! column of each panel [panels + 1]
    integer, allocatable :: height(:)    !! rows of each, from that of its first column on [panels]
  contains
    procedure :: entries
    procedure :: operations
  end type panel_layout

contains

  !> Lay out the panels of a matrix. If panels overlap, their last rows never decrease, so the factor fills
  !! the stored part.
  pure function new_panel_layout(profile) result(layout)
    integer, intent(in) :: profile(:)      !! last row coupled with each column [order]
    type(panel_layout) :: layout
    integer(i8) :: heights
    integer :: first, last, next, p, panels

    heights = sum([(int(profile(p) - p + 1, i8), p=1, size(profile))])
    associate (width => layout%width)
      width = int(heights/max(1, size(profile)))/heights_a_width
      width = min(most_width, max(least_width, width - mod(width, 8)))
      panels = (size(profile) + width - 1)/width
      layout%first = [(1 + (p - 1)*width, p=1, panels), size(profile) + 1]
    end associate
    allocate (layout%height(panels))
    last = 0
    do p = 1, panels
      first = layout%first(p)
      next = layout%first(p + 1)
      last = max(next - 1, maxval(profile(first:next - 1)), merge(last, 0, last >= first))
      layout%height(p) = last - first + 1
    end do
  end function new_panel_layout

  !> Entries of the factor.
  pure integer(i8) function entries(self)
    class(panel_layout), intent(in) :: self

    entries = sum(int(self%height, i8)*columns(self))
  end function entries

  !> Operations of the factorization.
  pure real(wp) function operations(self)
    class(panel_layout), intent(in) :: self

    operations = sum(real(columns(self), wp)*real(self%height, wp)**2)
  end function operations

  !> Columns of each panel.
  pure function columns(self)
    class(panel_layout), intent(in) :: self
    integer :: columns(size(self%height))

    columns = self%first(2:) - self%first(:size(columns))
  end function columns
end module epcont_linalg_panel_layout
