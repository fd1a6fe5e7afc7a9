!> What joined bodies do with the set of contacts that was found: under further loads, and whether its forces
!> are the only ones.
module epcont_linear_joined_response
  use epcont_assembly_bodies, only: factored_bodies, force_fields, half_solved_body
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces
  use epcont_linear_joined_contact, only: joined_contact
  use epcont_linear_joined_springs, only: add_suport_forces, suport_values
  use epcont_model_arrays, only: angle
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: are_unique, frozen_response, respond_joined

  !> What a solve leaves of forces of size one, at most, where they open gaps.
  real(wp), parameter :: most_left = 0.1_wp

  !> What joined bodies do under some loads, the set of contacts frozen.
  type :: frozen_response
    real(wp), allocatable :: load(:, :)      !! along the motions [force] [motions, any]
    real(wp), allocatable :: opening(:, :)   !! of the gaps [length] [pairs, any]
    real(wp), allocatable :: force(:, :)     !! [force] [pairs, any]
    real(wp), allocatable :: displacement(:, :, :)   !! [length] [directions, any, nodes]
  end type frozen_response

contains

  !> Find forces and displacements under loads and openings in one solve; of what is wrong of forces as far as
  !> known it leaves a thousandth or less. Springs at SUPORT freedoms bear what known displacements say.
  subroutine respond_joined(self, scene, bodies, found, at_contact)
    type(joined_contact), intent(in) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies !! factored with the set of contacts
    type(frozen_response), intent(inout) :: found
    logical, intent(in) :: at_contact               !! only displacements that gaps depend on are wanted
    type(force_fields) :: loads
    integer :: k

    loads%node = [(k, k=1, scene%model%nodes)]
    associate (force => found%force, u => found%displacement)
      allocate (loads%force(directions, size(force, 2), size(loads%node)))
      do k = 1, size(force, 2)
        where (self%closed) force(:, k) = force(:, k) - self%gamma*found%opening(:, k)
        loads%force(:, k, :) = pair_forces(scene%model, merge(force(:, k), 0.0_wp, self%closed))
        call add_suport_forces(scene, found%load(:, k) + self%hold*suport_values(scene, u(:, k, :)), &
                               loads%force(:, k, :))
      end do
      ! Angles come from the nodes of their RBE2.
      call bodies%body_displacements(scene, 1, loads, loads%node, u, &
                                     at_contact .and. all(scene%motions%component /= angle))
      do k = 1, size(force, 2)
        where (self%closed) force(:, k) = force(:, k) - self%gamma*gap_opening(scene%model, u(:, k, :))
      end do
    end associate
  end subroutine respond_joined

  !> Are the contact forces the only ones? Forces that open no gaps are what a solve leaves of any; of two
  !! that are given no one is likely to have none of these.
  logical function are_unique(self, scene, bodies)
    type(joined_contact), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies    !! factored with the set of contacts
    type(half_solved_body), allocatable :: half(:)
    real(wp) :: force(scene%model%pairs)
    integer :: j, k

    are_unique = .true.
    if (self%unique) return   ! as in the load case before
    do j = 1, 2
      force = merge(cos([(k*sqrt(real(j, wp)), k=1, size(force))]), 0.0_wp, self%closed)
      if (j > 1) deallocate (half)
      call bodies%add_forces(scene, pair_forces(scene%model, force), 0.0_wp, half)
      force = force - self%gamma*gap_opening(scene%model, bodies%finish(scene, half, 0.0_wp, .true.))
      are_unique = are_unique .and. all(abs(force) <= most_left .or. .not. self%closed)
    end do
    self%unique = are_unique
  end function are_unique
end module epcont_linear_joined_response
