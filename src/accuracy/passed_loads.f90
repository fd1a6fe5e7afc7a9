!> Forces at the pairs in contact under unit loads, of those loads whose errors are told.
module epcont_accuracy_passed_loads
  use epcont_base_kinds, only: wp
  use epcont_plan_forecast, only: most_assessed
  implicit none
  private
  public :: passed_loads, dense_loads, farthest

  type :: passed_loads
    integer :: loads = 0                   !! how many; those without a column have no forces here
    integer, allocatable :: number(:)      !! of the load of each column [columns]
    real(wp), allocatable :: force(:, :)   !! under it [force] [pairs, columns]
    !> Largest force under it; 0: nothing is asked of it [force] [columns]
    real(wp), allocatable :: unit(:)
    !> Of joined bodies: under it [length] [directions, columns, nodes]
    real(wp), allocatable :: displacement(:, :, :)
    !> Under each load that closes gaps, what it moves the SUPORT freedoms by: that is the sum of the forces,
    !! each times its pair's share, under a unit load along the motion (Betti) [motions, such loads]
    real(wp), allocatable :: shared(:, :)
  contains
    procedure :: add_up
    procedure :: weighed
    procedure :: ask_for
    procedure :: find_at
  end type passed_loads

contains

  !> Loads whose forces are known.
  pure type(passed_loads) function dense_loads(force, number, loads) result(passed)
    real(wp), intent(in) :: force(:, :)    !! under some of them [force] [pairs, these]
    integer, intent(in) :: number(:)       !! which these are [these]
    integer, intent(in) :: loads           !! in all

    passed%loads = loads
    passed%number = number
    passed%force = force
    allocate (passed%unit(size(number)), source=0.0_wp)
  end function dense_loads

  !> A few of those that count: the farthest.
  pure function farthest(approach, counts) result(chosen)
    real(wp), intent(in) :: approach(:)     !! [motions]
    logical, intent(in) :: counts(:)        !! [motions]
    integer, allocatable :: chosen(:)       !! ascending
    logical :: left(size(counts))
    integer :: i, m

    left = counts
    do i = 1, min(most_assessed, count(counts))
      left(maxloc(abs(approach), dim=1, mask=left)) = .false.
    end do
    chosen = pack([(m, m=1, size(counts))], counts .and. .not. left)
  end function farthest

  !> The same for each load, from what columns have; 0 of loads without one [any, loads].
  pure function add_up(self, part) result(total)
    class(passed_loads), intent(in) :: self
    real(wp), intent(in) :: part(:, :)   !! of each column [any, columns]
    real(wp) :: total(size(part, 1), self%loads)

    total = 0.0_wp
    total(:, self%number) = part
  end function add_up

  !> Sums of forces, each times a weight of its pair, under each load; of magnitudes of forces, if wanted
  !! [loads].
  pure function weighed(self, weight, magnitudes) result(total)
    class(passed_loads), intent(in) :: self
    real(wp), intent(in) :: weight(:)               !! [pairs]
    logical, intent(in), optional :: magnitudes
    real(wp) :: total(self%loads)
    integer :: c
    logical :: absolute

    absolute = .false.
    if (present(magnitudes)) absolute = magnitudes
    total = 0.0_wp
    do c = 1, size(self%number)
      total(self%number(c)) = dot_product(weight, merge(abs(self%force(:, c)), self%force(:, c), absolute))
    end do
  end function weighed

  !> Say which loads are asked for, by the unit of their columns.
  pure subroutine ask_for(self, asked)
    class(passed_loads), intent(inout) :: self
    logical, intent(in) :: asked(:)   !! [loads]
    integer :: c

    do c = 1, size(self%number)
      self%unit(c) = 0.0_wp
      if (asked(self%number(c))) self%unit(c) = maxval([abs(self%force(:, c)), 0.0_wp])
    end do
  end subroutine ask_for

  !> What arrives at some pairs.
  pure subroutine find_at(self, pair, column, force)
    class(passed_loads), intent(in) :: self
    integer, intent(in) :: pair(:)
    integer, allocatable, intent(out) :: column(:)       !! those that are asked for and felt there [any]
    real(wp), allocatable, intent(out) :: force(:, :)    !! under each [force] [columns, pairs]
    integer :: c

    column = pack([(c, c=1, size(self%number))], self%unit > 0.0_wp .and. &
                  [(any(self%force(pair, c) /= 0.0_wp), c=1, size(self%number))])
    force = transpose(self%force(pair, column))
  end subroutine find_at
end module epcont_accuracy_passed_loads
