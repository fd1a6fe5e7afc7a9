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
  use epcont_contact_problem, only: contact_problem, contact_solution
  implicit none
  private
  public :: scaled_problem, scale_problem, drop_motions, restore_units

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
    scaled%motion_size = maximum_of_columns(problem%motion)
    scaled%gap = problem%initial_gap + problem%load_gap
    scaled%gap_terms = abs(problem%initial_gap) + abs(problem%load_gap)
    scaled%unloaded_gap = max(problem%initial_gap, 0.0_wp)
    largest = max(maxval(abs(problem%flexibility)), 0.0_wp)   ! maxval of nothing is negative

    driving = max(largest_of(min(scaled%gap, 0.0_wp)), largest_of(problem%load_gap))
    scaled%force_unit = force_unit(largest, driving, largest_of(problem%resultant/scaled%motion_size))
    if (scaled%force_unit <= 0.0_wp) scaled%force_unit = force_unit(largest, largest_of(scaled%gap), 0.0_wp)
    if (scaled%force_unit <= 0.0_wp) scaled%force_unit = 1.0_wp
    scaled%gap_unit = scaled%force_unit*largest
    if (scaled%gap_unit <= 0.0_wp) then
      scaled%gap_unit = max(largest_of(scaled%gap), largest_of(scaled%unloaded_gap))
    end if
    if (scaled%gap_unit <= 0.0_wp) scaled%gap_unit = 1.0_wp

    scaled%flexibility = problem%flexibility*(scaled%force_unit/scaled%gap_unit)
    scaled%gap = scaled%gap/scaled%gap_unit
    scaled%gap_terms = scaled%gap_terms/scaled%gap_unit
    scaled%unloaded_gap = scaled%unloaded_gap/scaled%gap_unit
    scaled%resultant = problem%resultant/scaled%motion_size/scaled%force_unit
    scaled%motion = problem%motion
    do j = 1, m
      scaled%motion(:, j) = scaled%motion(:, j)/scaled%motion_size(j)
    end do
  end function scale_problem

  !> rho, from max|F|, the largest driving gap and the largest load; 0 if there is nothing to measure.
  pure real(wp) function force_unit(flexibility, gap, load)
    real(wp), intent(in) :: flexibility, gap, load

    force_unit = load
    if (flexibility > 0.0_wp) force_unit = max(load, gap/flexibility)
  end function force_unit

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
  end subroutine drop_motions

  !> Put forces, gaps and approach into `solution` in the deck's units; dropped motions stay at zero.
  pure subroutine restore_units(scaled, force, gap, approach, solution)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    real(wp), intent(in) :: force(:), gap(:)      !! [n]
    real(wp), intent(in) :: approach(:)           !! of the kept motions [m]
    type(contact_solution), intent(inout) :: solution   !! in the deck's units

    solution%force = force*scaled%force_unit
    solution%gap = gap*scaled%gap_unit
    solution%approach(scaled%kept) = approach*scaled%gap_unit/scaled%motion_size(scaled%kept)
  end subroutine restore_units

  !> Largest absolute entry of each column; that of the whole matrix (or 1) for a column of zeros.
  pure function maximum_of_columns(matrix) result(largest)
    real(wp), intent(in) :: matrix(:, :)
    real(wp) :: largest(size(matrix, 2))
    integer :: j

    largest = [(largest_of(matrix(:, j)), j=1, size(largest))]
    where (largest <= 0.0_wp) largest = largest_of(largest)
    where (largest <= 0.0_wp) largest = 1.0_wp
  end function maximum_of_columns

  !> Largest absolute value; 0 of none.
  pure real(wp) function largest_of(values)
    real(wp), intent(in) :: values(:)

    largest_of = maxval([abs(values), 0.0_wp])
  end function largest_of
end module epcont_contact_scaling
