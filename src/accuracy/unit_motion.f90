!> What the scene does, the pairs in contact held closed, under a unit load along each free motion, and when
!> their gaps shrink: what tells of an error anywhere how much of it arrives at the approach, and at sums of
!> contact forces.
module epcont_accuracy_unit_motion
  use epcont_accuracy_body_shares, only: find_shares
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: solved_to
  use epcont_contact_basis, only: contact_basis, new_basis, respond
  use epcont_contact_scaling, only: scale_problem, scaled_problem
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: closing_forces, find_unit_loads, forces_under, unit_loads

  !> A unit load along each free motion, then gaps that shrink by what each pair counts in a sum of forces.
  type :: unit_loads
    type(scaled_problem) :: problem
    type(contact_basis) :: basis              !! of the pairs in contact
    real(wp), allocatable :: force(:, :)      !! at the pairs, under each [pairs, loads]
    integer, allocatable :: moved(:)          !! the loads that say something
    real(wp), allocatable :: share(:, :)      !! of pairs in the sum of all, and in what bodies bear [pairs, any]
    integer, allocatable :: column(:, :)      !! of what each body bears, as `find_shares` says [2, bodies]
  end type unit_loads

contains

  !> Unit loads on a scene whose contact has been found.
  pure function find_unit_loads(scene, linear, answer) result(loads)
    type(planned_scene), intent(in) :: scene     !! that was solved
    type(linear_problem), intent(in) :: linear   !! of the last solve
    type(answer_type), intent(in) :: answer      !! with some contact
    type(unit_loads) :: loads
    integer :: j

    associate (pairs => scene%model%pairs, motions => scene%motions%count, contact => answer%contact)
      loads%problem = scale_problem(linear%problem)
      loads%basis = new_basis(loads%problem, contact%force > 0.0_wp)
      call find_shares(scene%model, scene%motions, contact%touching, answer%bodies, loads%share, loads%column)
      loads%force = reshape([unit_forces(), closing_forces(loads%problem, loads%basis, loads%share)], &
                            [pairs, motions + size(loads%share, 2)])
      loads%moved = pack([(j, j=1, size(loads%force, 2))], any(loads%force /= 0.0_wp, dim=1) .and. &
                         [.not. contact%motion_free, spread(.true., 1, size(loads%share, 2))])
    end associate

  contains

    !> Contact forces under unit loads; zero for motions that are not kept [pairs, motions].
    pure function unit_forces() result(force)
      real(wp) :: force(scene%model%pairs, scene%motions%count)
      real(wp), allocatable :: opening(:, :), load(:, :), carried(:, :), approach(:, :)
      integer :: j

      force = 0.0_wp
      if (.not. loads%basis%sound) return
      associate (pairs => loads%basis%pairs, kept => loads%problem%kept)
        allocate (opening(size(pairs), size(kept)), load(size(kept), size(kept)), source=0.0_wp)
        do j = 1, size(kept)
          load(j, j) = 1.0_wp/loads%problem%motion_size(kept(j))
        end do
        call respond(loads%basis, opening, load, carried, approach)
        force(pairs, kept) = carried
      end associate
    end function unit_forces
  end function find_unit_loads

  !> Contact forces when the gap of each pair shrinks by its weight; none where motions give way to that
  !! [force/length] [pairs, any].
  pure function closing_forces(problem, basis, weight) result(force)
    type(scaled_problem), intent(in) :: problem   !! of the contact
    type(contact_basis), intent(in) :: basis      !! of the pairs in contact
    real(wp), intent(in) :: weight(:, :)          !! [pairs, any]
    real(wp) :: force(size(problem%gap), size(weight, 2))
    real(wp), allocatable :: opening(:, :), carried(:, :)
    integer :: j

    force = 0.0_wp
    if (.not. basis%sound) return
    opening = -weight(basis%pairs, :)/problem%gap_unit
    carried = forces_under(basis, opening)
    do j = 1, size(weight, 2)
      if (maxval(abs(carried(:, j))) > solved_to*maxval(abs(opening(:, j)))) &
        force(basis%pairs, j) = carried(:, j)*problem%force_unit
    end do
  end function closing_forces

  !> Forces that keep the pairs in contact closed where their gaps would open so, nothing else driving them
  !! [pairs in contact, any].
  pure function forces_under(basis, opening) result(carried)
    type(contact_basis), intent(in) :: basis                 !! a sound one
    real(wp), contiguous, intent(in) :: opening(:, :)        !! in scaled units [pairs in contact, any]
    real(wp), allocatable :: carried(:, :), approach(:, :)
    real(wp) :: load(size(basis%resistance, 1), size(opening, 2))

    load = 0.0_wp
    call respond(basis, opening, load, carried, approach)
  end function forces_under
end module epcont_accuracy_unit_motion
