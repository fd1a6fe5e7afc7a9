!> Checks model data, from cards or from arrays of a caller, and makes a model that can be solved. Nodes,
!> elements and pairs are known by their columns.
module epcont_contact_geometry_complete
  use epcont_base_kinds, only: wp
  use epcont_contact_geometry_line_contacts, only: find_line_contacts
  use epcont_contact_geometry_loose_nodes, only: warn_of_loose_nodes
  use epcont_contact_geometry_pair_checks, only: check_pairs
  use epcont_contact_geometry_tangential_rows, only: add_tangential_rows
  use epcont_deck_entry, only: least_cause
  use epcont_element_kinematics, only: directions, plane_strain
  use epcont_model_arrays, only: angle, dof_tie, scene_type
  use epcont_model_controls, only: method_modsec, method_newton, method_secant
  use epcont_model_element_shapes, only: check_axis, complete_elements
  use epcont_model_finding, only: findings, item_hardening, of_node, of_paper_ratio, of_platen, &
      of_section, of_theory
  use epcont_model_freedoms, only: check_reference, follow_to_the_end, tie_freedom
  use epcont_model_given, only: check_values, take_arrays
  use epcont_model_load_cases, only: find_still, load_cases, put_case
  use epcont_model_load_checks, only: check_body_forces, check_loads
  use epcont_model_model, only: model_type
  use epcont_model_parts, only: make_parts
  use epcont_model_single_pairs, only: complete_pairs
  use epcont_model_springs, only: check_spring_ends
  use epcont_model_ties, only: check_equation, complete_ties, turn_followers
  implicit none
  private
  public :: complete_arrays, complete_model

contains

  !> Make a model from the arrays of a caller; it can be solved if there are no errors.
  subroutine complete_arrays(given, model, found)
    type(scene_type), intent(in) :: given      !! model data
    type(model_type), intent(out) :: model     !! made from them
    type(findings), intent(out) :: found       !! all errors and warnings
    type(load_cases) :: cases
    type(scene_type) :: data

    call take_arrays(given, data, cases, found)
    if (found%errors == 0) call complete_model(data, cases, 1, model, found)
  end subroutine complete_arrays

  !> Check model data and make the model; it can be solved if there are no errors. If the data have errors
  !! already, their references may be 0: the object was not found, which has been reported.
  subroutine complete_model(data, cases, case, model, found)
    type(scene_type), intent(inout) :: data    !! its arrays are moved
    type(load_cases), intent(in) :: cases      !! of the model
    integer, intent(in) :: case                !! load case of the model
    type(model_type), intent(inout) :: model   !! has ids, if they are not positions
    type(findings), intent(inout) :: found     !! all errors and warnings are added

    if (found%errors == 0) then
      call check_values(data, found)
      if (found%errors > 0) return
    end if
    call make_parts(data, model)
    call complete_elements(model, found)
    call complete_freedoms(data%tie, model, found)
    call check_axis(model, found)
    ! Remove rounding of a mesher near zero. Edges are longer by far, but gaps made of it would load
    ! the model.
    where (abs(model%mesh%x) < least_cause) model%mesh%x = 0.0_wp
    call complete_pairs(model, found)
    call find_line_contacts(model, found)
    if (found%errors == 0) then
      call find_still(cases, model%constraints%held, model%constraints%still)
      call add_tangential_rows(model)
    end if
    call check_controls(model, found)
    call check_loads(model, cases, found)
    if (found%errors > 0) return
    call put_case(cases, case, model)
    call check_body_forces(model, cases%body%given, found)
    call check_pairs(model, found)
    call warn_of_loose_nodes(model, found)
  end subroutine complete_model

  !> Complete ties, platens, SUPORT DOFs, equations and springs. Each is checked against the earlier ones.
  subroutine complete_freedoms(tie, model, found)
    type(dof_tie), intent(in) :: tie(:)
    type(model_type), intent(inout) :: model
    type(findings), intent(inout) :: found
    integer :: c, i, k

    model%constraints%sum_of = spread([0, 0], 2, model%mesh%nodes)
    model%constraints%leader = spread([(i, i=1, model%mesh%nodes)], 1, directions)
    do k = 1, size(tie)
      call tie_freedom(model, k, tie(k), found)
    end do
    if (size(model%constraints%platen) > 0 .and. model%has_rings()) call found%add_error(of_platen, 1, 0, &
      ': '//model%name_of(of_node, model%constraints%platen(1)%leader)// &
      ' would rotate, and axisymmetric bodies do not', &
      'remove the MOMENT, SUPORT or SPC of its direction 6')
    do k = 1, size(model%constraints%platen)
      call turn_followers(model, k, found)
    end do
    call follow_to_the_end(model%constraints%leader)
    do i = 1, model%mesh%nodes
      do c = 1, directions
        if (model%constraints%reference(c, i)) call check_reference(model, c, i, found)
      end do
    end do
    do k = 1, size(model%constraints%platen)
      if (model%constraints%platen(k)%reference) call check_reference(model, angle, &
        model%constraints%platen(k)%leader, found)
    end do
    do k = 1, size(model%constraints%equation)
      call check_equation(model, k, found)
    end do
    call complete_ties(model, found)
    call check_spring_ends(model, found)
  end subroutine complete_freedoms

  !> Check that MUP PAPER has the secant stiffness and plane strain, that flow theory has a method for
  !! histories, and that kinematic hardening has flow theory and a bilinear curve.
  pure subroutine check_controls(model, found)
    type(model_type), intent(inout) :: model
    type(findings), intent(inout) :: found   !! errors are added
    integer :: s

    ! With friction the answer depends on the path of the loads, also if nothing yields.
    if (model%contact%has_friction()) model%controls%by_increments = model%controls%by_increments .or. .not. &
      any([(allocated(model%sections%curve(s)%strain), s=1, size(model%sections%curve))])
    if (model%controls%by_increments) then
      if (model%controls%paper_ratio) call found%add_error(of_theory, 0, 2, &
        ': FLOW does not go with MUP PAPER, a ratio of total theory', 'use MUP EXACT, or THEORY TOTAL')
      if (any(model%controls%method == [method_secant, method_modsec])) &
        call found%add_error(of_theory, 0, 2, &
        ': FLOW does not go with METHOD SECANT or MODSEC, which use the whole strain', &
        'use METHOD NEWTON, INISTR or AUTO, or THEORY TOTAL')
    end if
    do s = 1, size(model%sections%curve)
      associate (curve => model%sections%curve(s))
        if (curve%kinematic == 0.0_wp .or. .not. allocated(curve%stress)) cycle   ! an error of the curve
        if (.not. model%controls%by_increments) then
          call found%add_error(of_theory, 0, 2, ': TOTAL has no kinematic hardening (MATS1 HR 2 or 3)', &
                               'use THEORY FLOW, or HR 1')
          exit
        end if
        if (size(curve%stress) > 3) call found%add_error(of_section, s, item_hardening, &
          ': field 7 (HR): kinematic hardening of a table with more than two slopes', &
          'use HR 1, or a table of three points')
      end associate
    end do
    if (.not. model%controls%paper_ratio) return
    if (model%controls%method == method_newton) &
      call found%add_error(of_paper_ratio, 0, 2, ': PAPER does not go with METHOD NEWTON', &
                           'use METHOD SECANT, MODSEC or INISTR, or MUP EXACT')
    do s = 1, size(model%sections%curve)
      if (model%sections%kinematics(s) == plane_strain .or. &
          .not. allocated(model%sections%curve(s)%strain)) cycle
      call found%add_error(of_paper_ratio, 0, 2, &
        ': formula (2-4) for Poisson''s ratio beyond yield (MUP PAPER) is of plane strain; '// &
        model%name_of(of_section, s)//' can yield, and is not', &
        'use plane strain, or MUP EXACT (ORIGINAL takes PAPER)')
      return
    end do
  end subroutine check_controls
end module epcont_contact_geometry_complete
