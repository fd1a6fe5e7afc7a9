!> Response of joined bodies to unit loads with the final active set, solved with its factor,
!> all in common solves; and a check that the contact forces are unique.
module epcont_linear_joined_response
  use epcont_assembly_bodies, only: factored_bodies, force_fields, half_solved_body
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_problem
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: gap_opening, pair_forces, terms_of_openings
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linear_contact_rule, only: contact_loads, contact_sensitivity
  use epcont_linear_joined_springs, only: add_suport_forces, joined_springs, suport_values
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_arrays, only: angle
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: are_unique, respond_joined, sensitivity_probe

  !> Largest residual of a solve for unit forces that open gaps.
  real(wp), parameter :: most_left = 0.1_wp
  !> Gap openings that modes explain up to this fraction cause no forces: springs of SUPORT
  !! DOFs leave this much.
  real(wp), parameter :: as_motions = 1.0e-5_wp

  !> Response of joined bodies to some loads, with fixed active set.
  type :: frozen_response
    real(wp), allocatable :: load(:, :)      !! along the modes [force] [modes, any]
    real(wp), allocatable :: opening(:, :)   !! of the gaps [length] [pairs, any]
    real(wp), allocatable :: force(:, :)     !! [force] [pairs, any]
    real(wp), allocatable :: displacement(:, :, :)   !! [length] [directions, any, nodes]
  contains
    procedure :: solve
  end type frozen_response

  !> Two columns that estimate the 1-norms of D M (`simplex_response.f90`) by Higham and Tisseur: D is the sum
  !! of magnitudes of gap contributions: by bodies, computed from the deformation, and by rigid displacements.
  type :: sensitivity_probe
    !> Result of a first solve for the two columns; not allocated before it [pairs, 2]
    real(wp), allocatable :: first(:, :)
    !> Relative change of the largest force by relative errors of these sums
    real(wp) :: change(2) = 0.0_wp
  contains
    procedure, private :: turn
    procedure :: found
  end type sensitivity_probe

contains

  !> Find forces under unit loads along modes, then of closing gaps, and under the columns of the probe after
  !! them. The second solve refines the loads, and has the columns that follow from the first. If the
  !! probe has a first solve, the loads are known.
  subroutine respond_joined(springs, scene, bodies, problem, state, probe, loads)
    class(joined_springs), intent(in) :: springs
    type(planned_model), intent(in) :: scene         !! already solved
    class(factored_bodies), intent(inout) :: bodies  !! factored with the active set
    type(contact_problem), intent(in) :: problem     !! its gaps and motions
    class(solved_state), intent(in) :: state         !! solution with some contact
    type(sensitivity_probe), intent(inout) :: probe
    type(contact_loads), intent(inout) :: loads      !! modes, and weights by which gaps close
    type(frozen_response) :: found
    integer, allocatable :: pressed(:)
    integer :: k, many

    many = size(loads%motion) + size(loads%share, 2)
    if (allocated(probe%first)) many = 0
    pressed = pack([(k, k=1, scene%model%contact%rows())], problem%between(state%contact%row_forces()))
    allocate (found%load(scene%motions%count, many + 2), &
              found%opening(scene%model%contact%rows(), many + 2), &
              found%force(scene%model%contact%rows(), many + 2), &
              found%displacement(directions, many + 2, scene%model%mesh%nodes), source=0.0_wp)
    associate (probes => [many + 1, many + 2])
      if (.not. allocated(probe%first)) then
        do k = 1, size(loads%motion)
          found%load(loads%motion(k), k) = 1.0_wp
        end do
        found%opening(:, size(loads%motion) + 1:many) = -loads%share
        found%opening(:, probes) = first_columns(pressed, scene%model%contact%rows())
        call found%solve(springs, scene, bodies, at_contact=.true.)
        probe%first = found%force(:, probes)
      end if
      call probe%turn(scene, problem, state, found%opening(:, many + 1:))
      found%force(:, probes) = 0.0_wp
      found%displacement(:, probes, :) = 0.0_wp
      call found%solve(springs, scene, bodies, at_contact=many == 0)
      probe%change = max(probe%change, &
                         maxval(abs(found%force(pressed, probes)), dim=1)/maxval(state%contact%force))
    end associate
    if (many > 0) call take_response(scene, problem%motion, pressed, found, loads)
  end subroutine respond_joined

  !> Take forces and displacements of the loads; zero forces if modes close the gaps.
  subroutine take_response(scene, motion, pressed, found, loads)
    type(planned_model), intent(in) :: scene
    type(motion_matrix), intent(in) :: motion        !! A
    integer, intent(in) :: pressed(:)                !! pairs with a force
    type(frozen_response), intent(inout) :: found
    type(contact_loads), intent(inout) :: loads
    integer :: j, many, motions

    motions = size(loads%motion)
    many = motions + size(loads%share, 2)
    if (allocated(loads%shared)) deallocate (loads%shared)   ! of the load case before, if the rule was new
    allocate (loads%shared(scene%motions%count, many - motions))
    do j = motions + 1, many
      associate (q => suport_values(scene, found%displacement(:, j, :)))
        if (gives_way(motion, pressed, found%opening(:, j), q)) found%force(:, j) = 0.0_wp
        loads%shared(:, j - motions) = -q
      end associate
    end do
    loads%force = found%force(:, :many)
    loads%displacement = found%displacement(:, :many, :)
    loads%sound = .true.
  end subroutine take_response

  !> Find forces and displacements under loads and openings in one solve; it reduces the error of known forces
  !! to a thousandth or less. Springs at SUPORT DOFs carry the forces of known displacements.
  subroutine solve(found, springs, scene, bodies, at_contact)
    class(frozen_response), intent(inout) :: found
    class(joined_springs), intent(in) :: springs
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies !! factored with the active set
    logical, intent(in) :: at_contact               !! compute only displacements that gaps depend on
    type(force_fields) :: loads
    integer :: k

    loads%node = [(k, k=1, scene%model%mesh%nodes)]
    associate (force => found%force, u => found%displacement)
      allocate (loads%force(directions, size(force, 2), size(loads%node)))
      do k = 1, size(force, 2)
        where (springs%closed) force(:, k) = force(:, k) - springs%gamma*found%opening(:, k)
        loads%force(:, k, :) = pair_forces(scene%model, merge(force(:, k), 0.0_wp, springs%closed))
        call add_suport_forces(scene, found%load(:, k) + springs%hold*suport_values(scene, u(:, k, :)), &
                               loads%force(:, k, :))
      end do
      ! Rotations come from the nodes of their RBE2.
      call bodies%body_displacements(scene, 1, loads, loads%node, u, &
                                     at_contact .and. all(scene%motions%component /= angle))
      do k = 1, size(force, 2)
        where (springs%closed) force(:, k) = force(:, k) - springs%gamma*gap_opening(scene%model, u(:, k, :))
      end do
    end associate
  end subroutine solve

  !> Equal entries, and an alternating column for the parts that cancel in these [pairs, 2].
  pure function first_columns(pressed, pairs) result(x)
    integer, intent(in) :: pressed(:), pairs   !! pairs with a force; number of pairs
    real(wp) :: x(pairs, 2)
    integer :: k

    x = 0.0_wp
    x(pressed, 1) = 1.0_wp/size(pressed)
    x(pressed, 2) = [((1 - 2*mod(k, 2))*(1.0_wp + (k - 1.0_wp)/size(pressed)), k=1, size(pressed))]
    x(:, 2) = x(:, 2)/sum(abs(x(:, 2)))
  end function first_columns

  !> Compute the norms from the first solve, and the next column for each: the largest
  !! entry of M'D is a bound, too.
  subroutine turn(self, scene, problem, state, x)
    class(sensitivity_probe), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    type(contact_problem), intent(in) :: problem
    class(solved_state), intent(in) :: state
    real(wp), intent(out) :: x(:, :)
    !> Sums of magnitudes of gap contributions, by deformations and by rigid displacements [length]
    real(wp) :: sums(scene%model%contact%rows(), 2)
    real(wp) :: of_column(2, 2)   ! by sums and columns
    integer :: k

    associate (contact => state%contact)
      sums(:, 1) = terms_of_openings(scene%model, state%deformation)
      sums(:, 2) = abs(problem%initial_gap) + problem%motion%times(contact%approach, magnitudes=.true.)
      where (spread(.not. problem%between(contact%row_forces()), 2, 2)) sums = 0.0_wp
      of_column = matmul(transpose(sums), abs(self%first))/maxval(contact%force)
    end associate
    self%change = maxval(of_column, dim=2)
    do k = 1, 2
      x(:, k) = sums(:, k)*sign(1.0_wp, self%first(:, maxloc(of_column(k, :), dim=1)))
    end do
  end subroutine turn

  !> Compute the sensitivity of the forces. Their error is the change in the last step of the contact, plus
  !! that of the gap contributions.
  pure type(contact_sensitivity) function found(self, condition, correction)
    class(sensitivity_probe), intent(in) :: self
    real(wp), intent(in) :: condition    !! of the stiffness
    real(wp), intent(in) :: correction   !! of forces in the last step, over the largest

    associate (off => epsilon(1.0_wp)*self%change)
      found = contact_sensitivity(.true., self%change(1), &
        min(1.0_wp, min(condition*off(1), correction + off(1)) + off(2)))
    end associate
  end function found

  !> Do the modes of a solve open the gaps of the pressed pairs in the same way? Then there are no forces.
  pure logical function gives_way(motion, pressed, opening, q)
    type(motion_matrix), intent(in) :: motion          !! A
    integer, intent(in) :: pressed(:)                  !! pairs
    real(wp), intent(in) :: opening(:), q(:)           !! [pairs], [motions]
    real(wp) :: rest(size(opening))

    rest = opening - motion%times(q)
    gives_way = norm2(rest(pressed)) <= as_motions*norm2(opening(pressed))
  end function gives_way

  !> Are the contact forces unique? Forces that open no gaps remain after a solve for arbitrary forces; two
  !! given forces are unlikely both to be free of them.
  logical function are_unique(springs, scene, bodies)
    class(joined_springs), intent(in) :: springs
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies    !! factored with the active set
    type(half_solved_body), allocatable :: half(:)
    real(wp) :: force(scene%model%contact%rows())
    integer :: j, k

    are_unique = .true.
    do j = 1, 2
      force = merge(cos([(k*sqrt(real(j, wp)), k=1, size(force))]), 0.0_wp, springs%closed)
      if (j > 1) deallocate (half)
      call bodies%add_forces(scene, pair_forces(scene%model, force), .false., half)
      force = force - springs%gamma*gap_opening(scene%model, bodies%finish(scene, half, .false., .true.))
      are_unique = are_unique .and. all(abs(force) <= most_left .or. .not. springs%closed)
    end do
  end function are_unique
end module epcont_linear_joined_response
