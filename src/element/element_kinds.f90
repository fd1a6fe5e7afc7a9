!> THE table of elements: a new type is one file in this folder and one row.
module epcont_element_element_kinds
  use epcont_element_element_kind, only: element_kind
  use epcont_element_quad4, only: quad4
  use epcont_element_quad8, only: quad8
  use epcont_element_tria3, only: tria3
  use epcont_element_tria6, only: tria6
  implicit none
  private
  public :: element_kinds

contains

  !> List all element types.
  pure function element_kinds() result(kind)
    type(element_kind), allocatable :: kind(:)

    kind = [tria3(), tria6(), quad4(), quad8()]
  end function element_kinds
end module epcont_element_element_kinds
