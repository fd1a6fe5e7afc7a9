!> Elements from their nodes: oriented counter-clockwise and checked, with the data that follow from them.
module epcont_model_element_shapes
  use epcont_base_incidence, only: new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: cancelled
  use epcont_element_element_kind, only: most_nodes
  use epcont_model_finding, only: and_more, findings, of_element, of_node
  use epcont_model_model, only: model_type
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: complete_elements, check_axis, check_overlaps

  !> Shorter edges have areas and stiffnesses close to underflow.
  real(wp), parameter :: shortest_side = 1.0e-30_wp

contains

  !> Complete the elements from type, nodes and section of each. Node 0 or section 0 was not found on the
  !! cards.
  subroutine complete_elements(model, found)
    type(model_type), intent(inout) :: model   !! the model
    type(findings), intent(inout) :: found   !! errors are added
    logical :: is_ring(model%mesh%elements)
    logical :: plain(model%mesh%elements)                    ! the element is complete
    real(wp), dimension(2, most_nodes) :: x, straight   ! nodes of an element; with straight edges
    integer :: e, n, next, plane, ring, turn            ! element, its corners; turn is 0 if it folds over

    model%mesh%node_count = model%mesh%kinds(model%mesh%kind)%nodes
    model%mesh%points = sum(model%mesh%kinds(model%mesh%kind)%points)
    allocate (model%mesh%first_point(model%mesh%elements + 1), model%mesh%point_element(model%mesh%points))
    !$omp parallel do num_threads(threads_over(model%mesh%elements))
    do e = 1, model%mesh%elements
      call turn_plain(e, plain(e), model)
    end do
    !$omp end parallel do
    next = 1
    do e = 1, model%mesh%elements
      model%mesh%first_point(e) = next
      next = next + model%mesh%kinds(model%mesh%kind(e))%points
      model%mesh%point_element(model%mesh%first_point(e):next - 1) = e
      if (.not. plain(e)) call check_shape()
    end do
    model%mesh%first_point(e) = next
    model%mesh%around = new_incidence(model%mesh%connectivity, model%mesh%nodes)
    is_ring = [(model%is_ring(e), e=1, model%mesh%elements)]
    ring = findloc(is_ring, .true., dim=1)
    plane = findloc(model%mesh%section > 0 .and. .not. is_ring, .true., dim=1)
    if (ring > 0 .and. plane > 0) call found%add_error(of_element, ring, 0, &
      ': an axisymmetric element in a deck of plane elements ('//model%name_of(of_element, plane)//')', &
      'use plane elements only, or axisymmetric elements only')

  contains

    !> Turn an element with curved edges counter-clockwise; report a shape that is not valid.
    subroutine check_shape()
      integer :: k
      real(wp) :: extent   ! size, from its first corner [length]

      n = model%mesh%corners(e)
      associate (node => model%mesh%connectivity(:model%mesh%node_count(e), e), &
                 kind => model%mesh%kinds(model%mesh%kind(e)))
        x(:, :size(node)) = model%mesh%x(:, node)
        straight(:, :n) = x(:, :n)
        do k = 1, n
          straight(:, n + k) = 0.5_wp*(x(:, k) + x(:, mod(k, n) + 1))
        end do
        turn = kind%turn(x)
        extent = max(maxval(abs(x(1, 2:n) - x(1, 1))), maxval(abs(x(2, 2:n) - x(2, 1))))
        if (extent > 0.0_wp .and. extent < shortest_side) then
          call found%add_error(of_element, e, -node(1), ': its edges are shorter than '// &
                               short_real(shortest_side), 'use other units')
        else if (turn /= 0 .or. kind%turn(straight) /= 0) then
          if (size(node) > n) call check_middles()
          if (turn < 0) then
            node([2, n]) = node([n, 2])
            if (size(node) > n) node(n + 1:) = node(size(node):n + 1:-1)
          end if
        else if (n == 3) then
          call found%add_error(of_element, e, -node(2), ': its corners '//ids(node(:n))//' lie on one line', &
                               'give corners that span an area')
        else
          call found%add_error(of_element, e, -node(1), ': its corners '//ids(node(:n))// &
                               ' cross over, bend inwards or lie on one line', &
                               'give four corners in turn, each bending the same way')
        end if
      end associate
    end subroutine check_shape

    !> Check mid-side nodes: they may leave the middle unless the element folds over. An edge that bulges
    !! more than half a circle is probably an error.
    subroutine check_middles()
      character(len=*), parameter :: remedy = 'put it near the middle of its edge'
      character(len=:), allocatable :: name
      real(wp) :: part(n)
      integer :: node

      associate (middle => straight(:, n + 1:2*n))
        part = sum((x(:, n + 1:2*n) - middle)**2, dim=1)/sum((x(:, :n) - middle)**2, dim=1)
      end associate
      if (turn /= 0 .and. all(part <= 1.0_wp)) return
      node = model%mesh%connectivity(n + maxloc(part, dim=1), e)
      name = ': mid-side node '//text_of(model%mesh%node_id(node))
      if (turn == 0) then
        call found%add_error(of_element, e, -node, name//' is so far from the middle of its edge that '// &
                             'the element folds over', remedy)
      else
        call found%add_warning(of_element, e, -node, name//' is farther from the middle of its edge '// &
                               'than half of the length of that edge', remedy)
      end if
    end subroutine check_middles

    !> Nodes in words: `1, 2 and 3`.
    pure function ids(node) result(text)
      integer, intent(in) :: node(:)
      character(len=:), allocatable :: text
      integer :: k

      text = text_of(model%mesh%node_id(node(1)))
      do k = 2, size(node)
        text = text//trim(merge(' and', ',   ', k == size(node)))//' '//text_of(model%mesh%node_id(node(k)))
      end do
    end function ids
  end subroutine complete_elements

  !> Turn an element counter-clockwise if it has straight edges and no errors.
  subroutine turn_plain(e, plain, model)
    integer, intent(in) :: e
    logical, intent(out) :: plain   !! it has straight edges and no errors, or has nodes missing
    type(model_type), intent(inout) :: model
    real(wp) :: x(2, most_nodes)
    integer :: k, turn

    associate (node => model%mesh%connectivity(:, e), n => model%mesh%node_count(e), &
               kind => model%mesh%kinds(model%mesh%kind(e)))
      plain = any(node(:n) == 0)
      if (plain .or. n > kind%corners) return
      do k = 1, n
        x(:, k) = model%mesh%x(:, node(k))
      end do
      turn = kind%turn(x)
      plain = turn /= 0 .and. &
              max(maxval(abs(x(1, 2:n) - x(1, 1))), maxval(abs(x(2, 2:n) - x(2, 1)))) >= shortest_side
      if (plain .and. turn < 0) node([2, n]) = node([n, 2])   ! the first corner stays, and the third of four
    end associate
  end subroutine turn_plain

  !> Check that axisymmetric elements, with their curved edges, lie at x >= 0, and that nodes on the axis are
  !! fixed in x. Supports and ties are known.
  subroutine check_axis(model, found)
    type(model_type), intent(in) :: model   !! the model
    type(findings), intent(inout) :: found   !! errors are added
    logical, dimension(model%mesh%nodes) :: beyond, in_ring, loose
    real(wp) :: control, radius(3)
    integer :: e, i

    in_ring = .false.
    beyond = .false.
    do e = 1, model%mesh%elements
      associate (node => model%mesh%connectivity(:model%mesh%node_count(e), e))
        if (.not. (model%is_ring(e) .and. all(node > 0))) cycle
        in_ring(node) = .true.
        do i = model%mesh%corners(e) + 1, size(node)
          radius = model%mesh%x(1, model%mesh%edge(e, i - model%mesh%corners(e)))
          control = 2.0_wp*radius(3) - 0.5_wp*(radius(1) + radius(2))
          ! The least radius is (radius(1) radius(2) - control**2)/(radius(1) + radius(2) - 2 control)
          beyond(node(i)) = -control > sqrt(abs(radius(1)*radius(2))) + cancelled*maxval(radius)
        end do
      end associate
    end do
    do i = 1, model%mesh%nodes
      if (in_ring(i) .and. model%mesh%x(1, i) < 0.0_wp) then
        call found%add_error(of_node, i, 3, &
                             ': belongs to an axisymmetric element and has a negative radius', &
                             'give an X1 of at least 0.0: x is the radius')
      else if (beyond(i)) then
        call found%add_error(of_node, i, 3, &
                             ': is the mid-side node of an axisymmetric edge that crosses the axis', &
                             'keep x at least 0.0 all along it: x is the radius')
      end if
    end do
    loose = in_ring .and. model%mesh%x(1, :) == 0.0_wp .and. &
      .not. model%constraints%held(1, model%constraints%leader(1, :))
    if (.not. any(loose)) return
    call found%add_error(of_node, findloc(loose, .true., dim=1), 3, &
                         ': is on the axis of axisymmetric bodies and could leave it'// &
                         and_more(count(loose), '; so could ', ' more'), &
                         'fix direction 1 of all nodes with an x of 0.0')
  end subroutine check_axis

  !> Check for elements that overlap. Two elements on the same corners add their stiffnesses: laminae, or a
  !! mesh read twice. If elements have an edge in the same direction, one lies over the other: a node or a
  !! corner is wrong.
  pure subroutine check_overlaps(model, over, found)
    type(model_type), intent(in) :: model    !! the model
    integer, intent(in) :: over(:)          !! an earlier element that each lies over, 0 if absent [elements]
    type(findings), intent(inout) :: found   !! errors are added
    logical :: twice(model%mesh%elements)
    integer :: e

    twice = [(on_the_same_corners(e), e=1, model%mesh%elements)]
    e = findloc(twice, .true., dim=1)
    if (e > 0) call found%add_warning(of_element, e, 1, ' has the nodes of '// &
      model%name_of(of_element, over(e))//': both count, one on the other'// &
      and_more(count(twice), '; so do ', ' more'), 'remove one, unless you mean two laminae')
    e = findloc(over > 0 .and. .not. twice, .true., dim=1)
    if (e > 0) call found%add_error(of_element, e, 1, ': overlaps '//model%name_of(of_element, over(e))// &
      ': both are on the same side of their common edge'// &
      and_more(count(over > 0) - count(twice), '; so do ', ' more'), &
      'use elements that do not overlap, or laminae on the same corners')

  contains

    pure logical function on_the_same_corners(element) result(same)
      integer, intent(in) :: element
      integer :: k

      same = .false.
      if (over(element) == 0) return
      associate (other => model%mesh%connectivity(:model%mesh%corners(over(element)), over(element)))
        same = all([(any(model%mesh%connectivity(k, element) == other), k=1, model%mesh%corners(element))]) &
               .and. size(other) == model%mesh%corners(element)
      end associate
    end function on_the_same_corners
  end subroutine check_overlaps
end module epcont_model_element_shapes
