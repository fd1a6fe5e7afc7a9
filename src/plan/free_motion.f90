!> Rigid motions that supports leave free, and the SUPORT freedoms that measure them.
!>
!> Found before anything is factored, since a Cholesky factorization calls many singular matrices definite.
!> The free motions of a body are the null space of one matrix: three columns a rigid part, a row for each
!> hinge, tie and support.
module epcont_plan_free_motion
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent, no_effect
  use epcont_linalg_dense, only: lu_solve, null_space
  use epcont_model_model, only: model_type
  use epcont_plan_rigid_parts, only: find_rigid_parts, rigid_parts
  implicit none
  private
  public :: free_motions, find_free_motions, motion_fault

  !> SUPORT freedoms that measure the motions with a condition above this are too close to each other: six
  !! digits of the displacements would be lost.
  real(wp), parameter :: largest_condition = 1.0e6_wp

  !> Freedoms that move by this part of the largest motion may take its place.
  real(wp), parameter :: nearly = 0.999_wp

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
    real(wp), allocatable :: turn(:)   !! how differently the nodes of its part move; 0: it shifts [any]
  end type motion_fault

  !> The free motions of all bodies.
  type :: free_motions
    integer :: count = 0
    integer, allocatable :: body(:), node(:), component(:)  !! of each motion: body, SUPORT freedom [count]
    type(rigid_parts) :: parts
    !> Of x, y, turn of each part in each motion [3, parts, count]
    real(wp), allocatable :: coefficient(:, :, :)
  contains
    procedure :: displacement
  end type free_motions

contains

  !> Displacement of a node in unit motion k.
  pure function displacement(self, model, node, k) result(u)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: node, k   !! the node, and the number of the motion
    real(wp) :: u(2)

    u = 0.0_wp
    if (self%body(k) /= model%body(node)) return
    associate (part => self%coefficient(:, self%parts%of_node(node), k))
      u = part(:2) + part(3)*self%parts%turn(model, node)
    end associate
  end function displacement

  !> Find the free motions of all bodies; a body whose SUPORT freedoms do not fit gives a fault.
  subroutine find_free_motions(model, motions, faults)
    type(model_type), intent(in) :: model   !! the scene
    type(free_motions), intent(out) :: motions   !! of all bodies without a fault
    type(motion_fault), allocatable, intent(out) :: faults(:)   !! one of each body that has one
    type(incidence) :: nodes, parts   !! of each body
    integer :: b

    allocate (faults(0), motions%body(0), motions%node(0), motions%component(0))
    motions%parts = find_rigid_parts(model)
    allocate (motions%coefficient(3, motions%parts%count, 0))
    nodes = new_incidence(reshape(model%body, [1, model%nodes]), model%bodies)
    parts = new_incidence(reshape(motions%parts%body, [1, motions%parts%count]), model%bodies)
    do b = 1, model%bodies
      call examine_body(model, nodes%group(nodes%start(b):nodes%start(b + 1) - 1), &
                        parts%group(parts%start(b):parts%start(b + 1) - 1), motions, faults)
    end do
  end subroutine find_free_motions

  !> Free motions of one body.
  subroutine examine_body(model, nodes, part_list, motions, faults)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:), part_list(:)  !! of the body
    type(free_motions), intent(inout) :: motions
    type(motion_fault), allocatable, intent(inout) :: faults(:)
    real(wp), allocatable :: basis(:, :), held(:, :), loose(:, :), measured(:, :), square(:, :), unit(:, :)
    integer, allocatable :: column(:), freedom(:, :)
    type(motion_fault) :: fault
    integer :: i, m

    allocate (column(motions%parts%count), source=0)
    column(part_list) = [(3*i - 3, i=1, size(part_list))]
    call collect_rows(model, motions%parts, nodes, column, held, measured, freedom)
    basis = null_space(held, dependent)
    m = size(basis, 2)
    fault = motion_fault(body=model%body(nodes(1)), node=nodes(1), motions=m, references=size(measured, 1))
    square = matmul(measured, basis)
    loose = matmul(basis, null_space(square, dependent))
    if (size(loose, 2) > 0) then
      fault%kind = motion_not_held
      call suggest(model, motions%parts, nodes, column, loose, fault)
    else if (fault%references > m) then
      fault%kind = motion_too_many
    else
      unit = inverse(square)
      if (norm2(unit)*norm2(square) > largest_condition) fault%kind = motion_too_close
    end if
    if (fault%kind > 0) then
      faults = [faults, fault]
    else if (m > 0) then
      motions%count = motions%count + m
      motions%body = [motions%body, spread(fault%body, 1, m)]
      motions%node = [motions%node, freedom(1, :)]
      motions%component = [motions%component, freedom(2, :)]
      call append(motions, part_list, reshape(matmul(basis, unit), [3, size(part_list), m]))
    end if
  end subroutine examine_body

  pure function inverse(matrix)
    real(wp), intent(in) :: matrix(:, :)
    real(wp) :: inverse(size(matrix, 1), size(matrix, 1))
    real(wp) :: factors(size(matrix, 1), size(matrix, 1))
    integer :: i, info

    inverse = 0.0_wp
    do i = 1, size(matrix, 1)
      inverse(i, i) = 1.0_wp
    end do
    factors = matrix
    call lu_solve(factors, inverse, info)
  end function inverse

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

  !> Rows of the motions of a body that hinges, ties and supports hold, and rows of its SUPORT freedoms.
  pure subroutine collect_rows(model, parts, nodes, column, held, measured, freedom)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: nodes(:), column(:)
    real(wp), allocatable, intent(out) :: held(:, :), measured(:, :)
    integer, allocatable, intent(out) :: freedom(:, :)  !! node, component of each measured row [2, any]
    integer :: c, columns, i, references, rows

    columns = maxval(column) + 3
    rows = 2*count(column(parts%hinge(2, :)) + column(parts%hinge(3, :)) > 0) + columns &
           + count(model%held(:, nodes) .or. model%leader(:, nodes) /= spread(nodes, 1, 2))
    allocate (held(rows, columns), measured(count(model%reference(:, nodes)), columns), source=0.0_wp)
    allocate (freedom(2, size(measured, 1)))
    call hold_parts(model, parts, model%body(nodes(1)), column, held, rows)
    references = 0
    do i = 1, size(nodes)
      associate (node => nodes(i), at => column(parts%of_node(nodes(i))))
        do c = 1, 2
          associate (leader => model%leader(c, node), &
                     at_leader => column(parts%of_node(model%leader(c, node))))
            if (leader /= node .or. model%held(c, node)) then
              rows = rows + 1
              held(rows, at + 1:at + 3) = parts%row(model, node, c)
              associate (others => held(rows, at_leader + 1:at_leader + 3))
                if (leader /= node) others = others - parts%row(model, leader, c)
              end associate
            end if
          end associate
          if (.not. model%reference(c, node)) cycle
          references = references + 1
          measured(references, at + 1:at + 3) = parts%row(model, node, c)
          freedom(:, references) = [node, c]
        end do
      end associate
    end do
    held = held(:rows, :)
  end subroutine collect_rows

  !> Rows of hinges, and of what parts cannot do: rings do not move along x nor turn, and what has no elements
  !! does not turn.
  pure subroutine hold_parts(model, parts, body, column, held, rows)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: body, column(:)
    real(wp), intent(inout) :: held(:, :)
    integer, intent(out) :: rows               !! that are filled
    integer :: c, h, p

    rows = 0
    do h = 1, size(parts%hinge, 2)
      associate (node => parts%hinge(1, h), a => column(parts%hinge(2, h)), b => column(parts%hinge(3, h)))
        if (model%body(node) /= body) cycle
        do c = 1, 2
          rows = rows + 1
          held(rows, a + 1:a + 3) = parts%row(model, node, c)
          held(rows, b + 1:b + 3) = -parts%row(model, node, c)
        end do
      end associate
    end do
    do p = 1, parts%count
      if (parts%body(p) /= body) cycle
      do c = 1, 3, 2   ! along x, turn
        if (.not. (parts%ring(p) .or. (c == 3 .and. .not. parts%turns(p)))) cycle
        rows = rows + 1
        held(rows, column(p) + c) = 1.0_wp
      end do
    end do
  end subroutine hold_parts

  !> Freedoms that would hold the loose motions: those that move most, one after the other, each motion taken
  !! out of the others at the freedom chosen for it.
  subroutine suggest(model, parts, nodes, column, loose, fault)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: nodes(:), column(:)
    real(wp), intent(in) :: loose(:, :)
    type(motion_fault), intent(inout) :: fault
    real(wp) :: motion(2*size(nodes), size(loose, 2)), size_of(2*size(nodes), size(loose, 2))
    integer :: at(2), i, j, k, m

    m = size(loose, 2)
    allocate (fault%freedom(2, m), fault%direction(2, m), fault%turn(m))
    do i = 1, size(nodes)
      k = column(parts%of_node(nodes(i)))
      motion(2*i - 1, :) = matmul(parts%row(model, nodes(i), 1), loose(k + 1:k + 3, :))
      motion(2*i, :) = matmul(parts%row(model, nodes(i), 2), loose(k + 1:k + 3, :))
      if (fault%moving == 0 .and. any(abs(loose(k + 1:k + 3, :)) > no_effect*maxval(abs(loose)))) then
        fault%moving = nodes(i)
      end if
    end do
    do k = 1, m
      ! The first of those that move nearly as much as the largest, so that rounding does not choose.
      size_of(:, k:) = abs(motion(:, k:))
      at = findloc(size_of(:, k:) >= nearly*maxval(size_of(:, k:)), .true.)
      i = at(1)
      j = k + at(2) - 1
      motion(:, [k, j]) = motion(:, [j, k])
      motion(:, k) = motion(:, k)/motion(i, k)
      associate (node => (i + 1)/2, u => reshape(motion(:, k), [2, size(nodes)]))
        fault%freedom(:, k) = [nodes(node), 2 - mod(i, 2)]
        fault%direction(:, k) = u(:, node)/norm2(u(:, node))
        associate (same_part => column(parts%of_node(nodes)) == column(parts%of_node(nodes(node))))
          fault%turn(k) = spread_of(pack(u(1, :), same_part)) + spread_of(pack(u(2, :), same_part))
        end associate
      end associate
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
