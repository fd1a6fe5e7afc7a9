!> Which variable becomes basic next: (3-4) added to the simplex's test for entry (Conry and Seireg 1971).
module epcont_contact_entry_rule
  implicit none
  private
  public :: next_to_enter

contains

  !> The partner of the variable that left, R_k for w_k and w_k for R_k: so never are both basic, and
  !> R_k w_k = 0 throughout.
  elemental function next_to_enter(left) result(entering)
    integer, intent(in) :: left   !! k: R_k, -k: w_k
    integer :: entering

    entering = -left
  end function next_to_enter
end module epcont_contact_entry_rule
