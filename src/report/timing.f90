!> What --timing prints: where the time of a run went.
module epcont_report_timing
  use epcont_base_kinds, only: i8, wp
  use epcont_report_layout, only: newline
  use epcont_system_stopwatch, only: stage_name, stages, stopwatch
  implicit none
  private
  public :: timing_text

contains

  !> A row a stage; each begins with the name of the deck, so that those of many decks in one file can be told
  !! apart.
  pure function timing_text(stem, watch, peak) result(text)
    character(len=*), intent(in) :: stem    !! name of the deck
    class(stopwatch), intent(in) :: watch   !! times of the stages
    integer(i8), intent(in) :: peak         !! memory [bytes]
    character(len=:), allocatable :: text
    character(len=13) :: buffer
    integer :: k

    text = stem//': stage               wall s  processor s'//newline
    do k = 1, stages
      text = text//row(stage_name(k), watch%wall(k), watch%processor(k))
    end do
    text = text//row('all          ', sum(watch%wall), sum(watch%processor))
    write (buffer, '(f13.1)') real(peak, wp)/1.0e6_wp
    text = text//stem//': peak memory  '//buffer//' MB'//newline

  contains

    pure function row(name, wall, processor)
      character(len=13), intent(in) :: name
      real(wp), intent(in) :: wall, processor
      character(len=:), allocatable :: row
      character(len=39) :: line

      write (line, '(a13, f13.4, f13.4)') name, wall, processor
      row = stem//': '//line//newline
    end function row
  end function timing_text
end module epcont_report_timing
