!> The simplex on the load not carried yet: follow the contact as the load factor t grows from 0 to 1.
module epcont_contact_loading
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: negligible, solved_to
  use epcont_contact_problem, only: contact_solution, history_limit, pivot_record
  use epcont_contact_ratio_test, only: step_type, test_ratios
  use epcont_contact_tableau, only: contact_tableau, load_factor, pivot
  implicit none
  private
  public :: follow_load

  !> How the load path ended.
  integer, parameter, public :: path_complete = 0  !! all of the load is carried
  integer, parameter, public :: path_ray = 1       !! the load cannot grow and nothing gives way
  integer, parameter, public :: path_endless = 2   !! too many pivots: rounding has broken the order of ties

contains

  !> Pivot until the load is complete. Each pivot is an event of growing load: a pair closes or opens. The
  !! partner of the variable that left enters next (Conry and Seireg 1971).
  pure subroutine follow_load(tableau, pivot_limit, solution, outcome, closed, ray)
    type(contact_tableau), intent(inout) :: tableau   !! at its start, then where the load path ended
    integer, intent(in) :: pivot_limit   !! pivots allowed
    type(contact_solution), intent(inout) :: solution   !! pivots are counted and recorded here
    integer, intent(out) :: outcome                     !! one of the above
    logical, allocatable, intent(out) :: closed(:)      !! pairs with a basic force at the end [n]
    real(wp), allocatable, intent(out) :: ray(:)        !! growth of the forces along a ray [n]
    type(step_type) :: step
    integer :: column, count, entering, left

    allocate (ray(size(tableau%basic)), source=0.0_wp)
    outcome = path_endless
    entering = load_factor
    do count = 0, pivot_limit
      column = -tableau%place(entering)
      step = test_ratios(tableau, column)
      if (is_complete(tableau, step)) then
        outcome = path_complete
      else if (step%row == 0) then
        outcome = path_ray
        ray = force_growth(tableau, column, step%slope)
      end if
      if (outcome /= path_endless .or. count == pivot_limit) exit
      left = tableau%basic(step%row)
      call pivot(tableau, step%row, column, step%slope)
      call record(tableau, entering, left, step%ratio, solution)
      ! (3-4), the contact entry rule: R_k for w_k and w_k for R_k, so that never are both basic
      entering = -left
    end do
    closed = tableau%place(1:) > 0
    ! The force on its way in at full load is positive; where it moved no load it stays out.
    if (entering > 0 .and. step%load_rate > 0.0_wp) closed(entering) = .true.
  end subroutine follow_load

  !> Is all of the load carried before another variable blocks, or together with it?
  pure logical function is_complete(tableau, step) result(complete)
    type(contact_tableau), intent(in) :: tableau
    type(step_type), intent(in) :: step

    complete = step%load_rate > 0.0_wp .and. step%full_load*(1.0_wp - solved_to) <= step%ratio
    associate (row => tableau%place(load_factor))
      if (row > 0) complete = complete .or. tableau%value(row) >= 1.0_wp - solved_to
    end associate
  end function is_complete

  !> Growth of each force with the entering variable.
  pure function force_growth(tableau, column, slope) result(growth)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: column
    real(wp), intent(in) :: slope(:)   !! change of the basic variables [n]
    real(wp), allocatable :: growth(:)
    integer :: i

    allocate (growth(size(tableau%basic)), source=0.0_wp)
    do i = 1, size(tableau%basic)
      if (tableau%basic(i) > 0) growth(tableau%basic(i)) = slope(i)
    end do
    if (tableau%nonbasic(column) > 0) growth(tableau%nonbasic(column)) = 1.0_wp
  end function force_growth

  !> Count the pivot and, of the first ones, write down what happened.
  pure subroutine record(tableau, entered, left, ratio, solution)
    type(contact_tableau), intent(in) :: tableau
    integer, intent(in) :: entered, left
    real(wp), intent(in) :: ratio
    type(contact_solution), intent(inout) :: solution

    solution%pivots = solution%pivots + 1
    if (ratio <= negligible) solution%degenerate_pivots = solution%degenerate_pivots + 1
    if (solution%pivots > history_limit) return
    associate (load => tableau%value(tableau%place(load_factor)))
      solution%history = [solution%history, pivot_record(entered, left, load, ratio)]
    end associate
  end subroutine record
end module epcont_contact_loading
