!> Smooth strains from those of the elements (Zienkiewicz and Zhu 1992, superconvergent patch recovery).
!>
!> At each corner a polynomial is fitted by least squares to the strains of the elements around it, at the
!> points where they are best: the middles of three- and four-node elements (linear), places within those with
!> nodes between corners (quadratic). Nodes between corners take the mean of the polynomials of both.
!>
!> Which elements tell of the strain at a node: those around it of one section, since strains jump where
!> materials change. A node where sections meet has a place in each of them. A place at the boundary of its
!> section has elements on one side only, too few to tell how the strain changes: the elements around its
!> neighbours are added there.
module epcont_accuracy_recovery
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: lost_digits
  use epcont_element_kinematics, only: components
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: new_patch_table, patch_table, recover_strains, wide_patch

  type :: patch_table
    integer :: places = 0
    integer, allocatable :: node(:)        !! of each place [places]
    !> Of each node of an element, 0 where it has no more [most_nodes, elements]
    integer, allocatable :: place(:, :)
    type(incidence) :: around              !! elements at each place
    logical, allocatable :: inside(:)      !! elements go all around the place [places]
  end type patch_table

  !> Terms of a quadratic polynomial: 1, x, y, x**2, xy, y**2.
  integer, parameter :: quadratic = 6
  !> Samples that a patch must have for each number of terms, or it is widened.
  integer, parameter :: least_linear = 4, least_quadratic = 9

contains

  !> The places of a scene.
  pure function new_patch_table(model) result(table)
    type(model_type), intent(in) :: model   !! the scene
    type(patch_table) :: table
    logical :: free(0:model%nodes)   ! on an outline
    integer :: p

    call split_places(table%place, table%node)
    table%places = size(table%node)
    table%around = new_incidence(table%place, table%places)
    free = .false.
    free([model%body_outline%node]) = .true.
    associate (full => model%around%start, own => table%around%start, node => table%node)
      table%inside = [(.not. free(node(p)) .and. own(p + 1) - own(p) == full(node(p) + 1) - full(node(p)), &
                       p=1, table%places)]
    end associate

  contains

    !> A node has one place for each section that it belongs to; that of the first section is the node's own
    !! number.
    pure subroutine split_places(place, node)
      integer, allocatable, intent(out) :: place(:, :), node(:)   !! of each element, of each place
      integer, allocatable :: next(:), section(:)   !! of each place the next place of its node, its section
      integer :: at, e, k, places

      place = model%connectivity
      node = [(k, k=1, model%nodes)]
      if (all(model%section == model%section(1))) return
      node = [node, spread(0, 1, size(place))]
      allocate (next(size(node)), source=0)
      places = model%nodes
      section = [(minval(model%section(model%around%of(k))), k=1, places), node(places + 1:)]
      do e = 1, model%elements
        do k = 1, model%node_count(e)
          at = place(k, e)
          do while (section(at) /= model%section(e))
            if (next(at) == 0) then
              places = places + 1
              next(at) = places
              section(places) = model%section(e)
              node(places) = place(k, e)
            end if
            at = next(at)
          end do
          place(k, e) = at
        end do
      end do
      node = node(:places)
    end subroutine split_places
  end function new_patch_table

  !> The elements around a place and around the corners of these.
  pure subroutine wide_patch(model, table, place, seen, patch)
    type(model_type), intent(in) :: model             !! the scene
    type(patch_table), intent(in) :: table            !! of its elements
    integer, intent(in) :: place                      !! which place
    !> The last place that each element was taken for [elements]
    integer, intent(inout) :: seen(:)
    integer, allocatable, intent(out) :: patch(:)     !! elements
    integer :: i, k

    allocate (patch(0))
    associate (near => table%around%of(place))
      do i = 1, size(near)
        do k = 1, model%corners(near(i))
          associate (there => table%around%of(table%place(k, near(i))))
            patch = [patch, pack(there, seen(there) /= place)]
            seen(there) = place
          end associate
        end do
      end do
    end associate
  end subroutine wide_patch

  !> Strains at the places of a table, of several fields at once [components, places, fields].
  function recover_strains(model, table, volume, strain) result(smooth)
    type(model_type), intent(in) :: model    !! the scene
    type(patch_table), intent(in) :: table   !! of its elements
    real(wp), intent(in) :: volume(:)        !! of the integration points [points]
    real(wp), intent(in) :: strain(:, :, :)  !! xx, yy, zz, xy [components, points, fields]
    real(wp), allocatable :: smooth(:, :, :)
    !> Samples: [length] [2, points], [components, points, fields]
    real(wp), allocatable :: x(:, :), sample(:, :, :)
    integer, allocatable :: patch(:)
    integer :: seen(model%elements), e, k, p
    !> Of a node between corners: polynomials that reach it; of others -1
    integer :: fits(table%places)

    call take_samples()
    allocate (smooth(components, table%places, size(strain, 3)), source=0.0_wp)
    fits = -1
    do e = 1, model%elements
      do k = model%corners(e) + 1, model%node_count(e)
        fits(table%place(k, e)) = 0
      end do
    end do
    seen = 0
    do p = 1, table%places
      patch = table%around%of(p)
      if (size(patch) == 0 .or. fits(p) >= 0) cycle
      associate (curved => any(model%kinds(model%kind(patch))%degree > 1))
        if (.not. table%inside(p) .or. size(patch) < merge(least_quadratic/3, least_linear, curved)) &
          call wide_patch(model, table, p, seen, patch)
        if (curved) then
          call fit_quadratic(p)
        else
          call fit_linear(p)
        end if
      end associate
    end do
    do p = 1, table%places
      if (fits(p) > 0) smooth(:, p, :) = smooth(:, p, :)/fits(p)
    end do

  contains

    !> Where the strains of the elements are best, and what they are there: the samples of an element have the
    !! numbers of its first points.
    subroutine take_samples()
      integer :: e, f, k, p

      allocate (x(2, model%points))
      sample = strain
      do e = 1, model%elements
        associate (node => model%connectivity(:model%node_count(e), e), kind => model%kinds(model%kind(e)), &
                   first => model%first_point(e), last => model%first_point(e + 1) - 1)
          if (kind%degree > 1) then
            do k = 1, kind%samples
              x(:, first + k - 1) = matmul(model%x(:, node), kind%sample_values(:kind%nodes, k))
              do f = 1, size(strain, 3)
                sample(:, first + k - 1, f) = matmul(strain(:, first:last, f), &
                    kind%sample_of(:kind%points, k))
              end do
            end do
            cycle
          end if
          x(:, first) = sum(model%x(:, node), dim=2)/kind%nodes
          if (first == last) cycle
          sample(:, first, :) = 0.0_wp
          do p = first, last
            sample(:, first, :) = sample(:, first, :) + strain(:, p, :)*(volume(p)/sum(volume(first:last)))
          end do
        end associate
      end do
    end subroutine take_samples

    !> The linear polynomials of one sample an element, at a place. A direction in which the samples do not
    !! spread is constant.
    subroutine fit_linear(p)
      integer, intent(in) :: p
      real(wp) :: at(2), d(2), determinant
      real(wp), dimension(components) :: mean, along, across
      real(wp) :: m(2), xx, xy, yy   !! moments of the samples about the place, then about their middle
      integer :: f, i, s

      at = model%x(:, table%node(p))
      m = 0.0_wp
      xx = 0.0_wp
      xy = 0.0_wp
      yy = 0.0_wp
      do i = 1, size(patch)
        d = x(:, model%first_point(patch(i))) - at
        m = m + d
        xx = xx + d(1)*d(1)
        xy = xy + d(1)*d(2)
        yy = yy + d(2)*d(2)
      end do
      xx = xx - m(1)*m(1)/size(patch)
      xy = xy - m(1)*m(2)/size(patch)
      yy = yy - m(2)*m(2)/size(patch)
      determinant = xx*yy - xy*xy
      do f = 1, size(sample, 3)
        mean = 0.0_wp
        along = 0.0_wp
        across = 0.0_wp
        do i = 1, size(patch)
          s = model%first_point(patch(i))
          d = x(:, s) - at
          mean = mean + sample(:, s, f)
          along = along + d(1)*sample(:, s, f)
          across = across + d(2)*sample(:, s, f)
        end do
        mean = mean/size(patch)
        along = along - m(1)*mean
        across = across - m(2)*mean
        if (determinant > lost_digits*(xx + yy)**2) &
          mean = mean - (m(1)*(yy*along - xy*across) + m(2)*(xx*across - xy*along))/(determinant*size(patch))
        smooth(:, p, f) = mean
      end do
    end subroutine fit_linear

    !> The quadratic polynomials about a corner: their values there, and added at the nodes on the sides that
    !! meet there.
    subroutine fit_quadratic(p)
      integer, intent(in) :: p
      real(wp) :: matrix(quadratic, quadratic), term(quadratic)
      real(wp) :: coefficient(components, size(sample, 3), quadratic)
      real(wp) :: at(2), reach, weight
      integer :: e, f, i, j, k, s, samples

      at = model%x(:, table%node(p))
      reach = 0.0_wp
      samples = 0
      do i = 1, size(patch)   ! in any direction, all samples alike: scenes and elements may be turned
        associate (first => model%first_point(patch(i)), own => model%kinds(model%kind(patch(i)))%samples)
          reach = reach + sum((x(:, first:first + own - 1) - spread(at, 2, own))**2)
          samples = samples + own
        end associate
      end do
      reach = sqrt(reach/samples)
      matrix = 0.0_wp
      coefficient = 0.0_wp
      do i = 1, size(patch)
        associate (first => model%first_point(patch(i)))
          do s = first, first + model%kinds(model%kind(patch(i)))%samples - 1
            term = terms((x(:, s) - at)/reach)
            weight = 1.0_wp/(0.1_wp + sum(term(2:3)**2))**2
            do j = 1, quadratic
              matrix(:, j) = matrix(:, j) + term*term(j)*weight
              coefficient(:, :, j) = coefficient(:, :, j) + sample(:, s, :)*term(j)*weight
            end do
          end do
        end associate
      end do
      if (samples < least_quadratic) matrix(:, 4:) = 0.0_wp   ! linear
      call solve(matrix, size(coefficient, 1)*size(coefficient, 2), coefficient)
      smooth(:, p, :) = coefficient(:, :, 1)
      do i = table%around%start(p), table%around%start(p + 1) - 1
        e = table%around%group(i)
        associate (place => table%place(:, e), corners => model%corners(e))
          do k = corners + 1, model%node_count(e)
            if (place(k - corners) /= p .and. place(mod(k - corners, corners) + 1) /= p) cycle
            term = terms((model%x(:, table%node(place(k))) - at)/reach)
            do f = 1, size(sample, 3)
              smooth(:, place(k), f) = smooth(:, place(k), f) + matmul(coefficient(:, f, :), term)
            end do
            fits(place(k)) = fits(place(k)) + 1
          end do
        end associate
      end do
    end subroutine fit_quadratic
  end function recover_strains

  !> Terms of a quadratic polynomial at a place.
  pure function terms(x) result(term)
    real(wp), intent(in) :: x(2)
    real(wp) :: term(quadratic)

    term = [1.0_wp, x(1), x(2), x(1)**2, x(1)*x(2), x(2)**2]
  end function terms

  !> Solve the normal equations; a term that depends on those before is left out.
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
