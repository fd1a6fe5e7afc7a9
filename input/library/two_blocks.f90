!> A block on a block, pressed down from above: the contact forces.
program two_blocks
  use epcont
  implicit none
  integer, parameter :: n = 4   ! elements along the contact
  type(scene_type) :: scene
  type(solution_type) :: solution
  type(outcome_type) :: outcome
  real(wp) :: x(2, 4*(n + 1))
  integer :: element(4, 2*n), i, row

  ! Rows of nodes, from below: y = 0, 1 of the lower block, 1, 2 of the upper one.
  x(1, :) = [((real(i, wp), i=0, n), row=0, 3)]
  x(2, :) = [((real((row + 1)/2, wp), i=0, n), row=0, 3)]
  do i = 1, n
    element(:, i) = [i, i + 1, i + n + 2, i + n + 1]
    element(:, n + i) = element(:, i) + 2*(n + 1)
  end do
  scene = new_scene(x)
  call set_sections(scene, young=[2.1e5_wp, 7.0e4_wp], poisson=[0.3_wp, 0.33_wp], &
                    kinematics=[plane_strain, plane_strain])
  call add_elements(scene, 'CQUAD4', element, section=[(1 + (i - 1)/n, i=1, 2*n)])
  associate (below => [(n + 1 + i, i=1, n + 1)], above => [(2*(n + 1) + i, i=1, n + 1)])
    call set_pairs(scene, node=reshape([(below(i), above(i), i=1, n + 1)], [2, n + 1]), &
                   normal=spread([0.0_wp, 1.0_wp], 2, n + 1), gap=spread(0.0_wp, 1, n + 1))
  end associate
  scene%held(:, :n + 1) = .true.                    ! the lower block stands
  scene%held(:, 3*(n + 1) + 1:) = .true.            ! the top of the upper one goes down
  scene%prescribed(2, 3*(n + 1) + 1:) = -0.001_wp
  call solve_scene(scene, solution, outcome)
  if (.not. outcome%has_answer) error stop outcome%sentence
  print '(2a)', 'answer: ', outcome%word
  do i = 1, n + 1
    print '(a, i3, a, f10.4, a, es10.2)', 'pair', i, ': force', solution%answer%contact%force(i), &
      ', gap', solution%answer%contact%gap(i)
  end do
end program two_blocks
