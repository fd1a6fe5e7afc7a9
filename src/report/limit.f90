!> What the largest pressures are beside their figures: bounded, unbounded, or not resolved by the mesh.
module epcont_report_limit
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_base_kinds, only: wp
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: limit_of_zone, limit_of_largest, reason_of

  character(len=*), parameter, public :: unbounded = 'unbounded', not_resolved = 'not resolved'
  character(len=*), parameter :: bounded = 'bounded'

contains

  !> Of the largest pressure of a zone; empty where that is not known, or nothing presses.
  pure function limit_of_zone(answer, accuracy, z) result(word)
    type(answer_type), intent(in) :: answer       !! the answer
    type(accuracy_type), intent(in) :: accuracy   !! what its figures are worth
    integer, intent(in) :: z                      !! the zone
    character(len=:), allocatable :: word

    word = ''
    if (z > size(accuracy%zone)) return
    if (answer%zones(z)%max_pressure < 0.0_wp) return
    word = bounded
    if (accuracy%zone(z)%unbounded) then
      word = unbounded
    else if (.not. accuracy%zone(z)%resolved) then
      word = not_resolved
    end if
  end function limit_of_zone

  !> Of the largest pressure of all.
  pure function limit_of_largest(answer, accuracy) result(word)
    type(answer_type), intent(in) :: answer       !! the answer
    type(accuracy_type), intent(in) :: accuracy   !! what its figures are worth
    character(len=:), allocatable :: word

    word = ''
    if (size(answer%zones) > 0) &
      word = limit_of_zone(answer, accuracy, maxloc(answer%zones%max_pressure, dim=1))
  end function limit_of_largest

  !> What a limit means, for the end of a line of the listing; empty where there is nothing to say.
  pure function reason_of(word) result(text)
    character(len=*), intent(in) :: word   !! of one of the functions above
    character(len=:), allocatable :: text

    text = ''
    if (word == unbounded) text = '   unbounded: it grows with every finer mesh'
    if (word == not_resolved) text = '   not resolved: too few pairs where it is largest'
  end function reason_of
end module epcont_report_limit
