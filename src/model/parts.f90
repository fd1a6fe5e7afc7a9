!> The parts of a model from model data that have been checked.
module epcont_model_parts
  use epcont_element_element_kind, only: element_kind
  use epcont_element_element_kinds, only: element_kinds
  use epcont_model_arrays, only: element_block, scene_type
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: kind_of, make_parts

contains

  !> Move the arrays of model data to the parts of the model, except loads of cases, ties and blocks.
  pure subroutine make_parts(data, model)
    type(scene_type), intent(inout) :: data    !! its arrays are moved
    type(model_type), intent(inout) :: model   !! keeps its ids; if it has no ids, they are positions

    call move_alloc(data%x, model%mesh%x)
    model%mesh%nodes = size(model%mesh%x, 2)
    call list_elements(data%block, model)
    model%sections = data%sections_type
    associate (constraints => model%constraints)
      call move_alloc(data%held, constraints%held)
      call move_alloc(data%reference, constraints%reference)
      call move_alloc(data%platen, constraints%platen)
      call move_alloc(data%equation, constraints%equation)
      call move_alloc(data%spring, constraints%spring)
    end associate
    associate (contact => model%contact)
      call move_alloc(data%pair_node, contact%pair_node)
      call move_alloc(data%normal, contact%normal)
      call move_alloc(data%initial_gap, contact%initial_gap)
      call move_alloc(data%line, contact%line)
      call move_alloc(data%couple, contact%couple)
      contact%pairs = size(contact%initial_gap)
      call move_alloc(data%friction, contact%friction)
      if (.not. allocated(contact%friction)) contact%friction = 0*contact%initial_gap
      contact%contact_is_off = data%contact_is_off
      contact%gap_by_geometry = data%gap_by_geometry
    end associate
    call move_alloc(data%load, model%loads%load)
    call move_alloc(data%prescribed, model%loads%prescribed)
    model%controls = data%controls
    if (.not. allocated(model%mesh%node_id)) call number_items(model)
  end subroutine make_parts

  !> Put all elements in one list.
  pure subroutine list_elements(block, model)
    type(element_block), intent(in) :: block(:)
    type(model_type), intent(inout) :: model
    integer :: b, first, last

    associate (mesh => model%mesh)
      mesh%kinds = element_kinds()
      mesh%elements = sum([(size(block(b)%section), b=1, size(block))])
      allocate (mesh%kind(mesh%elements), mesh%section(mesh%elements))
      allocate (mesh%connectivity(maxval([0, (size(block(b)%node, 1), b=1, size(block))]), mesh%elements), &
                source=0)
      last = 0
      do b = 1, size(block)
        first = last + 1
        last = last + size(block(b)%section)
        mesh%kind(first:last) = kind_of(mesh%kinds, block(b)%name)
        mesh%section(first:last) = block(b)%section
        mesh%connectivity(:size(block(b)%node, 1), first:last) = block(b)%node
      end do
    end associate
  end subroutine list_elements

  !> Use positions as ids.
  pure subroutine number_items(model)
    type(model_type), intent(inout) :: model
    integer :: i

    model%mesh%node_id = [(i, i=1, model%mesh%nodes)]
    model%mesh%element_id = [(i, i=1, model%mesh%elements)]
    model%sections%property_id = [(i, i=1, size(model%sections%young))]
    model%sections%material_id = model%sections%property_id
    model%contact%pair_id = [(i, i=1, model%contact%pairs)]
    model%contact%line%id = [(i, i=1, size(model%contact%line))]
    model%contact%couple%id = [(i, i=1, size(model%contact%couple))]
  end subroutine number_items

  !> Row of a card in the table of element types, 0 if absent.
  pure integer function kind_of(kinds, card)
    type(element_kind), intent(in) :: kinds(:)   !! the table
    character(len=*), intent(in) :: card         !! its name

    kind_of = findloc(card /= '' .and. (kinds%plane_card == card .or. kinds%ring_card == card), .true., dim=1)
  end function kind_of
end module epcont_model_parts
