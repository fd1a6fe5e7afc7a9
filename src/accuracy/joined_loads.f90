!> What errors of the stiffness and of the gaps do to the contact forces of bodies that are one system: the
!> figures of `find_sensitivity`, from few solves with its factor.
module epcont_accuracy_joined_sensitivity
  use epcont_accuracy_unit_loads, only: contact_sensitivity
  use epcont_base_kinds, only: wp
  use epcont_flexibility_flexibility, only: terms_of_openings
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: find_joined_sensitivity

contains

  !> The 1-norms of D M by Higham and Tisseur, two columns at a time, of which each begins with another one:
  !! three solves. What the contact forces open gaps by, body by body, is taken from the deformation.
  function find_joined_sensitivity(scene, linear, answer) result(found)
    type(planned_scene), intent(in) :: scene     !! that was solved
    type(linear_problem), intent(in) :: linear   !! of the last solve
    type(answer_type), intent(in) :: answer      !! with some contact
    type(contact_sensitivity) :: found
    real(wp), dimension(scene%model%pairs, 2) :: turned, x
    !> Sums that the gaps come from, and what rounding leaves of these [length] [pairs]
    real(wp), dimension(scene%model%pairs) :: opening, rounding
    integer, allocatable :: pairs(:)
    integer :: at(2), f, k

    pairs = pack([(k, k=1, scene%model%pairs)], answer%contact%force > 0.0_wp)
    opening = merge(terms_of_openings(scene%model, answer%deformation), 0.0_wp, answer%contact%force > 0.0_wp)
    rounding = epsilon(1.0_wp)*(answer%condition*opening + abs(linear%problem%initial_gap) + &
                                linear%problem%motion%times(answer%contact%approach, magnitudes=.true.))
    call begin()
    call look(x, turned)
    call look(spread(opening, 2, 2)*sign(1.0_wp, turned), turned)
    at = maxloc(abs(turned), dim=1)
    x = 0.0_wp
    do f = 1, 2
      x(at(f), f) = 1.0_wp
    end do
    call look(x, turned)
    found%known = .true.
    found%rounding = min(1.0_wp, found%rounding)

  contains

    !> Equal parts, and the alternating column that finds what they cancel.
    subroutine begin()
      x = 0.0_wp
      x(pairs, 1) = 1.0_wp/size(pairs)
      x(pairs, 2) = [((1 - 2*mod(k, 2))*(1.0_wp + (k - 1.0_wp)/size(pairs)), k=1, size(pairs))]
      x(:, 2) = x(:, 2)/sum(abs(x(:, 2)))
    end subroutine begin

    !> M x, and what it tells of the norms where the columns of x are of size one.
    subroutine look(x, product)
      real(wp), intent(in) :: x(:, :)
      real(wp), intent(out) :: product(:, :)
      real(wp) :: u(2, 2, scene%model%nodes)
      integer :: f

      product = 0.0_wp
      u = 0.0_wp
      call linear%joined%respond(scene, linear%factored_bodies, &
                                 spread(spread(0.0_wp, 1, 2), 1, scene%motions%count), x, product, u)
      do f = 1, 2
        if (sum(abs(x(:, f))) > 1.0_wp + epsilon(1.0_wp)*size(x)) cycle
        found%amplification = max(found%amplification, sum(opening*abs(product(:, f)))/ &
                                  maxval(answer%contact%force))
        found%rounding = max(found%rounding, sum(rounding*abs(product(:, f)))/maxval(answer%contact%force))
      end do
    end subroutine look
  end function find_joined_sensitivity
end module epcont_accuracy_joined_sensitivity
