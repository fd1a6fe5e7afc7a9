!> A body with motions that neither supports nor SUPORT hold, in words, with the card that would hold them.
module epcont_plan_loose_body
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: no_effect
  use epcont_element_kinematics, only: directions
  use epcont_model_finding, only: findings, of_body, of_node
  use epcont_model_model, only: model_type
  use epcont_plan_rigid_parts, only: rigid_parts
  implicit none
  private
  public :: add_loose_body

  !> Freedoms that move by this part of the largest motion may take its place.
  real(wp), parameter :: nearly = 0.999_wp

contains

  !> Say how a body moves, and the freedoms that would hold it: those that move most, one after the other, each
  !! motion taken out of the others at the freedom chosen for it.
  pure subroutine add_loose_body(model, parts, nodes, loose, found)
    type(model_type), intent(in) :: model      !! the scene
    type(rigid_parts), intent(in) :: parts     !! of all bodies
    integer, intent(in) :: nodes(:)            !! of the body
    real(wp), intent(in) :: loose(:, :, :)     !! motions that nothing holds [part_motions, parts, any]
    type(findings), intent(inout) :: found     !! it is added
    real(wp) :: motion(directions*size(nodes), size(loose, 3))
    character(len=:), allocatable :: body, card, motions
    integer :: at(2), i, j, k, moving

    moving = 0
    do i = 1, size(nodes)
      associate (of_part => loose(:, parts%of_node(nodes(i)), :))
        motion(directions*(i - 1) + 1:directions*i, :) = matmul(parts%rows(model, nodes(i)), of_part)
        if (moving == 0 .and. any(abs(of_part) > no_effect*maxval(abs(loose)))) moving = nodes(i)
      end associate
    end do
    body = 'the body of '//model%name_of(of_node, nodes(1))
    if (moving /= nodes(1)) body = 'a part of '//body//', with '//model%name_of(of_node, moving)//','
    motions = ''
    card = ''
    do k = 1, size(motion, 2)
      ! The first of those that move nearly as much as the largest, so that rounding does not choose.
      associate (moved => abs(motion(:, k:)))
        at = findloc(moved >= nearly*maxval(moved), .true.)
      end associate
      i = at(1)
      j = k + at(2) - 1
      motion(:, [k, j]) = motion(:, [j, k])
      motion(:, k) = motion(:, k)/motion(i, k)
      motions = motions//', '//words(motion(:, k), (i + 1)/directions)
      card = card//','//text_of(model%node_id(nodes((i + 1)/directions)))//','//text_of(2 - mod(i, directions))
      do j = 1, size(motion, 2)
        if (j /= k) motion(:, j) = motion(:, j) - motion(i, j)*motion(:, k)
      end do
    end do
    call found%add_error(of_body, moving, 0, body//' is free to move: '//motions(3:), &
                         'hold it by SPC1, or solve for the motion by SUPORT'//card)

  contains

    !> A motion, as one of the body's nodes has it. A part shifts whose nodes all move alike.
    pure function words(motion, k) result(text)
      real(wp), intent(in) :: motion(directions, size(nodes))
      integer, intent(in) :: k   !! the node's place in the list
      character(len=:), allocatable :: text
      real(wp) :: unit(directions)
      logical :: beside(size(nodes))

      beside = parts%of_node(nodes) == parts%of_node(nodes(k))
      text = 'it shifts'
      if (spread_of(pack(motion(1, :), beside)) + spread_of(pack(motion(2, :), beside)) > no_effect) &
        text = 'it turns, '//model%name_of(of_node, nodes(k))//' moving'
      ! Without rounding.
      unit = real(nint(motion(:, k)/norm2(motion(:, k))*1.0e4_wp), wp)*1.0e-4_wp
      text = text//' along ('//short_real(unit(1))//', '//short_real(unit(2))//')'
    end function words
  end subroutine add_loose_body

  !> Largest value less smallest.
  pure real(wp) function spread_of(values)
    real(wp), intent(in) :: values(:)

    spread_of = maxval(values) - minval(values)
  end function spread_of
end module epcont_plan_loose_body
