!> METHOD NEWTON: consistent tangent, contact exact in each step, line search on the energy.
!>
!> Total theory makes the model a convex minimisation. Each step is a direction of decreasing energy, and all
!> points along it satisfy supports and contact, since both its ends do. The search finds the zero of the
!> slope (f_int - f).d, since differences of the energy itself are lost in rounding. Friction forces have no
!> energy: with friction, the contact forces at the end of the step are loads of the search.
module epcont_plasticity_newton
  use epcont_base_bracket, only: bracket
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_material_material_law, only: point_state
  use epcont_model_model, only: model_type
  use epcont_model_springs, only: spring_forces
  use epcont_plasticity_secant, only: secant_method
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: newton_method

  !> Parts of the secant matrix added to a tangent that could not be factored, tried in order.
  real(wp), parameter :: blends(4) = [1.0e-6_wp, 1.0e-4_wp, 1.0e-2_wp, 1.0_wp]
  !> The full step is taken if the slope at its end is at most this part of that at its start.
  real(wp), parameter :: flat_enough = 0.5_wp
  !> The search ends if the slope is at most this part of that at the start.
  real(wp), parameter :: found_enough = 0.1_wp
  !> Largest number of slopes in one search.
  integer, parameter :: most_slopes = 30

  type, extends(secant_method) :: newton_method
    !> Prescribed displacements and overlaps are part of the first step
    logical, private :: takes_full_step = .true.
  contains
    procedure :: linearise
    procedure :: stiffen
    procedure :: advance
  end type newton_method

contains

  !> Set the tangent law: stress(strain) + D (d strain), D = D_t + blend (D_secant - D_t). With a perfectly
  !! plastic curve D_t is semidefinite.
  pure subroutine linearise(self, p, about, linear)
    class(newton_method), intent(inout) :: self
    integer, intent(in) :: p                         !! number of the point
    type(solved_state), intent(in) :: about           !! with strains and points
    type(linear_problem), intent(inout) :: linear    !! its law is set
    real(wp) :: matrix(components, components)

    associate (material => linear%materials%section(linear%materials%of_point(p)), &
               strain => about%strain(:, p), state => about%point(p))
      linear%law%initial_stress(:, p) = 0.0_wp
      matrix = material%secant_matrix(state)
      if (state%yielded) &
        matrix = self%blend*matrix + (1.0_wp - self%blend)*material%tangent_matrix(state)
      if (state%plastic) linear%law%initial_stress(:, p) = state%stress - matmul(matrix, strain)
      call linear%law%set_matrix(p, matrix)
    end associate
  end subroutine linearise

  !> Choose the next of `blends`.
  pure subroutine stiffen(self, possible)
    class(newton_method), intent(inout) :: self
    logical, intent(out) :: possible                 !! there is a next one

    possible = self%blend < maxval(blends)
    if (possible) self%blend = minval(blends, mask=blends > self%blend)
  end subroutine stiffen

  !> Follow the step as far as the energy decreases.
  subroutine advance(self, model, linear, found, about)
    class(newton_method), intent(inout) :: self
    type(model_type), intent(in) :: model            !! model
    type(linear_problem), intent(in) :: linear       !! solved model
    type(solved_state), intent(in) :: found           !! with its points
    type(solved_state), intent(inout) :: about        !! displacement, strain and points
    type(point_state), allocatable :: point(:)
    real(wp), allocatable :: along(:, :), travel(:, :)
    real(wp) :: length, pushed

    along = found%strain - about%strain
    travel = found%displacement - about%displacement
    length = 1.0_wp
    pushed = 0.0_wp
    if (model%contact%has_friction()) pushed = work_of_contact()
    if (.not. self%takes_full_step) call find_length(length, point)
    self%takes_full_step = .false.
    if (length < 1.0_wp) then
      about%displacement = about%displacement + length*travel
      about%strain = about%strain + length*along
      call move_alloc(point, about%point)
    else
      call self%secant_method%advance(model, linear, found, about)
    end if

  contains

    !> Work of the contact forces at the end of the step, along the whole step.
    pure real(wp) function work_of_contact() result(work)
      real(wp), allocatable :: force(:)
      integer :: k

      force = found%contact%row_forces()
      work = 0.0_wp
      do k = 1, size(force)
        associate (start => model%contact%row_start(k:k + 1))
          work = work + force(k)*model%contact%opening(k, travel(:, &
            model%contact%row_node(start(1):start(2) - 1)))
        end associate
      end do
    end function work_of_contact

    !> Find the zero of the slope of the energy, from 0 to 1.
    subroutine find_length(length, point)
      real(wp), intent(out) :: length
      type(point_state), allocatable, intent(out) :: point(:)   !! at this length; not allocated for 1
      type(bracket) :: zero
      real(wp) :: begin, slope
      integer :: k

      length = 1.0_wp
      zero = bracket([0.0_wp, 1.0_wp], [slope_of(about%point, 0.0_wp), slope_of(found%point, 1.0_wp)])
      begin = zero%values(1)
      if (begin >= 0.0_wp .or. zero%values(2) <= -flat_enough*begin) return
      do k = 1, most_slopes
        length = zero%likely()
        point = linear%materials%states(about%strain + length*along)
        slope = slope_of(point, length)
        if (abs(slope) <= -found_enough*begin) return
        call zero%take(length, slope)
      end do
    end subroutine find_length

    !> Slope (f_int - f).d with the stresses of these states.
    real(wp) function slope_of(state, length) result(slope)
      type(point_state), intent(in) :: state(:)
      real(wp), intent(in) :: length   !! length along the step
      real(wp) :: work(size(state))
      integer :: p

      !$omp parallel do num_threads(threads_over(size(work)))
      do p = 1, size(work)
        work(p) = linear%operator%volume(p)*dot_product(state(p)%stress, along(:, p))
      end do
      !$omp end parallel do
      slope = -sum(model%loads%load*travel) - pushed
      do p = 1, size(work)   ! in fixed order
        slope = slope + work(p)
      end do
      if (size(model%constraints%spring) > 0) &
        slope = slope + sum(spring_forces(model, about%displacement + length*travel)*travel)
    end function slope_of
  end subroutine advance
end module epcont_plasticity_newton
