!> Contact equations for a given set S of pairs in contact, factored from F and A, and their solution.
!>
!>     F_SS R_S - A_S q = -h,   A_S' R_S = p
!>
!> F_SS may be singular even if the forces are unique (a pair between fixed nodes has a row of zeros).
!> F_g = F + A gamma A' is definite whenever they are unique. Since A'R = p, it changes the rigid-body
!> displacement only: q is larger by gamma p, with the diagonal matrix gamma. The factored matrix is
!>
!>     [ F_g,SS  -A_S ]
!>     [ -A_S'    0   ]
!>
!> whose last pivots are negative if the pairs restrain all modes.
module epcont_contact_basis
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: factor_saddle, pivoted_cholesky, solve_saddle
  implicit none
  private
  public :: contact_basis, new_basis, renew_basis, move_basis, are_independent, respond

  !> A set of pairs in contact whose forces are unique, with the factor of its equations.
  type :: contact_basis
    logical :: sound = .false.           !! forces are unique, and the pairs restrain all modes
    integer, allocatable :: pairs(:)     !! S [s]
    integer :: motions = 0               !! m, number of modes
    integer, allocatable :: kept(:)      !! indices of these among the given modes [m]
    real(wp), allocatable :: gamma(:)    !! weight of each mode in F_g [m]
    real(wp) :: scale = 0.0_wp           !! of F
    real(wp), allocatable :: factor(:, :)   !! [s + m, s + m]
  end type contact_basis

contains

  !> Factor the equations of the chosen pairs. Pairs whose force depends on that of others are left out.
  type(contact_basis) function new_basis(scaled, chosen, held) result(basis)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    logical, intent(in), optional :: held        !! all modes are zero: only F_g is factored
    logical :: definite

    call begin(basis, scaled, chosen, held)
    call factor_basis(basis, scaled, lost_digits, definite)
    if (definite) return
    ! The pivot order takes longer, but shows the dependent pairs.
    call leave_out_dependent(basis, scaled)
    call factor_basis(basis, scaled, 0.0_wp, definite)
  end function new_basis

  !> Factor the equations of the chosen pairs, unless the basis has them; then F must be the same.
  subroutine renew_basis(basis, scaled, chosen)
    type(contact_basis), intent(inout) :: basis   !! empty, or of any set
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    logical :: same

    same = basis%sound .and. allocated(basis%factor)
    if (same) same = size(basis%pairs) == count(chosen) .and. size(basis%kept) == size(scaled%kept)
    if (same) same = all(chosen(basis%pairs)) .and. all(basis%kept == scaled%kept) .and. &
                     all(abs(basis%gamma - scaled%gamma) <= 0.0_wp) .and. &
                     abs(basis%scale - scaled%flexibility_scale) <= 0.0_wp
    if (same) return
    if (allocated(basis%factor)) deallocate (basis%factor)
    basis = new_basis(scaled, chosen)
  end subroutine renew_basis

  !> Move a basis; the source is empty afterwards.
  subroutine move_basis(from, to)
    type(contact_basis), intent(inout) :: from   !! may be empty
    type(contact_basis), intent(out) :: to       !! the moved basis
    real(wp), allocatable :: factor(:, :)

    call move_alloc(from%factor, factor)
    to = from
    call move_alloc(factor, to%factor)
  end subroutine move_basis

  !> Are the forces of the chosen pairs clearly independent, for any rigid-body displacement?
  logical function are_independent(scaled, chosen) result(independent)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    type(contact_basis) :: basis

    call begin(basis, scaled, chosen, held=.true.)
    call factor_basis(basis, scaled, lost_digits, independent)
  end function are_independent

  !> Begin with the chosen pairs and all modes, or no modes.
  pure subroutine begin(basis, scaled, chosen, held)
    type(contact_basis), intent(out) :: basis
    type(scaled_problem), intent(in) :: scaled
    logical, intent(in) :: chosen(:)
    logical, intent(in), optional :: held   !! true: without motions
    integer :: k

    basis%pairs = pack([(k, k=1, size(chosen))], chosen)
    basis%gamma = scaled%gamma
    basis%scale = scaled%flexibility_scale
    basis%kept = scaled%kept
    if (present(held)) basis%gamma = pack(basis%gamma, .not. held)
    basis%motions = size(basis%gamma)
  end subroutine begin

  !> Assemble and factor the equations.
  subroutine factor_basis(basis, scaled, least, definite)
    type(contact_basis), intent(inout) :: basis
    type(scaled_problem), intent(in) :: scaled
    real(wp), intent(in) :: least       !! least pivot of a unique force, over its softness
    logical, intent(out) :: definite    !! all pivots are above `least`
    real(wp), allocatable :: closing(:, :)   ! A_S
    integer :: info, k, n

    n = size(basis%pairs)
    if (allocated(basis%factor)) deallocate (basis%factor)
    allocate (basis%factor(n + basis%motions, n + basis%motions))
    closing = scaled%motion%rows(basis%pairs)
    call add_pairs(scaled, basis%pairs, closing, basis%factor)
    if (basis%motions > 0) then
      basis%factor(n + 1:, :n) = -transpose(closing)
      basis%factor(n + 1:, n + 1:) = 0.0_wp
    end if
    call factor_saddle(n + basis%motions, basis%factor, n, info)
    definite = (info == 0 .or. info > n) .and. &
               all([(basis%factor(k, k)**2, k=1, n)] >= least*scaled%softness(basis%pairs))
    ! Fewer pairs than modes do not restrain these, whatever the rounding of the last pivot.
    basis%sound = definite .and. info == 0 .and. n >= basis%motions
  end subroutine factor_basis

  !> Compute the lower triangle of F_g,SS.
  pure subroutine add_pairs(scaled, pairs, closing, f)
    type(scaled_problem), intent(in) :: scaled
    integer, intent(in) :: pairs(:)
    real(wp), intent(in) :: closing(:, :)    !! A_S [s, m]
    real(wp), intent(inout) :: f(:, :)       !! [>= s, >= s]
    integer :: j, n, t

    n = size(pairs)
    do j = 1, n
      f(j:n, j) = scaled%flexibility_scale*scaled%flexibility(pairs(j:), pairs(j))
      do t = 1, size(closing, 2)
        if (closing(j, t) /= 0.0_wp) f(j:n, j) = f(j:n, j) + scaled%gamma(t)*closing(j, t)*closing(j:, t)
      end do
    end do
  end subroutine add_pairs

  !> Order the pairs by their pivots, without those whose pivots are zero up to rounding.
  subroutine leave_out_dependent(basis, scaled)
    type(contact_basis), intent(inout) :: basis
    type(scaled_problem), intent(in) :: scaled
    real(wp), allocatable :: copy(:, :), unit(:)
    integer, allocatable :: order(:)
    integer :: k, rank

    allocate (copy(size(basis%pairs), size(basis%pairs)), source=0.0_wp)
    call add_pairs(scaled, basis%pairs, scaled%motion%rows(basis%pairs), copy)
    unit = sqrt(scaled%softness(basis%pairs))
    do k = 1, size(unit)
      copy(k:, k) = copy(k:, k)/(unit(k:)*unit(k))
    end do
    call pivoted_cholesky(copy, scaled%rank_tolerance, order, rank)
    basis%pairs = basis%pairs(order(:rank))
  end subroutine leave_out_dependent

  !> Compute forces and modes for right-hand sides h and p; the basis must be sound.
  pure subroutine respond(basis, opening, load, force, approach)
    type(contact_basis), intent(in) :: basis   !! sound
    real(wp), intent(in) :: opening(:, :)      !! h, gaps of the pairs without forces [s, k]
    real(wp), intent(in) :: load(:, :)         !! p [m, k]
    real(wp), allocatable, intent(out) :: force(:, :)      !! R_S [s, k]
    real(wp), allocatable, intent(out) :: approach(:, :)   !! q [m, k]
    real(wp), allocatable :: x(:, :)     ! forces and modes

    associate (n => size(basis%pairs))
      allocate (x(n + basis%motions, size(opening, 2)))
      x(:n, :) = -opening
      x(n + 1:, :) = -load
      call solve_saddle(basis%factor, n, x)
      force = x(:n, :)
      approach = x(n + 1:, :) - spread(basis%gamma, 2, size(load, 2))*load
    end associate
  end subroutine respond
end module epcont_contact_basis
