!> What a scene is given by, where it comes from arrays and not from a deck: nobody has looked at it before.
module epcont_model_given
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_element_element_kinds, only: element_kinds
  use epcont_element_kinematics, only: axisymmetric, directions, plane_strain
  use epcont_model_finding, only: findings, of_couple, of_element, of_line, of_node, of_pair, of_scene, &
                                  of_section
  use epcont_model_model, only: model_type
  use epcont_model_yield_curve, only: curve_fault, fault_of_curve
  implicit none
  private
  public :: new_scene, set_sections, add_elements, set_pairs, check_given

contains

  !> A scene of nodes alone: no elements, supports, ties, loads, pairs and lines.
  function new_scene(x) result(model)
    real(wp), intent(in) :: x(:, :)            !! their coordinates [length] [2, nodes]
    type(model_type) :: model
    integer :: i

    model%x = x
    model%nodes = size(x, 2)
    model%node_id = [(i, i=1, model%nodes)]
    model%kinds = element_kinds()
    model%leader = spread(model%node_id, 1, directions)
    allocate (model%held(directions, model%nodes), model%reference(directions, model%nodes), source=.false.)
    allocate (model%prescribed(directions, model%nodes), model%load(directions, model%nodes), source=0.0_wp)
    allocate (model%element_id(0), model%kind(0), model%section(0), model%connectivity(0, 0))
    allocate (model%line(0), model%couple(0))
    call set_sections(model, [real(wp) ::], [real(wp) ::], [integer ::])
    call set_pairs(model, reshape([integer ::], [2, 0]), reshape([real(wp) ::], [2, 0]), [real(wp) ::])
  end function new_scene

  !> What elements are made of; of thickness 1, and nothing yields: that may be changed.
  pure subroutine set_sections(model, young, poisson, kinematics)
    type(model_type), intent(inout) :: model   !! the scene
    real(wp), intent(in) :: young(:)          !! [stress] [sections]
    real(wp), intent(in) :: poisson(:)        !! [sections]
    integer, intent(in) :: kinematics(:)      !! plane_strain, plane_stress or axisymmetric [sections]
    integer :: s

    model%young = young
    model%poisson = poisson
    model%kinematics = kinematics
    model%thickness = spread(1.0_wp, 1, size(young))
    model%property_id = [(s, s=1, size(young))]
    model%material_id = model%property_id
    if (allocated(model%curve)) deallocate (model%curve)
    allocate (model%curve(size(young)))
  end subroutine set_sections

  !> Elements of one kind, behind those that the model has; their ids go on.
  pure subroutine add_elements(model, name, node, section)
    type(model_type), intent(inout) :: model   !! the scene
    character(len=*), intent(in) :: name       !! of their card: CTRIA3, CTRIA6, CQUAD4, CTRAX3, CTRAX6
    !> Corners in either turning sense, then middles of sides [nodes, elements]
    integer, intent(in) :: node(:, :)
    integer, intent(in) :: section(:)          !! of each [elements]
    integer, allocatable :: before(:, :)
    integer :: e, kind

    if (size(section) == 0) return
    kind = findloc(name /= '' .and. (model%kinds%plane_card == name .or. model%kinds%ring_card == name), &
                   .true., dim=1)
    if (kind > 0) kind = merge(kind, 0, all(shape(node) == [model%kinds(max(1, kind))%nodes, size(section)]))
    model%kind = [model%kind, spread(kind, 1, size(section))]
    model%section = [model%section, section]
    model%element_id = [model%element_id, (e, e=model%elements + 1, size(model%section))]
    call move_alloc(model%connectivity, before)
    allocate (model%connectivity(max(size(before, 1), size(node, 1)), size(model%section)), source=0)
    model%connectivity(:size(before, 1), :model%elements) = before
    if (kind > 0) model%connectivity(:size(node, 1), model%elements + 1:) = node
    model%elements = size(model%section)
  end subroutine add_elements

  !> Pairs of nodes that may touch, numbered from 1 on.
  pure subroutine set_pairs(model, node, normal, gap)
    type(model_type), intent(inout) :: model   !! the scene
    integer, intent(in) :: node(:, :)         !! A and B [2, pairs]
    real(wp), intent(in) :: normal(:, :)      !! unit, along which B is pushed; zero: from A to B [2, pairs]
    real(wp), intent(in) :: gap(:)            !! initial [length] [pairs]
    integer :: k

    model%pairs = size(gap)
    model%pair_id = [(k, k=1, model%pairs)]
    model%pair_node = node
    model%normal = normal
    model%initial_gap = gap
  end subroutine set_pairs

  !> Sizes, sections, numbers of nodes, sections and lines. What a deck's reader has looked at by itself is
  !! not looked at again.
  subroutine check_given(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: i, sections

    sections = size(model%young)
    call need(model%elements > 0, of_scene, 0, 'the scene has no elements', 'some of them')
    call need(all(model%kind > 0), of_scene, 0, 'elements are of a kind that there is not, or have'// &
              ' arrays that do not go together', 'CTRIA3, say, with nodes [3, elements], sections [elements]')
    call need(all([size(model%kinematics), size(model%poisson), size(model%thickness)] == sections), &
              of_scene, 0, 'the sections have arrays of different lengths', 'one number for each section')
    call need(all([shape(model%pair_node), shape(model%normal)] == [2, model%pairs, 2, model%pairs]), &
              of_scene, 0, 'the pairs have arrays of different lengths', 'one column for each pair')
    call need(all([shape(model%held), shape(model%prescribed), shape(model%reference), &
                   shape(model%leader), shape(model%load)] == [([2, model%nodes], i=1, 5)]), of_scene, 0, &
              'supports, ties and loads have arrays of different lengths', 'one column for each node')
    call need(size(model%curve) == sections, of_scene, 0, 'the sections have arrays of different lengths', &
              'one curve for each section')
    associate (controls => model%controls)
      call need(all([controls%tolerance, controls%accuracy] >= 0.0_wp .and. &
                    [controls%tolerance, controls%accuracy] < 1.0_wp), of_scene, 0, &
                'a tolerance or accuracy is out of range', '0 or more, and less than 1')
      call need(controls%load_steps > 0 .and. controls%most_iterations > 0, of_scene, 0, &
                'there are no load steps or iterations', '1 or more')
      call need(all([controls%search, controls%corner] >= 0.0_wp .and. &
                    [controls%search, controls%corner] <= [huge(1.0_wp), 180.0_wp]), of_scene, 0, &
                'a search or corner is out of range', '0, or a length; degrees')
    end associate
    if (found%errors > 0) return
    do i = 1, model%nodes
      call need(all(abs(model%x(:, i)) <= huge(1.0_wp)), of_node, i, ': its coordinates are no numbers', &
                'finite ones')
      call need(all(abs([model%load(:, i), model%prescribed(:, i)]) <= huge(1.0_wp)), of_node, i, &
                ': its load or prescribed displacement is no number', 'finite ones')
      call need(.not. any(model%prescribed(:, i) /= 0.0_wp .and. .not. model%held(:, i)), of_node, i, &
                ': has a prescribed displacement where it is not held', 'held there, too')
      call check_numbers(model%leader(:, i), model%nodes, of_node, i, 'node')
    end do
    do i = 1, model%elements
      call check_numbers(model%connectivity(:model%kinds(model%kind(i))%nodes, i), model%nodes, of_element, &
                         i, 'node')
      call check_numbers([model%section(i)], sections, of_element, i, 'section')
    end do
    do i = 1, model%pairs
      call check_numbers(model%pair_node(:, i), model%nodes, of_pair, i, 'node')
      call need(abs(model%initial_gap(i)) <= huge(1.0_wp), of_pair, i, ': its gap is no number', 'a length')
      call need(all(model%normal(:, i) == 0.0_wp) .or. &
                abs(norm2(model%normal(:, i)) - 1.0_wp) <= no_effect, of_pair, i, &
                ': its normal is no unit vector', 'one of length 1, or zero: from A to B')
    end do
    do i = 1, size(model%line)
      call check_numbers(model%line(i)%node, model%nodes, of_line, i, 'node')
    end do
    do i = 1, size(model%couple)
      call check_numbers(model%couple(i)%line, size(model%line), of_couple, i, 'line')
    end do
    do i = 1, sections
      call check_section(i)
    end do

  contains

    !> Numbers of things lie within how many of these there are.
    subroutine check_numbers(number, most, of, which, noun)
      integer, intent(in) :: number(:), most
      integer, intent(in) :: of, which             !! what has these numbers
      character(len=*), intent(in) :: noun
      integer :: k

      do k = 1, size(number)
        if (number(k) < 1 .or. number(k) > most) &
          call found%add_error(of, which, 0, ': there is no '//noun//' '//text_of(number(k)), &
                               'numbers from 1 to '//text_of(most))
      end do
    end subroutine check_numbers

    !> Stiffnesses above zero; and a curve that can be.
    subroutine check_section(s)
      integer, intent(in) :: s
      type(curve_fault) :: fault

      call need(model%young(s) > 0.0_wp .and. model%young(s) <= huge(1.0_wp), of_section, s, &
                ': Young''s modulus is not above zero', 'a stiffness')
      call need(model%poisson(s) >= 0.0_wp .and. model%poisson(s) < 0.5_wp, of_section, s, &
                ': Poisson''s ratio is out of range', '0 or more, and less than 0.5')
      call need(model%thickness(s) > 0.0_wp .and. model%thickness(s) <= huge(1.0_wp), of_section, s, &
                ': the thickness is not above zero', 'a length')
      call need(model%kinematics(s) >= plane_strain .and. model%kinematics(s) <= axisymmetric, of_section, &
                s, ': of no known kinematics', 'plane_strain, plane_stress or axisymmetric')
      if (found%errors > 0 .or. .not. allocated(model%curve(s)%strain)) return
      fault = fault_of_curve(model%curve(s)%strain, model%curve(s)%stress, model%young(s))
      if (fault%point > 0) call found%add_error(of_section, s, 0, ': '//fault%what, fault%remedy)
    end subroutine check_section

    !> It is an error where something does not hold.
    subroutine need(holds, of, which, what, remedy)
      logical, intent(in) :: holds
      integer, intent(in) :: of, which
      character(len=*), intent(in) :: what, remedy

      if (.not. holds) call found%add_error(of, which, 0, what, remedy)
    end subroutine need
  end subroutine check_given
end module epcont_model_given
