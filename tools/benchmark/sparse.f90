!> Times and storage of panels (BAND) and of MUMPS (SPARSE): where one overtakes the other.
!>
!>     cmake --build --preset release --target bench_sparse
!>     build/release/bench_sparse 100 200 DECK...
!>
!> A number N is a square of N x N four-node elements, held at its foot, with the top side in contact; a deck gives its largest
!> body, all of it elastic. CPU times in ms, the least of three; for a deck, begin with PARAM SOLVER BAND in it.
program bench_sparse
  use epcont_assembly_strain_operator, only: new_strain_operator, strain_operator
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_linalg_assembled, only: assembled_matrix
  use epcont_linalg_panel, only: panel_matrix
  use epcont_linalg_sparse, only: sparse_fault, sparse_matrix
  use epcont_material_elasticity, only: isotropic_matrix
  use epcont_material_linear_law, only: linear_law
  use epcont_model_build, only: build_model
  use epcont_model_model, only: model_type, most_nodes
  use epcont_plan_numbering, only: number_equations, numbering_type
  implicit none

  !> Element matrices of one body and their equations.
  type :: system
    integer :: order = 0, contact = 0
    integer, allocatable :: reach(:)         !! the last equation that each is coupled with
    integer, allocatable :: numbers(:, :)
    real(wp), allocatable :: stiffness(:, :, :)
  end type system

  type(system) :: body
  character(len=1000) :: argument
  integer :: i, ios, n

  print '(a)', '  unknowns contact  matrix    begin      add   factor        F    condition solve     MB   condition'
  do i = 1, command_argument_count()
    call get_command_argument(i, argument)
    read (argument, *, iostat=ios) n
    if (ios == 0 .and. verify(trim(argument), '0123456789') == 0) then
      call make_square(n, body)
    else
      call read_body(trim(argument), body)
    end if
    body%reach = last_coupled(body)
    call time_matrix(body, .false.)
    if (len(sparse_fault()) == 0) call time_matrix(body, .true.)
  end do

contains

  !> D of a material that all bodies here are made of.
  pure function elastic_matrix() result(d)
    real(wp) :: d(4, 4)

    d = isotropic_matrix(1.67_wp, 0.77_wp, .false.)
  end function elastic_matrix

  subroutine make_square(n, body)
    integer, intent(in) :: n
    type(system), intent(out) :: body
    integer :: c, e, i, r, point(4)

    body%order = 2*n*(n + 1)
    body%contact = 2*(n + 1)
    allocate (body%numbers(8, n*n), body%stiffness(8, 8, n*n))
    do r = 1, n
      do c = 1, n
        e = (r - 1)*n + c
        point = (r - 2)*(n + 1) + c + [0, 1, n + 2, n + 1]
        body%numbers(:, e) = [(2*point(i) - 1, 2*point(i), i=1, 4)]
        body%stiffness(:, :, e) = square_stiffness()
      end do
    end do
  end subroutine make_square

  !> Bilinear square of side 2, four points.
  pure function square_stiffness() result(k)
    real(wp) :: k(8, 8)
    real(wp), parameter :: x(4) = [-1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp], y(4) = [-1.0_wp, -1.0_wp, 1.0_wp, 1.0_wp]
    real(wp) :: b(4, 8), at(2)
    integer :: i, j

    k = 0.0_wp
    do i = 1, 4
      at = [x(i), y(i)]/sqrt(3.0_wp)
      b = 0.0_wp
      do j = 1, 4
        b(1, 2*j - 1) = x(j)*(1.0_wp + y(j)*at(2))/4.0_wp
        b(2, 2*j) = y(j)*(1.0_wp + x(j)*at(1))/4.0_wp
        b(4, 2*j - 1:2*j) = [b(2, 2*j), b(1, 2*j - 1)]
      end do
      k = k + matmul(transpose(b), matmul(elastic_matrix(), b))
    end do
  end function square_stiffness

  subroutine read_body(path, body)
    character(len=*), intent(in) :: path
    type(system), intent(out) :: body
    type(deck_type) :: deck
    type(model_type) :: model
    type(diagnostics) :: faults
    type(error_type), allocatable :: error
    type(numbering_type) :: numbering
    type(strain_operator) :: operator
    type(linear_law) :: law
    real(wp) :: k((2*most_nodes)**2)
    integer :: b, e, n

    call read_deck(path, deck, faults, error)
    if (allocated(error)) error stop 'this deck cannot be read'
    call build_model(deck, model, faults)
    if (faults%error_count() > 0) error stop 'this deck has faults'
    numbering = number_equations(model)
    operator = new_strain_operator(model)
    allocate (law%matrix(4, 4, 1), source=spread(elastic_matrix(), 3, 1))
    allocate (law%matrix_of(model%points), source=1)
    b = maxloc(numbering%body%equations, dim=1)
    associate (chosen => numbering%body(b))
      body%order = chosen%equations
      body%contact = chosen%contact_equations
      n = 2*maxval(model%order(chosen%element))
      allocate (body%numbers(n, size(chosen%element)), source=0)
      allocate (body%stiffness(n, n, size(chosen%element)), source=0.0_wp)
      do e = 1, size(chosen%element)
        n = model%order(chosen%element(e))
        call operator%element_stiffness(model, chosen%element(e), law, 2*n, k)
        body%stiffness(:2*n, :2*n, e) = reshape(k(:(2*n)**2), [2*n, 2*n])
        body%numbers(:2*n, e) = reshape(numbering%equation(:, model%connectivity(:n, chosen%element(e))), [2*n])
      end do
    end associate
  end subroutine read_body

  pure function last_coupled(body) result(reach)
    type(system), intent(in) :: body
    integer, allocatable :: reach(:)
    integer :: e, i

    reach = [(i, i=1, body%order)]
    do e = 1, size(body%numbers, 2)
      associate (numbers => body%numbers(:, e))
        do i = 1, size(numbers)
          if (numbers(i) > 0) reach(numbers(i)) = max(reach(numbers(i)), maxval(numbers))
        end do
      end associate
    end do
  end function last_coupled

  !> CPU time [ms].
  real(wp) function now()
    call cpu_time(now)
    now = 1000.0_wp*now
  end function now

  !> One matrix from nothing to a solution.
  subroutine time_matrix(body, sparse)
    type(system), intent(in) :: body
    logical, intent(in) :: sparse
    class(assembled_matrix), allocatable :: matrix
    type(panel_matrix), allocatable :: panels
    type(sparse_matrix), allocatable :: by_mumps
    real(wp) :: bytes, least(6), ratio, begun(7)
    real(wp), allocatable :: gram(:, :), x(:, :)
    integer :: at, e, i, run

    least = huge(1.0_wp)
    allocate (x(body%order, 1), source=1.0_wp)
    allocate (gram(body%contact, body%contact), source=0.0_wp)
    do run = 1, 3
      if (allocated(matrix)) deallocate (matrix)
      begun(1) = now()
      if (sparse) then
        allocate (by_mumps)
        call by_mumps%begin(body%order, body%numbers)
        bytes = real(by_mumps%bytes, wp)
        call move_alloc(by_mumps, matrix)
      else
        allocate (panels)
        call panels%begin(body%reach, .true., body%contact)
        bytes = 8.0_wp*size(panels%entries, kind=8)
        call move_alloc(panels, matrix)
      end if
      begun(2) = now()
      do e = 1, size(body%numbers, 2)
        call matrix%add(size(body%numbers, 1), body%numbers(:, e), body%stiffness(:, :, e))
      end do
      begun(3) = now()
      call matrix%factor(ratio, at)
      begun(4) = now()
      call matrix%add_gram([(i, i=1, body%contact + 1)], [(i, i=body%order - body%contact + 1, body%order)], &
                           [(1.0_wp, i=1, body%contact)], gram)
      begun(5) = now()
      ratio = matrix%condition()
      begun(6) = now()
      call matrix%solve(x)
      begun(7) = now()
      least = min(least, begun(2:) - begun(:6))
    end do
    print '(i10, i8, 2x, a6, 6f9.1, f7.0, es12.2)', body%order, body%contact, merge('SPARSE', 'BAND  ', sparse), least, &
      1.0e-6_wp*bytes, ratio
  end subroutine time_matrix
end program bench_sparse
