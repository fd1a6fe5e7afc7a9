!> What the scene does, the pairs in contact held closed, under a unit load along each free motion, and when
!> their gaps shrink: what tells of an error anywhere how much of it arrives at the approach, and at sums of
!> contact forces.
module epcont_accuracy_unit_loads
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference, no_effect
  use epcont_element_kinematics, only: directions
  use epcont_linear_contact_rule, only: contact_loads
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_plan_forecast, only: most_assessed
  use epcont_plan_planned_model, only: planned_model
  use epcont_result_answer, only: answer_type
  use epcont_result_body_force, only: shares_of_pairs
  implicit none
  private
  public :: choose_motions, find_unit_loads, unit_loads

  !> Bodies up to which errors are estimated of what each bears: one costs as much as two load cases.
  integer, parameter, public :: most_bodies = 12

  !> A unit load along each free motion, of which those of a few are looked at, then gaps that shrink by what
  !! each pair counts in a sum of forces.
  type :: unit_loads
    !> Sums of forces are that of all, then each resultant on a body that may be off by itself; what two
    !! bodies exert on each other is one
    type(contact_loads) :: contact
    !> Among these sums, of each component of what contact exerts on each body; 0: loads alone make it;
    !! negative: not known [directions, bodies]
    integer, allocatable :: column(:, :)
    !> The contacts that they are of
    logical, allocatable, private :: pressed(:), touching(:), motion_free(:)
  contains
    procedure, private :: are_of
  end type unit_loads

contains

  !> Unit loads on a scene whose contact has been found. Those of the load case before are kept where it had
  !> the same contacts, and nothing yields.
  subroutine find_unit_loads(scene, linear, answer, loads, kept)
    type(planned_model), intent(in) :: scene     !! that was solved
    type(linear_problem), intent(inout) :: linear   !! of the last solve
    type(answer_type), intent(in) :: answer      !! with some contact
    type(unit_loads), intent(inout) :: loads     !! of the load case before; and what they do
    logical, intent(out) :: kept                 !! they are those of the case before
    type(unit_loads) :: none
    integer, allocatable :: motion(:)            ! assessed ones

    motion = choose_motions(scene, abs(answer%contact%approach)*linear%rule%problem%motion%sizes(), &
                            answer%contact%motion_free)
    kept = loads%are_of(answer, motion) .and. .not. linear%materials%yields
    if (.not. kept) then
      loads = none
      loads%contact%motion = motion
      loads%pressed = answer%contact%force > 0.0_wp
      loads%touching = answer%contact%touching
      loads%motion_free = answer%contact%motion_free
      call find_shares()
    end if
    call linear%rule%respond(scene, linear%factored_bodies, answer, loads%contact, kept)
    if (kept) return
    call loads%contact%ask_for([.not. answer%contact%motion_free(motion), &
                                spread(.true., 1, size(loads%contact%share, 2))])

  contains

    !> Shares of pairs in sums of forces. Of bodies that no pair touches, though some might, nothing is known.
    subroutine find_shares()
      real(wp), dimension(scene%model%pairs) :: one, other   !! of one component, of the other
      integer :: body, c, i, k

      allocate (loads%contact%share(scene%model%pairs, 1), source=1.0_wp)
      allocate (loads%column(directions, size(answer%bodies)), &
                source=merge(-1, 0, size(answer%bodies) > most_bodies))
      if (size(answer%bodies) > most_bodies) return
      do i = 1, size(answer%bodies)
        body = answer%bodies(i)%body
        do c = merge(2, 1, scene%model%has_rings()), directions
          if (is_free(body, c)) cycle
          one = shares_of_pairs(scene%model, body, c)
          other = shares_of_pairs(scene%model, body, 3 - c)
          if (any(abs(one) > least_difference) .and. .not. &
              any(abs(one) + abs(other) > least_difference .and. answer%contact%touching)) then
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

    !> Is a body free to move along a component? Then contact bears its loads that way. Motions are one at
    !! their own SUPORT freedom and zero at the others: it is the sum of those measured along it that does so.
    pure logical function is_free(body, c)
      integer, intent(in) :: body, c
      real(wp) :: rest(directions)   !! of the movement of a node
      integer :: i, m

      is_free = .true.
      do i = 1, scene%model%nodes
        if (scene%model%body(i) /= body) cycle
        rest = merge(1.0_wp, 0.0_wp, [1, 2] == c)
        do m = scene%motions%first(body), scene%motions%first(body + 1) - 1
          if (scene%motions%component(m) == c) rest = rest - scene%motions%displacement(scene%model, i, m)
        end do
        is_free = norm2(rest) <= least_difference
        if (.not. is_free) return
      end do
    end function is_free
  end subroutine find_unit_loads

  !> The rigid-body modes with the largest motions, in ascending order. Of equal ones the mode with the least
  !> coordinates of its SUPORT node is taken first, so that the choice does not depend on numbers.
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
      associate (x => scene%model%x(:, scene%motions%node), c => scene%motions%component)
        among = among .and. x(1, :) <= minval(x(1, :), mask=among)
        among = among .and. x(2, :) <= minval(x(2, :), mask=among)
        left(minloc(c, dim=1, mask=among)) = .false.
      end associate
    end do
    chosen = pack([(j, j=1, size(left))], .not. left)
  end function choose_motions

  !> Are these the contacts of an answer, and its assessed modes?
  pure logical function are_of(self, answer, motion)
    class(unit_loads), intent(in) :: self
    type(answer_type), intent(in) :: answer
    integer, intent(in) :: motion(:)

    are_of = allocated(self%pressed)
    if (are_of) are_of = size(motion) == size(self%contact%motion)
    if (.not. are_of) return
    are_of = all(motion == self%contact%motion) .and. &
             all(self%pressed .eqv. answer%contact%force > 0.0_wp) .and. &
             all(self%touching .eqv. answer%contact%touching) .and. &
             all(self%motion_free .eqv. answer%contact%motion_free)
  end function are_of
end module epcont_accuracy_unit_loads
