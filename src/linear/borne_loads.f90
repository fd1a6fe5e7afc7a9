!> Loads that have been solved for: load cases that are a multiple of them need no solve of their own.
!> The response of elastic bodies is linear in the loads, except for prescribed displacements.
module epcont_linear_borne_loads
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body
  use epcont_base_kinds, only: wp
  use epcont_flexibility_flexibility, only: gap_opening
  use epcont_linear_multiple, only: multiple_of
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: borne_loads

  type :: borne_loads
    logical :: keeps = .false.                         !! all bodies are elastic, and a load case may follow
    real(wp), allocatable :: force(:, :)               !! not allocated: zero [force] [directions, nodes]
    type(half_solved_body), allocatable :: half(:)     !! their forward substitution [bodies]
    real(wp), allocatable :: opening(:)                !! of gaps, by these forces alone [length] [pairs]
  contains
    procedure :: bear
    procedure, private :: give
  end type borne_loads

contains

  !> Forward substitution for loads, and the gaps that they open.
  subroutine bear(self, scene, bodies, force, half, opening)
    class(borne_loads), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies                     !! factored
    real(wp), intent(in) :: force(:, :)                              !! [force] [directions, nodes]
    type(half_solved_body), allocatable, intent(out) :: half(:)      !! [bodies]
    real(wp), allocatable, intent(out) :: opening(:)                 !! [length] [pairs]
    logical :: moved   ! supports have displacements

    moved = any(scene%model%loads%beyond_travel /= 0.0_wp)
    if (.not. moved) call self%give(force, half, opening)
    if (allocated(half)) return
    call bodies%add_forces(scene, force, .true., half)
    opening = gap_opening(scene%model, bodies%finish(scene, half, .true., .true.))
    if (moved .or. .not. self%keeps) return
    self%force = force
    self%half = half
    self%opening = opening
  end subroutine bear

  !> Return the results for loads that are a multiple of these; else leave them unallocated.
  pure subroutine give(self, force, half, opening)
    class(borne_loads), intent(in) :: self
    real(wp), intent(in) :: force(:, :)                              !! [force] [directions, nodes]
    type(half_solved_body), allocatable, intent(out) :: half(:)      !! [bodies]
    real(wp), allocatable, intent(out) :: opening(:)                 !! [length] [pairs]
    real(wp) :: times
    integer :: b

    if (.not. allocated(self%force)) return
    times = multiple_of(force, self%force)
    if (times == 0.0_wp) return
    half = self%half
    do b = 1, size(half)
      half(b)%inner = times*half(b)%inner
    end do
    opening = times*self%opening
  end subroutine give
end module epcont_linear_borne_loads
