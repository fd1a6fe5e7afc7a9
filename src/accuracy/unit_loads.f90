!> What the scene does, the pairs in contact held closed, under a unit load along each free motion, and when
!> their gaps shrink: what tells of an error anywhere how much of it arrives at the approach, and at sums of
!> contact forces. And what an error of the flexibility and of the gaps does to the contact forces.
!>
!> On the pairs in contact these are R = -M g + ..., with M = F^-1 - F^-1 A (A'F^-1 A)^-1 A'F^-1. Errors dF
!> and dg move them by M (dF R + dg), at most |M| (|dF| |R| + |dg|): a bound that no change of units alters
!> (Skeel 1979). Its largest entry is the 1-norm of D M with D = diag(|dF| |R| + |dg|): summed up where pairs
!> are few, else estimated from a few products (Hager 1984; Higham 1988).
module epcont_accuracy_unit_loads
  use epcont_accuracy_body_loads, only: contact_loads
  use epcont_accuracy_joined_loads, only: contact_sensitivity, find_joined_loads
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference, no_effect, solved_to
  use epcont_contact_basis, only: contact_basis, move_basis, renew_basis, respond
  use epcont_contact_equilibrium, only: find_rigid_start, rigid_start
  use epcont_contact_scaling, only: drop_motions, gaps_by_forces, scale_problem, scaled_problem
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_motion_matrix, only: dense_motions
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_plan_forecast, only: most_assessed
  use epcont_plan_planned_model, only: planned_model
  use epcont_result_answer, only: answer_type
  use epcont_result_body_force, only: shares_of_pairs
  implicit none
  private
  public :: choose_motions, contact_sensitivity, find_sensitivity, find_unit_loads, load_pairs, unit_loads

  !> Bodies up to which errors are estimated of what each bears: one costs as much as two load cases.
  integer, parameter, public :: most_bodies = 12

  !> Pairs up to which all of M is made: the estimate may stop at one of two nearly equal rows, as rounding
  !! has it.
  integer, parameter :: few_pairs = 200
  integer, parameter :: most_products = 5

  !> A unit load along each free motion, of which those of a few are looked at, then gaps that shrink by what
  !! each pair counts in a sum of forces.
  type :: unit_loads
    type(scaled_problem) :: problem
    type(contact_basis) :: basis              !! of the pairs in contact
    !> Sums of forces are that of all, then each resultant on a body that may be off by itself; what two
    !! bodies exert on each other is one
    type(contact_loads) :: contact
    type(contact_sensitivity) :: sensitivity  !! known only of joined bodies yet
    !> Among these sums, of each component of what contact exerts on each body; 0: loads alone make it;
    !! negative: not known [directions, bodies]
    integer, allocatable :: column(:, :)
    !> The contacts that they are of
    logical, allocatable, private :: pressed(:), touching(:), motion_free(:)
    real(wp), allocatable, private :: probe(:, :)   !! of joined bodies (`find_joined_loads`)
  contains
    procedure, private :: are_of
  end type unit_loads

contains

  !> Unit loads on a scene whose contact has been found. Those of the load case before are kept where it had
  !> the same contacts, and nothing yields.
  subroutine find_unit_loads(scene, linear, answer, loads, kept)
    type(planned_model), intent(in) :: scene     !! that was solved
    !> Of the last solve; the basis of its contact is taken over, and its flexibility must remain
    type(linear_problem), intent(inout), target :: linear
    type(answer_type), intent(in) :: answer      !! with some contact
    type(unit_loads), intent(inout) :: loads     !! of the load case before; and what they do
    logical, intent(out) :: kept                 !! they are those of the case before
    type(unit_loads) :: none
    integer, allocatable :: motion(:)            ! assessed ones
    integer :: j

    motion = choose_motions(scene, abs(answer%contact%approach)*linear%problem%motion%sizes(), &
                            answer%contact%motion_free)
    kept = loads%are_of(answer, motion) .and. .not. linear%materials%yields
    if (kept) then
      if (scene%numbering%joined) call find_joined_loads(scene, linear, answer, loads%contact, loads%probe, &
                                                         loads%sensitivity)
      return
    end if
    loads = none
    loads%contact%motion = motion
    loads%pressed = answer%contact%force > 0.0_wp
    loads%touching = answer%contact%touching
    loads%motion_free = answer%contact%motion_free
    call find_shares()
    if (scene%numbering%joined) then
      call find_joined_loads(scene, linear, answer, loads%contact, loads%probe, loads%sensitivity)
      loads%basis%sound = .true.
    else
      call put_on_pairs()
    end if
    call loads%contact%ask_for([.not. answer%contact%motion_free(motion), &
                                spread(.true., 1, size(loads%contact%share, 2))])

  contains

    !> All loads on the pairs, by the contact's own factor of those that press. Of motions that none of these
    !! resists as many are held as are independent, which says nothing of the others.
    subroutine put_on_pairs()
      type(rigid_start) :: start
      integer, allocatable :: pressed(:)

      loads%problem = scale_problem(linear%problem)
      if (any(answer%contact%motion_free)) then
        pressed = pack([(j, j=1, scene%model%pairs)], answer%contact%force > 0.0_wp)
        call find_rigid_start(dense_motions(loads%problem%motion%rows(pressed)), 0*loads%problem%resultant, &
                              0*loads%problem%gap(pressed), start)
        call drop_motions(loads%problem, start%redundant)
      end if
      call move_basis(linear%basis, loads%basis)
      call renew_basis(loads%basis, loads%problem, answer%contact%force > 0.0_wp)
      call load_pairs(loads%problem, loads%basis, loads%contact)
    end subroutine put_on_pairs

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
        is_free = is_free .and. norm2(rest) <= least_difference
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

  !> Contact forces under unit loads along motions, and when the gap of each pair shrinks by its share: none
  !> if motions close the gaps. By reciprocity a unit load along a motion changes a sum of forces by the
  !> approach that closing the gaps causes.
  pure subroutine load_pairs(problem, basis, loads)
    type(scaled_problem), intent(in) :: problem   !! of the contact
    type(contact_basis), intent(in) :: basis      !! of the pairs in contact
    type(contact_loads), intent(inout) :: loads   !! motions and shares are given
    real(wp), allocatable :: opening(:, :), load(:, :), carried(:, :), approach(:, :)
    integer :: j, motions

    motions = size(loads%motion)
    associate (all_loads => motions + size(loads%share, 2), unit => problem%motion_size)
      allocate (loads%force(size(problem%gap), all_loads), loads%shared(size(unit), size(loads%share, 2)), &
                source=0.0_wp)
      if (.not. basis%sound) return
      allocate (opening(size(basis%pairs), all_loads), load(basis%motions, all_loads), source=0.0_wp)
      do j = 1, motions
        where (basis%kept == loads%motion(j)) load(:, j) = 1.0_wp/unit(loads%motion(j))
      end do
      opening(:, motions + 1:) = -loads%share(basis%pairs, :)/problem%gap_unit
      call respond(basis, opening, load, carried, approach)
      where (abs(carried(:, :motions)) <= least_difference/maxval(unit)) carried(:, :motions) = 0.0_wp
      loads%force(basis%pairs, :motions) = carried(:, :motions)
      do j = motions + 1, all_loads
        if (maxval(abs(carried(:, j))) > solved_to*maxval(abs(opening(:, j)))) &
          loads%force(basis%pairs, j) = carried(:, j)*problem%force_unit
        loads%shared(basis%kept, j - motions) = -approach(:, j)*problem%gap_unit/unit(basis%kept)
      end do
    end associate
  end subroutine load_pairs

  !> Forces that keep the pairs in contact closed where their gaps would open so, nothing else driving them
  !! [pairs in contact, any].
  pure function forces_under(basis, opening) result(carried)
    type(contact_basis), intent(in) :: basis                 !! a sound one
    real(wp), contiguous, intent(in) :: opening(:, :)        !! in scaled units [pairs in contact, any]
    real(wp), allocatable :: carried(:, :), approach(:, :)
    real(wp) :: load(basis%motions, size(opening, 2))

    load = 0.0_wp
    call respond(basis, opening, load, carried, approach)
  end function forces_under

  !> What errors of the stiffness and of the gaps do to the forces.
  pure function find_sensitivity(problem, basis, force, travel, condition) result(found)
    type(scaled_problem), intent(in) :: problem   !! of the contact
    type(contact_basis), intent(in) :: basis      !! of the pairs in contact
    real(wp), intent(in) :: force(:)     !! [force] [pairs]
    real(wp), intent(in) :: travel(:)    !! what the gap of each pair is the sum of, added up [length] [pairs]
    real(wp), intent(in) :: condition    !! of the stiffness
    type(contact_sensitivity) :: found
    real(wp), allocatable :: opening(:), pressed(:), rounding(:)
    real(wp) :: change(2)                !! by these

    if (.not. basis%sound .or. size(basis%pairs) == 0) return
    found%known = .true.
    allocate (pressed(size(force)), source=0.0_wp)
    pressed(basis%pairs) = force(basis%pairs)/problem%force_unit
    opening = gaps_by_forces(problem, pressed, magnitudes=.true.)
    opening = opening(basis%pairs)
    rounding = epsilon(1.0_wp)*(condition*opening + travel(basis%pairs)/problem%gap_unit)
    change = largest_changes(basis, reshape([opening, rounding], [size(opening), 2])) &
             *problem%force_unit/maxval(force)
    found%amplification = change(1)
    found%rounding = min(1.0_wp, change(2))
  end function find_sensitivity

  !> 1-norm of D M, of each D.
  pure function largest_changes(basis, d) result(norm)
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: d(:, :)   !! diagonals [pairs in contact, any]
    real(wp) :: norm(size(d, 2))
    real(wp), allocatable :: opening(:, :)
    integer :: k

    if (size(d, 1) > few_pairs) then
      norm = [(largest_change(basis, d(:, k)), k=1, size(d, 2))]
    else
      allocate (opening(size(d, 1), size(d, 1)), source=0.0_wp)
      do k = 1, size(d, 1)
        opening(k, k) = 1.0_wp
      end do
      norm = maxval(matmul(transpose(d), abs(forces_under(basis, opening))), dim=2)
    end if
  end function largest_changes

  !> 1-norm of D M, estimated.
  pure real(wp) function largest_change(basis, d) result(norm)
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: d(:)
    real(wp) :: x(size(d)), y(size(d)), turned(size(d))
    integer :: k, product

    norm = 0.0_wp
    x = 1.0_wp/size(d)
    do product = 1, most_products
      y = d*change(x)
      if (sum(abs(y)) <= norm) exit
      norm = sum(abs(y))
      turned = change(d*sign(1.0_wp, y))
      k = maxloc(abs(turned), dim=1)
      if (abs(turned(k)) <= dot_product(turned, x)) exit
      x = 0.0_wp
      x(k) = 1.0_wp
    end do
    ! Where all pairs are alike that stays at the start: forces of alternating sign are looked at, too.
    x = [(merge(1.0_wp, -1.0_wp, mod(k, 2) == 0)*(1.0_wp + (k - 1.0_wp)/(size(d) - 1.0_wp)), k=1, size(d))]
    norm = max(norm, sum(abs(d*change(x)))/(1.5_wp*size(d)))

  contains

    !> M g, but for its sign.
    pure function change(gap)
      real(wp), intent(in) :: gap(:)
      real(wp) :: change(size(gap))

      change = reshape(forces_under(basis, reshape(gap, [size(gap), 1])), [size(gap)])
    end function change
  end function largest_change
end module epcont_accuracy_unit_loads
