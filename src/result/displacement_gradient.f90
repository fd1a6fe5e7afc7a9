!> Size of displacement gradients: rotations and stretches so large that equilibrium and contact on the
!> undeformed shape differ from those on the deformed shape.
module epcont_result_displacement_gradient
  use epcont_base_kinds, only: wp
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: gradient_type, find_gradients

  !> Norm of a displacement gradient that is not small: a rotation by 4 degrees, a stretch by 10 %.
  real(wp), parameter :: large_gradient = 0.1_wp
  !> Part of the volume that may exceed it: at a corner, or at the end of a contact, some element always does.
  real(wp), parameter :: negligible_part = 0.01_wp

  type :: gradient_type
    real(wp) :: part = 0.0_wp         !! of the volume with large gradients; 0 if negligible
    integer :: worst = 0              !! element of the largest gradient
    real(wp) :: largest = 0.0_wp
  end type gradient_type

contains

  !> Find large gradients, and the largest.
  pure function find_gradients(model, volume, displacement) result(found)
    type(model_type), intent(in) :: model       !! model
    real(wp), intent(in) :: volume(:)           !! of the integration points [points]
    real(wp), intent(in) :: displacement(:, :)  !! [length] [2, nodes]
    type(gradient_type) :: found
    real(wp) :: gradient
    integer :: e
    logical :: rings

    rings = model%has_rings()
    do e = 1, model%mesh%elements
      gradient = norm_at(e)
      if (gradient > large_gradient) &
        found%part = found%part + sum(volume(model%mesh%first_point(e):model%mesh%first_point(e + 1) - 1))
      if (gradient <= found%largest) cycle
      found%largest = gradient
      found%worst = e
    end do
    found%part = found%part/max(sum(volume), tiny(1.0_wp))
    if (found%part < negligible_part) found%part = 0.0_wp

  contains

    !> Norm (Frobenius) of the displacement gradient from the corners of an element; in axisymmetric models
    !! the hoop strain, if larger.
    pure real(wp) function norm_at(e) result(norm)
      integer, intent(in) :: e
      real(wp) :: p(2), q(2), radius, s(2), t(2)
      integer :: n

      n = model%mesh%corners(e)
      associate (node => model%mesh%connectivity(:n, e), x => model%mesh%x, u => displacement)
        ! From the diagonals of a quadrilateral, or two edges of a triangle: gradient (s t) = (p q).
        t = x(:, node(n - 1)) - x(:, node(max(1, n - 3)))
        q = u(:, node(n - 1)) - u(:, node(max(1, n - 3)))
        s = x(:, node(n)) - x(:, node(n - 2))
        p = u(:, node(n)) - u(:, node(n - 2))
        norm = sqrt(sum((p*t(2) - q*s(2))**2) + sum((q*s(1) - p*t(1))**2))/abs(s(1)*t(2) - s(2)*t(1))
        if (.not. rings) return
        radius = sum(x(1, node))
        if (radius > 0.0_wp) norm = max(norm, abs(sum(u(1, node)))/radius)
      end associate
    end function norm_at
  end function find_gradients
end module epcont_result_displacement_gradient
