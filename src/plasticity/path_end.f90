!> End of a path of loads, from which another path can start.
module epcont_plasticity_path_end
  use epcont_base_archive, only: archive
  use epcont_base_kinds, only: wp
  use epcont_contact_problem, only: contact_solved
  use epcont_linear_solved_state, only: solved_state
  use epcont_material_material_law, only: plastic_history
  use epcont_model_arrays, only: body_load
  use epcont_model_load_set, only: load_set
  implicit none
  private
  public :: path_end

  type :: path_end
    type(load_set) :: loads
    type(plastic_history), allocatable :: history(:)   !! [points]
    type(solved_state) :: state
  contains
    procedure :: pass
  end type path_end

contains

  !> Store the end in an archive, or restore it.
  pure subroutine pass(self, file)
    class(path_end), intent(inout) :: self
    type(archive), intent(inout) :: file
    real(wp), allocatable :: history(:), mass_loads(:)

    associate (loads => self%loads, state => self%state, contact => self%state%contact)
      if (.not. file%reading) mass_loads = transfer(loads%body_load, [0.0_wp])
      call file%pass(mass_loads)
      loads%body_load = transfer(mass_loads, [body_load()])
      call file%pass(loads%load)
      call file%pass(loads%prescribed)
      call file%pass(loads%travel)
      call file%pass(loads%beyond_travel)
      call file%pass(loads%rotation)
      call file%pass(loads%rise)
      call file%pass(loads%body_force)
      if (allocated(self%history)) history = transfer(self%history, [0.0_wp])
      call file%pass(history)
      if (allocated(history)) self%history = transfer(history, [plastic_history()])
      call file%pass(state%displacement)
      call file%pass(state%deformation)
      call file%pass(state%strain)
      call file%pass(state%point_stress)
      call file%pass(contact%force)
      call file%pass(contact%gap)
      call file%pass(contact%approach)
      call file%pass(contact%touching)
      call file%pass(contact%at_upper)
      call file%pass(contact%indeterminate)
      call file%pass(contact%motion_free)
      call file%pass(contact%friction_force)
      call file%pass(contact%slip)
      call file%pass(contact%sticking)
      contact%state = contact_solved
    end associate
  end subroutine pass
end module epcont_plasticity_path_end
