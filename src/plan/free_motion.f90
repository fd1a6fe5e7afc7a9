!> Rigid motions that supports leave free, and the SUPORT freedoms that measure them.
!>
!> Found before anything is factored, since a Cholesky factorization calls many singular matrices definite.
!> The free motions of a body are the null space of one matrix: three columns a rigid part, a row for each
!> hinge, tie and support.
module epcont_plan_free_motion
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent
  use epcont_element_kinematics, only: directions
  use epcont_linalg_dense, only: lu_solve, null_space
  use epcont_model_arrays, only: angle, spring_type
  use epcont_model_finding, only: findings, of_body, of_node
  use epcont_model_model, only: model_type
  use epcont_plan_loose_bodies, only: add_loose_body, add_surplus
  use epcont_plan_rigid_parts, only: find_rigid_parts, part_motions, rigid_parts
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: free_motions, find_free_motions

  !> SUPORT freedoms that measure the motions with a condition above this are too close to each other: six
  !! digits of the displacements would be lost.
  real(wp), parameter :: largest_condition = 1.0e6_wp

  !> The free motions of all bodies.
  type :: free_motions
    integer :: count = 0
    integer, allocatable :: body(:), node(:), component(:)  !! of each motion: body, SUPORT freedom [count]
    !> First of each body: they end before that of the next [bodies + 1]
    integer, allocatable :: first(:)
    type(rigid_parts) :: parts
    integer, allocatable, private :: own_part(:)   !! number of each part among those of its body [parts]
    !> Of x, y, turn of each part of its body in each motion, and the columns before those of a motion
    !! [part_motions, any], [count]
    real(wp), allocatable, private :: coefficient(:, :)
    integer, allocatable, private :: before(:)
  contains
    procedure :: add
    procedure :: displacement
    procedure :: turn
    procedure :: travels
  end type free_motions

contains

  !> Add rigid motions to displacements.
  subroutine add(self, model, motion, displacement)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model              !! the scene
    real(wp), intent(in) :: motion(:)                  !! how far each goes [count]
    real(wp), intent(inout) :: displacement(:, :)      !! [length] [directions, nodes]
    integer :: k, node

    !$omp parallel do num_threads(threads_over(model%nodes)) private(k)
    do node = 1, model%nodes
      associate (b => model%body(node))
        do k = self%first(b), self%first(b + 1) - 1
          displacement(:, node) = displacement(:, node) + motion(k)*self%displacement(model, node, k)
        end do
      end associate
    end do
    !$omp end parallel do
  end subroutine add

  !> Displacement of a node in unit motion k.
  pure function displacement(self, model, node, k) result(u)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: node, k   !! the node, and the number of the motion
    real(wp) :: u(directions)

    u = 0.0_wp
    if (self%body(k) /= model%body(node)) return
    associate (part => self%coefficient(:, self%before(k) + self%own_part(self%parts%of_node(node))))
      u = part(:directions) + part(part_motions)*self%parts%turn(model, node)
    end associate
  end function displacement

  !> By how much the part of a node turns in a motion of its body: what a place at the body's extent from its
  !! centre moves by [length].
  pure real(wp) function turn(self, node, k)
    class(free_motions), intent(in) :: self
    integer, intent(in) :: node, k   !! the node, and the number of the motion

    turn = self%coefficient(part_motions, self%before(k) + self%own_part(self%parts%of_node(node)))
  end function turn

  !> How far each unit motion takes its body, whatever the axes: what it moves the SUPORT node by that
  !! measures both directions (the mean of several; where there is none, of all SUPORT nodes of the body), and
  !! what the turn of each part moves one of these by about another [length] [any, count].
  pure function travels(self, model) result(travel)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model   !! the scene
    real(wp), allocatable :: travel(:, :)
    integer, allocatable :: node(:)
    real(wp) :: apart
    integer :: b, i, k, parts

    allocate (travel(directions + maxval([0, self%own_part]), self%count), source=0.0_wp)
    do b = 1, size(self%first) - 1
      associate (own => self%node(self%first(b):self%first(b + 1) - 1))
        if (size(own) == 0) cycle
        node = pack(own, [(count(own == own(i)) == directions, i=1, size(own))])
        if (size(node) == 0) node = own
        associate (x => model%x(:, own))
          apart = maxval([((norm2(x(:, i) - x(:, k)), i=1, k), k=1, size(own))])
        end associate
      end associate
      parts = count(self%parts%body == b)
      do k = self%first(b), self%first(b + 1) - 1
        do i = 1, size(node)
          travel(:directions, k) = travel(:directions, k) + self%displacement(model, node(i), k)/size(node)
        end do
        if (self%parts%extent(b) > 0.0_wp) travel(directions + 1:directions + parts, k) = &
          apart/self%parts%extent(b)*self%coefficient(part_motions, self%before(k) + 1:self%before(k) + parts)
      end do
    end do
  end function travels

  !> Find the free motions of all bodies; a body whose SUPORT freedoms do not fit is an error.
  subroutine find_free_motions(model, motions, found)
    type(model_type), intent(in) :: model        !! the scene
    type(free_motions), intent(out) :: motions   !! of all bodies whose SUPORT freedoms fit
    type(findings), intent(inout) :: found       !! the others are added
    type(incidence) :: nodes, parts   ! of each body
    integer :: b, columns, i

    motions%parts = find_rigid_parts(model)
    nodes = new_incidence(reshape(model%body, [1, model%nodes]), model%bodies)
    parts = new_incidence(reshape(motions%parts%body, [1, motions%parts%count]), model%bodies)
    allocate (motions%own_part(motions%parts%count), motions%first(model%bodies + 1))
    associate (most => [(count(model%reference(:, nodes%of(b))) + size(turned(model, b)), &
                         b=1, model%bodies)])   ! motions of each body
      allocate (motions%body(sum(most)), motions%node(sum(most)), motions%component(sum(most)))
      allocate (motions%coefficient(part_motions, sum(most*(parts%start(2:) - parts%start(:model%bodies)))))
      allocate (motions%before(sum(most)))
    end associate
    columns = 0
    do b = 1, model%bodies
      motions%first(b) = motions%count + 1
      associate (own => parts%of(b))
        motions%own_part(own) = [(i, i=1, size(own))]
        call examine_body(model, nodes%of(b), own, columns, motions, found)
      end associate
    end do
    motions%first(model%bodies + 1) = motions%count + 1
    motions%body = motions%body(:motions%count)   ! fewer where some do not fit
    motions%node = motions%node(:motions%count)
    motions%component = motions%component(:motions%count)
  end subroutine find_free_motions

  !> The platens of a body whose angles are SUPORT freedoms.
  pure function turned(model, body) result(platen)
    type(model_type), intent(in) :: model
    integer, intent(in) :: body
    integer, allocatable :: platen(:)
    integer :: k

    platen = pack([(k, k=1, size(model%platen))], &
                  model%platen%reference .and. model%body(model%platen%leader) == body)
  end function turned

  !> Free motions of one body.
  subroutine examine_body(model, nodes, own, columns, motions, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:), own(:)         !! of the body: its nodes and parts
    integer, intent(inout) :: columns               !! of the coefficients so far
    type(free_motions), intent(inout) :: motions
    type(findings), intent(inout) :: found
    real(wp), allocatable :: basis(:, :), factors(:, :), loose(:, :), measured(:, :), square(:, :), unit(:, :)
    integer, allocatable :: component(:), node(:)   ! of the SUPORT freedoms
    integer, allocatable :: platen(:)               ! whose angles are some of these, the last
    integer :: i, info, m, shifts

    node = pack(spread(nodes, 1, directions), model%reference(:, nodes))
    component = pack(spread([(i, i=1, directions)], 2, size(nodes)), model%reference(:, nodes))
    platen = turned(model, model%body(nodes(1)))
    shifts = size(node)
    node = [node, model%platen(platen)%leader]
    component = [component, spread(angle, 1, size(platen))]
    allocate (measured(size(node), part_motions*size(own)))
    do i = 1, size(node)
      if (i <= shifts) measured(i, :) = row_of(component(i), node(i))
      if (i > shifts) measured(i, :) = row_of(angle, platen(i - shifts))
    end do
    basis = null_space(held_rows(), dependent)
    m = size(basis, 2)
    square = matmul(measured, basis)
    loose = matmul(basis, null_space(square, dependent))
    if (size(loose, 2) > 0) then
      call add_loose_body(model, motions%parts, motions%own_part, nodes, &
                          reshape(loose, [part_motions, size(own), size(loose, 2)]), found)
    else if (size(node) > m) then
      call add_surplus(model, node, component, null_space(transpose(square), dependent), m, found)
    else if (m > 0) then
      allocate (unit(m, m), source=0.0_wp)
      do i = 1, m
        unit(i, i) = 1.0_wp
      end do
      factors = square
      call lu_solve(factors, unit, info)
      if (norm2(unit)*norm2(square) > largest_condition) then
        call found%add_error(of_body, nodes(1), 0, 'the body of '//model%name_of(of_node, nodes(1))// &
          ': its SUPORT freedoms hardly tell its free motions apart', 'SUPORT nodes farther from each other')
        return
      end if
      ! By how much a turn moves the body's extent has told the motions apart; now it is an angle.
      unit(:, shifts + 1:) = unit(:, shifts + 1:)*motions%parts%extent(model%body(nodes(1)))
      associate (first => motions%count + 1, last => motions%count + m, next => columns + size(own)*m)
        motions%body(first:last) = model%body(nodes(1))
        motions%node(first:last) = node
        motions%component(first:last) = component
        motions%before(first:last) = [(columns + size(own)*(i - 1), i=1, m)]
        motions%coefficient(:, columns + 1:next) = &
          reshape(matmul(basis, unit), [part_motions, size(own)*m])
        columns = next
      end associate
      motions%count = motions%count + m
    end if

  contains

    !> The column before those of a part of the body.
    pure integer function column(part)
      integer, intent(in) :: part

      column = part_motions*(motions%own_part(part) - 1)
    end function column

    !> A freedom, or how far the angle of a platen moves the extent of its body, as one of the parts.
    pure function row_of(c, node) result(of_parts)
      integer, intent(in) :: c, node
      real(wp) :: of_parts(part_motions*size(own))

      of_parts = 0.0_wp
      if (c == angle) then
        of_parts(column(motions%parts%of_platen(node)) + part_motions) = 1.0_wp
      else
        associate (of_node => motions%parts%rows(model, node), at => column(motions%parts%of_node(node)))
          of_parts(at + 1:at + part_motions) = of_node(c, :)
        end associate
      end if
    end function row_of

    !> What a freedom is beyond that, or the sum, which it follows.
    pure function row_beyond(c, node) result(of_parts)
      integer, intent(in) :: c, node
      real(wp) :: of_parts(part_motions*size(own)), weight
      integer :: i

      of_parts = row_of(c, node)
      if (model%leader(c, node) /= node) of_parts = of_parts - row_of(c, model%leader(c, node))
      if (model%leader(c, node) /= node .or. model%sum_of(c, node) == 0) return
      do i = model%sum%first(model%sum_of(c, node)), model%sum%last(model%sum_of(c, node))
        weight = model%sum%weight(i)
        if (model%sum%component(i) == angle) weight = weight/motions%parts%extent(model%body(node))
        of_parts = of_parts - weight*row_of(model%sum%component(i), model%sum%node(i))
      end do
    end function row_beyond

    !> What a spring is strained by.
    pure function row_of_spring(spring) result(of_parts)
      type(spring_type), intent(in) :: spring
      real(wp) :: of_parts(part_motions*size(own))
      integer :: i

      of_parts = 0.0_wp
      do i = 1, 2
        if (spring%node(i) > 0) of_parts = of_parts + (2*i - 3)*row_of(spring%component(i), spring%node(i))
      end do
    end function row_of_spring

    !> Rows of what hinges, ties, springs and supports hold, and of what parts cannot do.
    pure function held_rows() result(held)
      real(wp), allocatable :: held(:, :)
      logical :: bound(directions, size(nodes))
      integer :: c, i, rows

      bound = model%held(:, nodes) .or. model%leader(:, nodes) /= spread(nodes, 1, directions) .or. &
              model%sum_of(:, nodes) > 0
      associate (parts => motions%parts)
        rows = directions*count(model%body(parts%hinge(1, :)) == model%body(nodes(1)))
        rows = rows + part_motions*size(own) + count(bound) + size(model%platen) + size(model%spring)
        allocate (held(rows, part_motions*size(own)), source=0.0_wp)
        rows = 0
        do i = 1, size(parts%hinge, 2)
          if (model%body(parts%hinge(1, i)) /= model%body(nodes(1))) cycle
          associate (here => held(rows + 1:rows + directions, :), one => column(parts%hinge(2, i)), &
                     other => column(parts%hinge(3, i)))
            here(:, one + 1:one + part_motions) = parts%rows(model, parts%hinge(1, i))
            here(:, other + 1:other + part_motions) = -parts%rows(model, parts%hinge(1, i))
          end associate
          rows = rows + directions
        end do
        do i = 1, size(own)
          do c = 1, part_motions
            if (.not. parts%cannot(c, own(i))) cycle
            rows = rows + 1
            held(rows, column(own(i)) + c) = 1.0_wp
          end do
        end do
        do i = 1, size(nodes)
          do c = 1, directions
            if (.not. bound(c, i)) cycle
            rows = rows + 1
            held(rows, :) = row_beyond(c, nodes(i))
          end do
        end do
      end associate
      do i = 1, size(model%platen)
        if (.not. model%platen(i)%held .or. model%body(model%platen(i)%leader) /= model%body(nodes(1))) cycle
        rows = rows + 1
        held(rows, :) = row_of(angle, i)
      end do
      do i = 1, size(model%spring)
        if (model%body(maxval(model%spring(i)%node)) /= model%body(nodes(1))) cycle
        rows = rows + 1
        held(rows, :) = row_of_spring(model%spring(i))
      end do
      held = held(:rows, :)
    end function held_rows
  end subroutine examine_body
end module epcont_plan_free_motion
