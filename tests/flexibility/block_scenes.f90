!> Models of two blocks, one on the other.
module block_scenes
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: plane_strain
  use epcont_model_arrays, only: add_elements, line_couple, new_scene, scene_type, set_pairs, set_sections
  use model_lines, only: lines_of
  implicit none
  private
  public :: turn, two_blocks

contains

  !> Two blocks of about square elements, rotated as a whole, their outer edges fixed. With equal numbers of columns their nodes
  !> are pairs, otherwise the upper one's line is the slave of the lower one's.
  function two_blocks(columns, rows, angle, wave, below, above) result(scene)
    integer, intent(in) :: columns(2), rows   !! of the lower and the upper block; of each
    real(wp), intent(in) :: angle             !! [degree]
    real(wp), intent(in) :: wave              !! height of the contact
    integer, allocatable, intent(out) :: below(:), above(:)   !! nodes at the contact
    type(scene_type) :: scene
    real(wp), allocatable :: x(:, :)
    integer, allocatable :: element(:, :)
    integer :: elements, first, i, n, nodes

    allocate (x(2, sum(columns + 1)*(rows + 1)), element(4, sum(columns)*rows))
    nodes = 0
    elements = 0
    call add_block(columns(1), -1.0_wp)
    below = [(nodes - columns(1) - 1 + i, i=1, columns(1) + 1)]
    first = nodes
    call add_block(columns(2), 1.0_wp)
    above = [(nodes - columns(2) - 1 + i, i=1, columns(2) + 1)]
    scene = new_scene(matmul(turn(angle), x))
    call set_sections(scene, [1000.0_wp], [0.3_wp], [plane_strain])
    call add_elements(scene, 'CQUAD4', element, spread(1, 1, elements))
    scene%held(:, :columns(1) + 1) = .true.
    scene%held(:, first + 1:first + columns(2) + 1) = .true.
    n = size(above)
    if (columns(1) == columns(2)) then
      call set_pairs(scene, reshape([(below(i), above(i), i=1, n)], [2, n]), &
                     spread(matmul(turn(angle), [0.0_wp, 1.0_wp]), 2, n), spread(0.0_wp, 1, n))
    else
      scene%line = lines_of(above, below)
      scene%couple = [line_couple([1, 2])]
    end if

  contains

    !> From its far edge to the contact.
    subroutine add_block(columns, sense)
      integer, intent(in) :: columns
      real(wp), intent(in) :: sense   !! relative to its height
      integer :: c, r

      do r = 0, rows
        do c = 0, columns
          nodes = nodes + 1
          x(:, nodes) = [10.0_wp*c/columns, sense*2.0_wp*(rows - r)/rows + wave*r/rows*cos(4.0_wp*c/columns)]
          if (r == 0 .or. c == 0) cycle
          elements = elements + 1
          element(:, elements) = [nodes - 1, nodes, nodes - columns - 1, nodes - columns - 2]
        end do
      end do
    end subroutine add_block
  end function two_blocks

  !> The matrix of a rotation by an angle [degree].
  pure function turn(angle)
    real(wp), intent(in) :: angle
    real(wp) :: turn(2, 2)
    real(wp), parameter :: degree = acos(-1.0_wp)/180

    turn = reshape([cos(angle*degree), sin(angle*degree), -sin(angle*degree), cos(angle*degree)], [2, 2])
  end function turn
end module block_scenes
