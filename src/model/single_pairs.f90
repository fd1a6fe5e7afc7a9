!> Pairs of nodes from CGAP: checked, and completed from their nodes.
module epcont_model_single_pairs
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_element_kinematics, only: directions
  use epcont_model_finding, only: findings, of_pair
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: complete_pairs

  !> The length of a unit vector may differ from 1 by this rounding.
  real(wp), parameter :: few_ulps = 8.0_wp*epsilon(1.0_wp)

contains

  !> Complete pairs from nodes, normals and gaps. Node 0 was not found; if a normal is zero, it points
  !! from A to B.
  subroutine complete_pairs(model, found)
    type(model_type), intent(inout) :: model   !! the model
    type(findings), intent(inout) :: found   !! errors are added
    character(len=:), allocatable :: others
    real(wp) :: between(directions)
    integer :: i, overlaps

    do i = 1, model%contact%pairs
      associate (a => model%contact%pair_node(1, i), b => model%contact%pair_node(2, i), &
                 normal => model%contact%normal(:, i))
        if (a == b .or. a == 0 .or. b == 0) then
          if (a == b .and. a > 0) &
            call found%add_error(of_pair, i, 4, ': GA and GB are the same GRID', &
                                 'give a node on each side of the gap')
          model%contact%initial_gap(i) = 0.0_wp
          cycle
        end if
        between = model%mesh%x(:, b) - model%mesh%x(:, a)
        if (all(normal == 0.0_wp)) then
          if (norm2(between) > no_effect*maxval(abs(model%mesh%x(:, [a, b])))) then
            normal = between/norm2(between)
          else
            call found%add_error(of_pair, i, 8, &
                                 ': GA and GB are at one point and field 9 (CID) is blank: no direction', &
                                 'give a CORD2R whose x-axis is the normal')
          end if
        else if (abs(norm2(normal) - 1.0_wp) > few_ulps) then
          normal = normal/norm2(normal)
        end if
        if (model%contact%gap_by_geometry) model%contact%initial_gap(i) = model%contact%initial_gap(i) + &
          dot_product(normal, between)
      end associate
    end do
    model%contact%row_start = [(2*i - 1, i=1, model%contact%pairs + 1)]
    model%contact%row_node = reshape(model%contact%pair_node([2, 1], :), [2*model%contact%pairs])
    model%contact%row_weight = [(1.0_wp, -1.0_wp, i=1, model%contact%pairs)]
    overlaps = count(model%contact%initial_gap < 0.0_wp)
    if (overlaps == 0) return
    ! One warning for all: shrink fits have many.
    i = findloc(model%contact%initial_gap < 0.0_wp, .true., dim=1)
    others = ''
    if (overlaps > 1) others = '; '//text_of(overlaps)//' pairs overlap, by up to '// &
                               short_real(-minval(model%contact%initial_gap))
    call found%add_warning(of_pair, i, 1, ': the initial gap is '// &
                           short_real(model%contact%initial_gap(i))//others, &
                           'give a gap of 0.0 or more, unless you mean an interference fit')
  end subroutine complete_pairs
end module epcont_model_single_pairs
