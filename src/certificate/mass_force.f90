!> Nodal forces of mass loads for the certificate, by other integration points than the solver's (Lobatto
!> instead of Gauss).
module epcont_certificate_mass_force
  use epcont_base_kinds, only: wp
  use epcont_certificate_unit_strains, only: slopes_at
  use epcont_element_element_kind, only: element_kind, most_nodes
  use epcont_element_kinematics, only: axisymmetric, directions
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_body_force, given_load

  !> Lobatto points on a line, exact to degree 9, and their weights: from one end to the centre; the other
  !! half is symmetric.
  real(wp), parameter :: root7 = sqrt(7.0_wp), &
    half(3) = [1.0_wp, sqrt((7.0_wp + 2.0_wp*root7)/21.0_wp), sqrt((7.0_wp - 2.0_wp*root7)/21.0_wp)], &
    of_half(3) = [2.0_wp, 14.0_wp - root7, 14.0_wp + root7]/30.0_wp, &
    line(6) = [-half, half], part(6) = [of_half, of_half]
  integer, parameter :: most_places = 36

  !> Integration points of an element type.
  type :: place_table
    integer :: count = 0
    real(wp) :: part(most_places) = 0.0_wp                 !! of the local area
    real(wp) :: share(most_nodes, most_places) = 0.0_wp    !! shape functions of the nodes at a point
    real(wp) :: slope(most_nodes, directions, most_places) = 0.0_wp   !! their derivatives
  end type place_table

contains

  !> Find the nodal forces of mass loads [force] [2, nodes].
  pure subroutine find_body_force(model, force)
    type(model_type), intent(in) :: model   !! model, with mass loads as given
    real(wp), intent(out) :: force(directions, model%mesh%nodes)
    type(place_table) :: table(size(model%mesh%kinds))
    integer :: e, k

    do k = 1, size(model%mesh%kinds)
      call set_places(model%mesh%kinds(k), table(k))
    end do
    force = 0.0_wp
    do e = 1, model%mesh%elements
      call add_element(model, e, table(model%mesh%kind(e)), force)
    end do
  end subroutine find_body_force

  !> Place the points in a square, or in a triangle as a square with a degenerate edge.
  pure subroutine set_places(kind, table)
    type(element_kind), intent(in) :: kind
    type(place_table), intent(out) :: table
    real(wp) :: at(directions), unused(directions, most_nodes)
    integer :: i, j

    do i = 1, size(line)
      do j = 1, size(line)
        at = [line(i), line(j)]
        associate (p => table%count)
          p = p + 1
          table%part(p) = part(i)*part(j)
          if (kind%corners == 3) then
            at = 0.5_wp*(1.0_wp + at)
            table%part(p) = table%part(p)*0.25_wp*(1.0_wp - at(2))
            at(1) = at(1)*(1.0_wp - at(2))
          end if
          call kind%shape(at, table%share(:, p), unused)
          table%slope(:, :, p) = transpose(slopes_at(kind, at))
        end associate
      end do
    end do
  end subroutine set_places

  !> Add the nodal forces of one element.
  pure subroutine add_element(model, e, table, force)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    type(place_table), intent(in) :: table
    real(wp), intent(inout) :: force(:, :)
    real(wp) :: apart(directions, most_nodes), area, here(directions), side(directions, directions)
    integer :: k, n, p

    n = model%mesh%node_count(e)
    associate (nodes => model%mesh%connectivity(:n, e), s => model%mesh%section(e))
      do k = 1, n
        apart(:, k) = model%mesh%x(:, nodes(k)) - model%mesh%x(:, nodes(1))
      end do
      do p = 1, table%count
        side = matmul(apart(:, :n), table%slope(:n, :, p))
        here = model%mesh%x(:, nodes(1)) + matmul(apart(:, :n), table%share(:n, p))
        area = table%part(p)*(side(1, 1)*side(2, 2) - side(1, 2)*side(2, 1))
        if (model%sections%kinematics(s) == axisymmetric) then
          area = area*2.0_wp*acos(-1.0_wp)*here(1)
        else
          area = area*model%sections%thickness(s)
        end if
        here = model%sections%density(s)*area*acceleration(model, s, here)
        do k = 1, n
          force(:, nodes(k)) = force(:, nodes(k)) + table%share(k, p)*here
        end do
      end do
    end associate
  end subroutine add_element

  !> Find the acceleration by all mass loads at a point.
  pure function acceleration(model, section, place) result(pull)
    type(model_type), intent(in) :: model
    integer, intent(in) :: section
    real(wp), intent(in) :: place(directions)
    real(wp) :: gain, omega, pull(directions), radius(directions)   ! in radians, not revolutions
    integer :: i

    pull = 0.0_wp
    do i = 1, size(model%loads%body_load)
      associate (load => model%loads%body_load(i))
        omega = 2.0_wp*acos(-1.0_wp)*load%spin
        gain = 2.0_wp*acos(-1.0_wp)*load%spin_up
        radius = place - load%centre
        if (model%sections%kinematics(section) == axisymmetric) radius = [place(1), 0.0_wp]
        pull = pull + load%factor*(load%acceleration + omega**2*radius)
        pull(1) = pull(1) - load%factor*gain*radius(2)
        pull(2) = pull(2) + load%factor*gain*radius(1)
      end associate
    end do
  end function acceleration

  !> Find the nodal loads of a model, with mass loads from the sum above.
  pure function given_load(model) result(load)
    type(model_type), intent(in) :: model   !! model
    real(wp) :: load(directions, model%mesh%nodes), own(directions, model%mesh%nodes)

    load = model%loads%load
    if (.not. allocated(model%loads%body_force)) return
    call find_body_force(model, own)
    load = load + (own - model%loads%body_force)
  end function given_load
end module epcont_certificate_mass_force
