!> What the scene does, the pairs in contact held closed, under a unit load along each free motion, and when
!> their gaps shrink: what tells of an error anywhere how much of it arrives at the approach, and at sums of
!> contact forces.
module epcont_accuracy_unit_motion
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: solved_to
  use epcont_contact_basis, only: contact_basis, respond
  use epcont_contact_scaling, only: scaled_problem
  use epcont_flexibility_flexibility, only: pair_forces
  use epcont_plan_planned_scene, only: planned_scene
  use epcont_linear_linear_problem, only: linear_problem
  implicit none
  private
  public :: closing_forces, unit_forces, unit_strains

contains

  !> Contact forces under unit loads [pairs, motions]; zero for motions that are not kept.
  pure function unit_forces(problem, basis, motions) result(force)
    type(scaled_problem), intent(in) :: problem
    type(contact_basis), intent(in) :: basis
    integer, intent(in) :: motions
    real(wp), allocatable :: force(:, :)
    real(wp), allocatable :: opening(:, :), load(:, :), carried(:, :), approach(:, :)
    integer :: j

    allocate (force(size(problem%gap), motions), source=0.0_wp)
    if (.not. basis%sound) return
    allocate (opening(size(basis%pairs), size(problem%kept)), load(size(problem%kept), size(problem%kept)), source=0.0_wp)
    do j = 1, size(problem%kept)
      load(j, j) = 1.0_wp/problem%motion_size(problem%kept(j))
    end do
    call respond(basis, opening, load, carried, approach)
    force(basis%pairs, problem%kept) = carried
  end function unit_forces

  !> Contact forces when the gap of each pair shrinks by its weight; none where motions give way to that
  !! [force/length] [pairs, any].
  pure function closing_forces(problem, basis, weight) result(force)
    type(scaled_problem), intent(in) :: problem
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: weight(:, :)   !! [pairs, any]
    real(wp), allocatable :: force(:, :)
    real(wp), allocatable :: opening(:, :), load(:, :), carried(:, :), approach(:, :)
    integer :: j

    allocate (force(size(problem%gap), size(weight, 2)), source=0.0_wp)
    if (.not. basis%sound) return
    opening = -weight(basis%pairs, :)/problem%gap_unit
    allocate (load(size(problem%kept), size(weight, 2)), source=0.0_wp)
    call respond(basis, opening, load, carried, approach)
    do j = 1, size(weight, 2)
      if (maxval(abs(carried(:, j))) > solved_to*maxval(abs(opening(:, j)))) &
        force(basis%pairs, j) = carried(:, j)*problem%force_unit
    end do
  end function closing_forces

  !> Strains of such forces [4, points].
  pure function unit_strains(scene, linear, force) result(strain)
    type(planned_scene), intent(in) :: scene
    type(linear_problem), intent(in) :: linear
    real(wp), intent(in) :: force(:)   !! [pairs]
    real(wp), allocatable :: strain(:, :)

    associate (model => scene%model)
      strain = linear%operator%strains(model, linear%displacements(scene, pair_forces(model, force), 0.0_wp))
    end associate
  end function unit_strains
end module epcont_accuracy_unit_motion
