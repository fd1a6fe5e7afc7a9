!> Materials of a model: the law of each section, and history and state of each integration point.
module epcont_material_model_materials
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: components, plane_stress
  use epcont_material_curve, only: new_curve
  use epcont_material_elasticity, only: new_elasticity
  use epcont_material_material_law, only: material_law, plastic_history, point_state
  use epcont_model_model, only: model_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: model_materials, find_materials

  type :: model_materials
    type(material_law), allocatable :: section(:)  !! [sections]
    integer, allocatable :: of_point(:)            !! section of each integration point [points]
    logical, allocatable :: can_yield(:)           !! the point can [points]
    logical :: yields = .false.                    !! a section can yield
    !> History after the previous increment; not allocated in total theory [points]
    type(plastic_history), allocatable :: committed(:)
  contains
    procedure :: commit
    procedure :: history
    procedure :: state_at
    procedure :: states
    procedure :: measure
  end type model_materials

contains

  !> Make the law of each section from the model's data.
  pure subroutine find_materials(model, materials)
    type(model_type), intent(in) :: model             !! model
    type(model_materials), intent(out) :: materials   !! of its sections and points
    logical :: yields(size(model%sections%young))
    integer :: s

    allocate (materials%section(size(model%sections%young)))
    do s = 1, size(model%sections%young)
      associate (law => materials%section(s))
        law%elasticity = new_elasticity(model%sections%young(s), model%sections%poisson(s))
        law%sheet = model%sections%kinematics(s) == plane_stress
        law%yields = allocated(model%sections%curve(s)%strain)
        law%remembers = law%yields .and. .not. model%sections%curve(s)%elastic
        if (law%yields) law%yield_stress = model%sections%curve(s)%stress(2)
        law%curve = new_curve(model%sections%curve(s), law%elasticity, model%controls%paper_ratio)
        if (model%sections%curve(s)%kinematic > 0.0_wp) then
          law%hardening = law%curve%hardening()
          law%kinematic = model%sections%curve(s)%kinematic*law%hardening
        end if
        yields(s) = law%yields
      end associate
    end do
    materials%yields = any(yields)
    materials%of_point = model%mesh%section(model%mesh%point_element)
    materials%can_yield = yields(materials%of_point)
  end subroutine find_materials

  !> Commit an increment of the loads: the next one starts from its states.
  subroutine commit(self, state)
    class(model_materials), intent(inout) :: self
    type(point_state), intent(in) :: state(:)      !! at its end [points]
    integer :: p

    if (.not. allocated(self%committed)) allocate (self%committed(size(state)))
    !$omp parallel do num_threads(threads_over(size(state)))
    do p = 1, size(state)
      associate (law => self%section(self%of_point(p)))
        self%committed(p) = law%history_after(self%committed(p), state(p))
      end associate
    end do
    !$omp end parallel do
  end subroutine commit

  !> History of a point.
  pure type(plastic_history) function history(self, point)
    class(model_materials), intent(in) :: self
    integer, intent(in) :: point

    if (allocated(self%committed)) history = self%committed(point)
  end function history

  !> Find the state of a point at a strain.
  pure type(point_state) function state_at(self, point, strain) result(state)
    class(model_materials), intent(in) :: self
    integer, intent(in) :: point
    real(wp), intent(in) :: strain(components)

    call self%section(self%of_point(point))%update(strain, self%history(point), state)
  end function state_at

  !> Find the states of all points at their strains [points].
  function states(self, strain) result(state)
    class(model_materials), intent(in) :: self
    real(wp), intent(in) :: strain(:, :)   !! [components, points]
    type(point_state), allocatable :: state(:)
    integer :: p

    allocate (state(size(strain, 2)))
    !$omp parallel do num_threads(threads_over(size(state)))
    do p = 1, size(state)
      call self%section(self%of_point(p))%update(strain(:, p), self%history(p), state(p))
    end do
    !$omp end parallel do
  end function states

  !> Find the largest stress error, by `distance`, and count the yielded elements.
  subroutine measure(self, model, state, stress, farthest, yielded)
    class(model_materials), intent(in) :: self
    type(model_type), intent(in) :: model        !! model
    type(point_state), intent(in) :: state(:)    !! [points]
    real(wp), intent(in) :: stress(:, :)         !! xx, yy, zz, xy [stress] [components, points]
    real(wp), intent(out) :: farthest            !! 0 if nothing can yield
    integer, intent(out) :: yielded              !! number of elements
    integer :: e, p

    farthest = 0.0_wp
    yielded = 0
    !$omp parallel do num_threads(threads_over(model%mesh%elements)) private(p) &
    !$omp reduction(max: farthest) reduction(+: yielded)
    do e = 1, model%mesh%elements
      if (.not. model%can_yield(e)) cycle
      associate (law => self%section(model%mesh%section(e)), &
                 first => model%mesh%first_point(e), last => model%mesh%first_point(e + 1) - 1)
        do p = first, last
          farthest = max(farthest, law%distance(state(p), stress(:, p)))
        end do
        if (any(state(first:last)%yielded)) yielded = yielded + 1
      end associate
    end do
    !$omp end parallel do
  end subroutine measure
end module epcont_material_model_materials
