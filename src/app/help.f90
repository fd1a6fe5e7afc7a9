!> What --help prints, from the tables of options and of exit statuses.
module epcont_app_help
  use epcont_app_options, only: option_type, options
  use epcont_base_error, only: status_meaning
  use epcont_base_text, only: text_of
  implicit none
  private
  public :: help_text

  character(len=1), parameter :: newline = new_line('a')
  integer, parameter :: width = 15   !! of the names of options

contains

  !> The text of --help.
  pure function help_text() result(text)
    character(len=:), allocatable :: text
    type(option_type) :: option
    character(len=width) :: name
    integer :: k

    text = 'usage: epcont [options] DECK...'//newline// &
           newline// &
           'Solves the contact of plane bodies and rings from card decks. Results go to DECK.lst and'// &
           ' DECK.*.csv.'//newline// &
           newline
    do k = 1, size(options)
      option = options(k)
      name = option%usage()
      text = text//'  '//name//trim(option%text)//newline
    end do
    text = text//newline//'exit status, of several decks the largest:'//newline
    do k = lbound(status_meaning, dim=1), ubound(status_meaning, dim=1)
      text = text//'  '//text_of(k)//'  '//trim(status_meaning(k))//newline
    end do
  end function help_text
end module epcont_app_help
