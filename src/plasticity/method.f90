!> What the loop asks of an iteration method: a linear law about a state, and from what that law finds the
!> next state.
module epcont_plasticity_method
  use epcont_base_kinds, only: wp
  use epcont_material_linear_law, only: linear_law
  use epcont_material_scene_materials, only: scene_materials
  use epcont_model_model, only: model_type
  use epcont_linear_scene_state, only: scene_state
  implicit none
  private
  public :: plastic_method

  type, abstract :: plastic_method
    real(wp), allocatable :: volume(:)     !! of each integration point [length**3] [points]
    logical :: keeps_stiffness = .false.   !! the matrices of the law stay elastic: factors and flexibility serve again
    integer :: telling_steps = 2           !! behind that tell what is to come: a plain iteration's last are its slowest
  contains
    procedure :: restart
    procedure(linearise_about), deferred :: linearise
    procedure :: stiffen
    procedure(advance_from), deferred :: advance
  end type plastic_method

  abstract interface
    !> The law about a state, for the points that can yield; that of the others stays as it is.
    pure subroutine linearise_about(self, materials, about, law)
      import :: linear_law, plastic_method, scene_materials, scene_state
      class(plastic_method), intent(inout) :: self
      type(scene_materials), intent(in) :: materials
      type(scene_state), intent(in) :: about           !! its strain, and its points
      type(linear_law), intent(inout) :: law
    end subroutine linearise_about

    !> The state to linearise about next, when the law about `about` has led to `found`.
    pure subroutine advance_from(self, model, materials, part, found, about)
      import :: model_type, plastic_method, scene_materials, scene_state, wp
      class(plastic_method), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(scene_materials), intent(in) :: materials
      real(wp), intent(in) :: part                     !! of the loads
      type(scene_state), intent(in) :: found
      type(scene_state), intent(inout) :: about        !! displacement and strain; points only where they are known by then
    end subroutine advance_from
  end interface

contains

  !> Forget what was learnt: another load step begins.
  pure subroutine restart(self)
    class(plastic_method), intent(inout) :: self
  end subroutine restart

  !> Another law, where a stiffness made of the last could not be factored. Most methods have none.
  pure subroutine stiffen(self, materials, about, law, possible)
    class(plastic_method), intent(inout) :: self
    type(scene_materials), intent(in) :: materials
    type(scene_state), intent(in) :: about
    type(linear_law), intent(inout) :: law
    logical, intent(out) :: possible

    possible = .false.
  end subroutine stiffen
end module epcont_plasticity_method
