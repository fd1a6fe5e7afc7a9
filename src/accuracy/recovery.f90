!> Smooth strains from those of the elements (Zienkiewicz and Zhu 1992, superconvergent patch recovery).
!>
!> At each corner a polynomial is fitted by least squares to the strains of the elements around it, at the points where they are
!> best: the middles of three- and four-node elements (linear), the integration points of six-node ones (quadratic). Nodes
!> between corners take the mean of the polynomials of both.
module epcont_accuracy_recovery
  use epcont_accuracy_patches, only: patch_table, wide_patch
  use epcont_base_kinds, only: wp
  use epcont_element_element, only: local_points, most_points, shape_values
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: recover_strains

  !> Terms of a quadratic polynomial: 1, x, y, x**2, xy, y**2.
  integer, parameter :: quadratic = 6
  !> Samples that a patch must have for each number of terms, or it is widened.
  integer, parameter :: least_linear = 4, least_quadratic = 9
  !> Part of a pivot that must be left for its term to be told from those before.
  real(wp), parameter :: dependent = 1.0e-8_wp

  !> Strains to fit to: one an element, or three of a six-node one.
  type :: sample_table
    integer, allocatable :: first(:)       !! of each element [elements + 1]
    real(wp), allocatable :: x(:, :)       !! [length] [2, samples]
    real(wp), allocatable :: strain(:, :)  !! [4, samples]
  end type sample_table

contains

  !> Strains at the places of a table [4, places].
  pure function recover_strains(model, table, volume, strain) result(smooth)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    real(wp), intent(in) :: volume(:)      !! of the integration points [points]
    real(wp), intent(in) :: strain(:, :)   !! xx, yy, zz, xy [4, points]
    real(wp), allocatable :: smooth(:, :)
    type(sample_table) :: sample
    integer, allocatable :: seen(:), patch(:)
    integer, allocatable :: fitted(:)      !! polynomials that a node between corners has had [places]
    real(wp), allocatable :: node(:, :)    !! coordinates of the places [2, places]
    integer :: count, e, k, p
    logical :: curved

    sample = take_samples(model, volume, strain)
    allocate (smooth(4, table%places), node(2, table%places), fitted(table%places))
    smooth = 0.0_wp
    fitted = 0
    do e = 1, model%elements
      do k = 1, model%order(e)
        node(:, table%place(k, e)) = model%x(:, model%connectivity(k, e))
        if (k > model%corners(e)) fitted(table%place(k, e)) = -1
      end do
    end do
    allocate (seen(model%elements), source=0)
    allocate (patch(64))
    do p = 1, table%places
      count = table%around%start(p + 1) - table%around%start(p)
      if (count == 0 .or. fitted(p) /= 0) cycle
      curved = model%order(table%around%group(table%around%start(p))) == 6
      if (table%inside(p) .and. count >= merge(least_quadratic/3, least_linear, curved)) then
        if (count > size(patch)) patch = [patch, table%around%group]
        patch(:count) = table%around%group(table%around%start(p):table%around%start(p + 1) - 1)
      else
        call wide_patch(model, table, p, seen, patch, count)
      end if
      if (curved) then
        call fit_quadratic(model, table, sample, patch(:count), p, node, smooth, fitted)
      else
        call fit_linear(sample, patch(:count), node(:, p), smooth(:, p))
      end if
    end do
    do p = 1, table%places
      if (fitted(p) < -1) smooth(:, p) = smooth(:, p)/(-1 - fitted(p))
    end do
  end function recover_strains

  !> Where the strains of the elements are best.
  pure function take_samples(model, volume, strain) result(sample)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: volume(:), strain(:, :)
    type(sample_table) :: sample
    real(wp) :: place(2, most_points), weight(most_points), shape(6, most_points)
    integer :: e, k, p, s

    call local_points(6, place, weight)
    do k = 1, 3
      shape(:, k) = shape_values(6, place(:, k))
    end do
    allocate (sample%first(model%elements + 1))
    allocate (sample%x(2, model%points), sample%strain(4, model%points))
    s = 1
    do e = 1, model%elements
      sample%first(e) = s
      associate (node => model%connectivity(:, e), first => model%first_point(e), last => model%first_point(e + 1) - 1)
        select case (model%order(e))
        case (3)
          sample%x(:, s) = (model%x(:, node(1)) + model%x(:, node(2)) + model%x(:, node(3)))/3.0_wp
          sample%strain(:, s) = strain(:, first)
          s = s + 1
        case (4)
          sample%x(:, s) = 0.25_wp*(model%x(:, node(1)) + model%x(:, node(2)) + model%x(:, node(3)) + model%x(:, node(4)))
          sample%strain(:, s) = 0.0_wp
          do p = first, last
            sample%strain(:, s) = sample%strain(:, s) + strain(:, p)*(volume(p)/sum(volume(first:last)))
          end do
          s = s + 1
        case default
          do k = 1, 3
            sample%x(:, s) = matmul(model%x(:, node), shape(:, k))
            sample%strain(:, s) = strain(:, first + k - 1)
            s = s + 1
          end do
        end select
      end associate
    end do
    sample%first(model%elements + 1) = s
  end function take_samples

  !> The linear polynomial of one sample an element, at a place. A direction in which the samples do not spread is constant.
  pure subroutine fit_linear(sample, patch, at, value)
    type(sample_table), intent(in) :: sample
    integer, intent(in) :: patch(:)
    real(wp), intent(in) :: at(2)
    real(wp), intent(out) :: value(4)
    real(wp) :: mean(4), along(4), across(4), x, y, mx, my, xx, xy, yy, determinant
    integer :: i, s

    mx = 0.0_wp
    my = 0.0_wp
    xx = 0.0_wp
    xy = 0.0_wp
    yy = 0.0_wp
    mean = 0.0_wp
    along = 0.0_wp
    across = 0.0_wp
    do i = 1, size(patch)
      s = sample%first(patch(i))
      x = sample%x(1, s) - at(1)
      y = sample%x(2, s) - at(2)
      mx = mx + x
      my = my + y
      xx = xx + x*x
      xy = xy + x*y
      yy = yy + y*y
      mean = mean + sample%strain(:, s)
      along = along + x*sample%strain(:, s)
      across = across + y*sample%strain(:, s)
    end do
    mean = mean/size(patch)
    along = along - mx*mean
    across = across - my*mean
    xx = xx - mx*mx/size(patch)
    xy = xy - mx*my/size(patch)
    yy = yy - my*my/size(patch)
    determinant = xx*yy - xy*xy
    value = mean
    if (determinant > dependent*(xx + yy)**2) &
      value = mean - (mx*(yy*along - xy*across) + my*(xx*across - xy*along))/(determinant*size(patch))
  end subroutine fit_linear

  !> The quadratic polynomial about a corner: its value there, and added at the nodes on the sides that meet there.
  pure subroutine fit_quadratic(model, table, sample, patch, p, node, smooth, fitted)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(sample_table), intent(in) :: sample
    integer, intent(in) :: patch(:), p
    real(wp), intent(in) :: node(:, :)
    real(wp), intent(inout) :: smooth(:, :)
    integer, intent(inout) :: fitted(:)   !! of a node between: -1, less one for each polynomial
    real(wp) :: matrix(quadratic, quadratic), coefficient(4, quadratic), term(quadratic), reach, weight
    integer :: e, i, j, k, s

    reach = 0.0_wp
    do i = 1, size(patch)
      reach = max(reach, maxval(abs(sample%x(:, sample%first(patch(i))) - node(:, p))))
    end do
    matrix = 0.0_wp
    coefficient = 0.0_wp
    do i = 1, size(patch)
      do s = sample%first(patch(i)), sample%first(patch(i) + 1) - 1
        term = terms((sample%x(:, s) - node(:, p))/reach)
        weight = 1.0_wp/(0.1_wp + sum(term(2:3)**2))**2
        do j = 1, quadratic
          matrix(:, j) = matrix(:, j) + term*term(j)*weight
          coefficient(:, j) = coefficient(:, j) + sample%strain(:, s)*term(j)*weight
        end do
      end do
    end do
    call solve(matrix, coefficient)
    smooth(:, p) = coefficient(:, 1)
    do i = table%around%start(p), table%around%start(p + 1) - 1
      e = table%around%group(i)
      if (model%order(e) /= 6) cycle
      do k = 1, 3
        if (table%place(k, e) /= p .and. table%place(mod(k, 3) + 1, e) /= p) cycle
        associate (middle => table%place(3 + k, e))
          smooth(:, middle) = smooth(:, middle) + matmul(coefficient, terms((node(:, middle) - node(:, p))/reach))
          fitted(middle) = fitted(middle) - 1
        end associate
      end do
    end do
  end subroutine fit_quadratic

  pure function terms(x) result(term)
    real(wp), intent(in) :: x(2)
    real(wp) :: term(quadratic)

    term = [1.0_wp, x(1), x(2), x(1)**2, x(1)*x(2), x(2)**2]
  end function terms

  !> Solve the normal equations; a term that depends on those before is left out.
  pure subroutine solve(matrix, unknown)
    real(wp), intent(inout) :: matrix(:, :)    !! symmetric
    real(wp), intent(inout) :: unknown(:, :)   !! right-hand sides, then solutions [any, terms]
    real(wp) :: diagonal(size(matrix, 1))
    integer :: i, j, n

    n = size(matrix, 1)
    diagonal = [(matrix(i, i), i=1, n)]
    do i = 1, n
      if (matrix(i, i) <= dependent*diagonal(i)) then
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
