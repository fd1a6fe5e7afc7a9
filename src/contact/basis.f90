!> The contact equations for a given set S of pairs in contact, factored from F and A, and their solution.
!>
!>     F_SS R_S - A_S q = -h,   A_S' R_S = p
!>
!> F_SS may be singular though the forces are unique (a pair between held nodes is a row of zeros).
!> F_g = F + A gamma A' is definite whenever they are unique, and since A'R = p it changes only the
!> motion: q comes out larger by gamma p, gamma a diagonal matrix. So what is factored is
!>
!>     [ F_g,SS  -A_S ]
!>     [ -A_S'    0   ]
!>
!> whose last pivots are negative where the pairs hold the motions.
module epcont_contact_basis
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits
  use epcont_contact_scaling, only: scaled_problem
  use epcont_linalg_dense, only: factor_saddle, pivoted_cholesky, solve_saddle
  implicit none
  private
  public :: contact_basis, new_basis, renew_basis, move_basis, are_independent, respond

  !> A set of pairs in contact whose forces are unique, and the factor that gives them.
  type :: contact_basis
    logical :: sound = .false.           !! the forces are unique, and the pairs hold every motion
    integer, allocatable :: pairs(:)     !! S [s]
    integer :: motions = 0               !! m
    integer, allocatable :: kept(:)      !! which of the given motions these are [m]
    real(wp), allocatable :: gamma(:)    !! weight of each motion in F_g [m]
    real(wp) :: scale = 0.0_wp           !! of F
    real(wp), allocatable :: factor(:, :)   !! [s + m, s + m]
  end type contact_basis

contains

  !> Factor the equations of the chosen pairs. Pairs whose force depends on that of others are left out.
  type(contact_basis) function new_basis(scaled, chosen, held) result(basis)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    logical, intent(in), optional :: held        !! all motions, at zero: F_g alone is factored
    logical :: definite

    call begin(basis, scaled, chosen, held)
    call factor_basis(basis, scaled, lost_digits, definite)
    if (definite) return
    ! The order of pivots, which takes longer, tells who depends on whom.
    call leave_out_dependent(basis, scaled)
    call factor_basis(basis, scaled, 0.0_wp, definite)
  end function new_basis

  !> Factor the equations of the chosen pairs, if that is not what the basis has: then F must be the same.
  subroutine renew_basis(basis, scaled, chosen)
    type(contact_basis), intent(inout) :: basis   !! none, or of any set
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

  !> Hand a basis over; none is left.
  subroutine move_basis(from, to)
    type(contact_basis), intent(inout) :: from   !! may be none
    type(contact_basis), intent(out) :: to       !! the same
    real(wp), allocatable :: factor(:, :)

    call move_alloc(from%factor, factor)
    to = from
    call move_alloc(factor, to%factor)
  end subroutine move_basis

  !> Does clearly no force of the chosen pairs depend on others, whatever the motions are?
  logical function are_independent(scaled, chosen) result(independent)
    type(scaled_problem), intent(in) :: scaled   !! in its own units
    logical, intent(in) :: chosen(:)             !! [n]
    type(contact_basis) :: basis

    call begin(basis, scaled, chosen, held=.true.)
    call factor_basis(basis, scaled, lost_digits, independent)
  end function are_independent

  !> The chosen pairs and all motions, or none.
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
    real(wp), intent(in) :: least       !! of pivots of forces that are unique, over their softness
    logical, intent(out) :: definite    !! all are
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
    ! Fewer pairs than motions do not hold these, whatever rounding makes of the last pivot.
    basis%sound = definite .and. info == 0 .and. n >= basis%motions
  end subroutine factor_basis

  !> The lower triangle of F_g,SS.
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

  !> Pairs in the order of their pivots, without those whose pivots are zero but for rounding.
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

  !> Forces and motions for right-hand sides h and p; call only if the basis is sound.
  pure subroutine respond(basis, opening, load, force, approach)
    type(contact_basis), intent(in) :: basis   !! a sound one
    real(wp), intent(in) :: opening(:, :)      !! h, gaps of the pairs without forces [s, k]
    real(wp), intent(in) :: load(:, :)         !! p [m, k]
    real(wp), allocatable, intent(out) :: force(:, :)      !! R_S [s, k]
    real(wp), allocatable, intent(out) :: approach(:, :)   !! q [m, k]
    real(wp), allocatable :: x(:, :)     ! forces and motions

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
