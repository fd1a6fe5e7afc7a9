!> Yielded elements that unload: total theory moves them back along the curve.
module epcont_plasticity_unloading
  use epcont_base_kinds, only: wp
  use epcont_material_material_law, only: point_state
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_unloaded

  !> A relative decrease of strain below this counts as none.
  real(wp), parameter :: least_fall = 1.0e-6_wp

contains

  !> Find yielded elements whose strain has decreased since the last load step, while the load grew.
  pure subroutine find_unloaded(model, point, tolerance, strained, unloaded, first)
    type(model_type), intent(in) :: model          !! model
    type(point_state), intent(in) :: point(:)      !! at this load [points]
    real(wp), intent(in) :: tolerance              !! of the iteration, relative: smaller decreases do not
                                                   !! count
    !> In: e of points that yielded at the last load, else 0; out: at this load [points]
    real(wp), intent(inout) :: strained(:)
    integer, intent(inout) :: unloaded             !! number of elements, each counted once for each load
    integer, intent(inout) :: first                !! one of them; 0 if there are no such elements
    logical :: fell(model%mesh%elements)
    integer :: p

    fell = .false.
    do p = 1, model%mesh%points
      associate (e => model%mesh%point_element(p), now => point(p))
        fell(e) = fell(e) .or. now%deviatoric < (1.0_wp - max(tolerance, least_fall))*strained(p)
        strained(p) = merge(now%deviatoric, 0.0_wp, now%yielded)
      end associate
    end do
    unloaded = unloaded + count(fell)
    if (first == 0) first = findloc(fell, .true., dim=1)
  end subroutine find_unloaded
end module epcont_plasticity_unloading
