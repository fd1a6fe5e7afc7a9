!> Units of the contact problem's own, so that the answer does not depend on the deck's.
!>
!> Forces are measured in rho, gaps in omega, and each motion by the largest gap that it closes:
!>
!>     rho   = max(max(-g, |gl|) / max|F|, max_j |P_j| / max|A_j|),   g = g0 + gl
!>     omega = rho max|F|
!>
!> so that what drives the contact is of size one, however far apart the other pairs are. Without load or
!> overlap rho is max|g| / max|F|; without flexibility omega is max|g|. Motions are scaled one by one
!> because translations and rotations have different units.
module epcont_contact_scaling
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible
  use epcont_contact_problem, only: contact_problem
  implicit none
  private
  public :: scaled_problem, scale_problem, drop_motions, measure

  !> The problem in its own units, over the motions that are kept.
  type :: scaled_problem
    real(wp), allocatable :: flexibility(:, :)  !! F [n, n]
    real(wp), allocatable :: motion(:, :)       !! A [n, m]
    real(wp), allocatable :: gap(:)             !! g, gaps under load before contact acts [n]
    real(wp), allocatable :: gap_terms(:)       !! |g0| + |gl|, what g is the sum of [n]
    real(wp), allocatable :: unloaded_gap(:)    !! g^, gaps of the start, >= 0 [n]
    real(wp), allocatable :: resultant(:)       !! P [m]
    real(wp) :: force_unit = 1.0_wp             !! rho
    real(wp) :: gap_unit = 1.0_wp               !! omega
    real(wp), allocatable :: motion_size(:)     !! largest entry of each column of the given A [all motions]
    integer, allocatable :: kept(:)             !! which of the given motions these are [m]
    real(wp) :: softest = 1.0_wp         !! max F_kk; 1 if nothing is flexible
    !> gamma: F and gamma A A' are of one size, and their sum F_g is definite wherever forces are unique
    real(wp) :: gamma = 1.0_wp
    !> A pivot of F_g up to this is rounding: a hundredth of a negligible flexibility, or that of n sums.
    real(wp) :: rank_tolerance = 0.0_wp
    logical, allocatable :: first_touching(:)   !! pairs that hold every motion [n]
    logical, allocatable :: guess(:)   !! of the pairs in contact; not allocated where there is none [n]
  end type scaled_problem

contains

  !> The problem in units of its own, with all of its motions.
  pure type(scaled_problem) function scale_problem(problem) result(scaled)
    type(contact_problem), intent(in) :: problem   !! in the deck's units
    real(wp) :: driving   !! largest gap that asks for forces
    real(wp) :: largest   !! max|F|
    integer :: j, m

    m = size(problem%resultant)
    scaled%kept = [(j, j=1, m)]
    scaled%motion_size = [(largest_of(problem%motion(:, j)), j=1, m)]
    scaled%motion_size = or_else(or_else(scaled%motion_size, largest_of(scaled%motion_size)), 1.0_wp)
    scaled%gap = problem%initial_gap + problem%load_gap
    scaled%gap_terms = abs(problem%initial_gap) + abs(problem%load_gap)
    scaled%unloaded_gap = max(problem%initial_gap, 0.0_wp)
    largest = max(maxval(abs(problem%flexibility)), 0.0_wp)   ! maxval of nothing is negative

    driving = max(largest_of(min(scaled%gap, 0.0_wp)), largest_of(problem%load_gap))
    associate (rho => scaled%force_unit, omega => scaled%gap_unit)
      rho = max(largest_of(problem%resultant/scaled%motion_size), force_over(driving))
      rho = or_else(or_else(rho, force_over(largest_of(scaled%gap))), 1.0_wp)
      omega = or_else(rho*largest, max(largest_of(scaled%gap), largest_of(scaled%unloaded_gap)))
      omega = or_else(omega, 1.0_wp)

      scaled%flexibility = problem%flexibility*(rho/omega)
      scaled%gap = scaled%gap/omega
      scaled%gap_terms = scaled%gap_terms/omega
      scaled%unloaded_gap = scaled%unloaded_gap/omega
      scaled%resultant = problem%resultant/scaled%motion_size/rho
    end associate
    scaled%motion = problem%motion/spread(scaled%motion_size, 1, size(scaled%gap))
    call measure(scaled)

  contains

    !> Force that opens a gap; 0 where nothing gives way.
    pure real(wp) function force_over(gap) result(force)
      real(wp), intent(in) :: gap

      force = 0.0_wp
      if (largest > 0.0_wp) force = gap/largest
    end function force_over
  end function scale_problem

  !> A size, or another where there is none.
  elemental real(wp) function or_else(size, other) result(chosen)
    real(wp), intent(in) :: size, other

    chosen = merge(other, size, size <= 0.0_wp)
  end function or_else

  !> Hold the motions in `dropped` at zero: they leave the problem.
  pure subroutine drop_motions(scaled, dropped)
    type(scaled_problem), intent(inout) :: scaled   !! the problem in its own units
    logical, intent(in) :: dropped(:)   !! [m]
    integer, allocatable :: kept(:)
    integer :: j

    kept = pack([(j, j=1, size(dropped))], .not. dropped)
    scaled%motion = scaled%motion(:, kept)
    scaled%resultant = scaled%resultant(kept)
    scaled%kept = scaled%kept(kept)
    call measure(scaled)
  end subroutine drop_motions

  !> What is large and what is rounding, of flexibilities and motions as they now are.
  pure subroutine measure(scaled)
    type(scaled_problem), intent(inout) :: scaled   !! the problem in its own units
    integer :: k, n

    n = size(scaled%gap)
    scaled%softest = or_else(largest_of([(scaled%flexibility(k, k), k=1, n)]), 1.0_wp)
    scaled%gamma = scaled%softest/or_else(largest_of(sum(scaled%motion**2, dim=2)), 1.0_wp)
    scaled%rank_tolerance = max(negligible/100, 4*n*epsilon(1.0_wp))*scaled%softest
  end subroutine measure

  !> Largest absolute value; 0 of none.
  pure real(wp) function largest_of(values)
    real(wp), intent(in) :: values(:)

    largest_of = maxval([abs(values), 0.0_wp])
  end function largest_of
end module epcont_contact_scaling
