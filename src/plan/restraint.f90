!> Conditions on the rigid-body modes of a body. Each is a row of weights whose product with a mode is zero. A
!> mode has three unknowns for each rigid part of the body: displacements along x and y, and rotation.
module epcont_plan_restraint
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle, spring_type
  use epcont_model_model, only: model_type
  use epcont_plan_rigid_parts, only: part_motions, rigid_parts
  implicit none
  private
  public :: restraint_rows, row_of

contains

  !> Rows of hinges, of motions that parts cannot make, and of supports, ties and springs of one body.
  function restraint_rows(model, parts, nodes) result(rows)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: nodes(:)         !! nodes of the body
    real(wp), allocatable :: rows(:, :)
    logical :: bound(directions, size(nodes))
    integer, allocatable :: hinge(:), own(:), platen(:), spring(:)   ! numbers of those of the body
    real(wp) :: of_node(directions, part_motions)
    integer :: b, c, i, k, last

    b = model%mesh%body(nodes(1))
    bound = model%constraints%held(:, nodes) .or. &
      model%constraints%leader(:, nodes) /= spread(nodes, 1, directions) .or. &
            model%constraints%sum_of(:, nodes) > 0
    own = pack([(i, i=1, parts%count)], parts%body == b)
    hinge = pack([(i, i=1, size(parts%hinge, 2))], model%mesh%body(parts%hinge(1, :)) == b)
    platen = pack([(i, i=1, size(model%constraints%platen))], &
                  model%constraints%platen%held .and. model%mesh%body(model%constraints%platen%leader) == b)
    spring = pack([(i, i=1, size(model%constraints%spring))], &
                  [(model%mesh%body(maxval(model%constraints%spring(i)%node)) == b, i=1, &
                    size(model%constraints%spring))])
    last = directions*size(hinge) + count(parts%cannot(:, own)) + count(bound) + size(platen) + size(spring)
    allocate (rows(last, part_motions*size(own)), source=0.0_wp)
    last = 0
    do i = 1, size(hinge)
      of_node = parts%rows(model, parts%hinge(1, hinge(i)))
      do k = 2, 3
        associate (at => parts%column(parts%hinge(k, hinge(i))))
          rows(last + 1:last + directions, at + 1:at + part_motions) = (5 - 2*k)*of_node
        end associate
      end do
      last = last + directions
    end do
    do i = 1, size(own)
      do c = 1, part_motions
        if (.not. parts%cannot(c, own(i))) cycle
        last = last + 1
        rows(last, parts%column(own(i)) + c) = 1.0_wp
      end do
    end do
    do i = 1, size(nodes)
      do c = 1, directions
        if (.not. bound(c, i)) cycle
        last = last + 1
        rows(last, :) = row_of_tie(model, parts, size(rows, 2), c, nodes(i))
      end do
    end do
    do i = 1, size(platen)
      rows(last + i, :) = row_of(model, parts, size(rows, 2), angle, platen(i))
    end do
    last = last + size(platen)
    do i = 1, size(spring)
      rows(last + i, :) = row_of_spring(model, parts, size(rows, 2), model%constraints%spring(spring(i)))
    end do
  end function restraint_rows

  !> The displacement of a DOF. For an angle, the displacement at the extent of the body caused by the
  !! rotation.
  pure function row_of(model, parts, columns, c, node) result(row)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: columns           !! unknowns of the body
    integer, intent(in) :: c, node           !! the DOF; component `angle`: of the platen with this number
    real(wp) :: row(columns), of_node(directions, part_motions)

    row = 0.0_wp
    if (c == angle) then
      row(parts%column(parts%of_platen(node)) + part_motions) = 1.0_wp
    else
      of_node = parts%rows(model, node)
      associate (at => parts%column(parts%of_node(node)))
        row(at + 1:at + part_motions) = of_node(c, :)
      end associate
    end if
  end function row_of

  !> The displacement of a DOF less that of its master, or less the sum on which it depends.
  pure function row_of_tie(model, parts, columns, c, node) result(row)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: columns, c, node
    real(wp) :: row(columns), weight
    integer :: i

    row = row_of(model, parts, columns, c, node)
    if (model%constraints%leader(c, node) /= node) then
      row = row - row_of(model, parts, columns, c, model%constraints%leader(c, node))
    else if (model%constraints%sum_of(c, node) > 0) then
      associate (sum => model%constraints%sum(model%constraints%sum_of(c, node)))
        do i = 1, size(sum%node)
          weight = sum%coefficient(i)
          if (sum%component(i) == angle) weight = weight/parts%extent(model%mesh%body(node))
          row = row - weight*row_of(model, parts, columns, sum%component(i), sum%node(i))
        end do
      end associate
    end if
  end function row_of_tie

  !> The elongation of a spring.
  pure function row_of_spring(model, parts, columns, spring) result(row)
    type(model_type), intent(in) :: model
    type(rigid_parts), intent(in) :: parts
    integer, intent(in) :: columns
    type(spring_type), intent(in) :: spring
    real(wp) :: row(columns)
    integer :: i

    row = 0.0_wp
    do i = 1, 2
      if (spring%node(i) > 0) &
        row = row + (2*i - 3)*row_of(model, parts, columns, spring%component(i), spring%node(i))
    end do
  end function row_of_spring
end module epcont_plan_restraint
