!> How proportional the loading was, at each point that has yielded. Total theory is justified if no stress
!> component falls while the loads grow, and if stress deviators hardly turn (paper, introduction).
module epcont_result_stress_path
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: no_effect, rounded_off
  use epcont_element_kinematics, only: components
  use epcont_material_elasticity, only: equivalent_stress
  use epcont_result_answer, only: answer_type
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: find_stress_path, stress_path

  !> A stress component falls if its rate, over that of the loads, is below this part of the von Mises stress.
  real(wp), parameter :: falls = -0.01_wp

  type :: stress_path
    integer :: falling = 0            !! yielded elements in which a stress component falls
    real(wp) :: turn = 0.0_wp         !! largest angle by which a stress deviator has turned [degree]
    real(wp) :: mean_turn = 0.0_wp    !! mean over the yielded elements [degree]
    integer :: worst = 0              !! element with the largest angle; 0: nothing has yielded
  end type stress_path

contains

  !> Compare the stresses with those of elastic bodies under the same loads, and with those under more load.
  pure function find_stress_path(model, answer, elastic, later, growth) result(path)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer     !! in total theory, converged
    !> Of elastic bodies, and of loads that have grown by a fraction [stress] [components, points]
    real(wp), intent(in) :: elastic(:, :), later(:, :)
    real(wp), intent(in) :: growth              !! this fraction
    type(stress_path) :: path
    logical :: falling(model%mesh%elements)
    real(wp) :: turn(model%mesh%elements)
    integer :: p

    falling = .false.
    turn = 0.0_wp
    do p = 1, model%mesh%points
      if (.not. answer%point(p)%yielded) cycle
      associate (e => model%mesh%point_element(p), now => answer%point_stress(:, p))
        turn(e) = max(turn(e), angle_between(elastic(:, p), now))
        falling(e) = falling(e) .or. any((later(:, p) - now)*sign(1.0_wp, now) < &
                                         falls*growth*equivalent_stress(now))
      end associate
    end do
    path%falling = count(falling)
    if (.not. any(answer%plastic)) return
    path%turn = maxval(turn, mask=answer%plastic)
    ! If angles are equal up to rounding, the first element is named.
    path%worst = findloc(answer%plastic .and. turn >= (1.0_wp - no_effect)*path%turn, .true., dim=1)
    path%mean_turn = sum(turn)/count(answer%plastic)
  end function find_stress_path

  !> Angle between two stress deviators [degree].
  pure real(wp) function angle_between(a, b) result(angle)
    real(wp), intent(in) :: a(components), b(components)   !! stresses xx, yy, zz, xy
    real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp, &
      twice(components) = [1.0_wp, 1.0_wp, 1.0_wp, 2.0_wp]
    real(wp), dimension(components) :: u, v
    real(wp) :: cosine, size_of_both

    u = [a(:3) - sum(a(:3))/3.0_wp, a(4)]
    v = [b(:3) - sum(b(:3))/3.0_wp, b(4)]
    size_of_both = sqrt(sum(twice*u*u))*sqrt(sum(twice*v*v))
    angle = 0.0_wp
    if (size_of_both <= 0.0_wp) return
    cosine = sum(twice*u*v)/size_of_both
    if (1.0_wp - cosine > rounded_off) angle = acos(max(-1.0_wp, cosine))/degree
  end function angle_between
end module epcont_result_stress_path
