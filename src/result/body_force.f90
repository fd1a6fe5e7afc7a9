!> Contact resultants on bodies, and the factor of each pair in them.
module epcont_result_body_force
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: body_force, find_body_forces, resultants, shares_of_rows

  !> Contact resultant on a body with elements. In axisymmetric models it has no x, since hoop stresses carry
  !! radial forces.
  type :: body_force
    integer :: body = 0                    !! number of the body
    integer :: node = 0                    !! its first node
    real(wp) :: resultant(directions) = 0.0_wp      !! [force]
  end type body_force

contains

  !> Find the contact resultants on all bodies with elements.
  pure function find_body_forces(model, force) result(found)
    type(model_type), intent(in) :: model   !! model
    real(wp), intent(in) :: force(:)        !! [force] [rows]
    type(body_force), allocatable :: found(:)
    real(wp) :: sums(directions, model%mesh%bodies)
    logical :: has_elements(model%mesh%bodies)
    integer :: b, first(model%mesh%bodies), i

    has_elements = .false.
    has_elements(model%mesh%body(model%mesh%connectivity(1, :))) = .true.
    sums = resultants(model, force)
    where (abs(sums) <= cancelled*sum(abs(force))) sums = 0.0_wp
    if (model%has_rings()) sums(1, :) = 0.0_wp
    do i = model%mesh%nodes, 1, -1
      first(model%mesh%body(i)) = i
    end do
    associate (bodies => pack([(b, b=1, model%mesh%bodies)], has_elements))
      found = [(body_force(body=bodies(i), node=first(bodies(i)), resultant=sums(:, bodies(i))), &
                i=1, size(bodies))]
    end associate
  end function find_body_forces

  !> Find the resultants of contact forces on each body [force] [2, bodies].
  pure function resultants(model, force) result(sums)
    type(model_type), intent(in) :: model   !! model
    real(wp), intent(in) :: force(:)        !! [force] [pairs, or rows]
    real(wp) :: sums(directions, model%mesh%bodies)
    real(wp), allocatable :: nodal(:, :)
    integer :: i

    sums = 0.0_wp
    nodal = pair_forces(model, force)
    do i = 1, model%mesh%nodes
      sums(:, model%mesh%body(i)) = sums(:, model%mesh%body(i)) + nodal(:, i)
    end do
  end function resultants

  !> Find the factor of each contact force in one component of the resultant on a body [rows].
  pure function shares_of_rows(model, body, c) result(share)
    type(model_type), intent(in) :: model   !! model
    integer, intent(in) :: body, c          !! the body, the component
    real(wp) :: share(model%contact%rows())
    integer :: first, k, last

    do k = 1, size(share)
      first = model%contact%row_start(k)
      last = model%contact%row_start(k + 1) - 1
      share(k) = model%contact%normal(c, k)*sum(model%contact%row_weight(first:last), &
          mask=model%mesh%body(model%contact%row_node(first:last)) == body)
    end do
  end function shares_of_rows
end module epcont_result_body_force
