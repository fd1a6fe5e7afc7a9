!> Checks of loads: pressures act on edges of elements, body loads on mass.
module epcont_model_load_checks
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_base_tolerances, only: same_place
  use epcont_deck_entry, only: farthest, least_cause
  use epcont_geometry_plane, only: extent_of
  use epcont_model_arrays, only: body_load
  use epcont_model_body_forces, only: body_forces, weigh_nodes
  use epcont_model_finding, only: and_more, findings, item_acceleration, item_centre, item_density, &
      item_spin_up, of_body_load, of_element, of_node, of_pressure, of_section
  use epcont_model_load_cases, only: load_cases, set_pressure
  use epcont_model_model, only: model_type
  use epcont_model_pressure, only: find_side
  implicit none
  private
  public :: check_body_forces, check_loads

contains

  !> Check those properties of the loads of all load cases that do not depend on supports.
  subroutine check_loads(model, cases, found)
    type(model_type), intent(in) :: model     !! the model: its mesh and sections
    type(load_cases), intent(in) :: cases     !! cases of the model
    type(findings), intent(inout) :: found    !! errors are added

    call check_pressures(model, cases%pressure, found)
    if (all(cases%body%given%factor == 0.0_wp)) return
    call check_masses(model, found)
    if (model%has_rings()) call check_ring_loads(cases%body%given, found)
  end subroutine check_loads

  !> Check that pressures act on edges of their elements. All those inside a body give one warning.
  subroutine check_pressures(model, pressure, found)
    type(model_type), intent(in) :: model
    type(set_pressure), intent(in) :: pressure(:)
    type(findings), intent(inout) :: found
    integer :: behind(size(pressure)), ends(3), k

    behind = 0
    do k = 1, size(pressure)
      associate (e => pressure(k)%given%element)
        if (any(model%mesh%connectivity(:model%mesh%node_count(e), e) == 0)) cycle
        call find_side(model, pressure(k)%given, ends, behind(k))
        if (ends(1) == 0) call found%add_error(of_pressure, k, 0, &
          ': GA and GB are not the ends of an edge of '//model%name_of(of_element, e), &
          'give two neighbouring corners of the element')
      end associate
    end do
    k = findloc(behind > 0, .true., dim=1)
    if (k > 0) call found%add_warning(of_pressure, k, 0, ': presses inside a body, between '// &
      model%name_of(of_element, pressure(k)%given%element)//' and '//model%name_of(of_element, behind(k))// &
      and_more(count(behind > 0), '; so do ', ' more'), 'give an edge of one element only')
  end subroutine check_pressures

  !> Check that sections have mass. Those of one material are reported once.
  subroutine check_masses(model, found)
    type(model_type), intent(in) :: model
    type(findings), intent(inout) :: found
    logical :: massless(size(model%sections%density))
    integer :: s

    massless = model%sections%density <= 0.0_wp .and. [(any(model%mesh%section == s), s=1, size(massless))]
    do s = 1, size(massless)
      if (.not. massless(s)) cycle
      if (any(massless(:s - 1) .and. model%sections%material_id(:s - 1) == &
              model%sections%material_id(s))) cycle
      call found%add_error(of_section, s, item_density, ': field 6 (RHO) leaves '// &
                           model%name_of(of_section, s)//' without mass, on which GRAV and RFORCE act', &
                           'give a density above 0.0')
    end do
  end subroutine check_masses

  !> Check that body loads are axisymmetric.
  subroutine check_ring_loads(load, found)
    type(body_load), intent(in) :: load(:)   !! in the order of their cards
    type(findings), intent(inout) :: found
    character(len=*), parameter :: of_rings = 'write 0.0: axisymmetric loads act along the axis, which is y'
    integer :: k

    do k = 1, size(load)
      if (load(k)%factor == 0.0_wp) cycle
      if (load(k)%acceleration(1) /= 0.0_wp) &
        call found%add_error(of_body_load, k, item_acceleration, &
                             ': field 5 (N1) points across the axis', of_rings)
      if (load(k)%centre(1) /= 0.0_wp) call found%add_error(of_body_load, k, item_centre, &
        ': field 3 (G) is off the axis of the axisymmetric bodies, x = 0.0', &
        'give a node on it, or leave it blank')
      if (load(k)%spin_up /= 0.0_wp) &
        call found%add_error(of_body_load, k, item_spin_up, &
                             ': field 12 (RACC) points around the axis', of_rings)
    end do
  end subroutine check_ring_loads

  !> Check all body loads whose factor is not 0 for overflow and for symmetry;
  !! compute the masses of nodes.
  subroutine check_body_forces(model, load, found)
    type(model_type), intent(inout) :: model   !! complete, with its supports
    type(body_load), intent(in) :: load(:)     !! in the order of their cards
    type(findings), intent(inout) :: found     !! errors are added
    real(wp) :: largest
    integer :: k

    if (any(load%factor /= 0.0_wp) .and. .not. allocated(model%loads%mass)) call weigh_nodes(model)
    do k = 1, size(load)
      if (load(k)%factor == 0.0_wp) cycle
      largest = maxval(abs(body_forces(model, load(k))))
      if (largest /= 0.0_wp .and. .not. (largest >= least_cause .and. largest <= farthest)) &
        call found%add_error(of_body_load, k, 0, ': its forces, up to '//short_real(largest)// &
                             ', are too far from 1.0', 'use other units: forces from '// &
                             short_real(least_cause)//' to '//short_real(farthest))
      if (load(k)%spin /= 0.0_wp .and. .not. model%has_rings()) call look_at_mirrors(k)
    end do

  contains

    !> Warn if the rotation axis is beside a line of symmetry: an axis-parallel edge whose nodes are fixed
    !! across it, and free along it.
    subroutine look_at_mirrors(k)
      integer, intent(in) :: k
      integer :: c, e, edge(3), side
      real(wp) :: extent

      extent = maxval(extent_of(model%mesh%x(:, model%mesh%around%members())))
      do e = 1, model%mesh%elements
        do side = 1, model%mesh%corners(e)
          edge = model%mesh%edge(e, side)
          associate (a => edge(1), b => edge(2), centre => load(k)%centre)
            do c = 1, 2
              if (.not. (holds_across(c, a) .and. holds_across(c, b))) cycle
              if (abs(model%mesh%x(c, a) - model%mesh%x(c, b)) > same_place*extent .or. &
                  abs(model%mesh%x(c, a) - centre(c)) <= same_place*max(extent, abs(centre(c)))) cycle
              call found%add_warning(of_body_load, k, 0, ': its axis is beside the line from '// &
                model%name_of(of_node, a)//' to '//model%name_of(of_node, b)//', which is fixed across'// &
                ' and free along itself: a symmetric body rotates about a point of its line of symmetry', &
                'give a centre on that line; ignore this unless it is a line of symmetry')
              return
            end do
          end associate
        end do
      end do
    end subroutine look_at_mirrors

    !> Is a node fixed at zero across a line along an axis, and free along it?
    pure logical function holds_across(c, node)
      integer, intent(in) :: c, node   !! direction across the line

      holds_across = model%constraints%is_held(c, node) .and. .not. model%constraints%is_held(3 - c, node)
      if (holds_across) holds_across = model%loads%prescribed(c, model%constraints%leader(c, node)) == 0.0_wp
    end function holds_across
  end subroutine check_body_forces
end module epcont_model_load_checks
