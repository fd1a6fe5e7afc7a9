!> Units of the contact problem, which make the solution independent of the deck's units.
!>
!> The unit of forces is rho, of gaps omega, and of each mode the largest gap that it closes:
!>
!>     rho   = max(max(-g, |gl|) / max|F|, max_j |P_j| / max|A_j|),   g = g0 + gl
!>     omega = rho max|F|
!>
!> so that the driving gaps and loads are of size one, even if other pairs are far apart. Without load or
!> overlap, rho is max|g| / max|F|; without flexibility, omega is max|g|. Modes are scaled one by one
!> because translations and rotations have different units. F, which may be large, is not copied:
!> its entries are scaled when used.
module epcont_contact_scaling
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible
  use epcont_contact_problem, only: contact_problem
  use epcont_flexibility_motion_matrix, only: motion_matrix
  implicit none
  private
  public :: scaled_problem, scale_problem, diagonal_of, drop_motions, gaps_by_forces

  !> Scaled problem with the kept modes.
  type :: scaled_problem
    real(wp), pointer, contiguous :: flexibility(:, :) => null()   !! F, as given [n, n]
    real(wp) :: flexibility_scale = 1.0_wp       !! rho/omega, factor of the entries of F
    type(motion_matrix) :: motion               !! A [n, m]
    real(wp), allocatable :: gap(:)             !! g, gaps under load and known forces [n]
    real(wp), allocatable :: known_force(:)     !! known forces, 0 if the problem has none [n]
    real(wp), allocatable :: gap_terms(:)       !! sum of magnitudes of the terms of g [n]
    real(wp), allocatable :: unloaded_gap(:)    !! g^, gaps of the start, >= 0 [n]
    real(wp), allocatable :: resultant(:)       !! P [m]
    real(wp) :: force_unit = 1.0_wp             !! rho
    real(wp) :: gap_unit = 1.0_wp               !! omega
    real(wp), allocatable :: motion_size(:)     !! largest entry of each column of the given A [all motions]
    integer, allocatable :: kept(:)             !! indices of these among the given modes [m]
    !> gamma of each mode: F and the sum of gamma a a', over the columns a of A, have the same size, and their
    !! sum F_g is definite whenever forces are unique [m]
    real(wp), allocatable :: gamma(:)
    !> Flexibility by which the pivots of each pair are measured: max F_kk, 1 if nothing is flexible; for
    !! much stiffer pairs the entry of F_g itself [n]
    real(wp), allocatable :: softness(:)
    !> Pivots of F_g below this fraction are rounding: a hundredth of a negligible one, or that of n sums
    real(wp) :: rank_tolerance = 0.0_wp
    logical, allocatable :: first(:)   !! pairs in contact first of rigid bodies: they restrain all modes [n]
    logical, allocatable :: guess(:)   !! of the pairs in contact; not allocated: no guess [n]
  end type scaled_problem

  !> Pairs whose flexibility is below this fraction of the largest are measured by themselves: forces on
  !! bodies a billion times stiffer than others are unique as well.
  real(wp), parameter :: far_stiffer = 1.0e-4_wp

contains

  !> Scale the problem, with all of its modes.
  type(scaled_problem) function scale_problem(problem) result(scaled)
    type(contact_problem), intent(in), target :: problem   !! in the deck's units; it must remain
    real(wp) :: driving   !! largest gap that causes forces
    real(wp) :: largest   !! max|F|: on the diagonal, as F is semidefinite
    integer :: j

    scaled%kept = [(j, j=1, size(problem%resultant))]
    scaled%motion_size = problem%motion%sizes()
    scaled%motion_size = or_else(or_else(scaled%motion_size, largest_of(scaled%motion_size)), 1.0_wp)
    scaled%gap = problem%initial_gap + problem%load_gap
    scaled%unloaded_gap = max(problem%initial_gap, 0.0_wp)
    largest = largest_of(diagonal_of(problem%flexibility))

    driving = max(largest_of(min(scaled%gap, 0.0_wp)), largest_of(problem%load_gap))
    associate (rho => scaled%force_unit, omega => scaled%gap_unit)
      rho = max(largest_of(problem%resultant/scaled%motion_size), force_over(driving))
      rho = or_else(or_else(rho, force_over(largest_of(scaled%gap))), 1.0_wp)
      omega = or_else(rho*largest, max(largest_of(scaled%gap), largest_of(scaled%unloaded_gap)))
      omega = or_else(omega, 1.0_wp)

      scaled%flexibility_scale = merge(1.0_wp/or_else(largest, 1.0_wp), rho/omega, largest > 0.0_wp)
      scaled%known_force = 0*scaled%gap
      scaled%gap_terms = abs(problem%initial_gap) + abs(problem%load_gap)
      if (allocated(problem%known_force)) then
        scaled%known_force = problem%known_force/rho
        scaled%gap = problem%known_gap
        scaled%gap_terms = abs(problem%known_gap)
      end if
      scaled%gap_terms = scaled%gap_terms/omega
      scaled%gap = scaled%gap/omega
      scaled%unloaded_gap = scaled%unloaded_gap/omega
      scaled%resultant = problem%resultant/scaled%motion_size/rho
    end associate
    scaled%flexibility => problem%flexibility
    scaled%motion = problem%motion%over(scaled%motion_size)
    call measure(scaled)

  contains

    !> Force that opens a gap; 0 if nothing deforms.
    pure real(wp) function force_over(gap) result(force)
      real(wp), intent(in) :: gap

      force = 0.0_wp
      if (largest > 0.0_wp) force = gap/largest
    end function force_over
  end function scale_problem

  !> Use a value, or another one if it is zero.
  elemental real(wp) function or_else(size, other) result(chosen)
    real(wp), intent(in) :: size, other

    chosen = merge(other, size, size <= 0.0_wp)
  end function or_else

  !> Remove the modes in `dropped`: they are zero.
  pure subroutine drop_motions(scaled, dropped)
    type(scaled_problem), intent(inout) :: scaled   !! the problem in its own units
    logical, intent(in) :: dropped(:)   !! [m]
    integer, allocatable :: kept(:)
    integer :: j

    kept = pack([(j, j=1, size(dropped))], .not. dropped)
    scaled%motion = scaled%motion%only(kept)
    scaled%resultant = scaled%resultant(kept)
    scaled%kept = scaled%kept(kept)
    call measure(scaled)
  end subroutine drop_motions

  !> Find the sizes of flexibilities and modes, and their rounding.
  pure subroutine measure(scaled)
    type(scaled_problem), intent(inout) :: scaled   !! the problem in its own units
    real(wp), dimension(size(scaled%gap)) :: own, squares   ! F_kk, and closing of each gap by the modes
    real(wp) :: softest
    integer :: i, j

    own = diagonal_of(scaled%flexibility)*scaled%flexibility_scale
    softest = or_else(largest_of(own), 1.0_wp)
    squares = 0.0_wp
    scaled%gamma = spread(0.0_wp, 1, scaled%motion%motions())
    do j = 1, size(scaled%gamma)
      do i = scaled%motion%start(j), scaled%motion%start(j + 1) - 1
        associate (k => scaled%motion%pair(i))
          squares(k) = squares(k) + scaled%motion%closing(i)**2
          scaled%gamma(j) = max(scaled%gamma(j), own(k))
        end associate
      end do
    end do
    scaled%gamma = measured_by(scaled%gamma, softest)/or_else(largest_of(squares), 1.0_wp)
    do j = 1, size(scaled%gamma)
      do i = scaled%motion%start(j), scaled%motion%start(j + 1) - 1
        associate (k => scaled%motion%pair(i))
          own(k) = own(k) + scaled%gamma(j)*scaled%motion%closing(i)**2
        end associate
      end do
    end do
    scaled%softness = measured_by(own, softest)
    scaled%rank_tolerance = max(negligible/100, 4*size(squares)*epsilon(1.0_wp))
  end subroutine measure

  !> A flexibility, if it is not zero and far below the largest; else the largest.
  elemental real(wp) function measured_by(own, softest)
    real(wp), intent(in) :: own, softest

    measured_by = merge(own, softest, own > 0.0_wp .and. own < far_stiffer*softest)
  end function measured_by

  !> F R, or the sum of magnitudes |F| |R|.
  pure function gaps_by_forces(scaled, force, magnitudes) result(gap)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    real(wp), intent(in) :: force(:)              !! R [n]
    logical, intent(in), optional :: magnitudes   !! sum of magnitudes
    real(wp) :: gap(size(force))
    integer :: k
    logical :: absolute

    absolute = .false.
    if (present(magnitudes)) absolute = magnitudes
    gap = 0.0_wp
    do k = 1, size(force)
      if (force(k) == 0.0_wp) cycle
      if (absolute) gap = gap + abs(force(k)*scaled%flexibility(:, k))
      if (.not. absolute) gap = gap + force(k)*scaled%flexibility(:, k)
    end do
    gap = scaled%flexibility_scale*gap
  end function gaps_by_forces

  !> Diagonal of a square matrix.
  pure function diagonal_of(matrix) result(diagonal)
    real(wp), intent(in) :: matrix(:, :)
    real(wp) :: diagonal(size(matrix, 1))
    integer :: k

    diagonal = [(matrix(k, k), k=1, size(diagonal))]
  end function diagonal_of

  !> Largest absolute value; 0 if there are no values.
  pure real(wp) function largest_of(values)
    real(wp), intent(in) :: values(:)

    largest_of = maxval([abs(values), 0.0_wp])
  end function largest_of
end module epcont_contact_scaling
