!> Unknowns of a body that are kept out of its band or fronts, because each may be coupled with a whole line
!> of nodes: master DOFs (RBE2, MPC), angles of rotating platens, and ends of springs.
module epcont_plan_border
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_model_arrays, only: angle
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: add_sums, number_border

contains

  !> Number the border of a body. Other free DOFs keep the number 0.
  subroutine number_border(model, own, equation, border, tied)
    type(model_type), intent(in) :: model
    integer, intent(in) :: own(:)                !! nodes of the body
    !> Minus the row of `tied` of each DOF [directions, nodes]
    integer, intent(inout) :: equation(:, :)
    integer, intent(out) :: border               !! unknowns
    !> Sums of these that DOFs are; the first rows are each one of them
    type(sparse_rows), intent(out) :: tied
    integer :: angles(size(model%constraints%platen))        ! number of each angle; 0 if it has none
    integer :: c, i

    equation(:, own) = 0
    angles = 0
    border = 0
    do i = 1, size(own)
      do c = 1, directions
        call take_leaders(c, own(i))
      end do
    end do
    do i = 1, size(model%constraints%spring)
      if (model%mesh%body(maxval(model%constraints%spring(i)%node)) == &
          model%mesh%body(own(1))) call take_ends(i)
    end do
    tied%start = [(i, i=1, border + 1)]
    tied%equation = [(i, i=1, border)]
    tied%weight = [(1.0_wp, i=1, border)]
    call add_sums(model, own, angles, equation, tied)
    do i = 1, size(own)
      do c = 1, directions
        equation(c, own(i)) = equation(c, model%constraints%leader(c, own(i)))
      end do
    end do

  contains

    !> Take the masters of a DOF.
    subroutine take_leaders(c, node)
      integer, intent(in) :: c, node
      integer :: i

      if (model%constraints%sum_of(c, node) == 0) then
        if (model%constraints%leader(c, node) /= node) call take(c, model%constraints%leader(c, node))
        return
      end if
      do i = model%constraints%sum%first(model%constraints%sum_of(c, node)), &
        model%constraints%sum%last(model%constraints%sum_of(c, node))
        call take(model%constraints%sum%component(i), model%constraints%sum%node(i))
      end do
    end subroutine take_leaders

    !> Take both ends of a spring; masters of its ends are in the border already.
    subroutine take_ends(k)
      integer, intent(in) :: k
      integer :: i

      do i = 1, 2
        associate (c => model%constraints%spring(k)%component(i), node => model%constraints%spring(k)%node(i))
          if (node == 0) cycle
          if (model%constraints%leader(c, node) == node .and. &
              model%constraints%sum_of(c, node) == 0) call take(c, node)
        end associate
      end do
    end subroutine take_ends

    !> Put a DOF, or the angle of a platen, in the border if it is free.
    subroutine take(c, node)
      integer, intent(in) :: c, node

      if (.not. is_free(model, c, node)) return
      if (c == angle) then
        if (angles(node) > 0) return
        border = border + 1
        angles(node) = border
      else if (equation(c, node) == 0) then
        border = border + 1
        equation(c, node) = -border
      end if
    end subroutine take
  end subroutine number_border

  !> Append a row for each DOF of some nodes that is a sum. A sum in which nothing is free gets none.
  pure subroutine add_sums(model, nodes, angles, equation, tied)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: angles(:)             !! number of each angle; 0 if it is not free [platens]
    !> Numbers of free DOFs, of either sign; 0 if they are not free. Sums get the negative of their row
    !! [directions, nodes of the model]
    integer, intent(inout) :: equation(:, :)
    type(sparse_rows), intent(inout) :: tied     !! rows are appended
    integer :: c, e, entries, i, number, row, terms

    row = size(tied%start) - 1
    entries = size(tied%equation)
    terms = 0
    do i = 1, size(nodes)
      do c = 1, directions
        associate (k => model%constraints%sum_of(c, nodes(i)))
          if (k > 0) terms = terms + model%constraints%sum%last(k) - model%constraints%sum%first(k) + 1
        end associate
      end do
    end do
    if (terms == 0) return
    tied = sparse_rows([tied%start, spread(0, 1, count(model%constraints%sum_of(:, nodes) > 0))], &
                       [tied%equation, spread(0, 1, terms)], [tied%weight, spread(0.0_wp, 1, terms)])
    do i = 1, size(nodes)
      do c = 1, directions
        if (model%constraints%leader(c, nodes(i)) /= nodes(i) .or. &
            model%constraints%sum_of(c, nodes(i)) == 0) cycle
        do e = model%constraints%sum%first(model%constraints%sum_of(c, nodes(i))), &
          model%constraints%sum%last(model%constraints%sum_of(c, nodes(i)))
          associate (of => model%constraints%sum%component(e), node => model%constraints%sum%node(e))
            if (of == angle) number = angles(node)
            if (of /= angle) number = abs(equation(of, node))
          end associate
          if (number == 0) cycle
          entries = entries + 1
          tied%equation(entries) = number
          tied%weight(entries) = model%constraints%sum%weight(e)
        end do
        if (entries < tied%start(row + 1)) cycle
        row = row + 1
        tied%start(row + 1) = entries + 1
        equation(c, nodes(i)) = -row
      end do
    end do
    tied%start = tied%start(:row + 1)
    tied%equation = tied%equation(:entries)
    tied%weight = tied%weight(:entries)
  end subroutine add_sums

  !> Is a DOF, or the angle of a platen, an unknown? It is not a sum itself.
  pure logical function is_free(model, component, node)
    type(model_type), intent(in) :: model
    integer, intent(in) :: component, node   !! component 1: x, 2: y; `angle`: of the platen with this number

    if (component == angle) then
      is_free = .not. (model%constraints%platen(node)%held .or. model%constraints%platen(node)%reference)
    else
      is_free = .not. (model%constraints%held(component, node) .or. &
                       model%constraints%reference(component, node))
    end if
  end function is_free
end module epcont_plan_border
