!> Unit loads, the forces that they cause at the pairs in contact, and displacements of one body under them.
!>
!> Contact frozen, a unit load on one body presses on others down to the ground. But far from it they feel its
!> resultants only, and no body feels more than its pairs can tell apart: of all loads few are solved for, and
!> the others are sums of these.
module epcont_accuracy_body_loads
  use epcont_accuracy_element_errors, only: most_fields
  use epcont_assembly_bodies, only: force_fields
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect
  use epcont_element_kinematics, only: directions
  use epcont_linear_contact_rule, only: contact_loads
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_model_model, only: model_type
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: body_loads, choose_fields, find_displacements, load_batch, new_body_loads

  !> A load that others make up for, but for this part of its largest force on any body, is a sum of these:
  !! with ten times as much the error of an approach could be twice what all loads tell (blocks that tilt),
  !! and a stack of 30 bodies took a twentieth less.
  real(wp), parameter :: made_up_for = 1.0e-3_wp

  !> Of unit loads those that a body feels, and that no batch of fields has told of yet.
  type :: body_loads
    integer, allocatable :: pair(:)        !! those in contact with a node in the body [its pairs]
    integer, allocatable :: load(:)        !! which unit loads these are [loads]
    !> Contact forces, in the unit of each load [loads, its pairs]
    real(wp), allocatable :: force(:, :)
  end type body_loads

  !> Some loads, and the few of them that make up for all.
  type :: load_batch
    integer, allocatable :: load(:)        !! as in `body_loads` [loads]
    integer, allocatable :: field(:)       !! those that are solved for [fields]
    real(wp), allocatable :: force(:, :)   !! under these [body's pairs, fields]
    real(wp), allocatable :: share(:, :)   !! of each field in each load [fields, loads]
  end type load_batch

contains

  !> The loads that a body feels, of those that are asked for.
  pure function new_body_loads(pair, unit_loads) result(loads)
    integer, intent(in) :: pair(:)                   !! those of the body
    type(contact_loads), intent(in) :: unit_loads    !! forces there
    type(body_loads) :: loads
    integer :: j

    associate (felt => unit_loads%force(pair, :) /= 0.0_wp)
      loads%pair = pack(pair, any(felt, dim=2))
      loads%load = pack([(j, j=1, size(felt, 2))], any(felt, dim=1) .and. unit_loads%unit > 0.0_wp)
    end associate
    allocate (loads%force(size(loads%load), size(loads%pair)))
    do j = 1, size(loads%load)
      loads%force(j, :) = unit_loads%force(loads%pair, loads%load(j))/unit_loads%unit(loads%load(j))
    end do
  end function new_body_loads

  !> Take the loads that a few fields make up for out of those that are left: Gram and Schmidt's way, next the
  !! load of which most is left; of loads that are as much, but for rounding, the first.
  pure subroutine choose_fields(loads, batch)
    type(body_loads), intent(inout) :: loads   !! those that are left
    type(load_batch), intent(out) :: batch     !! fields and what they make up for
    real(wp), allocatable :: rest(:, :)        !! of each load [loads, its pairs]
    real(wp), allocatable :: share(:, :)       !! of each direction in each load [loads, fields]
    real(wp) :: along(size(loads%pair))        !! a direction
    real(wp) :: left(size(loads%load))         !! square of what is left of each load
    integer :: chosen(min(most_fields, size(loads%pair), size(loads%load)))
    integer :: fields, k

    rest = loads%force
    allocate (share(size(left), size(chosen)), source=0.0_wp)
    left = 0.0_wp
    do k = 1, size(along)
      left = left + rest(:, k)**2
    end do
    fields = 0
    do
      if (fields == size(chosen) .or. all(left <= made_up_for**2)) exit
      fields = fields + 1
      associate (next => findloc(left >= (1.0_wp - no_effect)*maxval(left), .true., dim=1))
        chosen(fields) = next
        along = rest(next, :)/norm2(rest(next, :))
      end associate
      do k = 1, size(along)
        share(:, fields) = share(:, fields) + along(k)*rest(:, k)
      end do
      do k = 1, size(along)
        rest(:, k) = rest(:, k) - along(k)*share(:, fields)
      end do
      left = left - share(:, fields)**2
      rest(chosen(fields), :) = 0.0_wp
      left(chosen(fields)) = 0.0_wp
    end do
    call from_directions(chosen(:fields), share)
    call divide(loads, left <= made_up_for**2, chosen(:fields), share, batch)
  end subroutine choose_fields

  !> From sums of directions to sums of the fields that gave them.
  pure subroutine from_directions(chosen, share)
    integer, intent(in) :: chosen(:)            !! the load of each field
    real(wp), intent(inout) :: share(:, :)      !! of each direction, then field, in each load [loads, any]
    integer :: i, j

    do i = size(chosen), 1, -1
      share(:, i) = share(:, i)/share(chosen(i), i)
      do j = 1, i - 1
        share(:, j) = share(:, j) - share(chosen(i), j)*share(:, i)
      end do
    end do
  end subroutine from_directions

  !> Hand loads over to a batch.
  pure subroutine divide(loads, is_told, chosen, share, batch)
    type(body_loads), intent(inout) :: loads   !! the others remain
    logical, intent(in) :: is_told(:)          !! the fields make up for it [loads]
    integer, intent(in) :: chosen(:)           !! the load of each field
    real(wp), intent(in) :: share(:, :)        !! of each field in each load [loads, any]
    type(load_batch), intent(out) :: batch     !! fields and what they make up for
    integer :: j

    associate (told => pack([(j, j=1, size(is_told))], is_told), &
               others => pack([(j, j=1, size(is_told))], .not. is_told))
      batch%field = loads%load(chosen)
      batch%force = transpose(loads%force(chosen, :))
      batch%load = loads%load(told)
      batch%share = transpose(share(told, :size(chosen)))
      loads%load = loads%load(others)
      loads%force = loads%force(others, :)
    end associate
  end subroutine divide

  !> Displacements of nodes of a body under the fields of a batch.
  subroutine find_displacements(scene, linear, b, pair, batch, node, u)
    type(planned_model), intent(in) :: scene     !! that was solved
    type(linear_problem), intent(inout) :: linear   !! of the last solve
    integer, intent(in) :: b                     !! the body
    integer, intent(in) :: pair(:)               !! its pairs
    type(load_batch), intent(in) :: batch        !! forces on it
    integer, intent(in) :: node(:)               !! that are asked for
    real(wp), allocatable, intent(out) :: u(:, :, :)   !! [length] [directions, fields, nodes asked for]
    type(force_fields) :: loads

    allocate (u(directions, size(batch%force, 2), size(node)))
    if (size(u) == 0) return
    call put_forces(scene%model, b, pair, batch, loads)
    call linear%body_displacements(scene, b, loads, node, u)
  end subroutine find_displacements

  !> What pairs exert on the nodes of a body, one entry of its rows after the other.
  pure subroutine put_forces(model, b, pair, batch, loads)
    type(model_type), intent(in) :: model        !! the scene
    integer, intent(in) :: b, pair(:)            !! the body, its pairs
    type(load_batch), intent(in) :: batch        !! forces on it
    type(force_fields), intent(out) :: loads
    integer :: c, i, k, n

    n = sum(model%row_start(pair + 1) - model%row_start(pair))
    allocate (loads%node(n), loads%force(directions, size(batch%force, 2), n))
    n = 0
    do k = 1, size(pair)
      do i = model%row_start(pair(k)), model%row_start(pair(k) + 1) - 1
        if (model%body(model%row_node(i)) /= b) cycle
        n = n + 1
        loads%node(n) = model%row_node(i)
        do c = 1, directions
          loads%force(c, :, n) = model%row_weight(i)*model%normal(c, pair(k))*batch%force(k, :)
        end do
      end do
    end do
    loads%node = loads%node(:n)   ! so many of the forces count
  end subroutine put_forces
end module epcont_accuracy_body_loads
