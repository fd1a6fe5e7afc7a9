!> Indeterminate forces and undetermined modes of a contact solution.
module epcont_contact_uniqueness
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible, null_component
  use epcont_contact_basis, only: are_independent, contact_basis, new_basis, respond
  use epcont_contact_equilibrium, only: can_carry, find_rigid_start, rigid_start
  use epcont_contact_loose_motions, only: loose_motions
  use epcont_contact_scaling, only: scaled_problem
  use epcont_flexibility_motion_matrix, only: dense_motions, motion_matrix
  use epcont_linalg_dense, only: add_product, null_space, pivoted_cholesky
  implicit none
  private
  public :: find_indeterminate_forces, share_equally, find_undetermined_motions

  !> Rounding in the Schur complement exceeds that in F_g by the condition of the pressed pairs: this factor
  !! allows for it.
  real(wp), parameter :: amplification = 100.0_wp

contains

  !> Find pairs whose force can change without changing any gap or resultant: z with F z = 0, A'z = 0, and
  !> z >= 0 if there is no force yet.
  !>
  !> With the gaps of the pressed pairs kept closed, the Schur complement M of F_g relates idle pairs in
  !> contact to the forces z on them, and z must satisfy M z = 0.
  function find_indeterminate_forces(problem, touching, pressed) result(indeterminate)
    type(scaled_problem), intent(in) :: problem   !! in its own units
    logical, intent(in) :: touching(:)      !! gap zero [n]
    logical, intent(in) :: pressed(:)       !! force above rounding; pairs of a basis, so it is unique [n]
    logical, allocatable :: indeterminate(:)
    type(contact_basis) :: basis
    !> M [idle, idle], and the change of the pressed pairs' forces by z
    real(wp), allocatable, dimension(:, :) :: coupling, answer, change, loose, motion
    real(wp), allocatable :: unit(:)   !! units of M and z [idle]
    integer, allocatable :: growing(:), idle(:)
    real(wp) :: zero   !! entries of M below it are rounding
    integer :: k

    allocate (indeterminate(size(touching)), source=.false.)
    idle = pack([(k, k=1, size(touching))], touching .and. .not. pressed)
    if (size(idle) == 0) return
    if (are_independent(problem, touching)) return
    basis = new_basis(problem, pressed, held=.true.)
    coupling = regular_flexibility(problem, idle, idle)
    loose = regular_flexibility(problem, basis%pairs, idle)
    call respond(basis, loose, spread([real(wp) ::], 2, size(idle)), answer, motion)
    call add_product(1.0_wp, transpose(loose), answer, coupling)
    unit = sqrt(problem%softness(idle))
    coupling = coupling/(spread(unit, 1, size(idle))*spread(unit, 2, size(idle)))
    answer = answer/spread(unit, 1, size(answer, 1))

    zero = amplification*problem%rank_tolerance
    growing = forces_that_can_grow()
    indeterminate(idle(growing)) = .true.
    change = matmul(answer(:, growing), null_space(coupling(growing, growing), zero))
    indeterminate(basis%pairs) = [(any(abs(change(k, :)) > null_component), k=1, size(change, 1))]

  contains

    !> Find all j for which some z >= 0 with M z = 0 has z_j > 0.
    function forces_that_can_grow() result(growing)
      integer, allocatable :: growing(:), order(:)
      real(wp), allocatable :: factor(:, :), rows(:, :)
      type(motion_matrix) :: growth
      integer :: j, rank

      factor = coupling
      call pivoted_cholesky(factor, zero, order, rank)
      growing = [integer ::]
      if (rank == size(order)) return
      rows = coupling(:, order(:rank))/max(maxval(abs(coupling)), zero)
      where (abs(coupling(:, order(:rank))) <= zero) rows = 0.0_wp
      growth = dense_motions(rows)
      do j = 1, size(order)
        if (can_carry(growth, -rows(j, :))) growing = [growing, j]
      end do
    end function forces_that_can_grow
  end function find_indeterminate_forces

  !> Block of F_g = F + A gamma A'.
  pure function regular_flexibility(scaled, rows, columns) result(block)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    integer, intent(in) :: rows(:), columns(:)   !! pairs
    real(wp), allocatable :: block(:, :)     ! of F_g
    real(wp), allocatable :: closing(:, :), other(:, :)   ! A gamma of the rows, A of the columns

    block = scaled%flexibility_scale*scaled%flexibility(rows, columns)
    closing = scaled%motion%rows(rows)*spread(scaled%gamma, 1, size(rows))
    other = scaled%motion%rows(columns)
    call add_product(1.0_wp, closing, transpose(other), block)
  end function regular_flexibility

  !> Distribute the force of pairs with equal rows in F and A equally.
  pure subroutine share_equally(problem, indeterminate, force)
    type(scaled_problem), intent(in) :: problem   !! in its own units
    logical, intent(in) :: indeterminate(:)    !! [n]
    real(wp), intent(inout) :: force(:)        !! [n]
    integer, allocatable :: alike(:), left(:)
    integer :: k

    left = pack([(k, k=1, size(force))], indeterminate)
    do while (size(left) > 0)
      alike = [left(1), pack(left(2:), [(are_alike(left(1), left(k)), k=2, size(left))])]
      force(alike) = sum(force(alike))/size(alike)
      left = pack(left, [(all(left(k) /= alike), k=1, size(left))])
    end do

  contains

    !> Have two pairs the same flexibility and the same entries of modes?
    pure logical function are_alike(i, k) result(alike)
      integer, intent(in) :: i, k
      alike = all(abs(problem%motion%rows([i]) - problem%motion%rows([k])) <= negligible)
      if (.not. alike) return
      associate (f => problem%flexibility)
        alike = all(abs(f(:, i) - f(:, k)) <= negligible*max(f(i, i), f(k, k)))
      end associate
    end function are_alike
  end subroutine share_equally

  !> Find modes that the pressed pairs do not restrain, and that idle pairs in contact do not block in both
  !! directions: they do if their forces, all compressive, can carry a load along the mode in both directions.
  function find_undetermined_motions(motion, touching, pressed) result(free)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry of each column one [n, m]
    logical, intent(in) :: touching(:), pressed(:)   !! [n]
    logical, allocatable :: free(:)                  !! [m]
    type(motion_matrix) :: closing
    real(wp), allocatable :: loose(:, :)
    integer :: j, pair(size(pressed))
    integer, allocatable :: idle(:)

    allocate (free(motion%motions()), source=.false.)
    pair = [(j, j=1, size(pair))]
    loose = loose_motions(motion, pack(pair, pressed), null_component)
    idle = pack(pair, touching .and. .not. pressed)
    closing = dense_motions(motion%of_each(loose, idle))
    do j = 1, size(free)
      if (all(abs(loose(j, :)) <= null_component)) cycle
      if (.not. free(j)) call give_way(loose(j, :))
      if (.not. free(j)) call give_way(-loose(j, :))
    end do

  contains

    !> If nothing resists a load, all modes in its displacement are undetermined: of a pile that no
    !! load presses together, most bodies move.
    subroutine give_way(load)
      real(wp), intent(in) :: load(:)   !! along the loose modes
      type(rigid_start) :: start

      call find_rigid_start(closing, load, spread(0.0_wp, 1, closing%pairs), start)
      if (start%balanced) return
      associate (way => matmul(loose, start%escape))
        free(j) = .true.
        free = free .or. abs(way) > null_component*maxval(abs(way))
      end associate
    end subroutine give_way
  end function find_undetermined_motions
end module epcont_contact_uniqueness
