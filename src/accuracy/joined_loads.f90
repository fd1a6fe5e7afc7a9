!> Unit loads on bodies that are one system, and what errors of the stiffness and of the gaps do to its
!> contact forces: the figures of `unit_loads`, by solves with its factor, which they share.
module epcont_accuracy_joined_loads
  use epcont_accuracy_body_loads, only: contact_loads
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: solved_to
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_flexibility, only: terms_of_openings
  use epcont_linear_joined_response, only: frozen_response, respond_joined
  use epcont_linear_joined_springs, only: suport_values
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_plan_planned_model, only: planned_model
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: contact_sensitivity, find_joined_loads

  !> Openings of gaps that motions explain but for this part of them make no forces: springs of SUPORT
  !! freedoms leave that much.
  real(wp), parameter :: as_motions = 1.0e-5_wp
  !> Motions up to which that is asked of all of them.
  integer, parameter :: few_motions = 40

  type :: contact_sensitivity
    logical :: known = .false.
    !> Relative error of the forces / relative error of the flexibility, at most
    real(wp) :: amplification = 0.0_wp
    real(wp) :: rounding = 0.0_wp        !! what rounding may leave in a force, of the largest
  end type contact_sensitivity

contains

  !> Unit loads along motions, then closing gaps; behind them two columns that tell the 1-norms of D M
  !! (`unit_loads`) by Higham and Tisseur. The second solve makes the loads better, and has the columns that
  !! the first has led to. What the contact forces open gaps by, body by body, is taken from the deformation.
  !> Of another load case with the same contacts the loads are known: those columns alone are new.
  subroutine find_joined_loads(scene, linear, answer, unit_loads, probe, sensitivity)
    type(planned_model), intent(in) :: scene         !! that was solved
    type(linear_problem), intent(inout) :: linear    !! of the last solve
    type(answer_type), intent(in) :: answer          !! with some contact
    !> Motions and shares by which gaps close; contact forces and displacements
    type(contact_loads), intent(inout) :: unit_loads
    !> What the first solve has for the two columns; not allocated: nothing is known [pairs, 2]
    real(wp), allocatable, intent(inout) :: probe(:, :)
    type(contact_sensitivity), intent(out) :: sensitivity
    type(frozen_response) :: found
    !> Sums that the gaps come from, of deformations and of travels; what these change of a force, if they are
    !! as much off, of the largest [length] [pairs, 2], [2]
    real(wp) :: sums(scene%model%pairs, 2), change(2), condition
    integer, allocatable :: pressed(:)
    integer :: j, k, loads, motions

    motions = size(unit_loads%motion)
    loads = merge(0, motions + size(unit_loads%share, 2), allocated(probe))
    pressed = pack([(k, k=1, scene%model%pairs)], answer%contact%force > 0.0_wp)
    allocate (found%load(scene%motions%count, loads + 2), found%opening(scene%model%pairs, loads + 2), &
              found%force(scene%model%pairs, loads + 2), &
              found%displacement(directions, loads + 2, scene%model%nodes), source=0.0_wp)
    if (.not. allocated(probe)) then
      do j = 1, motions
        found%load(unit_loads%motion(j), j) = 1.0_wp
      end do
      found%opening(:, motions + 1:loads) = -unit_loads%share
      call begin_probes(found%opening(:, loads + 1:))
      call respond_joined(linear%joined, scene, linear%factored_bodies, found, at_contact=.true.)
      probe = found%force(:, loads + 1:)
    end if
    call turn_probes(found%opening(:, loads + 1:))
    found%force(:, loads + 1:) = 0.0_wp
    found%displacement(:, loads + 1:, :) = 0.0_wp
    call respond_joined(linear%joined, scene, linear%factored_bodies, found, at_contact=loads == 0)
    change = max(change, maxval(abs(found%force(pressed, loads + 1:)), dim=1)/maxval(answer%contact%force))
    call linear%estimate_condition(scene, condition)
    sensitivity = contact_sensitivity(.true., change(1), rounding())
    if (loads == 0) return
    do j = motions + 1, loads
      if (give_way(found%opening(:, j), suport_values(scene, found%displacement(:, j, :)))) &
        found%force(:, j) = 0.0_wp
    end do
    unit_loads%force = found%force(:, :loads)
    unit_loads%displacement = found%displacement(:, :loads, :)
    allocate (unit_loads%shared(scene%motions%count, loads - motions))
    do j = motions + 1, loads
      unit_loads%shared(:, j - motions) = -suport_values(scene, unit_loads%displacement(:, j, :))
    end do

  contains

    !> What rounding may leave in a force, of the largest: what the last step of the contact has not changed
    !! is right, but for what gaps are the sum of.
    real(wp) function rounding()
      associate (off => epsilon(1.0_wp)*change)
        rounding = min(condition*off(1), linear%joined%correction + off(1))
        rounding = min(1.0_wp, rounding + off(2))
      end associate
    end function rounding

    !> Equal parts, and the alternating column that finds what they cancel.
    subroutine begin_probes(x)
      real(wp), intent(out) :: x(:, :)

      x = 0.0_wp
      x(pressed, 1) = 1.0_wp/size(pressed)
      x(pressed, 2) = [((1 - 2*mod(k, 2))*(1.0_wp + (k - 1.0_wp)/size(pressed)), k=1, size(pressed))]
      x(:, 2) = x(:, 2)/sum(abs(x(:, 2)))
    end subroutine begin_probes

    !> What a solve has told of the norms, and for each of them the column that is next: of M'D the largest
    !! entry is a bound, too.
    subroutine turn_probes(x)
      real(wp), intent(out) :: x(:, :)
      real(wp) :: of_column(2, 2)   ! by sums and columns

      sums(:, 1) = terms_of_openings(scene%model, answer%deformation)
      sums(:, 2) = abs(linear%problem%initial_gap) + &
                   linear%problem%motion%times(answer%contact%approach, magnitudes=.true.)
      where (spread(answer%contact%force <= 0.0_wp, 2, 2)) sums = 0.0_wp
      of_column = matmul(transpose(sums), abs(probe))/maxval(answer%contact%force)
      change = maxval(of_column, dim=2)
      do k = 1, 2
        x(:, k) = sums(:, k)*sign(1.0_wp, probe(:, maxloc(of_column(k, :), dim=1)))
      end do
    end subroutine turn_probes

    !> Do motions open the gaps of the pressed pairs so? Then no forces come of it. Of many motions those that
    !! the solve has led to are looked at; of few their part is taken off by Gram and Schmidt's way, twice,
    !! against rounding.
    logical function give_way(opening, q)
      real(wp), intent(in) :: opening(:), q(:)
      real(wp), allocatable :: closing(:, :), rest(:)
      real(wp) :: all_pairs(size(opening)), length
      integer :: i, k, turn

      all_pairs = opening - linear%problem%motion%times(q)
      rest = all_pairs(pressed)
      give_way = norm2(rest) <= as_motions*norm2(opening(pressed))
      if (size(q) > few_motions) return
      closing = linear%problem%motion%rows(pressed)
      do k = 1, size(closing, 2)
        length = norm2(closing(:, k))
        do turn = 1, 2
          do i = 1, k - 1
            closing(:, k) = closing(:, k) - dot_product(closing(:, i), closing(:, k))*closing(:, i)
          end do
        end do
        if (norm2(closing(:, k)) <= solved_to*length) closing(:, k) = 0.0_wp
        if (any(closing(:, k) /= 0.0_wp)) closing(:, k) = closing(:, k)/norm2(closing(:, k))
        rest = rest - dot_product(closing(:, k), rest)*closing(:, k)
      end do
      give_way = norm2(rest) <= solved_to*norm2(opening(pressed))
    end function give_way
  end subroutine find_joined_loads
end module epcont_accuracy_joined_loads
