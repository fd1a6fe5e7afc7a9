!> THE table of options. The parser, --help and the manual page come from it; what they do is asked by
!> their names (`asks` of the arguments).
module epcont_app_options
  implicit none
  private
  public :: option_type, find_option

  type :: option_type
    character(len=10) :: name = ''    !! as it is given; blank: no option
    character(len=76) :: text = ''    !! what it does
    !> what follows it: capital letters stand for something, others for themselves; in brackets where it may
    !! be left out
    character(len=6) :: value = ''
    character(len=2) :: short = ''    !! another name of it
    character(len=320) :: more = ''   !! for the manual page alone
  contains
    procedure :: usage
  end type option_type

  type(option_type), parameter, public :: options(*) = [ &
    option_type('-o', 'write results to DIR (default: the current directory)', 'DIR', &
                more='DIR is made where there is none; what it lies in must be there.'), &
    option_type('--check', 'read and check the decks, then stop'), &
    option_type('--plan', 'print model size, methods, memory and operations, then stop'), &
    option_type('--tables', 'write node and element tables, whatever the deck asks for', 'all', &
                more='Without it they are written where the deck has DISPLACEMENT, SPCFORCES or STRESS.'), &
    option_type('--brief', 'write the listing and the summary alone, none of the other tables', &
                more='For many small decks. Tables of nodes and elements that are asked for stand in the '// &
                     'listing then.'), &
    option_type('--vtk', 'write DECK.vtu and DECK.contact.vtu, for ParaView'), &
    option_type('--memory', 'refuse decks that need more memory (default 16)', 'GB'), &
    option_type('--progress', 'tell of every solve on standard error, terminal or not', &
                more='Without it, one line on a terminal tells of runs of more than a second, and goes '// &
                     'when they end: elapsed time, then the operations of the first solve, or iteration, '// &
                     'load factor, change of the displacements, yielded elements, touching pairs.'), &
    option_type('--timing', 'print on standard error where the time of each run went', &
                more='Seconds of wall clock and of processor by stage, and the largest memory of the '// &
                     'process so far.'), &
    option_type('--quiet', 'print nothing on standard output, and no progress unless --progress asks'), &
    option_type('--cards', 'print the manual of the cards, or of one', '[NAME]'), &
    option_type('--man', 'print the manual page: epcont --man | man -l -'), &
    option_type('--version', 'print the version'), &
    option_type('--help', 'print this', short='-h')]

contains

  !> The option of this name, to the letter; a blank name where there is none.
  pure type(option_type) function find_option(word) result(option)
    character(len=*), intent(in) :: word   !! of the command line
    integer :: k

    if (len_trim(word) < len(word)) return   ! to Fortran, blanks at the end make no difference
    do k = 1, size(options)
      if (word == options(k)%name .or. word == options(k)%short) option = options(k)
    end do
  end function find_option

  !> Names and value: `-h, --help`, `--memory GB`.
  pure function usage(self) result(text)
    class(option_type), intent(in) :: self
    character(len=:), allocatable :: text

    text = trim(self%name)
    if (self%short /= '') text = self%short//', '//text
    if (self%value /= '') text = text//' '//trim(self%value)
  end function usage
end module epcont_app_options
