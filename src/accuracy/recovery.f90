!> Recovered (smooth) strains from element strains: superconvergent patch recovery (Zienkiewicz and Zhu 1992).
!>
!> At each corner node, a polynomial is fitted by least squares to the strains of the elements around it
!> (`patches.f90`) at their sampling points: the centres of three- and four-node elements (linear), interior
!> points of elements with mid-side nodes (quadratic). Mid-side nodes take the mean of the polynomials of both
!> corners.
module epcont_accuracy_recovery
  use epcont_accuracy_patches, only: patch_table, wide_patch
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits
  use epcont_model_model, only: model_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: recover

  !> Terms of a quadratic polynomial: 1, x, y, x**2, xy, y**2.
  integer, parameter :: quadratic = 6
  !> Number of samples that a patch must have; with fewer it is widened.
  integer, parameter :: least_linear = 4, least_quadratic = 9

contains

  !> Recover strains at the recovery points of a body, for several fields at once.
  subroutine recover(model, table, b, width, strain, smooth)
    type(model_type), intent(in) :: model        !! model
    type(patch_table), intent(in) :: table       !! of its elements
    integer, intent(in) :: b                     !! the body
    integer, intent(in) :: width                 !! components of all fields
    real(wp), intent(in) :: strain(width, *)     !! at the sampling points of the body [width, samples]
    real(wp), intent(inout) :: smooth(width, *)  !! [width, its places]
    real(wp), allocatable :: x(:, :)
    integer, allocatable :: place(:)
    integer :: i

    place = table%of_body%of(b)
    x = table%points_of(b)
    smooth(:, :size(place)) = 0.0_wp
    ! Corners add to the mid-side nodes next to them, so elements with such nodes use one thread.
    !$omp parallel do num_threads(merge(1, threads_over(size(place)), any(table%fits(place) > 0)))
    do i = 1, size(place)
      if (table%fits(place(i)) == 0) &
        call recover_place(model, table, place(i), x, strain(:, :size(x, 2)), smooth(:, :size(place)))
    end do
    !$omp end parallel do
    do i = 1, size(place)
      if (table%fits(place(i)) > 0) smooth(:, i) = smooth(:, i)/table%fits(place(i))
    end do
  end subroutine recover

  !> Has any of these elements mid-side nodes?
  pure logical function has_curved(model, elements)
    type(model_type), intent(in) :: model
    integer, intent(in) :: elements(:)
    integer :: k

    has_curved = .false.
    do k = 1, size(elements)
      has_curved = has_curved .or. model%mesh%kinds(model%mesh%kind(elements(k)))%degree > 1
    end do
  end function has_curved

  !> Fit the polynomials at a recovery point.
  subroutine recover_place(model, table, p, x, strain, smooth)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: p                     !! the point
    real(wp), intent(in) :: x(:, :)              !! sampling points of the body [length]
    real(wp), contiguous, intent(in) :: strain(:, :)      !! at these
    real(wp), contiguous, intent(inout) :: smooth(:, :)   !! of the body
    integer, allocatable :: wide(:)
    logical :: curved

    associate (narrow => table%around%group(table%around%start(p):table%around%start(p + 1) - 1))
      if (size(narrow) == 0) return
      curved = has_curved(model, narrow)
      if (table%inside(p) .and. size(narrow) >= merge(least_quadratic/3, least_linear, curved)) then
        call fit(narrow)
      else
        call wide_patch(model, table, p, wide)
        call fit(wide)
      end if
    end associate

  contains

    !> Fit the polynomials with the samples of a patch.
    subroutine fit(patch)
      integer, intent(in) :: patch(:)

      if (curved) then
        call fit_quadratic(model, table, p, patch, x, strain, smooth)
      else
        call fit_linear(table%before, patch, x, model%mesh%x(:, table%node(p)), strain, &
                        smooth(:, table%own(p)))
      end if
    end subroutine fit
  end subroutine recover_place

  !> Find the value of the linear polynomials at a point, as a weighted sum of one sample for each element. In
  !! a direction in which the samples do not spread, the polynomial is constant.
  pure subroutine fit_linear(before, patch, x, centre, strain, here)
    integer, intent(in) :: before(:)             !! samples before those of each element
    integer, intent(in) :: patch(:)              !! its elements
    real(wp), intent(in) :: x(:, :)              !! sampling points of the body [length]
    real(wp), intent(in) :: centre(2)            !! the point [length]
    real(wp), contiguous, intent(in) :: strain(:, :)   !! at the sampling points
    real(wp), intent(inout) :: here(size(strain, 1))   !! zero on entry
    real(wp) :: determinant, from(2), mean(2), slope(2)
    real(wp) :: xx, xy, yy   !! moments of the samples about the point, then about their centre
    integer :: k, n

    n = size(patch)
    mean = 0.0_wp
    xx = 0.0_wp
    xy = 0.0_wp
    yy = 0.0_wp
    do k = 1, n
      from = x(:, before(patch(k)) + 1) - centre
      mean = mean + from
      xx = xx + from(1)**2
      xy = xy + from(1)*from(2)
      yy = yy + from(2)**2
    end do
    mean = mean/n
    xx = xx - n*mean(1)**2
    xy = xy - n*mean(1)*mean(2)
    yy = yy - n*mean(2)**2
    determinant = xx*yy - xy*xy
    slope = 0.0_wp
    if (determinant > lost_digits*(xx + yy)**2) &
      slope = [mean(1)*yy - mean(2)*xy, mean(2)*xx - mean(1)*xy]/determinant
    do k = 1, n
      from = x(:, before(patch(k)) + 1) - centre - mean
      here = here + (1.0_wp/n - slope(1)*from(1) - slope(2)*from(2))*strain(:, before(patch(k)) + 1)
    end do
  end subroutine fit_linear

  !> Fit the quadratic polynomials at a corner. Find their values there, and add their values at the nodes on
  !! the edges that meet there.
  pure subroutine fit_quadratic(model, table, p, patch, x, strain, smooth)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: p, patch(:)           !! the corner, its patch
    real(wp), intent(in) :: x(:, :)              !! sampling points of the body [length]
    real(wp), contiguous, intent(in) :: strain(:, :)      !! at these
    real(wp), contiguous, intent(inout) :: smooth(:, :)   !! of the body
    real(wp) :: matrix(quadratic, quadratic), term(quadratic), coefficient(size(strain, 1), quadratic)
    real(wp) :: centre(2), near, reach
    integer, allocatable :: sample(:)
    integer :: e, j, k, s

    centre = model%mesh%x(:, table%node(p))
    sample = [([(table%before(patch(k)) + s, s=1, model%mesh%kinds(model%mesh%kind(patch(k)))%samples)], &
               k=1, size(patch))]
    reach = 0.0_wp   ! treat all samples and directions alike, so that rotated models give rotated results
    do s = 1, size(sample)
      reach = reach + sum((x(:, sample(s)) - centre)**2)
    end do
    reach = sqrt(reach/size(sample))
    matrix = 0.0_wp
    coefficient = 0.0_wp
    do s = 1, size(sample)
      term = terms((x(:, sample(s)) - centre)/reach)
      near = 1.0_wp/(0.1_wp + sum(term(2:3)**2))**2
      do j = 1, quadratic
        matrix(:, j) = matrix(:, j) + term*term(j)*near
        coefficient(:, j) = coefficient(:, j) + strain(:, sample(s))*(term(j)*near)
      end do
    end do
    if (size(sample) < least_quadratic) matrix(:, 4:) = 0.0_wp   ! linear
    call solve(matrix, size(strain, 1), coefficient)
    smooth(:, table%own(p)) = coefficient(:, 1)
    do j = table%around%start(p), table%around%start(p + 1) - 1
      e = table%around%group(j)
      associate (place => table%place(:, e), corners => model%mesh%corners(e))
        do k = corners + 1, model%mesh%node_count(e)
          if (place(k - corners) /= p .and. place(mod(k - corners, corners) + 1) /= p) cycle
          associate (here => smooth(:, table%own(place(k))))
            here = here + matmul(coefficient, terms((model%mesh%x(:, table%node(place(k))) - centre)/reach))
          end associate
        end do
      end associate
    end do
  end subroutine fit_quadratic

  !> Terms of a quadratic polynomial at a point.
  pure function terms(x) result(term)
    real(wp), intent(in) :: x(2)
    real(wp) :: term(quadratic)

    term = [1.0_wp, x(1), x(2), x(1)**2, x(1)*x(2), x(2)**2]
  end function terms

  !> Solve the normal equations; terms that depend linearly on earlier terms are left out.
  pure subroutine solve(matrix, sides, unknown)
    real(wp), intent(inout) :: matrix(:, :)                        !! symmetric
    integer, intent(in) :: sides
    real(wp), intent(inout) :: unknown(sides, size(matrix, 1))     !! right-hand sides, then solutions
    real(wp) :: diagonal(size(matrix, 1))
    integer :: i, j, n

    n = size(matrix, 1)
    diagonal = [(matrix(i, i), i=1, n)]
    do i = 1, n
      if (matrix(i, i) <= lost_digits*diagonal(i)) then
        matrix(i, :) = 0.0_wp
        matrix(:, i) = 0.0_wp
        matrix(i, i) = 1.0_wp
        unknown(:, i) = 0.0_wp
        cycle
      end if
      do j = i + 1, n
        unknown(:, j) = unknown(:, j) - unknown(:, i)*(matrix(j, i)/matrix(i, i))
        matrix(j, i + 1:) = matrix(j, i + 1:) - matrix(j, i)/matrix(i, i)*matrix(i, i + 1:)
      end do
    end do
    do i = n, 1, -1
      do j = i + 1, n
        unknown(:, i) = unknown(:, i) - matrix(i, j)*unknown(:, j)
      end do
      unknown(:, i) = unknown(:, i)/matrix(i, i)
    end do
  end subroutine solve
end module epcont_accuracy_recovery
