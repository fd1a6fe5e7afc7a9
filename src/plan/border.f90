!> Unknowns of a body that are kept out of its band or fronts, since each may be coupled with a whole line of
!> nodes: what others follow (RBE2, MPC), the angles of platens that turn, the ends of springs.
module epcont_plan_border
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_model_arrays, only: angle
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: number_border

contains

  !> Number the border of a body; what is free and not in it has the number 0 still.
  subroutine number_border(model, own, equation, border, tied)
    type(model_type), intent(in) :: model        !! the scene
    integer, intent(in) :: own(:)                !! nodes of the body
    !> Of each freedom: minus its row of `tied` [directions, nodes]
    integer, intent(inout) :: equation(:, :)
    integer, intent(out) :: border               !! unknowns
    !> Sums of these, which freedoms are; the first are each one of them
    type(sparse_rows), intent(out) :: tied
    integer :: angles(size(model%platen))        ! their numbers
    integer :: c, entries, i, row

    equation(:, own) = 0
    angles = 0
    border = 0
    entries = 0
    do i = 1, size(own)
      do c = 1, directions
        call take_leaders(c, own(i))
      end do
    end do
    do i = 1, size(model%spring)
      if (model%body(maxval(model%spring(i)%node)) == model%body(own(1))) call take_ends(i)
    end do
    tied%start = [(i, i=1, border + 1)]
    tied%equation = [(i, i=1, border), (0, i=1, entries)]
    tied%weight = [(1.0_wp, i=1, border), (0.0_wp, i=1, entries)]
    if (entries > 0) then
      entries = border
      row = border
      tied%start = [tied%start, [(0, i=1, count(model%sum_of(:, own) > 0))]]
      do i = 1, size(own)
        do c = 1, directions
          if (model%leader(c, own(i)) == own(i) .and. model%sum_of(c, own(i)) > 0) call add_sum(c, own(i))
        end do
      end do
      tied = sparse_rows(tied%start(:row + 1), tied%equation(:entries), tied%weight(:entries))
    end if
    do i = 1, size(own)
      do c = 1, directions
        equation(c, own(i)) = equation(c, model%leader(c, own(i)))
      end do
    end do

  contains

    !> What a freedom follows.
    subroutine take_leaders(c, node)
      integer, intent(in) :: c, node
      integer :: i

      if (model%sum_of(c, node) == 0) then
        if (model%leader(c, node) /= node) call take(c, model%leader(c, node))
        return
      end if
      do i = model%sum%first(model%sum_of(c, node)), model%sum%last(model%sum_of(c, node))
        call take(model%sum%component(i), model%sum%node(i))
        entries = entries + 1
      end do
    end subroutine take_leaders

    !> Both ends of a spring, or what they follow, which is there already.
    subroutine take_ends(k)
      integer, intent(in) :: k
      integer :: i

      do i = 1, 2
        associate (c => model%spring(k)%component(i), node => model%spring(k)%node(i))
          if (node == 0) cycle
          if (model%leader(c, node) == node .and. model%sum_of(c, node) == 0) call take(c, node)
        end associate
      end do
    end subroutine take_ends

    !> A freedom, or the angle of a platen, is of the border if it is free.
    subroutine take(c, node)
      integer, intent(in) :: c, node

      if (.not. is_free(model, c, node)) return
      if (number_of(c, node) > 0) return
      border = border + 1
      if (c == angle) then
        angles(node) = border
      else
        equation(c, node) = -border
      end if
    end subroutine take

    !> The number of one; 0: it has none.
    integer function number_of(c, node) result(number)
      integer, intent(in) :: c, node

      if (c == angle) then
        number = angles(node)
      else
        number = -equation(c, node)
      end if
    end function number_of

    !> The row of a sum; none where nothing in it is free.
    subroutine add_sum(c, node)
      integer, intent(in) :: c, node
      integer :: i, number

      do i = model%sum%first(model%sum_of(c, node)), model%sum%last(model%sum_of(c, node))
        number = number_of(model%sum%component(i), model%sum%node(i))
        if (number == 0) cycle
        entries = entries + 1
        tied%equation(entries) = number
        tied%weight(entries) = model%sum%weight(i)
      end do
      if (entries < tied%start(row + 1)) return
      row = row + 1
      tied%start(row + 1) = entries + 1
      equation(c, node) = -row
    end subroutine add_sum
  end subroutine number_border

  !> Is a freedom, or the angle of a platen, one that an equation is solved for? It is no part of a sum.
  pure logical function is_free(model, component, node)
    type(model_type), intent(in) :: model
    integer, intent(in) :: component, node   !! 1: x, 2: y; `angle`: of the platen of that number

    if (component == angle) then
      is_free = .not. (model%platen(node)%held .or. model%platen(node)%reference)
    else
      is_free = .not. (model%held(component, node) .or. model%reference(component, node))
    end if
  end function is_free
end module epcont_plan_border
