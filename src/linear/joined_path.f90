!> Interior path to the first active set of joined bodies: all forces are between their bounds, and the
!> products of their distances from these with the gaps decrease together, by Newton steps that are cut before
!> one of them is zero. A pair has a gap for each finite bound, the second one with opposite sense; the
!> opening of the pair is their difference.
!>
!> Each pair has a spring of stiffness force/gap in a step, so that every system has a solution, even if
!> contacts open or bodies rock. The stiffest springs would cost digits of the factor: a firm pair
!> has a spring of bounded stiffness, and its force converges in additional steps. The path
!> ends near the active set, not at it.
module epcont_linear_joined_path
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body
  use epcont_base_kinds, only: wp
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: joined_path

  !> Maximum number of steps; 10 to 40 are usual.
  integer, parameter :: step_limit = 40
  !> Stiffness of the firmest springs, over that of Newton steps of the search.
  real(wp), parameter :: firmest = 100.0_wp
  !> Fraction of the way to the first zero force or gap.
  real(wp), parameter :: to_the_wall = 0.95_wp
  !> Fraction of the mean product after a step: for long, short and very short steps.
  real(wp), parameter :: left(3) = [0.1_wp, 0.5_wp, 0.9_wp], short(2) = [0.3_wp, 0.05_wp]
  !> The set is clear if each force, over the force that its gap causes at a half-plane, is beyond this or its
  !! inverse; or if the mean product is below these fractions of the first, after a long step or any step.
  !! Least gap of a firm pair, over that of the spring of a Newton step.
  real(wp), parameter :: no_gap = 1.0e-6_wp
  real(wp), parameter :: clear = 1.0e3_wp, small = 1.0e-10_wp, smallest = 1.0e-20_wp

  !> Start of the path, and the set at its end.
  type :: joined_path
    real(wp), allocatable :: gap(:)             !! of the initial state [length] [pairs]
    real(wp), allocatable :: unbalanced(:, :)   !! forces on the nodes [force] [directions, nodes]
    real(wp), allocatable :: gamma(:)           !! springs of Newton steps [force/length] [pairs]
    real(wp), allocatable :: compliance(:)      !! of a half-plane, for each pair [length/force] [pairs]
    real(wp), allocatable :: lower(:), upper(:) !! bounds of the forces [force] [pairs]
    real(wp), allocatable :: force(:)           !! at the end [force] [pairs]
    logical, allocatable :: closed(:)           !! at the end [pairs]
    integer :: steps = 0                        !! number of steps taken
    logical, allocatable, private :: firm(:)    !! pairs with bounded springs [pairs]
    logical, allocatable, private :: two(:)     !! pairs with an upper bound [pairs]
    !> Distances from the lower and the upper bound, and the corresponding gaps [pairs, 2]
    real(wp), allocatable, private :: inside(:, :), open(:, :)
    !> Change of forces and gaps by a step [pairs], [pairs, 2]
    real(wp), allocatable, private :: force_step(:), open_step(:, :)
  contains
    procedure :: follow
    procedure, private :: begin
    procedure, private :: solve_step
    procedure, private :: length_of_step
    procedure, private :: over
  end type joined_path

contains

  !> Follow the path, and return the pairs closed at its end and their forces.
  subroutine follow(self, scene, threads, bodies)
    class(joined_path), intent(inout) :: self
    type(planned_model), intent(in) :: scene           !! numbered as one system
    integer, intent(in) :: threads                     !! number of threads
    class(factored_bodies), intent(inout) :: bodies    !! afterwards factored with springs of the path
    real(wp) :: first, length, mean, over(size(self%gap), 2), part
    integer :: k, step

    call self%begin(scene%model%mesh%bodies)
    if (all(self%inside(:, 1) == 0.0_wp)) then   ! no contact forces
      self%closed = self%gap < 0.0_wp
      return
    end if
    first = maxval(self%inside(:, 1))*maxval([abs(self%gap), self%compliance*self%inside(:, 1)])
    over = clear
    part = left(1)
    do step = 1, step_limit
      mean = sum([(dot_product(self%inside(:, k), self%open(:, k)), k=1, 2)])/ &
             (size(over, 1) + count(self%two))
      call self%solve_step(scene, threads, bodies, part*mean)
      if (.not. bodies%body(1)%is_sound()) exit
      length = self%length_of_step()
      self%force = self%force + length*self%force_step
      self%inside(:, 1) = self%inside(:, 1) + length*self%force_step
      where (self%two) self%inside(:, 2) = self%inside(:, 2) - length*self%force_step
      self%open = self%open + length*self%open_step
      where (self%firm) self%open(:, 1) = max(left(1)*mean/self%inside(:, 1), &
                                              no_gap*self%inside(:, 1)/self%gamma)
      where (self%firm .and. self%two) self%open(:, 2) = max(left(1)*mean/self%inside(:, 2), &
                                                             no_gap*self%inside(:, 2)/self%gamma)
      part = left(1 + count(length < short))
      self%steps = self%steps + 1
      over = self%over()
      if (length > 0.5_wp .and. all(over > clear .or. over < 1.0_wp/clear) .or. &
          step > step_limit/2 .and. length > to_the_wall .and. mean < small*first .or. &
          mean < smallest*first) exit
    end do
    self%closed = all(over > 1.0_wp, dim=2)
    where (.not. self%closed) self%force = merge(self%lower, self%upper, over(:, 1) <= over(:, 2))
  end subroutine follow

  !> Set forces between their bounds that would balance all others, and the gaps that they cause.
  subroutine begin(self, bodies)
    class(joined_path), intent(inout) :: self
    integer, intent(in) :: bodies     !! number of bodies
    real(wp) :: load
    integer :: n

    n = size(self%gap)
    self%two = self%upper < huge(1.0_wp)
    load = sum(abs(self%unbalanced))
    if (load <= 0.0_wp) load = maxval(max(-self%gap, 0.0_wp)/self%compliance, mask=.not. self%two)
    self%inside = spread(spread(load/max(1.0_wp, n/real(bodies, wp)), 1, n), 2, 2)
    self%force = self%lower + self%inside(:, 1)
    self%open = spread(max(self%gap, self%compliance*self%inside(:, 1)), 2, 2)
    where (.not. self%two) self%open(:, 2) = 0.0_wp
    where (self%two)   ! a pair of equal bounds needs a distance
      self%inside(:, 1) = max(0.5_wp*(self%upper - self%lower), no_gap*self%inside(:, 1))
      self%inside(:, 2) = self%inside(:, 1)
      self%force = 0.5_wp*(self%lower + self%upper)
      self%open(:, 1) = max(self%gap, self%compliance*self%inside(:, 1))
      self%open(:, 2) = max(-self%gap, self%compliance*self%inside(:, 1))
    end where
  end subroutine begin

  !> Solve for a step to this product; gaps of firm pairs are computed afterwards.
  subroutine solve_step(self, scene, threads, bodies, product)
    class(joined_path), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    integer, intent(in) :: threads
    class(factored_bodies), intent(inout) :: bodies
    real(wp), intent(in) :: product
    type(half_solved_body), allocatable :: half(:)
    real(wp), dimension(size(self%gap)) :: reached, stiffness, target   ! gaps, springs, forces without gaps

    associate (inside => self%inside, open => self%open)
      stiffness = inside(:, 1)/open(:, 1)
      where (self%two) stiffness = 1.0_wp/(open(:, 1)/inside(:, 1) + open(:, 2)/inside(:, 2))
      self%firm = stiffness > firmest*self%gamma
      where (self%firm) stiffness = firmest*self%gamma
      target = self%force + merge(0.0_wp, product/open(:, 1), self%firm)
      where (self%two .and. .not. self%firm) target = self%force + &
        stiffness*product*(1.0_wp/inside(:, 1) - 1.0_wp/inside(:, 2))
      bodies%spring%stiffness(:size(target)) = stiffness
      bodies%spring%changed(:size(target)) = .true.
      call bodies%factor_system(scene, threads)
      call bodies%add_forces(scene, self%unbalanced + &
                             pair_forces(scene%model, target - stiffness*self%gap), .false., half)
      reached = self%gap + gap_opening(scene%model, bodies%finish(scene, half, .false., at_contact=.true.))
      self%force_step = target - stiffness*reached - self%force
      self%open_step = spread(merge(0.0_wp, reached - open(:, 1), self%firm), 2, 2)
      where (.not. self%two) self%open_step(:, 2) = 0.0_wp
      where (self%two .and. .not. self%firm)
        self%open_step(:, 1) = (product - open(:, 1)*self%force_step)/inside(:, 1) - open(:, 1)
        self%open_step(:, 2) = (product + open(:, 2)*self%force_step)/inside(:, 2) - open(:, 2)
      end where
    end associate
  end subroutine solve_step

  !> Fraction of a step that nearly reaches the first bound or closed gap.
  pure real(wp) function length_of_step(self) result(length)
    class(joined_path), intent(in) :: self
    real(wp) :: fastest

    fastest = maxval([-self%force_step/self%inside(:, 1), -self%open_step(:, 1)/self%open(:, 1), &
                      tiny(fastest)])
    if (any(self%two)) fastest = max(fastest, maxval(self%force_step/self%inside(:, 2), mask=self%two), &
                                     maxval(-self%open_step(:, 2)/self%open(:, 2), mask=self%two))
    length = min(1.0_wp, to_the_wall/fastest)
  end function length_of_step

  !> Distances from the bounds, over the force that gaps cause at a half-plane; infinite without a bound.
  pure function over(self)
    class(joined_path), intent(in) :: self
    real(wp) :: over(size(self%gap), 2)

    over(:, 1) = self%inside(:, 1)*self%compliance/self%open(:, 1)
    over(:, 2) = huge(1.0_wp)
    where (self%two) over(:, 2) = self%inside(:, 2)*self%compliance/self%open(:, 2)
  end function over
end module epcont_linear_joined_path
