!> How far displacements are from small: what of the bodies turns or stretches so much that equilibrium and contact on the
!> undeformed shape are no longer those of the deformed one.
module epcont_result_gradient
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: axisymmetric, model_type
  implicit none
  private
  public :: gradient_type, find_gradients

  !> Norm of the displacement gradient that is no longer small: a turn by 4 degrees, a stretch by 10 %.
  real(wp), parameter, public :: large_gradient = 0.1_wp
  !> Part of the volume that may be beyond it: at a corner, or at the end of a contact, some element always is.
  real(wp), parameter :: negligible_part = 0.01_wp

  type :: gradient_type
    real(wp) :: part = 0.0_wp         !! of the volume, beyond that; 0 where it is negligible
    integer :: worst = 0              !! element of the largest
    real(wp) :: largest = 0.0_wp
  end type gradient_type

contains

  pure function find_gradients(model, volume, displacement) result(found)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: volume(:)           !! of the integration points [points]
    real(wp), intent(in) :: displacement(:, :)  !! [length] [2, nodes]
    type(gradient_type) :: found
    real(wp) :: gradient, own
    integer :: e

    do e = 1, model%elements
      gradient = norm(model, e, displacement)
      own = sum(volume(model%first_point(e):model%first_point(e + 1) - 1))
      if (gradient > large_gradient) found%part = found%part + own
      if (gradient <= found%largest) cycle
      found%largest = gradient
      found%worst = e
    end do
    found%part = found%part/max(sum(volume), tiny(1.0_wp))
    if (found%part < negligible_part) found%part = 0.0_wp
  end function find_gradients

  !> Norm (Frobenius) of the displacement gradient, by the corners of an element; of rings the stretch around, if that is more.
  pure real(wp) function norm(model, e, displacement)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    real(wp), intent(in) :: displacement(:, :)
    real(wp) :: across(2, 2), adjoint(2, 2), change(2, 2), radius

    associate (node => model%connectivity(:model%corners(e), e))
      associate (x => model%x(:, node), u => displacement(:, node), last => size(node))
        ! Of a quadrilateral its diagonals, of a triangle two sides.
        across = reshape([x(:, last) - x(:, last - 2), x(:, last - 1) - x(:, max(1, last - 3))], [2, 2])
        change = reshape([u(:, last) - u(:, last - 2), u(:, last - 1) - u(:, max(1, last - 3))], [2, 2])
        radius = sum(x(1, :))
        norm = 0.0_wp
        if (model%kinematics(model%section(e)) == axisymmetric .and. radius > 0.0_wp) norm = abs(sum(u(1, :)))/radius
      end associate
    end associate
    adjoint = reshape([across(2, 2), -across(2, 1), -across(1, 2), across(1, 1)], [2, 2])
    norm = max(norm, norm2(matmul(change, adjoint))/abs(across(1, 1)*across(2, 2) - across(1, 2)*across(2, 1)))
  end function norm
end module epcont_result_gradient
