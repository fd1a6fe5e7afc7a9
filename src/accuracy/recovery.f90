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
  use epcont_element_element_kind, only: element_kind
  use epcont_element_kinematics, only: components
  use epcont_model_model, only: model_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: body_samples, place_samples, recover

  !> Sampling points of one body's elements.
  type :: body_samples
    integer, allocatable :: element(:)     !! the elements
    !> Number of samples before those of each element of the body [elements of the model]
    integer, allocatable :: before(:)
    real(wp), allocatable :: x(:, :)       !! [length] [2, samples]
  contains
    procedure :: take
  end type body_samples

  !> State of the recovery in one body.
  type :: recovery_type
    type(model_type), pointer :: model => null()
    type(patch_table), pointer :: table => null()   !! of its elements
    integer :: fields = 0                           !! number of fields besides the answer
    integer, allocatable :: fits(:)   !! mid-side node: number of polynomials that reach it; corner node: -1
    integer, allocatable :: places(:)   !! recovery points of the body
    logical :: any_curved = .false.   !! elements of the body have mid-side nodes
  end type recovery_type

  !> Terms of a quadratic polynomial: 1, x, y, x**2, xy, y**2.
  integer, parameter :: quadratic = 6
  !> Number of samples that a patch must have; with fewer it is widened.
  integer, parameter :: least_linear = 4, least_quadratic = 9

contains

  !> Place the sampling points of a body.
  subroutine place_samples(model, element, samples)
    type(model_type), intent(in) :: model    !! model
    integer, intent(in) :: element(:)        !! those of the body
    type(body_samples), intent(inout) :: samples   !! empty, or of another body
    integer :: i, last

    samples%element = element
    ! once for all bodies
    if (.not. allocated(samples%before)) allocate (samples%before(model%mesh%elements))
    last = 0
    do i = 1, size(element)
      samples%before(element(i)) = last
      last = last + model%mesh%kinds(model%mesh%kind(element(i)))%samples
    end do
    if (allocated(samples%x)) deallocate (samples%x)
    allocate (samples%x(2, last))
    !$omp parallel do num_threads(threads_over(size(element)))
    do i = 1, size(element)
      call place_element(element(i))
    end do
    !$omp end parallel do

  contains

    !> Place the sampling points of an element.
    subroutine place_element(e)
      integer, intent(in) :: e
      integer :: k

      associate (node => model%mesh%connectivity(:model%mesh%node_count(e), e), &
                 kind => model%mesh%kinds(model%mesh%kind(e)), &
                 before => samples%before(e))
        if (kind%degree > 1) then
          do k = 1, kind%samples
            samples%x(:, before + k) = matmul(model%mesh%x(:, node), kind%sample_values(:kind%nodes, k))
          end do
        else
          samples%x(:, before + 1) = 0.0_wp
          do k = 1, kind%nodes   ! intrinsic `sum` copies the sections: several times as long
            samples%x(:, before + 1) = samples%x(:, before + 1) + model%mesh%x(:, node(k))
          end do
          samples%x(:, before + 1) = samples%x(:, before + 1)/kind%nodes
        end if
      end associate
    end subroutine place_element
  end subroutine place_samples

  !> Find the strains of an element with mid-side nodes at its sampling points.
  pure subroutine take(self, kind, element, width, strain, sample)
    class(body_samples), intent(in) :: self
    type(element_kind), intent(in) :: kind                !! of the element
    integer, intent(in) :: element                        !! its number
    integer, intent(in) :: width                          !! components of all fields
    real(wp), intent(in) :: strain(width, kind%points)    !! at its integration points
    real(wp), intent(inout) :: sample(width, *)           !! of the body [width, samples]
    integer :: k, p, s, v

    do k = 1, kind%samples
      s = self%before(element) + k
      do p = 1, kind%points
        do v = 1, width
          if (p == 1) sample(v, s) = 0.0_wp
          sample(v, s) = sample(v, s) + kind%sample_of(p, k)*strain(v, p)
        end do
      end do
    end do
  end subroutine take

  !> Recover strains at the recovery points of a body, for the answer and some fields at once.
  subroutine recover(model, table, b, samples, fields, strain, smooth)
    type(model_type), target, intent(in) :: model        !! model
    type(patch_table), target, intent(in) :: table       !! of its elements
    integer, intent(in) :: b                     !! the body
    type(body_samples), intent(in) :: samples   !! of its elements
    integer, intent(in) :: fields                !! number of fields besides the answer; others are unchanged
    real(wp), contiguous, intent(in) :: strain(:, 0:, :)        !! [components, fields or more, samples]
    real(wp), contiguous, intent(inout) :: smooth(:, 0:, :)     !! [components, fields or more, its places]
    type(recovery_type) :: work
    integer :: i

    work%model => model
    work%table => table
    work%fields = fields
    work%places = table%of_body%of(b)
    smooth(:, :fields, :) = 0.0_wp
    allocate (work%fits(size(smooth, 3)), source=-1)
    call find_middles(work, samples)
    associate (places => work%places)
      ! Corners add to the mid-side nodes next to them, so elements with such nodes use one thread.
      !$omp parallel do num_threads(merge(1, threads_over(size(places)), work%any_curved))
      do i = 1, size(places)
        if (work%fits(i) < 0) call recover_place(work, samples, strain, smooth, i)
      end do
      !$omp end parallel do
    end associate
    do i = 1, size(work%fits)
      if (work%fits(i) > 0) smooth(:, :fields, i) = smooth(:, :fields, i)/work%fits(i)
    end do
  end subroutine recover

  !> Find the mid-side nodes.
  subroutine find_middles(work, samples)
    type(recovery_type), intent(inout) :: work
    type(body_samples), intent(in) :: samples   !! of the body
    integer :: e, j, k

    work%any_curved = has_curved(work, samples%element)
    if (.not. work%any_curved) return
    do j = 1, size(samples%element)
      e = samples%element(j)
      do k = work%model%mesh%corners(e) + 1, work%model%mesh%node_count(e)
        work%fits(work%table%own(work%table%place(k, e))) = 0
      end do
    end do
  end subroutine find_middles

  !> Has any of these elements mid-side nodes?
  pure logical function has_curved(work, elements)
    type(recovery_type), intent(in) :: work
    integer, intent(in) :: elements(:)
    integer :: k

    has_curved = .false.
    do k = 1, size(elements)
      has_curved = has_curved .or. work%model%mesh%kinds(work%model%mesh%kind(elements(k)))%degree > 1
    end do
  end function has_curved

  !> Fit the polynomials at a recovery point, the i-th of the body.
  subroutine recover_place(work, samples, strain, smooth, i)
    type(recovery_type), intent(inout) :: work
    type(body_samples), intent(in) :: samples   !! of the body
    real(wp), contiguous, intent(in) :: strain(:, 0:, :)        !! at these
    real(wp), contiguous, intent(inout) :: smooth(:, 0:, :)     !! at its places
    integer, intent(in) :: i
    integer, allocatable :: patch(:)
    logical :: curved

    associate (p => work%places(i), around => work%table%around)
      associate (first => around%start(p), last => around%start(p + 1) - 1)
        if (last < first) return
        curved = work%any_curved
        if (work%any_curved) curved = has_curved(work, around%group(first:last))
        if (work%table%inside(p) .and. &
            last - first + 1 >= merge(least_quadratic/3, least_linear, curved)) then
          call fit(work, samples, strain, smooth, i, curved, around%group(first:last))
        else
          call wide_patch(work%model, work%table, p, patch)
          call fit(work, samples, strain, smooth, i, curved, patch)
        end if
      end associate
    end associate
  end subroutine recover_place

  !> Fit the polynomials at the i-th point with the samples of a patch.
  subroutine fit(work, samples, strain, smooth, i, curved, patch)
    type(recovery_type), intent(inout) :: work
    type(body_samples), intent(in) :: samples   !! of the body
    real(wp), contiguous, intent(in) :: strain(:, 0:, :)        !! at these
    real(wp), contiguous, intent(inout) :: smooth(:, 0:, :)     !! at its places
    integer, intent(in) :: i, patch(:)
    logical, intent(in) :: curved   !! elements of the patch have mid-side nodes

    if (curved) then
      call fit_quadratic(work, samples, strain, smooth, i, patch)
    else
      associate (x => work%model%mesh%x(:, work%table%node(work%places(i))))
        call fit_linear(work, samples, strain, patch, x(1), x(2), smooth(:, :work%fields, i))
      end associate
    end if
  end subroutine fit

  !> Find the value of the linear polynomials at a point, as a weighted sum of one sample for each element. In
  !! a direction in which the samples do not spread, the polynomial is constant.
  subroutine fit_linear(work, samples, strain, patch, x, y, here)
    type(recovery_type), intent(inout) :: work
    type(body_samples), intent(in) :: samples   !! of the body
    real(wp), contiguous, intent(in) :: strain(:, 0:, :)        !! at these
    integer, intent(in) :: patch(:)   !! elements
    real(wp), intent(in) :: x, y
    real(wp), intent(inout) :: here(components, 0:work%fields)   !! zero on entry
    real(wp) :: determinant, dx, dy, slope(2), weight
    real(wp) :: mx, my, xx, xy, yy   !! moments of the samples about the point, then about their centre
    integer :: f, k, n

    n = size(patch)
    mx = 0.0_wp
    my = 0.0_wp
    xx = 0.0_wp
    xy = 0.0_wp
    yy = 0.0_wp
    do k = 1, n
      dx = samples%x(1, samples%before(patch(k)) + 1) - x
      dy = samples%x(2, samples%before(patch(k)) + 1) - y
      mx = mx + dx
      my = my + dy
      xx = xx + dx*dx
      xy = xy + dx*dy
      yy = yy + dy*dy
    end do
    mx = mx/n
    my = my/n
    xx = xx - n*mx*mx
    xy = xy - n*mx*my
    yy = yy - n*my*my
    determinant = xx*yy - xy*xy
    slope = 0.0_wp
    if (determinant > lost_digits*(xx + yy)**2) slope = [mx*yy - my*xy, my*xx - mx*xy]/determinant
    do k = 1, n
      associate (at => samples%before(patch(k)) + 1)
        weight = 1.0_wp/n - slope(1)*(samples%x(1, at) - x - mx) - slope(2)*(samples%x(2, at) - y - my)
        do f = 0, work%fields
          here(:, f) = here(:, f) + weight*strain(:, f, at)
        end do
      end associate
    end do
  end subroutine fit_linear

  !> Fit the quadratic polynomials at a corner. Find their values there, and add their values at the nodes on
  !! the edges that meet there.
  subroutine fit_quadratic(work, samples, strain, smooth, i, patch)
    type(recovery_type), intent(inout) :: work
    type(body_samples), intent(in) :: samples   !! of the body
    real(wp), contiguous, intent(in) :: strain(:, 0:, :)        !! at these
    real(wp), contiguous, intent(inout) :: smooth(:, 0:, :)     !! at its places
    integer, intent(in) :: i, patch(:)
    real(wp) :: matrix(quadratic, quadratic), term(quadratic)
    real(wp) :: coefficient(components, 0:work%fields, quadratic)
    real(wp) :: centre(2), near, reach
    integer :: e, j, k, n, p, s

    p = work%places(i)
    centre = work%model%mesh%x(:, work%table%node(p))
    reach = 0.0_wp
    n = 0
    do k = 1, size(patch)   ! treat all samples and directions alike, so that rotated models give rotated
                            ! results
      do s = samples%before(patch(k)) + 1, samples%before(patch(k)) + samples_of(work, patch(k))
        reach = reach + sum((samples%x(:, s) - centre)**2)
        n = n + 1
      end do
    end do
    reach = sqrt(reach/n)
    matrix = 0.0_wp
    coefficient = 0.0_wp
    do k = 1, size(patch)
      do s = samples%before(patch(k)) + 1, samples%before(patch(k)) + samples_of(work, patch(k))
        term = terms((samples%x(:, s) - centre)/reach)
        near = 1.0_wp/(0.1_wp + sum(term(2:3)**2))**2
        do j = 1, quadratic
          matrix(:, j) = matrix(:, j) + term*term(j)*near
          coefficient(:, :, j) = coefficient(:, :, j) + strain(:, :work%fields, s)*(term(j)*near)
        end do
      end do
    end do
    if (n < least_quadratic) matrix(:, 4:) = 0.0_wp   ! linear
    call solve(matrix, components*(1 + work%fields), coefficient)
    smooth(:, :work%fields, i) = coefficient(:, :, 1)
    do j = work%table%around%start(p), work%table%around%start(p + 1) - 1
      e = work%table%around%group(j)
      associate (place => work%table%place(:, e), corners => work%model%mesh%corners(e))
        do k = corners + 1, work%model%mesh%node_count(e)
          if (place(k - corners) /= p .and. place(mod(k - corners, corners) + 1) /= p) cycle
          term = terms((work%model%mesh%x(:, work%table%node(place(k))) - centre)/reach)
          associate (own => work%table%own(place(k)))
            do n = 1, quadratic
              smooth(:, :work%fields, own) = smooth(:, :work%fields, own) + coefficient(:, :, n)*term(n)
            end do
            work%fits(own) = work%fits(own) + 1
          end associate
        end do
      end associate
    end do
  end subroutine fit_quadratic

  !> Count the sampling points of an element.
  pure integer function samples_of(work, element)
    type(recovery_type), intent(in) :: work
    integer, intent(in) :: element

    samples_of = work%model%mesh%kinds(work%model%mesh%kind(element))%samples
  end function samples_of

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
