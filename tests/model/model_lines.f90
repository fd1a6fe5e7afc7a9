!> Lines of models. Tests call `lines_of`, because gfortran 12 leaks what `[named_line(...)]` allocates.
module model_lines
  use epcont, only: named_line
  implicit none
  private
  public :: lines_of

contains

  !> One line or two, through these nodes.
  function lines_of(first, second) result(line)
    integer, intent(in) :: first(:)
    integer, intent(in), optional :: second(:)
    type(named_line), allocatable :: line(:)

    allocate (line(merge(2, 1, present(second))))
    line(1)%node = first
    if (present(second)) line(2)%node = second
  end function lines_of
end module model_lines
