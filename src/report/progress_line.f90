!> How far a run is, in one line.
module epcont_report_progress_line
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_plasticity_expectation, only: expectation_type
  use epcont_plasticity_onlooker, only: iteration_record
  use epcont_report_number, only: rounding_number
  implicit none
  private
  public :: progress_line, duration

contains

  !> Time gone and expected, then what the last solve has found, in the words of the listing. Of a line that
  !! would be longer than `width` the last parts are left out, whole.
  pure function progress_line(stem, elapsed, expected, now, width) result(text)
    character(len=*), intent(in) :: stem             !! name of the deck
    real(wp), intent(in) :: elapsed                  !! [s]
    type(expectation_type), intent(in) :: expected   !! how long it will take
    type(iteration_record), intent(in) :: now        !! iteration 0: before the first solve
    integer, intent(in) :: width                     !! of the terminal, in columns
    character(len=:), allocatable :: text, more
    integer :: room

    text = stem//': '//duration(elapsed)
    if (expected%seconds >= 0.0_wp) text = text//' of about '//duration(expected%seconds)
    more = ''
    if (now%iteration > 0) then
      more = ', iteration '//text_of(now%iteration)//', load factor '//short_real(now%load_factor)// &
             ', change '//rounding_number(now%change)//', yielded '//text_of(now%yielded)//', touching '// &
             text_of(now%touching)
    else if (expected%seconds < 0.0_wp) then
      more = ', first solve after about '//duration(expected%first_solve)
    end if
    room = max(0, width - len(text))
    if (len(text) > width) text = text(:width)
    ! A comma just behind the last column ends a part that has room.
    if (len(more) > room) more = more(:index(more(:room + 1), ',', back=.true.) - 1)
    text = text//more
  end function progress_line

  !> Seconds, minutes or hours in two or three digits.
  pure function duration(seconds) result(text)
    real(wp), intent(in) :: seconds   !! a time [s]
    character(len=:), allocatable :: text
    character(len=24) :: buffer

    if (seconds < 9.95_wp) then
      write (buffer, '(f4.1, a)') seconds, ' s'
    else if (seconds < 119.5_wp) then
      write (buffer, '(i0, a)') nint(seconds), ' s'
    else if (seconds < 119.5_wp*60) then
      write (buffer, '(i0, a)') nint(seconds/60), ' min'
    else
      write (buffer, '(f12.1, a)') seconds/3600, ' h'
    end if
    text = trim(adjustl(buffer))
  end function duration
end module epcont_report_progress_line
