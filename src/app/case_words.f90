!> What a run says of a load case: its warnings on standard error, and its line on standard output.
module epcont_app_case_words
  use epcont_base_error, only: status_valid
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, shown, text_of
  use epcont_report_columns, only: known, listed_number, number, right
  use epcont_messages_outcome, only: limit_of_pressure, reason_of, remark_lines
  use epcont_report_run, only: run_results
  implicit none
  private
  public :: case_words, words_of

  type :: case_words
    logical :: known = .false.                   !! the case was solved
    integer :: status = status_valid             !! its exit status
    character(len=:), allocatable :: remarks     !! lines of standard error
    character(len=:), allocatable :: line        !! of standard output
  end type case_words

contains

  !> Of a case that was judged.
  pure function words_of(run, path, name) result(words)
    type(run_results), intent(in) :: run         !! with its answer and outcome
    character(len=*), intent(in) :: path, name   !! of the deck, and what its results are called
    type(case_words) :: words

    words%known = .true.
    words%status = run%outcome%status
    words%remarks = behind_name(remark_lines(run%outcome%found, .false.))
    if (len(run%outcome%sentence) > 0) &
      words%remarks = words%remarks//behind_name(run%outcome%sentence//newline)
    words%line = one_line()

  contains

    !> Lines, each behind the name of the deck.
    pure function behind_name(text) result(lines)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: lines
      integer :: from, to

      lines = ''
      from = 1
      do while (from <= len(text))
        to = from + index(text(from:), newline) - 2
        lines = lines//shown(path)//case_name()//': '//text(from:to + 1)
        from = to + 2
      end do
    end function behind_name

    !> Which load case is meant, where there are several.
    pure function case_name() result(text)
      character(len=:), allocatable :: text

      text = ''
      if (run%has_cases()) text = ' SUBCASE '//text_of(run%deck%subcase(run%case)%id)
    end function case_name

    !> Stem, status, largest pressure, first approach; of a pressure that has no limit, or none that the mesh
    !! shows, that too.
    pure function one_line() result(text)
      character(len=:), allocatable :: limit, text

      text = name//case_name()//'  '//run%outcome%word
      if (.not. run%outcome%has_answer) return
      if (run%model%pairs > 0) then
        text = text//'  p_max'//right(listed_number(known, run%answer%largest_pressure(), 0.0_wp), 13)
        limit = limit_of_pressure(run)
        if (len(reason_of(limit)) > 0) text = text//' ('//limit//')'
      end if
      if (run%motions%count > 0) &
        text = text//'  approach'//right(listed_number(number, run%answer%contact%approach(1), 0.0_wp), 13)
    end function one_line
  end function words_of
end module epcont_app_case_words
