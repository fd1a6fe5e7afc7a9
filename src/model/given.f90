!> Model data: taken from the arrays of a caller, and checked for invalid values.
module epcont_model_given
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_deck_entry, only: farthest, least_cause, least_divisor
  use epcont_element_element_kind, only: element_kind
  use epcont_element_element_kinds, only: element_kinds
  use epcont_element_kinematics, only: axisymmetric, directions
  use epcont_model_arrays, only: count_from_one, element_block, scene_type
  use epcont_model_controls, only: method_name, rule_name, solver_name
  use epcont_model_finding, only: findings, of_scene, of_section, of_spring
  use epcont_model_load_cases, only: load_cases, single_case
  use epcont_model_parts, only: kind_of
  use epcont_model_yield_curve, only: curve_fault, straighten
  implicit none
  private
  public :: check_values, take_arrays

  integer, parameter :: any_shape(0) = [integer ::]   !! for `fit`
  character(len=*), parameter :: coefficients = 'give a number from 0.0 to 100.0'

contains

  !> Copy the arrays of a caller, if all exist and their shapes agree.
  subroutine take_arrays(given, scene, cases, found)
    type(scene_type), intent(in) :: given      !! arrays with any lower bounds
    type(scene_type), intent(out) :: scene     !! their copy, counted from 1
    type(load_cases), intent(out) :: cases     !! their loads
    type(findings), intent(inout) :: found     !! errors are added

    call check_shapes(found, given)
    if (found%errors > 0) return
    call count_from_one(given, scene)
    cases = single_case(scene)
  end subroutine take_arrays

  !> Check the range of numbers; the first error of each array is reported.
  subroutine check_values(scene, found)
    type(scene_type), intent(inout) :: scene   !! its curves are corrected for rounding
    type(findings), intent(inout) :: found     !! errors are added
    type(element_kind), allocatable :: kinds(:)
    integer :: elements, i, nodes

    nodes = size(scene%x, 2)
    call need(found, scene%young >= least_divisor .and. scene%young <= farthest, 'young(#) is no stiffness', &
              above_zero(), of_section)
    call need(found, scene%poisson >= 0.0_wp .and. scene%poisson < 0.5_wp, 'poisson(#) is out of range', &
              '0.0 or more, and less than 0.5', of_section)
    call need(found, scene%thickness >= least_divisor .and. scene%thickness <= farthest, &
              'thickness(#) is no thickness', above_zero(), of_section)
    call need(found, has_size(scene%density), 'density(#) is no density', any_size(), of_section)
    call need(found, within(scene%kinematics, axisymmetric), 'kinematics(#) is unknown', &
              'plane_strain, plane_stress or axisymmetric')
    do i = 1, size(scene%curve)
      if (found%errors == 0) call check_curve(found, i, scene)
    end do
    elements = 0
    kinds = element_kinds()
    do i = 1, size(scene%block)
      if (found%errors == 0) call check_block(found, scene, kinds, nodes, 'block('//text_of(i)//')%', &
                                              scene%block(i), elements)
    end do
    if (found%errors == 0) call need(found, [elements > 0], 'the deck has no elements', &
                                    'elements, such as CTRIA3')
    call need(found, all(abs(scene%x) <= farthest, dim=1), 'x(:, #) is no place', any_size())
    call need(found, all(has_size(scene%load), dim=1), 'load(:, #) is no force', any_size())
    call need(found, all(has_size(scene%prescribed), dim=1), 'prescribed(:, #) is no displacement', &
              any_size())
    call need(found, all(scene%held .or. scene%prescribed == 0.0_wp, dim=1), &
              'prescribed(:, #) is not 0.0 where held is false', '0.0, or set held there')
    call need(found, all(within(scene%pair_node, nodes), dim=1), 'pair_node(:, #) is no node', up_to(nodes))
    call need(found, abs(norm2(scene%normal, dim=1) - 1.0_wp) <= no_effect .or. &
              all(scene%normal == 0.0_wp, dim=1), &
              'normal(:, #) is no unit vector', 'a vector of length 1, or zero: from A to B')
    call need(found, has_size(scene%initial_gap), 'initial_gap(#) is no length', any_size())
    if (allocated(scene%friction)) call need(found, is_friction(scene%friction), &
      'friction(#) is no coefficient of friction', coefficients)
    call need(found, is_friction(scene%couple%friction), 'couple(#)%friction is no coefficient of friction', &
              coefficients)
    if (allocated(scene%temperature)) then
      call need(found, abs(scene%temperature) <= farthest, 'temperature(#) is no temperature', any_size())
      call need(found, has_size(scene%expansion), 'expansion(#) is no expansion', any_size())
      call need(found, abs(scene%reference_temperature) <= farthest, &
                'reference_temperature(#) is no temperature', any_size())
    end if
    if (elements > 0) &
      call need(found, within(scene%pressure%element, elements), 'pressure(#)%element is no element', &
                up_to(elements))
    call need(found, has_size(scene%pressure%pressure(1)) .and. has_size(scene%pressure%pressure(2)) .and. &
              has_size(scene%pressure%theta), 'pressure(#) is no pressure', any_size())
    do i = 1, size(scene%body_load)
      associate (load => scene%body_load(i))
        call need(found, &
                  [all(has_size([load%factor, load%acceleration, load%centre, load%spin, load%spin_up]))], &
                  'body_load('//text_of(i)//') is out of range', any_size())
      end associate
    end do
    call check_ties(found, scene)
    do i = 1, size(scene%line)
      call fit(found, 'line('//text_of(i)//')%node', any_shape, scene%line(i)%node)
      if (allocated(scene%line(i)%node)) &
        call need(found, within(scene%line(i)%node, nodes), 'line('//text_of(i)//')%node(#) is no node', &
                  up_to(nodes))
    end do
    call need(found, within(scene%couple%line(1), size(scene%line)) .and. &
              within(scene%couple%line(2), size(scene%line)), 'couple(#)%line is no line', &
              up_to(size(scene%line)))
    call check_choices(found, scene)
  end subroutine check_values

  !> Report an error if not all values hold: the first one, with its number in place of `#`,
  !! and the values to give.
  subroutine need(found, holds, what, remedy, of)
    type(findings), intent(inout) :: found
    logical, intent(in) :: holds(:)
    character(len=*), intent(in) :: what, remedy
    integer, intent(in), optional :: of   !! item type, if a card of the deck has this number
    character(len=:), allocatable :: text
    integer :: at, which
    character(len=:), allocatable :: give

    if (all(holds)) return
    which = findloc(holds, .false., dim=1)
    at = index(what, '#')
    text = what
    if (at > 0) text = what(:at - 1)//text_of(which)//what(at + 1:)
    give = 'give '//remedy
    if (present(of)) call found%add_error(of, which, 0, ': '//text, give)
    if (.not. present(of)) call found%add_error(of_scene, 0, 0, text, give)
  end subroutine need

  !> Check that an array is allocated and has the required shape. Its rank is not assumed: gfortran 12
  !! would dereference an array that is not allocated.
  subroutine fit(found, name, wanted, array)
    type(findings), intent(inout) :: found
    character(len=*), intent(in) :: name
    integer, intent(in) :: wanted(:)
    type(*), intent(in), optional :: array(:)   !! absent: the array is not allocated
    integer, allocatable :: extent(:)

    if (present(array)) extent = shape(array)
    call fit_shape(found, name, wanted, extent)
  end subroutine fit

  !> The same for an array of rank 2.
  subroutine fit_matrix(found, name, wanted, array)
    type(findings), intent(inout) :: found
    character(len=*), intent(in) :: name
    integer, intent(in) :: wanted(:)
    type(*), intent(in), optional :: array(:, :)   !! absent: the array is not allocated
    integer, allocatable :: extent(:)

    if (present(array)) extent = shape(array)
    call fit_shape(found, name, wanted, extent)
  end subroutine fit_matrix

  !> Report an array that is not allocated or has another shape.
  subroutine fit_shape(found, name, wanted, extent)
    type(findings), intent(inout) :: found
    character(len=*), intent(in) :: name
    integer, intent(in) :: wanted(:)
    integer, allocatable, intent(in) :: extent(:)   !! not allocated: nor is the array

    if (.not. allocated(extent)) then
      call need(found, [.false.], name//' is not allocated', 'it a size, 0 if it is empty')
    else if (size(wanted) > 0) then
      call need(found, [all(extent == wanted)], name//' has the shape '//text_of_shape(extent), &
                'it the shape '//text_of_shape(wanted))
    end if
  end subroutine fit_shape

  !> Check that arrays are allocated, with one column for each node, section or pair.
  subroutine check_shapes(found, given)
    type(findings), intent(inout) :: found
    type(scene_type), intent(in) :: given
    integer :: nodes(2), pairs(2), sections(1)

    call fit_matrix(found, 'x', any_shape, given%x)
    call fit(found, 'young', any_shape, given%young)
    call fit(found, 'initial_gap', any_shape, given%initial_gap)
    call fit(found, 'block', any_shape, given%block)
    call fit(found, 'pressure', any_shape, given%pressure)
    call fit(found, 'line', any_shape, given%line)
    call fit(found, 'couple', any_shape, given%couple)
    if (found%errors > 0) return
    nodes = [directions, size(given%x, 2)]
    sections = size(given%young)
    pairs = [2, size(given%initial_gap)]
    call fit_matrix(found, 'x(2, nodes)', nodes, given%x)
    call fit_matrix(found, 'held(2, nodes)', nodes, given%held)
    call fit_matrix(found, 'prescribed(2, nodes)', nodes, given%prescribed)
    call fit_matrix(found, 'reference(2, nodes)', nodes, given%reference)
    call fit_matrix(found, 'load(2, nodes)', nodes, given%load)
    call fit(found, 'poisson(sections)', sections, given%poisson)
    call fit(found, 'kinematics(sections)', sections, given%kinematics)
    call fit(found, 'thickness(sections)', sections, given%thickness)
    if (allocated(given%density)) call fit(found, 'density(sections)', sections, given%density)
    call fit(found, 'curve(sections)', sections, given%curve)
    call fit_matrix(found, 'pair_node(2, pairs)', pairs, given%pair_node)
    call fit_matrix(found, 'normal(2, pairs)', pairs, given%normal)
    if (allocated(given%friction)) call fit(found, 'friction(pairs)', pairs(2:), given%friction)
    if (.not. allocated(given%temperature)) return
    call fit(found, 'temperature(nodes)', nodes(2:), given%temperature)
    call fit(found, 'expansion(sections)', sections, given%expansion)
    call fit(found, 'reference_temperature(sections)', sections, given%reference_temperature)
  end subroutine check_shapes

  !> Check that ties, platens and springs name existing nodes.
  subroutine check_ties(found, scene)
    type(findings), intent(inout) :: found
    type(scene_type), intent(in) :: scene
    integer :: i, nodes
    character(len=:), allocatable :: name

    nodes = size(scene%x, 2)
    call need(found, within(scene%tie%node, nodes) .and. within(scene%tie%leader, nodes) .and. &
              within(scene%tie%component, directions), 'tie(#) does not name two nodes and a component', &
              up_to(nodes)//'; component 1 or 2')
    do i = 1, size(scene%platen)
      name = 'platen('//text_of(i)//')%'
      call fit(found, name//'follower', any_shape, scene%platen(i)%follower)
      call need(found, [within(scene%platen(i)%leader, nodes)], name//'leader'//' is no node', up_to(nodes))
      if (found%errors > 0) return
      call need(found, within(scene%platen(i)%follower, nodes), name//'follower(#) is no node', up_to(nodes))
      call need(found, [has_size(scene%platen(i)%prescribed) .and. has_size(scene%platen(i)%moment)], &
                name//'prescribed or moment is out of range', any_size())
    end do
    call check_equations(found, scene)
    call need(found, [(all([within(scene%spring(i)%node + 1, nodes + 1), &
                            within(scene%spring(i)%component + 1, directions + 1)]), &
                       i=1, size(scene%spring))], &
              'names no node or component', '0, or '//up_to(nodes)//'; component 0, 1 or 2', of_spring)
    call need(found, scene%spring%stiffness >= least_divisor .and. scene%spring%stiffness <= farthest, &
              'its stiffness is out of range', above_zero(), of_spring)
  end subroutine check_ties

  !> Check that equations have terms, which name existing nodes and components.
  subroutine check_equations(found, scene)
    type(findings), intent(inout) :: found
    type(scene_type), intent(in) :: scene
    integer :: i, nodes
    character(len=:), allocatable :: name

    nodes = size(scene%x, 2)
    do i = 1, size(scene%equation)
      name = 'equation('//text_of(i)//')%'
      call fit(found, name//'coefficient', any_shape, scene%equation(i)%coefficient)
      if (found%errors > 0) return
      call fit(found, name//'component', shape(scene%equation(i)%coefficient), scene%equation(i)%component)
      call fit(found, name//'node', shape(scene%equation(i)%coefficient), scene%equation(i)%node)
      call need(found, [size(scene%equation(i)%coefficient) > 0], name//'coefficient is empty', &
                'at least one term')
      if (found%errors > 0) return
      call need(found, within(scene%equation(i)%node, nodes), name//'node(#) is no node', up_to(nodes))
      call need(found, within(scene%equation(i)%component, directions), &
                name//'component(#) is out of range', '1 or 2')
      call need(found, has_size(scene%equation(i)%coefficient), name//'coefficient(#) is out of range', &
                any_size())
    end do
  end subroutine check_equations

  !> Check a stress-strain curve.
  subroutine check_curve(found, i, scene)
    type(findings), intent(inout) :: found
    integer, intent(in) :: i
    type(scene_type), intent(inout) :: scene
    type(curve_fault) :: fault
    character(len=:), allocatable :: name

    name = 'curve('//text_of(i)//')'
    associate (curve => scene%curve(i))
      if (.not. (allocated(curve%strain) .or. allocated(curve%stress))) return
      call fit(found, name//'%strain', any_shape, curve%strain)
      if (found%errors == 0) call fit(found, name//'%stress', shape(curve%strain), curve%stress)
      if (found%errors > 0) return
      call need(found, abs(curve%strain) <= farthest, name//'%strain(#) is no strain', any_size())
      call need(found, abs(curve%stress) <= farthest, name//'%stress(#) is no stress', any_size())
      if (found%errors > 0) return
      call straighten(curve, scene%young(i), fault)
      if (fault%point > 0) call found%add_error(of_section, i, 0, ': '//name//': '//fault%what, fault%remedy)
    end associate
  end subroutine check_curve

  !> Check elements of one type: name, nodes and sections; axisymmetric types need axisymmetric sections.
  subroutine check_block(found, scene, kinds, nodes, name, block, elements)
    type(findings), intent(inout) :: found
    type(scene_type), intent(in) :: scene
    type(element_kind), intent(in) :: kinds(:)
    integer, intent(in) :: nodes
    character(len=*), intent(in) :: name
    type(element_block), intent(in) :: block
    integer, intent(inout) :: elements
    integer :: row

    row = kind_of(kinds, block%name)
    call need(found, [row > 0], name//'name is '''//trim(block%name)//'''', &
              'the card name of an element type, such as CTRIA3')
    if (row == 0) return
    call fit(found, name//'section', any_shape, block%section)
    if (found%errors == 0) &
      call fit_matrix(found, name//'node', [kinds(row)%nodes, size(block%section)], block%node)
    if (found%errors > 0) return
    elements = elements + size(block%section)
    call need(found, all(within(block%node, nodes), dim=1), name//'node(:, #) is no node', up_to(nodes))
    call need(found, within(block%section, size(scene%young)), name//'section(#) is no section', &
              up_to(size(scene%young)))
    if (found%errors > 0) return
    call need(found, &
              (scene%kinematics(block%section) == axisymmetric) .eqv. block%name == kinds(row)%ring_card, &
              name//'section(#) is not of the kinematics of '//trim(block%name), &
              'axisymmetric sections to axisymmetric elements (CTRAX3), and to no others')
  end subroutine check_block

  !> Check that the choices of `controls` exist and its numbers are in range.
  subroutine check_choices(found, scene)
    type(findings), intent(inout) :: found
    type(scene_type), intent(in) :: scene
    character(len=*), parameter :: name(2, 9) = reshape([character(len=22) :: &
      'method', 'method_auto', 'rule', 'rule_auto', 'solver', 'solver_auto', &
      'most_iterations', '1 to 100000', 'load_steps', '1 to 10000', &
      'tolerance', '0.0 to less than 1.0', 'accuracy', '0.0 to less than 1.0', &
      'search', '0.0, or a length', 'corner', '0.0 to 180.0 degrees'], [2, 9])
    logical :: fits(9)
    integer :: k

    associate (is => scene%controls)
      fits = [within([is%method, is%rule, is%solver] + 1, &
                     [size(method_name), size(rule_name), size(solver_name)]), &
              within([is%most_iterations, is%load_steps], [100000, 10000]), &
              [is%tolerance, is%accuracy, is%search, is%corner] >= 0.0_wp .and. &
              [is%tolerance < 1.0_wp, is%accuracy < 1.0_wp, is%search <= farthest, is%corner <= 180.0_wp]]
    end associate
    do k = 1, size(fits)
      call need(found, fits(k:k), 'controls%'//trim(name(1, k))//' is out of range', trim(name(2, k)))
    end do
  end subroutine check_choices

  !> Remedies.
  function any_size() result(text)
    character(len=:), allocatable :: text

    text = '0.0, or a size of '//short_real(least_cause)//' to '//short_real(farthest)
  end function any_size

  function above_zero() result(text)
    character(len=:), allocatable :: text

    text = short_real(least_divisor)//' to '//short_real(farthest)
  end function above_zero

  pure function up_to(most) result(text)
    integer, intent(in) :: most
    character(len=:), allocatable :: text

    text = '1 to '//text_of(most)
  end function up_to

  !> Write a shape in parentheses.
  pure function text_of_shape(extent) result(text)
    integer, intent(in) :: extent(:)
    character(len=:), allocatable :: text
    character(len=30) :: number

    write (number, '(*(i0, :, ", "))') extent
    text = '('//trim(number)//')'
  end function text_of_shape

  !> Is the value zero, or of a size that products of it cannot overflow?
  elemental logical function has_size(cause)
    real(wp), intent(in) :: cause

    has_size = cause == 0.0_wp .or. abs(cause) >= least_cause .and. abs(cause) <= farthest
  end function has_size

  !> Is the value a coefficient of friction?
  elemental logical function is_friction(coefficient)
    real(wp), intent(in) :: coefficient

    is_friction = coefficient >= 0.0_wp .and. coefficient <= 100.0_wp
  end function is_friction

  !> Is a number between 1 and the last one?
  elemental logical function within(number, most)
    integer, intent(in) :: number, most   !! `most` is the last one

    within = number >= 1 .and. number <= most
  end function within
end module epcont_model_given
