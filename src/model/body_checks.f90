!> Body loads of a scene that is whole: are they forces, and do they go with its lines of symmetry?
module epcont_model_body_checks
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real
  use epcont_base_tolerances, only: same_place
  use epcont_deck_entry, only: farthest, least_cause
  use epcont_geometry_plane, only: extent_of
  use epcont_model_arrays, only: body_load
  use epcont_model_body_forces, only: body_forces, weigh_nodes
  use epcont_model_finding, only: findings, of_body_load, of_node
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_body_loads

contains

  !> Look at each body load whose factor is not 0, of all load cases, and weigh the nodes.
  subroutine check_body_loads(model, load, found)
    type(model_type), intent(inout) :: model   !! the scene, whole and with its supports
    type(body_load), intent(in) :: load(:)     !! in the order of their cards
    type(findings), intent(inout) :: found     !! what is wrong with it is added
    real(wp) :: largest
    integer :: k

    if (any(load%factor /= 0.0_wp) .and. .not. allocated(model%mass)) call weigh_nodes(model)
    do k = 1, size(load)
      if (load(k)%factor == 0.0_wp) cycle
      largest = maxval(abs(body_forces(model, load(k))))
      if (largest /= 0.0_wp .and. .not. (largest >= least_cause .and. largest <= farthest)) &
        call found%add_error(of_body_load, k, 0, ': its forces, up to '//short_real(largest)// &
                             ', are too far from 1.0', 'other units: forces from '// &
                             short_real(least_cause)//' to '//short_real(farthest))
      if (load(k)%spin /= 0.0_wp .and. .not. model%has_rings()) call look_at_mirrors(k)
    end do

  contains

    !> Warn of a spin about a point beside a line of symmetry: sides along an axis whose nodes are held across
    !! it, and free along it.
    subroutine look_at_mirrors(k)
      integer, intent(in) :: k
      integer :: c, e, edge(3), side
      real(wp) :: extent

      extent = maxval(extent_of(model%x(:, model%around%members())))
      do e = 1, model%elements
        do side = 1, model%corners(e)
          edge = model%edge(e, side)
          associate (a => edge(1), b => edge(2), centre => load(k)%centre)
            do c = 1, 2
              if (.not. (holds_across(c, a) .and. holds_across(c, b))) cycle
              if (abs(model%x(c, a) - model%x(c, b)) > same_place*extent .or. &
                  abs(model%x(c, a) - centre(c)) <= same_place*max(extent, abs(centre(c)))) cycle
              call found%add_warning(of_body_load, k, 0, ': its axis lies beside the line from '// &
                model%name_of(of_node, a)//' to '//model%name_of(of_node, b)//', which is held across'// &
                ' and free along itself: what is symmetric spins about a point of its line of symmetry', &
                'a centre on that line; no harm where that is no line of symmetry')
              return
            end do
          end associate
        end do
      end do
    end subroutine look_at_mirrors

    !> Is a node held at its place across a line along an axis, and free along it?
    pure logical function holds_across(c, node)
      integer, intent(in) :: c, node   !! the direction across

      holds_across = model%is_held(c, node) .and. .not. model%is_held(3 - c, node)
      if (holds_across) holds_across = model%prescribed(c, model%leader(c, node)) == 0.0_wp
    end function holds_across
  end subroutine check_body_loads
end module epcont_model_body_checks
