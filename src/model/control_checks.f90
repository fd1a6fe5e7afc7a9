!> Whether the scene allows what is chosen for the plastic iteration.
module epcont_model_control_checks
  use epcont_element_kinematics, only: plane_strain
  use epcont_model_controls, only: method_newton
  use epcont_model_finding, only: findings, of_paper_ratio, of_section
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_controls

contains

  !> MUP PAPER is of the secant stiffness, and of plane strain.
  pure subroutine check_controls(model, found)
    type(model_type), intent(in) :: model
    type(findings), intent(inout) :: found
    integer :: s

    if (.not. model%controls%paper_ratio) return
    if (model%controls%method == method_newton) &
      call found%add_error(of_paper_ratio, 0, 2, ': PAPER does not go with METHOD NEWTON', &
                           'METHOD SECANT, MODSEC or INISTR, or MUP EXACT')
    do s = 1, size(model%curve)
      if (model%kinematics(s) == plane_strain .or. .not. allocated(model%curve(s)%strain)) cycle
      call found%add_error(of_paper_ratio, 0, 2, ': PAPER is for plane strain, and '//model%name_of(of_section, s)// &
                           ' is not', 'MUP EXACT')
      return
    end do
  end subroutine check_controls
end module epcont_model_control_checks
