!> Messages about unconstrained bodies, and about SUPORT DOFs that measure no rigid-body mode.
module epcont_plan_loose_bodies
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle
  use epcont_model_finding, only: findings, of_body, of_node
  use epcont_model_model, only: model_type
  use epcont_plan_rigid_parts, only: part_motions, rigid_parts
  implicit none
  private
  public :: add_loose_body, add_surplus

  !> Displacements larger than this fraction of the largest are equal to it. Messages name the first of these,
  !! so that rounding does not choose.
  real(wp), parameter :: nearly = 0.999_wp

contains

  !> Report a body with more SUPORT DOFs than rigid-body modes, and name the last SUPORT DOF that can be
  !! removed.
  subroutine add_surplus(model, node, component, dependence, motions, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node(:), component(:)   !! SUPORT DOFs of the body
    real(wp), intent(in) :: dependence(:, :)       !! combinations that measure no mode [SUPORT, any]
    integer, intent(in) :: motions                 !! number of rigid-body modes of the body
    type(findings), intent(inout) :: found         !! an error is added
    character(len=:), allocatable :: direction, name, remedy
    integer :: last

    associate (part => norm2(dependence, dim=2))
      last = findloc(part >= nearly*maxval(part), .true., dim=1, back=.true.)
    end associate
    name = model%name_of(of_node, node(last))
    direction = text_of(component(last))
    remedy = 'use one SUPORT DOF for each rigid-body mode'
    if (component(last) == angle) then
      direction = '6'
      remedy = remedy//'; MOMENT 0.0 lets '//name//' rotate without SUPORT'
    end if
    call found%add_error(of_body, node(last), 0, 'the body of '//name//' has '// &
      plural(motions, 'rigid-body mode')//' and '//plural(size(node), 'SUPORT DOF')//': '//name// &
      ' direction '//direction//' is one too many', remedy)
  end subroutine add_surplus

  !> Report an unconstrained body: its modes, and the DOFs that measure them. The DOF with the largest
  !! displacement is chosen; its mode is subtracted from the others; then the next DOF is chosen.
  subroutine add_loose_body(model, parts, nodes, loose, found)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: nodes(:)          !! nodes of the body
    real(wp), intent(in) :: loose(:, :, :)   !! its unconstrained modes [part_motions, own parts, any]
    type(findings), intent(inout) :: found   !! an error is added
    real(wp) :: motion(directions, size(nodes), size(loose, 3))
    character(len=:), allocatable :: body, cards, text
    logical :: follows(directions, size(nodes))   ! dependent DOFs, which cannot be SUPORT DOFs
    integer :: at(3), i, k, moving

    moving = 0
    do i = 1, size(nodes)
      associate (of_part => loose(:, parts%own(parts%of_node(nodes(i))), :))
        motion(:, i, :) = matmul(parts%rows(model, nodes(i)), of_part)
        if (moving == 0 .and. any(abs(of_part) > no_effect*maxval(abs(loose)))) moving = nodes(i)
      end associate
      follows(:, i) = model%constraints%sum_of(:, nodes(i)) > 0
    end do
    text = ''
    cards = ''
    do k = 1, size(motion, 3)
      at = place_of_most(motion(:, :, k:), follows) + [0, 0, k - 1]
      motion(:, :, [k, at(3)]) = motion(:, :, [at(3), k])
      call take_out(motion, k, at(1), at(2))
      associate (beside => parts%of_node(nodes) == parts%of_node(nodes(at(2))))
        text = text//', '//words(model, motion(:, :, k), nodes, at(2), beside)
      end associate
      cards = cards//','//text_of(model%mesh%node_id(nodes(at(2))))//','//text_of(at(1))
    end do
    body = 'the body of '//model%name_of(of_node, nodes(1))
    if (moving /= nodes(1)) body = 'a part of '//body//', with '//model%name_of(of_node, moving)//','
    if (size(nodes) == 1) body = model%name_of(of_node, moving)//', a node without elements,'
    call found%add_error(of_body, moving, 0, body//' has '// &
                         plural(size(motion, 3), 'unconstrained rigid-body mode')// &
                         ': it can '//text(3:), &
                         'fix it with SPC1, or solve for it with SUPORT'//cards)
  end subroutine add_loose_body

  !> Direction, node and mode of the largest displacement of DOFs that can be SUPORT DOFs.
  pure function place_of_most(motion, follows) result(at)
    real(wp), intent(in) :: motion(:, :, :)   !! [directions, nodes, modes]
    logical, intent(in) :: follows(:, :)      !! cannot be a SUPORT DOF [directions, nodes]
    integer :: at(3)

    associate (moved => merge(0.0_wp, abs(motion), spread(follows, 3, size(motion, 3))))
      at = findloc(moved >= nearly*maxval(moved), .true.)
    end associate
  end function place_of_most

  !> Scale mode k to 1 at a DOF, and subtract it from the other modes so that they do not move this DOF.
  pure subroutine take_out(motion, k, direction, node)
    real(wp), intent(inout) :: motion(:, :, :)       !! [directions, nodes, modes]
    integer, intent(in) :: k, direction, node
    integer :: j

    motion(:, :, k) = motion(:, :, k)/motion(direction, node, k)
    do j = 1, size(motion, 3)
      if (j /= k) motion(:, :, j) = motion(:, :, j) - motion(direction, node, j)*motion(:, :, k)
    end do
  end subroutine take_out

  !> Describe a mode at one of the nodes. A part translates if all its nodes have the same displacement.
  pure function words(model, motion, nodes, k, beside) result(text)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: motion(:, :)   !! [directions, nodes]
    integer, intent(in) :: nodes(:)        !! nodes of the body
    integer, intent(in) :: k               !! position of the node in this list
    logical, intent(in) :: beside(:)       !! nodes of the same part
    character(len=:), allocatable :: text
    real(wp) :: unit(directions)

    text = 'translate'
    associate (mask => spread(beside, 1, directions))
      if (sum(maxval(motion, dim=2, mask=mask) - minval(motion, dim=2, mask=mask)) > no_effect) &
        text = 'rotate so that '//model%name_of(of_node, nodes(k))//' moves'
    end associate
    unit = real(nint(motion(:, k)/norm2(motion(:, k))*1.0e4_wp), wp)*1.0e-4_wp   ! rounding removed
    text = text//' along ('//short_real(unit(1))//', '//short_real(unit(2))//')'
  end function words
end module epcont_plan_loose_bodies
