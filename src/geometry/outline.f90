!> The outlines of all bodies: the sides that one element alone has. Each is walked with the body to the left,
!> and so are the edges of holes. Nodes without elements have none.
module epcont_geometry_outline
  implicit none
  private
  public :: outline_type

  !> Part 1 has the sides first(1) to first(2) - 1, and so on.
  type :: outline_type
    integer :: sides = 0
    integer :: parts = 0                   !! that elements join; what RBE2 alone join are two
    integer, allocatable :: node(:, :)     !! where a side begins, where it ends, its middle or 0 [3, sides]
    integer, allocatable :: element(:)     !! whose side it is [sides]
    integer, allocatable :: before(:)      !! the side that ends where it begins [sides]
    integer, allocatable :: after(:)       !! the side that begins where it ends [sides]
    integer, allocatable :: part(:)        !! [sides]
    integer, allocatable :: first(:)       !! [parts + 1]
    integer, allocatable :: part_of(:)     !! part of each node; 0: it has no elements [nodes]
  end type outline_type
end module epcont_geometry_outline
