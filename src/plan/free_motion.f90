!> Rigid motions that supports leave free, and the SUPORT freedoms that measure them.
!>
!> Found before anything is factored, since a Cholesky factorization calls many singular matrices definite. The
!> free motions of a body are the null space of one matrix: three columns a rigid part, a row for each hinge, tie
!> and support.
module epcont_plan_free_motion
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_linalg_dense, only: lu_solve, null_space
  use epcont_model_model, only: model_type
  use epcont_plan_rigid_parts, only: find_rigid_parts, rigid_parts
  implicit none
  private
  public :: free_motions, find_free_motions, motion_fault

  !> A singular value up to this part of unit displacements is a free motion.
  real(wp), parameter :: free_tolerance = 1.0e-9_wp
  !> SUPORT freedoms that measure the motions with a condition above this are too close to each other.
  real(wp), parameter :: largest_condition = 1.0e6_wp

  !> A part of a body that moves by less than this part of what moves most does not move.
  real(wp), parameter :: moves = 1.0e-6_wp

  !> What can be wrong with the SUPORT freedoms of a body.
  integer, parameter, public :: motion_not_held = 1, motion_too_many = 2, motion_too_close = 3

  !> A fault of one body.
  type :: motion_fault
    integer :: kind = 0
    integer :: body = 0, node = 0             !! the body and its first node
    integer :: moving = 0                     !! the first node of the parts that motions not held move
    integer :: motions = 0, references = 0    !! free motions, SUPORT freedoms
    integer, allocatable :: freedom(:, :)     !! node, component that would hold each motion not held [2, any]
    real(wp), allocatable :: direction(:, :)  !! motion of that node [2, any]
    real(wp), allocatable :: turn(:)          !! how differently the nodes of its part move; 0: it shifts [any]
  end type motion_fault

  !> The free motions of all bodies.
  type :: free_motions
    integer :: count = 0
    integer, allocatable :: body(:), node(:), component(:)  !! of each motion: body, SUPORT freedom [count]
    type(rigid_parts) :: parts
    real(wp), allocatable :: coefficient(:, :, :)  !! of x, y, turn of each part in each motion [3, parts, count]
  contains
    procedure :: displacement
  end type free_motions

contains

  !> Displacement of a node in unit motion k.
  pure function displacement(self, model, node, k) result(u)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, k
    real(wp) :: u(2)

    u = 0.0_wp
    if (self%body(k) /= model%body(node)) return
    associate (part => self%coefficient(:, self%parts%of_node(node), k))
      u = part(:2) + part(3)*self%parts%turn(model, node)
    end associate
  end function displacement

  !> Find the free motions of all bodies; a body whose SUPORT freedoms do not fit gives a fault.
  subroutine find_free_motions(model, motions, faults)
    type(model_type), intent(in) :: model
    type(free_motions), intent(out) :: motions
    type(motion_fault), allocatable, intent(out) :: faults(:)
    integer, allocatable :: order(:), part_order(:)
    integer :: b, first, last, part_first, part_last

    allocate (faults(0), motions%body(0), motions%node(0), motions%component(0))
    motions%parts = find_rigid_parts(model)
    allocate (motions%coefficient(3, motions%parts%count, 0))
    order = sorted_order(model%body)
    part_order = sorted_order(motions%parts%body)
    first = 1
    part_first = 1
    do b = 1, model%bodies
      last = run_end(model%body, order, first)
      part_last = run_end(motions%parts%body, part_order, part_first)
      call examine_body(model, order(first:last), part_order(part_first:part_last), motions, faults)
      first = last + 1
      part_first = part_last + 1
    end do
  end subroutine find_free_motions

  !> Last place of the run of equal keys that begins at `first`.
  pure integer function run_end(key, order, first) result(last)
    integer, intent(in) :: key(:), order(:), first

    last = first
    do while (last < size(order))
      if (key(order(last + 1)) /= key(order(first))) return
      last = last + 1
    end do
  end function run_end

  !> Free motions of one body.
  subroutine examine_body(model, nodes, part_list, motions, faults)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:), part_list(:)  !! of the body
    type(free_motions), intent(inout) :: motions
    type(motion_fault), allocatable, intent(inout) :: faults(:)
    real(wp), allocatable :: held(:, :), measured(:, :), basis(:, :), loose(:, :), square(:, :), unit(:, :)
    integer, allocatable :: column(:), freedom(:, :)
    type(motion_fault) :: fault
    integer :: i, info, m, old

    allocate (column(motions%parts%count), source=0)
    column(part_list) = [(3*i - 3, i=1, size(part_list))]
    call constraint_rows(model, motions%parts, nodes, column, 3*size(part_list), held, measured, freedom)
    basis = null_space(held, free_tolerance)
    m = size(basis, 2)
    fault%body = model%body(nodes(1))
    fault%node = nodes(1)
    fault%motions = m
    fault%references = size(measured, 1)
    square = matmul(measured, basis)
    loose = matmul(basis, null_space(square, free_tolerance))
    if (size(loose, 2) > 0) then
      fault%kind = motion_not_held
      call suggest(model, motions%parts, nodes, column, loose, fault)
    else if (fault%references > m) then
      fault%kind = motion_too_many
    else if (m > 0) then
      allocate (unit(m, m), source=0.0_wp)
      do i = 1, m
        unit(i, i) = 1.0_wp
      end do
      call lu_solve(square, unit, info)
      if (norm2(unit)*norm2(matmul(measured, basis)) > largest_condition) fault%kind = motion_too_close
    end if
    if (fault%kind > 0) then
      faults = [faults, fault]
      return
    end if
    if (m == 0) return
    old = motions%count
    motions%count = old + m
    motions%body = [motions%body, spread(fault%body, 1, m)]
    motions%node = [motions%node, freedom(1, :)]
    motions%component = [motions%component, freedom(2, :)]
    call append(motions, part_list, reshape(matmul(basis, unit), [3, size(part_list), m]))
  end subroutine examine_body

  !> Add motions of some parts.
  pure subroutine append(motions, part_list, coefficient)
    type(free_motions), intent(inout) :: motions
    integer, intent(in) :: part_list(:)
    real(wp), intent(in) :: coefficient(:, :, :)
    real(wp), allocatable :: grown(:, :, :)
    integer :: old

    old = size(motions%coefficient, 3)
    allocate (grown(3, motions%parts%count, old + size(coefficient, 3)), source=0.0_wp)
    grown(:, :, :old) = motions%coefficient
    grown(:, part_list, old + 1:) = coefficient
    call move_alloc(grown, motions%coefficient)
  end subroutine append

  !> Rows of the motions that hinges, ties and supports hold, and rows of the SUPORT freedoms.
  pure subroutine constraint_rows(model, parts, nodes, column, columns, held, measured, freedom)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: nodes(:), column(:), columns
    real(wp), allocatable, intent(out) :: held(:, :), measured(:, :)
    integer, allocatable, intent(out) :: freedom(:, :)  !! node, component of each measured row [2, any]
    integer :: c, h, i, leader, p, rows, references

    rows = 2*count(column(parts%hinge(2, :)) + column(parts%hinge(3, :)) > 0) + columns &
           + count(model%held(:, nodes)) + count(model%leader(:, nodes) /= spread(nodes, 1, 2))
    references = count(model%reference(:, nodes))
    allocate (held(rows, columns), measured(references, columns), source=0.0_wp)
    allocate (freedom(2, references))
    rows = 0
    references = 0
    do h = 1, size(parts%hinge, 2)
      associate (node => parts%hinge(1, h), a => column(parts%hinge(2, h)), b => column(parts%hinge(3, h)))
        if (model%body(node) /= model%body(nodes(1))) cycle
        do c = 1, 2
          rows = rows + 1
          held(rows, a + 1:a + 3) = parts%row(model, node, c)
          held(rows, b + 1:b + 3) = -parts%row(model, node, c)
        end do
      end associate
    end do
    do p = 1, parts%count
      if (parts%body(p) /= model%body(nodes(1))) cycle
      if (parts%ring(p)) then
        rows = rows + 1
        held(rows, column(p) + 1) = 1.0_wp
      end if
      if (parts%turns(p) .and. .not. parts%ring(p)) cycle
      rows = rows + 1
      held(rows, column(p) + 3) = 1.0_wp
    end do
    do i = 1, size(nodes)
      associate (node => nodes(i), at => column(parts%of_node(nodes(i))))
        do c = 1, 2
          leader = model%leader(c, node)
          if (leader /= node) then
            rows = rows + 1
            held(rows, at + 1:at + 3) = parts%row(model, node, c)
            p = column(parts%of_node(leader))
            held(rows, p + 1:p + 3) = held(rows, p + 1:p + 3) - parts%row(model, leader, c)
          else if (model%held(c, node)) then
            rows = rows + 1
            held(rows, at + 1:at + 3) = parts%row(model, node, c)
          end if
          if (model%reference(c, node)) then
            references = references + 1
            measured(references, at + 1:at + 3) = parts%row(model, node, c)
            freedom(:, references) = [node, c]
          end if
        end do
      end associate
    end do
    held = held(:rows, :)
  end subroutine constraint_rows

  !> Freedoms that would hold the loose motions: those that move most, one after the other, each motion taken out
  !! of the others at the freedom chosen for it.
  subroutine suggest(model, parts, nodes, column, loose, fault)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: nodes(:), column(:)
    real(wp), intent(in) :: loose(:, :)
    type(motion_fault), intent(inout) :: fault
    real(wp), allocatable :: motion(:, :), size_of(:, :)
    real(wp) :: best
    logical, allocatable :: same_part(:)
    integer :: at(2), i, j, k, m, node

    m = size(loose, 2)
    allocate (motion(2*size(nodes), m), fault%freedom(2, m), fault%direction(2, m), fault%turn(m))
    do i = 1, size(nodes)
      k = column(parts%of_node(nodes(i)))
      motion(2*i - 1, :) = matmul(parts%row(model, nodes(i), 1), loose(k + 1:k + 3, :))
      motion(2*i, :) = matmul(parts%row(model, nodes(i), 2), loose(k + 1:k + 3, :))
      if (fault%moving == 0 .and. any(abs(loose(k + 1:k + 3, :)) > moves*maxval(abs(loose)))) fault%moving = nodes(i)
    end do
    do k = 1, m
      ! The first of those that move nearly as much as the largest, so that rounding does not choose.
      size_of = abs(motion(:, k:))
      best = 0.999_wp*maxval(size_of)
      at = findloc(size_of >= best, .true.)
      i = at(1)
      j = k + at(2) - 1
      motion(:, [k, j]) = motion(:, [j, k])
      motion(:, k) = motion(:, k)/motion(i, k)
      node = (i + 1)/2
      fault%freedom(:, k) = [nodes(node), 2 - mod(i, 2)]
      fault%direction(:, k) = motion(2*node - 1:2*node, k)/norm2(motion(2*node - 1:2*node, k))
      same_part = column(parts%of_node(nodes)) == column(parts%of_node(nodes(node)))
      fault%turn(k) = spread_of(pack(motion(1::2, k), same_part)) + spread_of(pack(motion(2::2, k), same_part))
      do j = 1, m
        if (j /= k) motion(:, j) = motion(:, j) - motion(i, j)*motion(:, k)
      end do
    end do
  end subroutine suggest

  !> Largest value less smallest.
  pure real(wp) function spread_of(values)
    real(wp), intent(in) :: values(:)

    spread_of = maxval(values) - minval(values)
  end function spread_of
end module epcont_plan_free_motion
