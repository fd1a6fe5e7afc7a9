!> Files of VTK's XML format for unstructured grids (`.vtu`): ParaView, meshio and pyvista read them.
!>
!> Numbers are in full, as base64 within the XML: the number of bytes (8 of its own), then the values. Points
!> and vectors have three components, the third 0.
module epcont_report_vtk_grid
  use, intrinsic :: iso_fortran_env, only: int8
  use epcont_base_base64, only: base64
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: text_of
  use epcont_report_file, only: new_text_file, text_file
  implicit none
  private
  public :: vtk_cells, vtk_grid, new_vtk_grid

  !> Kinds of cells (vtkCellType.h). The nodes of a quadratic triangle: corners counter-clockwise, then the
  !! middles of its sides, the first behind the first corner.
  integer, parameter, public :: vtk_vertex = 1, vtk_line = 3

  type :: vtk_cells
    integer, allocatable :: kind(:)    !! [cells]
    integer, allocatable :: last(:)    !! of the points of each cell [cells]
    integer, allocatable :: point(:)   !! of one cell after the other, counted from 1
  end type vtk_cells

  !> A grid that is being written: arrays of the points, then those of the cells.
  type :: vtk_grid
    type(text_file), private :: file
  contains
    procedure :: begin_point_data
    procedure :: begin_cell_data
    generic :: put => put_integers, put_reals, put_fields
    procedure :: finish
    procedure, private :: put_integers, put_reals, put_fields
  end type vtk_grid

contains

  !> Begin a file with the points and the cells.
  subroutine new_vtk_grid(path, status, x, cells, grid, error)
    character(len=*), intent(in) :: path   !! of the file
    integer, intent(in) :: status           !! exit status of the run: 0 where the answer is valid
    real(wp), intent(in) :: x(:, :)         !! of the points [length] [2, points]
    type(vtk_cells), intent(in) :: cells   !! how the points are joined
    type(vtk_grid), intent(out) :: grid   !! open; arrays of the points come next
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written

    call new_text_file(path, grid%file, error)
    if (allocated(error)) return
    associate (file => grid%file)
      call file%line('<?xml version="1.0"?>')
      call file%line('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="'//byte_order()// &
                     '" header_type="UInt64">')
      call file%line('<UnstructuredGrid>')
      call file%line('<FieldData>')
      call write_array(file, 'Int32', 'exit_status', ' NumberOfTuples="1"', transfer([status], [0_int8]))
      call file%line('</FieldData>')
      call file%line('<Piece NumberOfPoints="'//text_of(size(x, 2))//'" NumberOfCells="'// &
                     text_of(size(cells%kind))//'">')
      call file%line('<Points>')
      call grid%put('Points', x)
      call file%line('</Points>')
      call file%line('<Cells>')
      call grid%put('connectivity', cells%point - 1)
      call grid%put('offsets', cells%last)
      call write_array(file, 'UInt8', 'types', '', int(cells%kind, int8))
      call file%line('</Cells>')
    end associate
  end subroutine new_vtk_grid

  !> Arrays of the points follow.
  subroutine begin_point_data(self, active)
    class(vtk_grid), intent(inout) :: self
    character(len=*), intent(in) :: active   !! the attributes that a viewer shows at first

    call self%file%line('<PointData '//active//'>')
  end subroutine begin_point_data

  !> Arrays of the cells follow.
  subroutine begin_cell_data(self, active)
    class(vtk_grid), intent(inout) :: self
    character(len=*), intent(in) :: active   !! the attributes that a viewer shows at first

    call self%file%line('</PointData>')
    call self%file%line('<CellData '//active//'>')
  end subroutine begin_cell_data

  !> One integer a point or cell.
  subroutine put_integers(self, name, values)
    class(vtk_grid), intent(inout) :: self
    character(len=*), intent(in) :: name
    integer, intent(in) :: values(:)

    call write_array(self%file, 'Int32', name, '', transfer(values, [0_int8]))
  end subroutine put_integers

  !> One real a point or cell.
  subroutine put_reals(self, name, values)
    class(vtk_grid), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: values(:)

    call write_array(self%file, 'Float64', name, '', transfer(values, [0_int8]))
  end subroutine put_reals

  !> One vector of the plane a point or cell, or one symmetric tensor, in VTK's order of components.
  subroutine put_fields(self, name, values)
    class(vtk_grid), intent(inout) :: self
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: values(:, :)   !! vectors [2, any], or tensors: xx, yy, zz, xy [4, any]
    character(len=2), parameter :: component(0:5) = ['XX', 'YY', 'ZZ', 'XY', 'YZ', 'XZ']
    real(wp), allocatable :: space(:, :)
    character(len=:), allocatable :: names
    integer :: c, components

    components = merge(3, 6, size(values, 1) == 2)
    names = ' NumberOfComponents="'//text_of(components)//'"'
    do c = 0, merge(-1, 5, components == 3)
      names = names//' ComponentName'//text_of(c)//'="'//component(c)//'"'
    end do
    allocate (space(components, size(values, 2)), source=0.0_wp)
    space(:size(values, 1), :) = values
    call write_array(self%file, 'Float64', name, names, transfer(space, [0_int8]))
  end subroutine put_fields

  !> Close the file and give it its name.
  subroutine finish(self, error)
    class(vtk_grid), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written

    call self%file%line('</CellData>')
    call self%file%line('</Piece>')
    call self%file%line('</UnstructuredGrid>')
    call self%file%line('</VTKFile>')
    call self%file%finish(error)
  end subroutine finish

  !> One array.
  subroutine write_array(file, type, name, shape, bytes)
    type(text_file), intent(inout) :: file
    character(len=*), intent(in) :: type, name
    character(len=*), intent(in) :: shape      !! further attributes, each behind a blank
    integer(int8), intent(in) :: bytes(:)
    integer(int8), allocatable :: counted(:)
    integer, parameter :: head = 8

    allocate (counted(head + size(bytes)))
    counted(:head) = transfer(int(size(bytes), i8), counted(:head))
    counted(head + 1:) = bytes
    call file%line('<DataArray type="'//type//'" Name="'//name//'"'//shape//' format="binary">')
    call file%line(base64(counted))
    call file%line('</DataArray>')
  end subroutine write_array

  !> How this machine orders the bytes of a number.
  pure function byte_order() result(name)
    character(len=:), allocatable :: name
    integer(int8) :: bytes(4)

    bytes = transfer(1, bytes)
    name = trim(merge('LittleEndian', 'BigEndian   ', bytes(1) == 1_int8))
  end function byte_order
end module epcont_report_vtk_grid
