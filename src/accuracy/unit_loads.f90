!> Adjoint fields: response of the model, with the active set fixed, to a unit load along each rigid-body mode
!> and to unit changes of gaps. They show how much of a local error reaches an approach or a sum of contact
!> forces.
module epcont_accuracy_unit_loads
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference, no_effect
  use epcont_element_kinematics, only: directions
  use epcont_linear_contact_rule, only: contact_loads
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_plan_forecast, only: most_assessed
  use epcont_plan_planned_model, only: planned_model
  use epcont_result_answer, only: answer_type
  use epcont_result_body_force, only: shares_of_rows
  implicit none
  private
  public :: choose_motions, find_unit_loads, unit_loads

  !> Maximum number of bodies with error estimates of their contact resultants: one takes as long as two load
  !! cases.
  integer, parameter, public :: most_bodies = 12

  !> Adjoint loads: first unit loads along the assessed rigid-body modes, then gap changes by the factor of
  !! each pair in a sum of forces.
  type :: unit_loads
    !> Sums: the total contact force, then each independent resultant on a body. The forces that two bodies
    !! exert on each other are one sum.
    type(contact_loads) :: contact
    !> Number of the sum for each component of the contact resultant on each body; 0 if loads alone determine
    !! it, negative if unknown [directions, bodies]
    integer, allocatable :: column(:, :)
    !> Active set of these fields
    logical, allocatable, private :: pressed(:), touching(:), motion_free(:)
  contains
    procedure, private :: are_of
  end type unit_loads

contains

  !> Find the adjoint fields of a model with known active set. Fields of the previous load case are kept if
  !> its active set is the same and nothing yields.
  subroutine find_unit_loads(scene, linear, answer, loads, kept)
    type(planned_model), intent(in) :: scene     !! solved model
    type(linear_problem), intent(inout) :: linear   !! of the last solve
    type(answer_type), intent(in) :: answer      !! some pairs are in contact
    type(unit_loads), intent(inout) :: loads     !! in: of the previous load case; out: with their response
    logical, intent(out) :: kept                 !! they are those of the previous load case
    type(unit_loads) :: none
    integer, allocatable :: motion(:)            ! assessed modes
    logical, allocatable :: pressed(:)           ! rows with a force between its bounds

    motion = choose_motions(scene, abs(answer%contact%approach)*linear%rule%problem%motion%sizes(), &
                            answer%contact%motion_free)
    pressed = linear%rule%problem%between(answer%contact%row_forces())
    kept = loads%are_of(answer, pressed, motion) .and. .not. linear%materials%yields
    if (.not. kept) then
      loads = none
      loads%contact%motion = motion
      loads%pressed = pressed
      loads%touching = answer%contact%touching
      loads%motion_free = answer%contact%motion_free
      call find_shares()
    end if
    call linear%rule%respond(scene, linear%factored_bodies, answer, loads%contact, kept)
    if (kept) return
    call loads%contact%ask_for([.not. answer%contact%motion_free(motion), &
                                spread(.true., 1, size(loads%contact%share, 2))])

  contains

    !> Find the factors of pairs in sums of forces. If no pair of a body is in contact, although some could
    !! be, its sums are unknown.
    subroutine find_shares()
      real(wp), dimension(scene%model%contact%rows()) :: one, other   !! of one component, and of the other
      integer :: body, c, i, k, pairs

      pairs = scene%model%contact%pairs
      allocate (loads%contact%share(scene%model%contact%rows(), 1), source=0.0_wp)
      loads%contact%share(:pairs, 1) = 1.0_wp
      allocate (loads%column(directions, size(answer%bodies)), &
                source=merge(-1, 0, size(answer%bodies) > most_bodies))
      if (size(answer%bodies) > most_bodies) return
      do i = 1, size(answer%bodies)
        body = answer%bodies(i)%body
        do c = merge(2, 1, scene%model%has_rings()), directions
          if (is_free(body, c)) cycle
          one = shares_of_rows(scene%model, body, c)
          other = shares_of_rows(scene%model, body, 3 - c)
          if (any(abs(one) > least_difference) .and. .not. &
              any(abs(one(:pairs)) + abs(other(:pairs)) > least_difference .and. &
                  answer%contact%touching)) then
            loads%column(c, i) = -1
            cycle
          end if
          do k = 2, size(loads%contact%share, 2)
            if (min(maxval(abs(loads%contact%share(:, k) - one)), &
                    maxval(abs(loads%contact%share(:, k) + one))) <= least_difference) exit
          end do
          if (k > size(loads%contact%share, 2)) &
            loads%contact%share = reshape([loads%contact%share, one], [size(one), k])
          loads%column(c, i) = k
        end do
      end do
    end subroutine find_shares

    !> Can a body translate along a component? Then contact carries its loads in this direction. A mode is one
    !! at its own SUPORT DOF and zero at the others, so the translation is the sum of the modes with SUPORT
    !! DOFs along it.
    pure logical function is_free(body, c)
      integer, intent(in) :: body, c
      real(wp) :: rest(directions)   !! difference from the displacement of a node
      integer :: i, m

      is_free = .true.
      do i = 1, scene%model%mesh%nodes
        if (scene%model%mesh%body(i) /= body) cycle
        rest = merge(1.0_wp, 0.0_wp, [1, 2] == c)
        do m = scene%motions%first(body), scene%motions%first(body + 1) - 1
          if (scene%motions%component(m) == c) rest = rest - scene%motions%displacement(scene%model, i, m)
        end do
        is_free = norm2(rest) <= least_difference
        if (.not. is_free) return
      end do
    end function is_free
  end subroutine find_unit_loads

  !> Choose the rigid-body modes with the largest gap changes, in ascending order. Of equal modes the one with
  !> the least coordinates of its SUPORT node is first, so that the choice does not depend on numbers.
  pure function choose_motions(scene, extent, free) result(chosen)
    type(planned_model), intent(in) :: scene
    real(wp), intent(in) :: extent(:)   !! largest change of a gap by each mode [length] [modes]
    logical, intent(in) :: free(:)      !! undetermined, which come last [modes]
    integer, allocatable :: chosen(:)
    logical, dimension(size(free)) :: left, among   ! not taken yet; the largest of these
    real(wp) :: rank(size(free)), largest
    integer :: j, k

    rank = merge(-1.0_wp, extent, free)
    where (.not. free .and. rank <= least_difference*maxval(rank)) rank = 0.0_wp   ! rounding
    left = .true.
    do k = 1, min(most_assessed, size(left))
      largest = maxval(rank, mask=left)
      among = left .and. rank >= largest - no_effect*abs(largest)
      associate (x => scene%model%mesh%x(:, scene%motions%node), c => scene%motions%component)
        among = among .and. x(1, :) <= minval(x(1, :), mask=among)
        among = among .and. x(2, :) <= minval(x(2, :), mask=among)
        left(minloc(c, dim=1, mask=among)) = .false.
      end associate
    end do
    chosen = pack([(j, j=1, size(left))], .not. left)
  end function choose_motions

  !> Do these fields have the active set and the assessed modes of an answer?
  pure logical function are_of(self, answer, pressed, motion)
    class(unit_loads), intent(in) :: self
    type(answer_type), intent(in) :: answer
    logical, intent(in) :: pressed(:)   !! rows with a force between its bounds
    integer, intent(in) :: motion(:)

    are_of = allocated(self%pressed)
    if (are_of) are_of = size(motion) == size(self%contact%motion)
    if (.not. are_of) return
    are_of = all(motion == self%contact%motion) .and. &
             all(self%pressed .eqv. pressed) .and. &
             all(self%touching .eqv. answer%contact%touching) .and. &
             all(self%motion_free .eqv. answer%contact%motion_free)
  end function are_of
end module epcont_accuracy_unit_loads
