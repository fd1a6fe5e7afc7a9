!> The scene made complete: from what is given of it, by a deck or by arrays, to a model that is checked and
!> can be solved. From arrays (epcont_model_arrays) `complete_model` checks all and finds the rest; they stay
!> as they are. Nodes, elements and pairs are known by their columns.
module epcont_contact_geometry_complete
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_contact_geometry_line_contacts, only: find_line_contacts
  use epcont_contact_geometry_loose_nodes, only: warn_of_hanging_nodes, warn_of_lying_together
  use epcont_contact_geometry_pair_checks, only: check_pairs
  use epcont_element_kinematics, only: directions, plane_strain
  use epcont_geometry_outline_shape, only: new_outline_shape, outline_shape
  use epcont_model_arrays, only: scene_type
  use epcont_model_body_checks, only: check_body_loads
  use epcont_model_body_forces, only: are_massless, put_body_forces
  use epcont_model_controls, only: method_auto, method_newton
  use epcont_model_element_shapes, only: check_axis, complete_elements
  use epcont_model_expansion, only: find_free_strains
  use epcont_model_finding, only: findings, of_body_load, of_node, of_paper_ratio, of_scene, of_section, &
      of_theory
  use epcont_model_freedoms, only: find_travels, follow_to_the_end, set_reference, tie
  use epcont_model_given, only: check_given, number_parts
  use epcont_model_model, only: model_type
  use epcont_model_pressure, only: add_pressure, find_side
  use epcont_model_ties, only: add_moment, check_equation, complete_ties, turn_with
  use epcont_model_single_pairs, only: complete_pairs
  implicit none
  private
  public :: complete_model, check_controls, finish_model

contains

  !> A model made from arrays, checked and made complete; it serves only without errors.
  subroutine complete_model(given, model, found)
    type(scene_type), intent(in) :: given      !! what is given
    type(model_type), intent(out) :: model     !! what comes of it
    type(findings), intent(out) :: found       !! all that is wrong with it, or looks so
    integer, allocatable :: leader(:, :)       ! that is given
    integer :: behind, ends(3), i

    call check_given(given, model%scene_type, found)
    if (found%errors > 0) return
    model%normal = model%normal/spread(max(norm2(model%normal, dim=1), 0.5_wp), 1, directions)   ! 0 stays 0
    call number_parts(model)
    call complete_elements(model, found)
    if (found%errors == 0) then
      do i = 1, size(model%pressure)   ! loads of the nodes beside them
        call find_side(model, model%pressure(i), ends, behind)
        if (ends(1) > 0 .and. behind == 0) then
          call add_pressure(model, model%pressure(i), 1.0_wp)
        else
          call found%add_error(of_scene, 0, 0, 'pressure('//text_of(i)//')%corner is of no side of the'// &
                               ' boundary', 'two neighbouring corners of a side that its element alone has')
        end if
      end do
    end if
    if (any(model%body_load%factor /= 0.0_wp)) call check_masses()
    call complete_freedoms()
    call check_axis(model, found)
    call complete_pairs(model, .false., found)
    call find_line_contacts(model, found)
    call check_controls(model, found)
    if (found%errors > 0) return
    call find_travels(model)
    call find_free_strains(model)
    call check_body_loads(model, model%body_load, found)
    call put_body_forces(model)
    call finish_model(model, found)

  contains

    !> What body loads act on has mass, and those of rings act along what they resist.
    subroutine check_masses()
      logical :: massless(size(model%density))

      massless = are_massless(model)
      if (any(massless)) &
        call found%add_error(of_scene, 0, 0, 'density('//text_of(findloc(massless, .true., dim=1))// &
                             ') is not above 0.0, and body_load acts on mass', 'a density above 0.0')
      if (.not. model%has_rings()) return
      do i = 1, size(model%body_load)
        associate (load => model%body_load(i))
          if (load%acceleration(1) /= 0.0_wp .or. load%centre(1) /= 0.0_wp .or. load%spin_up /= 0.0_wp) &
            call found%add_error(of_body_load, i, 0, ' acts across the axis of rings', &
                                 '0.0 for acceleration(1), centre(1) and spin_up')
        end associate
      end do
    end subroutine check_masses

    !> Ties and reference freedoms, one by one: each is checked against those before it.
    subroutine complete_freedoms()
      integer :: c, k

      call move_alloc(model%leader, leader)
      model%sum_of = spread([0, 0], 2, model%nodes)
      model%leader = spread([(i, i=1, model%nodes)], 1, directions)
      do i = 1, model%nodes
        do c = 1, directions
          if (leader(c, i) /= i) call tie(model, c, i, leader(c, i), [of_node, i, 0], found)
        end do
      end do
      call complete_platens()
      call follow_to_the_end(model%leader)
      do i = 1, model%nodes
        do c = 1, directions
          if (model%reference(c, i)) call set_reference(model, c, i, [of_node, i, 0], found)
        end do
      end do
      do k = 1, size(model%equation)
        call check_equation(model, model%equation(k), [of_node, model%equation(k)%node(1), 0], found)
        model%equation(k)%card = model%equation(k)%node(1)
      end do
      call complete_ties(model, found)
      do k = 1, size(model%platen)
        call add_moment(model, k, model%platen(k)%moment, model%load)
      end do
    end subroutine complete_freedoms

    !> Those that follow leaders which turn.
    subroutine complete_platens()
      integer, allocatable :: follower(:)
      integer :: k

      do k = 1, size(model%platen)
        call move_alloc(model%platen(k)%follower, follower)
        allocate (model%platen(k)%follower(0))
        do i = 1, size(follower)
          call turn_with(model, k, follower(i), [of_node, follower(i), 0], found)
        end do
      end do
    end subroutine complete_platens
  end subroutine complete_model

  !> What a scene without errors must still be refused or warned of.
  subroutine finish_model(model, found)
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    type(outline_shape) :: drawn

    call check_pairs(model, found)
    drawn = new_outline_shape(model%body_outline, model%x)
    call warn_of_hanging_nodes(model, drawn, found)
    call warn_of_lying_together(model, drawn, found)
  end subroutine finish_model

  !> MUP PAPER is of the secant stiffness, and of plane strain. Flow theory has no secant.
  pure subroutine check_controls(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: s

    if (model%controls%flow_theory) then
      if (model%controls%paper_ratio) call found%add_error(of_theory, 0, 2, &
        ': FLOW does not go with MUP PAPER, a ratio of total theory', 'MUP EXACT, or THEORY TOTAL')
      if (all(model%controls%method /= [method_auto, method_newton])) call found%add_error(of_theory, 0, 2, &
        ': FLOW goes with METHOD NEWTON alone', 'METHOD NEWTON or AUTO, or THEORY TOTAL')
    end if
    if (.not. model%controls%paper_ratio) return
    if (model%controls%method == method_newton) &
      call found%add_error(of_paper_ratio, 0, 2, ': PAPER does not go with METHOD NEWTON', &
                           'METHOD SECANT, MODSEC or INISTR, or MUP EXACT')
    do s = 1, size(model%curve)
      if (model%kinematics(s) == plane_strain .or. .not. allocated(model%curve(s)%strain)) cycle
      call found%add_error(of_paper_ratio, 0, 2, &
        ': formula (2-4) for Poisson''s ratio beyond yield (MUP PAPER) is of plane strain; '// &
        model%name_of(of_section, s)//' can yield, and is not', &
        'plane strain, or MUP EXACT (ORIGINAL takes PAPER)')
      return
    end do
  end subroutine check_controls
end module epcont_contact_geometry_complete
