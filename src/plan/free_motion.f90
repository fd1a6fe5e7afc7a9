!> Rigid-body modes that supports leave free, and the SUPORT DOFs that measure them.
!>
!> They are found before any factorization, because Cholesky factorization succeeds for many singular
!> matrices. The modes of a body are the null space of one matrix, with three columns for each rigid part, and
!> a row for each hinge, tie and support.
module epcont_plan_free_motion
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: dependent
  use epcont_element_kinematics, only: directions
  use epcont_linalg_dense, only: lu_solve, null_space
  use epcont_model_arrays, only: angle
  use epcont_model_finding, only: findings, of_body, of_node
  use epcont_model_model, only: model_type
  use epcont_plan_loose_bodies, only: add_loose_body, add_surplus
  use epcont_plan_restraint, only: restraint_rows, row_of
  use epcont_plan_rigid_parts, only: find_rigid_parts, part_motions, rigid_parts
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: free_motions, find_free_motions

  !> Largest condition with which SUPORT DOFs measure modes. Nodes too close to each other exceed it: six
  !! digits of the displacements would be lost.
  real(wp), parameter :: largest_condition = 1.0e6_wp

  !> Rigid-body modes of all bodies.
  type :: free_motions
    integer :: count = 0
    integer, allocatable :: body(:), node(:), component(:)  !! of each mode: body, SUPORT DOF [count]
    !> First mode of each body [bodies + 1]
    integer, allocatable :: first(:)
    type(rigid_parts) :: parts
    !> Displacements and rotation of each part in each mode [part_motions, any], and number of columns before
    !! those of each mode [count]
    real(wp), allocatable, private :: coefficient(:, :)
    integer, allocatable, private :: before(:)
  contains
    procedure :: add
    procedure :: displacement
    procedure :: turn
    procedure :: travels
    procedure, private :: append
  end type free_motions

contains

  !> Add rigid-body displacements.
  subroutine add(self, model, motion, displacement)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: motion(:)                  !! amplitude of each mode [count]
    real(wp), intent(inout) :: displacement(:, :)      !! [length] [directions, nodes]
    integer :: k, node

    !$omp parallel do num_threads(threads_over(model%mesh%nodes)) private(k)
    do node = 1, model%mesh%nodes
      associate (b => model%mesh%body(node))
        do k = self%first(b), self%first(b + 1) - 1
          displacement(:, node) = displacement(:, node) + motion(k)*self%displacement(model, node, k)
        end do
      end associate
    end do
    !$omp end parallel do
  end subroutine add

  !> Displacement of a node in mode k with amplitude one.
  pure function displacement(self, model, node, k) result(u)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, k   !! node and number of the mode
    real(wp) :: u(directions)

    u = 0.0_wp
    if (self%body(k) /= model%mesh%body(node)) return
    associate (part => self%coefficient(:, self%before(k) + self%parts%own(self%parts%of_node(node))))
      u = part(:directions) + part(part_motions)*self%parts%turn(model, node)
    end associate
  end function displacement

  !> Rotation of the part of a node in a mode, times the extent of the body [length].
  pure real(wp) function turn(self, node, k)
    class(free_motions), intent(in) :: self
    integer, intent(in) :: node, k   !! node and number of the mode

    turn = self%coefficient(part_motions, self%before(k) + self%parts%own(self%parts%of_node(node)))
  end function turn

  !> Displacements in each mode that do not depend on the axes: at the SUPORT node that measures both
  !! directions (the mean, if several do; that of all SUPORT nodes of the body, if none does), and of one
  !! SUPORT node about another due to the rotation of each part [length] [any, count].
  pure function travels(self, model) result(travel)
    class(free_motions), intent(in) :: self
    type(model_type), intent(in) :: model
    real(wp), allocatable :: travel(:, :)
    integer, allocatable :: node(:)
    real(wp) :: apart
    integer :: b, i, k, parts

    allocate (travel(directions + maxval([0, self%parts%own]), self%count), source=0.0_wp)
    do b = 1, size(self%first) - 1
      associate (own => self%node(self%first(b):self%first(b + 1) - 1))
        if (size(own) == 0) cycle
        node = pack(own, [(count(own == own(i)) == directions, i=1, size(own))])
        if (size(node) == 0) node = own
        associate (x => model%mesh%x(:, own))
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

  !> Find the rigid-body modes of all bodies. SUPORT DOFs that do not measure the modes of a body are an
  !! error.
  subroutine find_free_motions(model, motions, found)
    type(model_type), intent(in) :: model
    type(free_motions), intent(out) :: motions   !! of all bodies without errors
    type(findings), intent(inout) :: found       !! errors are added
    type(incidence) :: nodes   ! nodes of each body
    integer :: b

    motions%parts = find_rigid_parts(model)
    nodes = new_incidence(reshape(model%mesh%body, [1, model%mesh%nodes]), model%mesh%bodies)
    allocate (motions%first(model%mesh%bodies + 1))
    allocate (motions%body(0), motions%node(0), motions%component(0), motions%before(0))
    allocate (motions%coefficient(part_motions, 0))
    do b = 1, model%mesh%bodies
      motions%first(b) = motions%count + 1
      call examine_body(model, nodes%of(b), motions, found)
    end do
    motions%first(model%mesh%bodies + 1) = motions%count + 1
  end subroutine find_free_motions

  !> Find the rigid-body modes of one body.
  subroutine examine_body(model, nodes, motions, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)                 !! nodes of the body
    type(free_motions), intent(inout) :: motions    !! modes are appended
    type(findings), intent(inout) :: found
    real(wp), allocatable :: basis(:, :), factors(:, :), loose(:, :), measured(:, :), square(:, :), unit(:, :)
    integer, allocatable :: component(:), node(:)   ! of the SUPORT DOFs
    integer, allocatable :: platen(:)               ! platens whose angles are the last SUPORT DOFs
    integer :: b, i, info, m, translations

    b = model%mesh%body(nodes(1))
    node = pack(spread(nodes, 1, directions), model%constraints%reference(:, nodes))
    component = pack(spread([(i, i=1, directions)], 2, size(nodes)), model%constraints%reference(:, nodes))
    platen = pack([(i, i=1, size(model%constraints%platen))], &
                  model%constraints%platen%reference .and. &
                    model%mesh%body(model%constraints%platen%leader) == b)
    translations = size(node)
    node = [node, model%constraints%platen(platen)%leader]
    component = [component, spread(angle, 1, size(platen))]
    basis = null_space(restraint_rows(model, motions%parts, nodes), dependent)
    allocate (measured(size(node), size(basis, 1)))
    associate (number => [node(:translations), platen])
      do i = 1, size(node)
        measured(i, :) = row_of(model, motions%parts, size(basis, 1), component(i), number(i))
      end do
    end associate
    m = size(basis, 2)
    square = matmul(measured, basis)
    loose = matmul(basis, null_space(square, dependent))
    if (size(loose, 2) > 0) then
      call add_loose_body(model, motions%parts, nodes, &
                          reshape(loose, [part_motions, size(loose, 1)/part_motions, size(loose, 2)]), found)
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
          ': its SUPORT DOFs hardly distinguish its rigid-body modes', 'move the SUPORT nodes farther apart')
        return
      end if
      ! Until here rotations are displacements at the extent of the body; from here on they are angles.
      unit(:, translations + 1:) = unit(:, translations + 1:)*motions%parts%extent(b)
      call motions%append(b, node, component, matmul(basis, unit))
    end if
  end subroutine examine_body

  !> Append the modes of a body.
  subroutine append(self, body, node, component, modes)
    class(free_motions), intent(inout) :: self
    integer, intent(in) :: body
    integer, intent(in) :: node(:), component(:)   !! SUPORT DOF of each mode
    real(wp), intent(in) :: modes(:, :)            !! [part_motions*parts of the body, modes]
    integer :: i

    associate (m => size(modes, 2), parts => size(modes, 1)/part_motions, &
               columns => size(self%coefficient, 2))
      self%before = [self%before, (columns + parts*(i - 1), i=1, m)]
      self%coefficient = reshape([self%coefficient, modes], [part_motions, columns + parts*m])
    end associate
    self%count = self%count + size(node)
    self%body = [self%body, spread(body, 1, size(node))]
    self%node = [self%node, node]
    self%component = [self%component, component]
  end subroutine append
end module epcont_plan_free_motion
