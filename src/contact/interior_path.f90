!> A way to the set of contacts through states that are none: all forces and gaps are above zero, and their
!> products fall together, by Newton steps that are cut before one of them is zero (interior points with
!> Mehrotra's predictor and corrector, 1992).
!>
!> A step takes all pairs, each with a flexibility of its own, gap over force, so that every set of equations
!> has its solution: ten to forty of them, of however many bodies, where exchanges of pairs leave one body
!> after the other without any that hold it. Each motion has a stiffness of its own in it, too: the pairs of a
!> body that no load presses open on the way, and what is left of their hold is rounding beside that of stiff
!> bodies. It shortens a step, and changes nothing of where the path leads. The path ends near the set, not at
!> it.
module epcont_contact_interior_path
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: null_component
  use epcont_contact_basis, only: contact_basis, factor_all, respond
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_loose_motions, only: loose_motions
  use epcont_contact_scaling, only: scaled_problem
  use epcont_contact_state, only: gaps_under
  use epcont_flexibility_motion_matrix, only: dense_motions
  implicit none
  private
  public :: follow_interior_path

  !> Steps that are taken at most; where there is a set, 9 to 40 were seen.
  integer, parameter :: step_limit = 60
  !> Products of force and gap, scaled, at the end: which of the two is none is clear then.
  !! After 1e-18 gaps were taken for forces below 1e-9, which bear bodies that are levers to each other.
  real(wp), parameter :: least_product = 1.0e-24_wp
  !> If the mean product grows beyond this, the path diverges: there is no equilibrium.
  real(wp), parameter :: most_product = 1.0e100_wp
  !> Part of the way to where the first force or gap is zero.
  real(wp), parameter :: to_the_wall = 0.99_wp
  !> Part of its largest kind that a force or gap has at first, at least.
  real(wp), parameter :: inside = 0.01_wp
  !> Stiffness of a motion's own, as a part of the largest by which pairs can hold it: above its rounding.
  real(wp), parameter :: own_stiffness = 1.0e-13_wp

  !> Where the path is, or a step along it.
  type :: inner_point
    real(wp), allocatable :: force(:), gap(:)   !! R and w [n]
    real(wp), allocatable :: approach(:)        !! q [m]
  end type inner_point

contains

  !> Follow the path to its end, and tell which pairs are closed there.
  subroutine follow_interior_path(scaled, closed, steps)
    type(scaled_problem), intent(in) :: scaled   !! the problem in its own units
    logical, intent(out) :: closed(:)            !! [n]
    integer, intent(inout) :: steps              !! sets of equations solved so far
    type(scaled_problem) :: barrier      ! with flexibilities of its pairs' own
    type(contact_basis) :: basis         ! of all pairs there
    type(inner_point) :: at, step        ! where the path is, and whereto
    real(wp), dimension(size(closed)) :: open, product   ! gaps that are not so yet, products wanted
    real(wp) :: mean
    integer :: count

    barrier = scaled
    barrier%own_stiffness = own_stiffness/scaled%gamma
    call begin()
    do count = 1, step_limit
      mean = dot_product(at%force, at%gap)/size(closed)
      if (.not. basis%sound .or. mean <= least_product .or. mean > most_product) exit
      barrier%own_flexibility = scaled%own_flexibility + at%gap/at%force
      call factor_all(basis, barrier)
      steps = steps + 1
      if (basis%sound) call advance()
    end do
    closed = at%force*scaled%softness > at%gap
    call hold_all_motions()

  contains

    !> Forces and gaps above zero, of the size that they have where no force is none.
    subroutine begin()
      at = inner_point(0*scaled%gap, 0*scaled%gap, 0*scaled%resultant)
      barrier%own_flexibility = scaled%own_flexibility + maxval(scaled%softness)
      call factor_all(basis, barrier)
      if (.not. basis%sound) return
      call answer(gaps_there(), scaled%resultant, at)
      at%gap = gaps_there()
      at%force = at%force + above_zero(at%force)
      at%gap = at%gap + above_zero(at%gap)
    end subroutine begin

    !> What gaps are under the forces and motions there.
    pure function gaps_there() result(gap)
      real(wp) :: gap(size(closed))

      gap = gaps_under(scaled, scaled%gap, at%force - scaled%known_force, at%approach)
    end function gaps_there

    !> Of no products at all the step tells how far they can fall; they are asked for what it leaves of them.
    subroutine advance()
      real(wp) :: ahead, length

      open = gaps_there() - at%gap
      product = 0.0_wp
      call find_step()
      length = length_of_step(1.0_wp)
      ahead = dot_product(at%force + length*step%force, at%gap + length*step%gap)/size(closed)
      product = mean*(ahead/mean)**3 - step%force*step%gap
      call find_step()
      length = length_of_step(to_the_wall)
      at%force = at%force + length*step%force
      at%gap = at%gap + length*step%gap
      at%approach = at%approach + length*step%approach
    end subroutine advance

    !> Where no load presses bodies down, they lie on the pairs that they come to first.
    subroutine hold_all_motions()
      real(wp), allocatable :: loose(:, :)
      integer, allocatable :: open(:)
      type(rigid_start) :: rest
      integer :: k

      loose = loose_motions(scaled%motion, pack([(k, k=1, size(closed))], closed), null_component)
      if (size(loose, 2) == 0) return
      open = pack([(k, k=1, size(closed))], .not. closed)
      call find_rigid_start(dense_motions(scaled%motion%of_each(loose, open)), &
                            spread(0.0_wp, 1, size(loose, 2)), at%gap(open), rest)
      closed(pack(open, rest%touching)) = .true.
    end subroutine hold_all_motions

    !> The step to gaps that are so, loads that are carried, and products.
    subroutine find_step()
      call answer(open + at%gap - product/at%force, &
                  scaled%resultant - scaled%motion%carried(at%force), step)
      step%gap = (product - at%gap*(at%force + step%force))/at%force
    end subroutine find_step

    !> Forces and motions with all pairs closed.
    subroutine answer(opening, load, found)
      real(wp), intent(in) :: opening(:), load(:)
      type(inner_point), intent(inout) :: found
      real(wp), allocatable :: force(:, :), approach(:, :)

      call respond(basis, reshape(opening(basis%pairs), [size(opening), 1]), &
                   reshape(load, [size(load), 1]), force, approach)
      found%force = 0*opening
      found%force(basis%pairs) = force(:, 1)
      found%approach = approach(:, 1)
    end subroutine answer

    !> Length of the step, up to one, by this part of the way to the wall.
    pure real(wp) function length_of_step(part) result(length)
      real(wp), intent(in) :: part

      length = min(1.0_wp, part/maxval([-step%force/at%force, -step%gap/at%gap, tiny(part)]))
    end function length_of_step
  end subroutine follow_interior_path

  !> What lifts all values well above zero.
  pure real(wp) function above_zero(values) result(lift)
    real(wp), intent(in) :: values(:)

    lift = max(-1.5_wp*minval(values), inside*maxval(abs(values)), inside)
  end function above_zero
end module epcont_contact_interior_path
