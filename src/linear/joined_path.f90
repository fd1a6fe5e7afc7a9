!> Interior path to the first set of contacts of joined bodies: all forces and gaps are above zero, and their
!> products fall together, by Newton steps that are cut before one of them is zero.
!>
!> Each pair has a spring of stiffness force/gap in a step, so that every system has its solution, also while
!> contacts open or bodies rock. The stiffest of these springs would cost digits of the factor: a pair that
!> is firm has one of bounded stiffness, and its force is followed by as many steps as it takes. The path
!> ends near the set, not at it.
module epcont_linear_joined_path
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body
  use epcont_base_kinds, only: wp
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: joined_path

  !> Steps at most; 10 to 40 are seen.
  integer, parameter :: step_limit = 40
  !> Stiffness of the firmest springs, over those of pairs that Newton steps have.
  real(wp), parameter :: firmest = 100.0_wp
  !> Part of the way to where the first force or gap is zero.
  real(wp), parameter :: to_the_wall = 0.95_wp
  !> Part of the mean product that a step leaves, after long steps, short and very short ones.
  real(wp), parameter :: left(3) = [0.1_wp, 0.5_wp, 0.9_wp], short(2) = [0.3_wp, 0.05_wp]
  !> The set is clear where each force, over what its gap would make at a half-plane, is beyond this or its
  !! inverse; or the mean product is below these parts of the first, after a long step or any.
  !! The gap of a firm pair, at least, over what the spring of a Newton step would have.
  real(wp), parameter :: no_gap = 1.0e-6_wp
  real(wp), parameter :: clear = 1.0e3_wp, small = 1.0e-10_wp, smallest = 1.0e-20_wp

  !> Where the path begins, and the set at its end.
  type :: joined_path
    real(wp), allocatable :: gap(:)             !! without any step [length] [pairs]
    real(wp), allocatable :: unbalanced(:, :)   !! forces on the nodes [force] [directions, nodes]
    real(wp), allocatable :: gamma(:)           !! springs of Newton steps [force/length] [pairs]
    real(wp), allocatable :: compliance(:)      !! of a half-plane at each pair [length/force] [pairs]
    real(wp), allocatable :: force(:)           !! at the end [force] [pairs]
    logical, allocatable :: closed(:)           !! at the end [pairs]
    integer :: steps = 0                        !! taken
  contains
    procedure :: follow
  end type joined_path

contains

  !> Follow the path, and tell the pairs closed at its end and their forces.
  subroutine follow(self, scene, threads, bodies)
    class(joined_path), intent(inout) :: self
    type(planned_model), intent(in) :: scene           !! numbered as one system
    integer, intent(in) :: threads                     !! that share the fronts
    class(factored_bodies), intent(inout) :: bodies    !! factored with springs of the path then
    real(wp), dimension(size(self%gap)) :: force, open, stiffness, force_step, open_step, over
    logical :: firm(size(self%gap))
    real(wp) :: begin, length, mean, part
    integer :: step

    force = sum(abs(self%unbalanced))/max(1.0_wp, size(force)/real(scene%model%bodies, wp))
    if (all(force == 0.0_wp)) then   ! nothing presses
      self%closed = self%gap < 0.0_wp
      self%force = force
      return
    end if
    open = max(self%gap, self%compliance*force)
    begin = maxval(force)*maxval([abs(self%gap), self%compliance*force])
    over = clear
    part = left(1)
    do step = 1, step_limit
      mean = dot_product(force, open)/size(force)
      firm = force > firmest*self%gamma*open
      stiffness = merge(firmest*self%gamma, force/open, firm)
      call solve_step(force + merge(0.0_wp, part*mean/open, firm))
      if (.not. bodies%body(1)%is_sound()) exit
      length = min(1.0_wp, to_the_wall/maxval([-force_step/force, -open_step/open, tiny(part)]))
      force = force + length*force_step
      open = open + length*open_step
      where (firm) open = max(left(1)*mean/force, no_gap*force/self%gamma)
      part = left(1 + count(length < short))
      self%steps = self%steps + 1
      over = force*self%compliance/open
      if (length > 0.5_wp .and. all(over > clear .or. over < 1.0_wp/clear) .or. &
          step > step_limit/2 .and. length > to_the_wall .and. mean < small*begin .or. &
          mean < smallest*begin) exit
    end do
    self%closed = over > 1.0_wp
    self%force = merge(force, 0.0_wp, self%closed)

  contains

    !> The step to these forces, less what springs lose as gaps open; gaps of firm pairs follow afterwards.
    subroutine solve_step(target)
      real(wp), intent(in) :: target(:)   !! [force] [pairs]
      type(half_solved_body), allocatable :: half(:)
      real(wp) :: reached(size(force))      ! gaps

      bodies%spring%stiffness(:size(force)) = stiffness
      bodies%spring%changed(:size(force)) = .true.
      call bodies%factor_system(scene, threads)
      call bodies%add_forces(scene, self%unbalanced + &
                             pair_forces(scene%model, target - stiffness*self%gap), 0.0_wp, half)
      reached = self%gap + gap_opening(scene%model, bodies%finish(scene, half, 0.0_wp, at_contact=.true.))
      force_step = target - stiffness*reached - force
      open_step = merge(0.0_wp, reached - open, firm)
    end subroutine solve_step
  end subroutine follow
end module epcont_linear_joined_path
