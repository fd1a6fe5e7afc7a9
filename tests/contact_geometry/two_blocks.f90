!> Decks of two blocks, one on the other, whose meshes along the joint need not match.
module two_blocks
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: blocks_type, write_blocks, write_cell

  !> Nodes of a cell, from its first one, in half columns and rows: corners, mid-side nodes, centre.
  integer, parameter, public :: across(9) = [0, 2, 2, 0, 1, 2, 1, 0, 1], up(9) = [0, 0, 2, 2, 0, 1, 2, 1, 1]

  type :: blocks_type
    integer :: columns(2) = [4, 4]         !! of the lower and the upper block
    character(len=6) :: element = 'CTRIA3' !! CTRIA3, CTRIA6, CQUAD4, CTRAX3, CTRAX6
    logical :: lines = .true.              !! contact by BCONP, otherwise by CGAP; then the columns must be equal
    logical :: upper_is_slave = .true.
    real(wp) :: inside = 0.0_wp            !! x of the left ends of the blocks; their width is 1
    real(wp) :: rise = 0.0_wp              !! y of the upper surface of the lower block at its right end
    real(wp) :: pressure = 10.0_wp         !! pressure on top
    character(len=8) :: poisson = ''       !! of both, if given
    logical :: stuck = .false.             !! the lower block's base is also fixed sideways
    real(wp) :: gap = 0.0_wp               !! initial height of the upper block above the lower one
    real(wp) :: stretch = 1.0_wp           !! ratio of the widths of the last and the first column
  end type blocks_type

  integer, parameter :: rows = 2

contains

  !> Write the deck: grids of columns by 2, the upper one unconstrained vertically.
  subroutine write_blocks(path, blocks)
    character(len=*), intent(in) :: path
    type(blocks_type), intent(in) :: blocks
    integer :: unit, element

    open (newunit=unit, file=path, status='replace')
    write (unit, '(a)') 'PARAM,GAPGEOM,YES'
    if (blocks%poisson == '') then
      write (unit, '(a)') 'MAT1,1,1000.0,,0.3', 'MAT1,2,500.0,,0.2'
    else
      write (unit, '(a)') 'MAT1,1,1000.0,,'//trim(blocks%poisson), 'MAT1,2,500.0,,'//trim(blocks%poisson)
    end if
    if (blocks%element(:5) == 'CTRAX') then
      write (unit, '(a)') 'PSOLID,1,1', 'PSOLID,2,2'
    else
      write (unit, '(a)') 'PSHELL,1,1,1.0,-1', 'PSHELL,2,2,1.0,-1'
    end if
    element = 0
    call write_block(unit, blocks, 1, element)
    call write_block(unit, blocks, 2, element)
    call write_contact(unit, blocks)
    write (unit, '(a)') 'ENDDATA'
    close (unit)
  end subroutine write_blocks

  !> Nodes, elements, supports and loads of one block.
  subroutine write_block(unit, blocks, which, element)
    integer, intent(in) :: unit, which
    type(blocks_type), intent(in) :: blocks
    integer, intent(inout) :: element
    integer :: c(9), i, j, n

    n = blocks%columns(which)
    do j = 0, 2*rows
      do i = 0, 2*n
        if (.not. is_six(blocks) .and. (mod(i, 2) + mod(j, 2) > 0)) cycle
        write (unit, '(a, i0, 2(a, f0.14))') 'GRID,', node(which, i, j), ',,', blocks%inside + place(blocks, i, n), ',', &
          height(blocks, which, real(j, wp)/(2*rows), place(blocks, i, n))
        if (j == 0 .and. which == 1) write (unit, '(2a, i0)') 'SPC1,1,', trim(merge('12,', '2, ', blocks%stuck)), node(which, i, j)
        if (i == 0) write (unit, '(a, i0)') 'SPC1,1,1,', node(which, i, j)
      end do
    end do
    do j = 0, 2*rows - 2, 2
      do i = 0, 2*n - 2, 2
        c = node(which, i + across, j + up)
        call write_cell(unit, blocks%element, element + 1, which, c)
        element = element + merge(1, 2, blocks%element == 'CQUAD4')
        if (which == 2 .and. j == 2*rows - 2) &
          write (unit, '(a, i0, a, f0.4, 2(a, i0))') 'PLOADX1,1,', element, ',', blocks%pressure, ',,', c(3), ',', c(4)
      end do
    end do
    if (which == 2) write (unit, '(a, i0, a)') 'SUPORT,', node(2, 0, 2*rows), ',2'
  end subroutine write_block

  !> The one or two elements of a cell.
  subroutine write_cell(unit, name, first, property, c)
    integer, intent(in) :: unit
    character(len=6), intent(in) :: name
    integer, intent(in) :: first      !! id
    integer, intent(in) :: property
    integer, intent(in) :: c(9)       !! ids of the nodes

    select case (name)
    case ('CQUAD4')
      call write_element(first, c(:4))
    case ('CTRIA6')
      call write_element(first, c([1, 2, 3, 5, 6, 9]))
      call write_element(first + 1, c([1, 3, 4, 9, 7, 8]))
    case ('CTRAX6')
      call write_element(first, c([1, 5, 2, 6, 3, 9]))
      call write_element(first + 1, c([1, 9, 3, 7, 4, 8]))
    case default
      call write_element(first, c(:3))
      call write_element(first + 1, c([1, 3, 4]))
    end select

  contains

    subroutine write_element(id, node)
      integer, intent(in) :: id, node(:)

      write (unit, '(a, *(:, ",", i0))') name, id, property, node
    end subroutine write_element
  end subroutine write_cell

  subroutine write_contact(unit, blocks)
    integer, intent(in) :: unit
    type(blocks_type), intent(in) :: blocks
    integer :: i

    if (blocks%lines) then
      ! Listed in either direction, without mid-side nodes.
      write (unit, '(a, i0, a, i0, a, i0)') 'BLSEG,1,', node(1, 0, 2*rows), ',THRU,', &
        node(1, 2*blocks%columns(1), 2*rows), ',BY,', 2
      write (unit, '(a, i0, a, i0, a, i0)') 'BLSEG,2,', node(2, 2*blocks%columns(2), 0), ',THRU,', node(2, 0, 0), ',BY,', -2
      write (unit, '(a)') 'BCONP,1,'//merge('2,1', '1,2', blocks%upper_is_slave)
    else
      write (unit, '(a)') 'CORD2R,1,,0.0,0.0,0.0,0.0,0.0,1.0', ',0.0,1.0,0.0', 'PGAP,9,0.0'
      do i = 0, 2*blocks%columns(2), merge(1, 2, is_six(blocks))
        write (unit, '(3(a, i0), a)') 'CGAP,', 100000 + i, ',9,', node(1, i, 2*rows), ',', node(2, i, 0), ',,,,1'
      end do
    end if
  end subroutine write_contact

  pure logical function is_six(blocks)
    type(blocks_type), intent(in) :: blocks

    is_six = blocks%element(6:6) == '6'
  end function is_six

  !> Id of a node by half column and half row.
  elemental integer function node(which, i, j)
    integer, intent(in) :: which, i, j

    node = 10000*which + 1000*j + i + 1
  end function node

  !> From 0 to 1: columns that widen.
  pure real(wp) function place(blocks, i, columns)
    type(blocks_type), intent(in) :: blocks
    integer, intent(in) :: i, columns

    associate (s => real(i/2, wp)/columns, t => real(i/2 + 1, wp)/columns, a => 2.0_wp/(1.0_wp + blocks%stretch))
      place = a*s + (1.0_wp - a)*s**2
      if (mod(i, 2) == 1) place = 0.5_wp*(place + a*t + (1.0_wp - a)*t**2)
    end associate
  end function place

  pure real(wp) function height(blocks, which, part, across)
    type(blocks_type), intent(in) :: blocks
    integer, intent(in) :: which
    real(wp), intent(in) :: part, across

    if (which == 1) then
      height = part*(1.0_wp + blocks%rise*across)
    else
      height = 2.0_wp*part + (1.0_wp - part)*(1.0_wp + blocks%rise*across) + blocks%gap
    end if
  end function height
end module two_blocks
