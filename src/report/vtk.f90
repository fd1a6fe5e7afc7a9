!> Files for ParaView: the bodies and the boundary in contact, as unstructured grids in VTK's XML format
!> (`.vtu`), which meshio and pyvista read too.
!>
!> Numbers are stored in full as base64: the number of bytes (itself 8 bytes), then the values. Points and
!> vectors have three components; the third is 0.
module epcont_report_vtk
  use, intrinsic :: iso_fortran_env, only: int8
  use epcont_base_base64, only: base64
  use epcont_base_decimal, only: decimal_text
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: newline, text_of
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_model_model, only: model_type
  use epcont_report_file, only: remove_file, text_file
  use epcont_messages_names, only: when
  use epcont_result_answer, only: answer_type, pair_sticks
  use epcont_result_contact_line, only: contact_line, find_contact_line
  implicit none
  private
  public :: drawing, remove_drawings, write_collection, write_vtk

  !> Cell types (vtkCellType.h).
  integer, parameter :: vtk_vertex = 1, vtk_line = 3

  !> Cells of the grid. VTK and the model have the same order of nodes in an element.
  type :: vtk_cells
    integer, allocatable :: kind(:)     !! [cells]
    integer, allocatable :: last(:)     !! last point of each cell [cells]
    integer, allocatable :: point(:)    !! points of one cell after the other, numbered from 1
  end type vtk_cells

  !> A file with a grid, and arrays for its points or cells.
  type, extends(text_file) :: vtk_file
  contains
    procedure, private :: begin, end_grid, put_bytes, put_integers, put_reals, put_fields
    generic, private :: put => put_integers, put_reals, put_fields
  end type vtk_file

  !> Files of one state: the end of a load case, or of an increment.
  type :: drawing
    character(len=40) :: suffix = ''   !! of the files, before `.vtu`
    real(wp) :: time = 0.0_wp          !! in DECK.pvd
  end type drawing

contains

  !> Write DECK.vtu, and DECK.contact.vtu if there are pairs.
  subroutine write_vtk(model, answer, status, stem, error)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer               !! of the model
    integer, intent(in) :: status                         !! exit status of the answer
    character(len=*), intent(in) :: stem                  !! path of the files, without their suffixes
    type(error_type), allocatable, intent(out) :: error   !! a file cannot be written

    call write_bodies(model, answer, status, stem, error)
    if (model%contact%pairs > 0 .and. .not. allocated(error)) &
      call write_contact(model, answer, status, stem, error)
  end subroutine write_vtk

  !> Write the bodies: points are the nodes of elements, in the order of the deck; cells are the elements.
  subroutine write_bodies(model, answer, status, stem, error)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    integer, intent(in) :: status
    character(len=*), intent(in) :: stem
    type(error_type), allocatable, intent(out) :: error
    type(vtk_file) :: file
    real(wp), allocatable :: force(:, :)
    integer, allocatable :: last(:), node(:), point(:)
    integer :: i

    node = model%mesh%around%members()
    allocate (point(model%mesh%nodes))
    point(node) = [(i, i=1, size(node))]
    last = model%mesh%node_count
    do i = 2, size(last)
      last(i) = last(i - 1) + last(i)
    end do
    call file%begin(status, model%mesh%x(:, node), &
                    vtk_cells(model%mesh%kinds(model%mesh%kind)%vtk, last, &
                              point(pack(model%mesh%connectivity, model%mesh%connectivity > 0))))
    call file%line('<PointData Vectors="displacement">')
    call file%put('node_id', model%mesh%node_id(node))
    call file%put('displacement', answer%displacement(:, node))
    force = pair_forces(model, answer%contact%row_forces())
    call file%put('contact_force', force(:, node))
    call file%put('reaction', answer%reaction(:, node))
    call file%line('</PointData>'//newline//'<CellData Scalars="equivalent_stress">')
    call file%put('element_id', model%mesh%element_id)
    call file%put('body', model%mesh%body(model%mesh%connectivity(1, :)))
    call file%put('property_id', model%sections%property_id(model%mesh%section))
    call file%put('material_id', model%sections%material_id(model%mesh%section))
    call file%put('stress', answer%stress)
    call file%put('equivalent_stress', answer%equivalent_stress)
    call file%put('max_equivalent_stress', answer%largest_stress)
    call file%put('equivalent_strain', answer%equivalent_strain)
    call file%put('secant_modulus', answer%secant_modulus)
    call file%put('yielded', merge(1, 0, answer%plastic))
    if (allocated(answer%plastic_strain)) then
      call file%put('plastic_strain', answer%plastic_strain(:4, :))
      call file%put('accumulated_plastic_strain', answer%plastic_strain(5, :))
    end if
    call file%end_grid(stem//'.vtu', error)
  end subroutine write_bodies

  !> Write the contact: points are pairs, at their boundary nodes, in the order of the deck; cells are lines
  !! between neighbours, and single pairs without neighbours.
  subroutine write_contact(model, answer, status, stem, error)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    integer, intent(in) :: status
    character(len=*), intent(in) :: stem
    type(error_type), allocatable, intent(out) :: error
    type(vtk_file) :: file
    type(contact_line) :: line
    type(vtk_cells) :: cells
    integer, dimension(model%contact%pairs) :: bconp, zone   ! 0 for a CGAP; 0 outside of zones
    real(wp) :: force(directions, model%contact%pairs)
    real(wp), dimension(model%contact%pairs) :: friction, slip
    logical :: sticking(model%contact%pairs)
    integer :: k

    line = find_contact_line(model)
    cells = cells_along(line)
    call file%begin(status, model%mesh%x(:, line%node), cells)
    do k = 1, model%contact%pairs
      force(:, k) = answer%contact%force(k)*model%contact%normal(:, k)
      if (line%node(k) /= model%contact%pair_node(2, k)) force(:, k) = -force(:, k)
    end do
    associate (contact => model%contact, found => answer%contact)
      slip = 0.0_wp
      friction = 0.0_wp
      sticking = .false.
      if (contact%has_friction()) then
        slip(contact%sliding) = found%slip
        friction(contact%sliding) = found%friction_force
        sticking(contact%sliding) = answer%friction_states(contact%sliding) == pair_sticks
      end if
    end associate
    zone = 0
    do k = 1, size(answer%zones)
      zone(answer%zones(k)%pairs) = k
    end do
    bconp = 0
    do k = 1, size(model%contact%line_contact)
      associate (contact => model%contact%line_contact(k))
        bconp(contact%first:contact%last) = contact%bconp(1)
      end associate
    end do
    call file%line('<PointData Scalars="pressure" Vectors="displacement">')
    call file%put('pair_id', model%contact%pair_id)
    call file%put('node_a', model%mesh%node_id(model%contact%pair_node(1, :)))
    call file%put('node_b', model%mesh%node_id(model%contact%pair_node(2, :)))
    call file%put('displacement', answer%displacement(:, line%node))
    call file%put('contact_force', force)
    call file%put('pressure', max(0.0_wp, answer%pressure))
    call file%put('has_pressure', merge(1, 0, answer%pressure >= 0.0_wp))
    call file%put('gap', answer%contact%gap)
    call file%put('touching', merge(1, 0, answer%contact%touching))
    if (model%contact%has_friction()) then
      call file%put('friction_force', friction)
      call file%put('slip', slip)
      call file%put('sticking', merge(1, 0, sticking))
    end if
    call file%put('zone', zone)
    call file%line('</PointData>'//newline//'<CellData Scalars="bconp">')
    call file%put('bconp', bconp(cells%point(cells%last)))
    call file%end_grid(stem//'.contact.vtu', error)
  end subroutine write_contact

  !> Begin a file with the points and the cells; arrays of the points come next.
  subroutine begin(self, status, x, cells)
    class(vtk_file), intent(inout) :: self
    integer, intent(in) :: status           !! exit status of the run
    real(wp), intent(in) :: x(:, :)         !! of the points [length] [2, points]
    type(vtk_cells), intent(in) :: cells    !! the cells

    call self%line('<?xml version="1.0"?>'//newline// &
                   '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="'// &
                   when(transfer(1, 0_int8) == 1_int8, 'LittleEndian', 'BigEndian')// &
                   '" header_type="UInt64">'//newline//'<UnstructuredGrid>'//newline//'<FieldData>')
    call self%put_bytes('Int32', 'exit_status', ' NumberOfTuples="1"', transfer([status], [0_int8]))
    call self%line('</FieldData>'//newline//'<Piece NumberOfPoints="'//text_of(size(x, 2))// &
                   '" NumberOfCells="'//text_of(size(cells%kind))//'">'//newline//'<Points>')
    call self%put('Points', x)
    call self%line('</Points>'//newline//'<Cells>')
    call self%put('connectivity', cells%point - 1)
    call self%put('offsets', cells%last)
    call self%put_bytes('UInt8', 'types', '', int(cells%kind, int8))
    call self%line('</Cells>')
  end subroutine begin

  !> End the grid and write the file.
  subroutine end_grid(self, path, error)
    class(vtk_file), intent(inout) :: self
    character(len=*), intent(in) :: path    !! of the file
    type(error_type), allocatable, intent(out) :: error

    call self%line('</CellData>'//newline//'</Piece>'//newline//'</UnstructuredGrid>'//newline//'</VTKFile>')
    call self%write_to(path, error)
  end subroutine end_grid

  !> Write one integer for each point or cell.
  subroutine put_integers(self, name, values)
    class(vtk_file), intent(inout) :: self
    character(len=*), intent(in) :: name   !! of the array
    integer, intent(in) :: values(:)       !! [points] or [cells]

    call self%put_bytes('Int32', name, '', transfer(values, [0_int8]))
  end subroutine put_integers

  !> Write one real for each point or cell.
  subroutine put_reals(self, name, values)
    class(vtk_file), intent(inout) :: self
    character(len=*), intent(in) :: name   !! of the array
    real(wp), intent(in) :: values(:)      !! [points] or [cells]

    call self%put_bytes('Float64', name, '', transfer(values, [0_int8]))
  end subroutine put_reals

  !> Write one plane vector or one symmetric tensor for each point or cell, in VTK's order of components.
  subroutine put_fields(self, name, values)
    class(vtk_file), intent(inout) :: self
    character(len=*), intent(in) :: name   !! of the array
    real(wp), intent(in) :: values(:, :)   !! vectors [2, any], or tensors: xx, yy, zz, xy [4, any]
    character(len=*), parameter :: tensor = ' NumberOfComponents="6" ComponentName0="XX" '// &
      'ComponentName1="YY" ComponentName2="ZZ" ComponentName3="XY" ComponentName4="YZ" ComponentName5="XZ"'
    real(wp), allocatable :: space(:, :)
    logical :: is_vector

    is_vector = size(values, 1) == directions
    allocate (space(merge(3, 6, is_vector), size(values, 2)), source=0.0_wp)
    space(:size(values, 1), :) = values
    call self%put_bytes('Float64', name, when(is_vector, ' NumberOfComponents="3"', tensor), &
                        transfer(space, [0_int8]))
  end subroutine put_fields

  !> Write one array with more attributes, each after a blank.
  subroutine put_bytes(self, type, name, shape, bytes)
    class(vtk_file), intent(inout) :: self
    character(len=*), intent(in) :: type, name, shape
    integer(int8), intent(in) :: bytes(:)

    call self%line('<DataArray type="'//type//'" Name="'//name//'"'//shape//' format="binary">')
    call self%line(base64([transfer(int(size(bytes), i8), bytes), bytes]))
    call self%line('</DataArray>')
  end subroutine put_bytes

  !> Find lines between neighbouring pairs, then single pairs without neighbours.
  pure function cells_along(line) result(cells)
    type(contact_line), intent(in) :: line
    type(vtk_cells) :: cells
    integer, allocatable :: alone(:)
    integer :: i, k, other, segment(2, 2*size(line%node)), segments
    logical :: joined(size(line%node))

    joined = .false.
    segments = 0
    do k = 1, size(line%node)
      do i = 1, 2
        other = line%neighbour(i, k)
        if (other == 0) cycle
        if (any(line%neighbour(:, other) == k)) then
          if (other < k) cycle   ! this line exists already
        else if (count(line%node == line%node(other)) > 1) then
          cycle                  ! at a corner: the node's pair on the other edge
        end if
        segments = segments + 1
        segment(:, segments) = [k, other]
        joined([k, other]) = .true.
      end do
    end do
    alone = pack([(k, k=1, size(joined))], .not. joined)
    cells%kind = [spread(vtk_line, 1, segments), spread(vtk_vertex, 1, size(alone))]
    cells%last = [(2*k, k=1, segments), (2*segments + k, k=1, size(alone))]
    cells%point = [segment(:, :segments), alone]
  end function cells_along

  !> Write DECK.pvd: an index of the files of the bodies for ParaView.
  subroutine write_collection(stem, drawings, error)
    character(len=*), intent(in) :: stem                  !! path of the files, without their suffixes
    type(drawing), intent(in) :: drawings(:)
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written
    type(text_file) :: file
    integer :: k

    call file%line('<?xml version="1.0"?>')
    call file%line('<VTKFile type="Collection" version="1.0">')
    call file%line('<Collection>')
    do k = 1, size(drawings)
      call file%line('<DataSet timestep="'//time_text(drawings(k)%time)//'" file="'// &
        escaped(stem(index(stem, '/', back=.true.) + 1:))//trim(drawings(k)%suffix)//'.vtu"/>')
    end do
    call file%line('</Collection>')
    call file%line('</VTKFile>')
    call file%write_to(stem//'.pvd', error)
  end subroutine write_collection

  !> Write a time: `2` or `1.25000000E+00`.
  pure function time_text(time) result(text)
    real(wp), intent(in) :: time
    character(len=:), allocatable :: text

    text = trim(decimal_text(time, 9, 2))
    if (time == nint(time)) text = text_of(nint(time))
  end function time_text

  !> Escape text for an XML attribute.
  pure function escaped(text) result(xml)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: xml
    integer :: i

    xml = ''
    do i = 1, len(text)
      select case (text(i:i))
      case ('&')
        xml = xml//'&amp;'
      case ('<')
        xml = xml//'&lt;'
      case ('"')
        xml = xml//'&quot;'
      case default
        xml = xml//text(i:i)
      end select
    end do
  end function escaped

  !> Remove the files of an earlier run: of the load cases in its DECK.pvd, or of a single one.
  subroutine remove_drawings(stem)
    character(len=*), intent(in) :: stem   !! path of the files, without their suffixes
    integer :: at, id, opened, status, unit
    character(len=2048) :: line            ! longer than any name

    open (newunit=unit, file=stem//'.pvd', status='old', action='read', iostat=opened)
    status = opened
    do while (status == 0)
      read (unit, '(a)', iostat=status) line
      at = index(line, '.case', back=.true.)
      if (status /= 0 .or. at == 0) cycle
      line = line(at + len('.case'):)
      id = 0
      read (line(:index(line, '.') - 1), '(i20)', iostat=at) id
      if (id > 0) call remove_case(stem//'.case'//text_of(id))
    end do
    if (opened == 0) close (unit)
    call remove_case(stem)

  contains

    !> Remove the files of a load case: of its end, and of each increment.
    subroutine remove_case(stem)
      character(len=*), intent(in) :: stem
      logical :: exists
      integer :: k

      call remove_file(stem//'.vtu')
      call remove_file(stem//'.contact.vtu')
      k = 0
      do
        k = k + 1
        inquire (file=stem//'.inc'//text_of(k)//'.vtu', exist=exists)
        if (.not. exists) exit
        call remove_file(stem//'.inc'//text_of(k)//'.vtu')
        call remove_file(stem//'.inc'//text_of(k)//'.contact.vtu')
      end do
    end subroutine remove_case
  end subroutine remove_drawings
end module epcont_report_vtk
