!> Adjoint loads, the contact forces that they cause, and the displacements of one body under them. With the
!> contact state frozen, an adjoint load on one body presses on others down to the ground. Distant bodies feel
!> only its resultants, and the pairs of a body cannot distinguish more loads than they are. So few loads are
!> solved; the others are linear combinations of these.
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

  !> A load that differs from a linear combination of fields by at most this part of its largest force on any
  !! body is replaced by the combination. With ten times as much, the error of an approach could double
  !! (tilting blocks), and a stack of 30 bodies took only 5 % less time.
  real(wp), parameter :: made_up_for = 1.0e-3_wp

  !> Adjoint loads that act on a body and are not yet part of a batch of adjoint fields.
  type :: body_loads
    integer, allocatable :: pair(:)        !! pairs in contact with a node in the body [its pairs]
    integer, allocatable :: load(:)        !! numbers of the adjoint loads [loads]
    !> Contact forces, in the unit of each load [loads, its pairs]
    real(wp), allocatable :: force(:, :)
  end type body_loads

  !> Some loads, and the few fields whose linear combinations represent them.
  type :: load_batch
    integer, allocatable :: load(:)        !! as in `body_loads` [loads]
    integer, allocatable :: field(:)       !! loads that are solved [fields]
    real(wp), allocatable :: force(:, :)   !! contact forces under these [body's pairs, fields]
    real(wp), allocatable :: share(:, :)   !! factor of each field in each load [fields, loads]
  end type load_batch

contains

  !> Select the loads that act on a body.
  pure function new_body_loads(pair, unit_loads) result(loads)
    integer, intent(in) :: pair(:)                   !! pairs of the body
    type(contact_loads), intent(in) :: unit_loads    !! forces at the pairs
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

  !> Move loads that a few fields can represent to a batch (Gram-Schmidt orthogonalization). The next field is
  !! the load with the largest remainder; if remainders are equal up to rounding, the first.
  pure subroutine choose_fields(loads, batch)
    type(body_loads), intent(inout) :: loads   !! loads that are not in a batch yet
    type(load_batch), intent(out) :: batch     !! fields, and the loads that they represent
    real(wp), allocatable :: rest(:, :)        !! remainder of each load [loads, its pairs]
    real(wp), allocatable :: share(:, :)       !! factor of each direction in each load [loads, fields]
    real(wp) :: along(size(loads%pair))        !! a direction
    real(wp) :: left(size(loads%load))         !! square of the remainder of each load
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

  !> Convert factors of directions to factors of the fields that gave these directions.
  pure subroutine from_directions(chosen, share)
    integer, intent(in) :: chosen(:)            !! the load of each field
    real(wp), intent(inout) :: share(:, :)      !! factor of each direction, then field, in each load [loads,
                                                !! any]
    integer :: i, j

    do i = size(chosen), 1, -1
      share(:, i) = share(:, i)/share(chosen(i), i)
      do j = 1, i - 1
        share(:, j) = share(:, j) - share(chosen(i), j)*share(:, i)
      end do
    end do
  end subroutine from_directions

  !> Move loads to a batch.
  pure subroutine divide(loads, is_told, chosen, share, batch)
    type(body_loads), intent(inout) :: loads   !! the others remain
    logical, intent(in) :: is_told(:)          !! the fields represent the load [loads]
    integer, intent(in) :: chosen(:)           !! the load of each field
    real(wp), intent(in) :: share(:, :)        !! factor of each field in each load [loads, any]
    type(load_batch), intent(out) :: batch     !! fields, and the loads that they represent
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

  !> Find the displacements of nodes of a body under the fields of a batch.
  subroutine find_displacements(scene, linear, b, pair, batch, node, u)
    type(planned_model), intent(in) :: scene     !! solved model
    type(linear_problem), intent(inout) :: linear   !! of the last solve
    integer, intent(in) :: b                     !! the body
    integer, intent(in) :: pair(:)               !! its pairs
    type(load_batch), intent(in) :: batch        !! forces on it
    integer, intent(in) :: node(:)               !! requested nodes
    real(wp), allocatable, intent(out) :: u(:, :, :)   !! [length] [directions, fields, requested nodes]
    type(force_fields) :: loads

    allocate (u(directions, size(batch%force, 2), size(node)))
    if (size(u) == 0) return
    call put_forces(scene%model, b, pair, batch, loads)
    call linear%body_displacements(scene, b, loads, node, u)
  end subroutine find_displacements

  !> Find the forces of pairs on the nodes of a body, one entry of its gap rows after the other.
  pure subroutine put_forces(model, b, pair, batch, loads)
    type(model_type), intent(in) :: model        !! model
    integer, intent(in) :: b, pair(:)            !! the body, its pairs
    type(load_batch), intent(in) :: batch        !! forces on it
    type(force_fields), intent(out) :: loads
    integer :: c, i, k, n

    n = sum(model%contact%row_start(pair + 1) - model%contact%row_start(pair))
    allocate (loads%node(n), loads%force(directions, size(batch%force, 2), n))
    n = 0
    do k = 1, size(pair)
      do i = model%contact%row_start(pair(k)), model%contact%row_start(pair(k) + 1) - 1
        if (model%mesh%body(model%contact%row_node(i)) /= b) cycle
        n = n + 1
        loads%node(n) = model%contact%row_node(i)
        do c = 1, directions
          loads%force(c, :, n) = model%contact%row_weight(i)*model%contact%normal(c, pair(k))*batch%force(k, &
            :)
        end do
      end do
    end do
    loads%node = loads%node(:n)   ! drop unused entries
  end subroutine put_forces
end module epcont_accuracy_body_loads
