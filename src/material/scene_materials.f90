!> The materials of a scene: which law each section has, made once, and the states of all integration points.
module epcont_material_scene_materials
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: plane_stress
  use epcont_material_curve, only: new_curve
  use epcont_material_elasticity, only: new_elasticity
  use epcont_material_material_law, only: material_law, point_state
  use epcont_material_total_theory, only: total_theory
  use epcont_model_model, only: model_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: scene_materials, find_materials

  !> The law of one section.
  type :: section_law
    class(material_law), allocatable :: law
  end type section_law

  type :: scene_materials
    type(section_law), allocatable :: section(:)   !! [sections]
    integer, allocatable :: of_point(:)            !! section of each integration point [points]
    logical, allocatable :: can_yield(:)           !! the point can [points]
    logical :: yields = .false.                    !! does any section?
  contains
    procedure :: states
    procedure :: measure
  end type scene_materials

contains

  !> The law of each section, as the deck has it.
  pure subroutine find_materials(model, materials)
    type(model_type), intent(in) :: model             !! the scene
    type(scene_materials), intent(out) :: materials   !! of its sections and points
    type(total_theory) :: law
    logical :: yields(size(model%young))
    integer :: s

    allocate (materials%section(size(model%young)))
    do s = 1, size(model%young)
      law%elasticity = new_elasticity(model%young(s), model%poisson(s))
      law%sheet = model%kinematics(s) == plane_stress
      law%yields = allocated(model%curve(s)%strain)
      if (law%yields) law%yield_stress = model%curve(s)%stress(2)
      law%curve = new_curve(model%curve(s), law%elasticity, model%controls%paper_ratio)
      materials%section(s)%law = law
      yields(s) = law%yields
    end do
    materials%yields = any(yields)
    materials%of_point = model%section(model%point_element)
    materials%can_yield = yields(materials%of_point)
  end subroutine find_materials

  !> The states of all points at their strains [points].
  function states(self, strain) result(state)
    class(scene_materials), intent(in) :: self
    real(wp), intent(in) :: strain(:, :)   !! [components, points]
    type(point_state), allocatable :: state(:)
    integer :: p

    allocate (state(size(strain, 2)))
    !$omp parallel do num_threads(threads_over(size(state)))
    do p = 1, size(state)
      call self%section(self%of_point(p))%law%update(strain(:, p), point_state(), state(p))
    end do
    !$omp end parallel do
  end function states

  !> How far stresses are from those of the materials, by `distance`, at most, and how many elements yield.
  subroutine measure(self, model, state, stress, farthest, yielded)
    class(scene_materials), intent(in) :: self
    type(model_type), intent(in) :: model        !! the scene
    type(point_state), intent(in) :: state(:)    !! [points]
    real(wp), intent(in) :: stress(:, :)         !! xx, yy, zz, xy [stress] [components, points]
    real(wp), intent(out) :: farthest            !! 0 where nothing can yield
    integer, intent(out) :: yielded              !! elements
    integer :: e, p

    farthest = 0.0_wp
    yielded = 0
    !$omp parallel do num_threads(threads_over(model%elements)) private(p) &
    !$omp reduction(max: farthest) reduction(+: yielded)
    do e = 1, model%elements
      if (.not. model%can_yield(e)) cycle
      associate (law => self%section(model%section(e))%law, &
                 first => model%first_point(e), last => model%first_point(e + 1) - 1)
        do p = first, last
          farthest = max(farthest, law%distance(state(p), stress(:, p)))
        end do
        if (any(state(first:last)%yielded)) yielded = yielded + 1
      end associate
    end do
    !$omp end parallel do
  end subroutine measure
end module epcont_material_scene_materials
