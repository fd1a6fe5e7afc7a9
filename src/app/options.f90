!> THE table of options, from which the parser, --help and the manual page are made. Other code asks for an
!> option by its name (`asks` of the arguments).
module epcont_app_options
  implicit none
  private
  public :: option_type, find_option

  type :: option_type
    character(len=10) :: name = ''    !! as typed; blank if there is no option
    character(len=76) :: text = ''    !! its effect
    !> value of the option: capital letters are a placeholder, other letters literal; in brackets if it is
    !! optional
    character(len=6) :: value = ''
    character(len=2) :: short = ''    !! alternative name
    character(len=320) :: more = ''   !! more text, only for the manual page
  contains
    procedure :: usage
  end type option_type

  type(option_type), parameter, public :: options(*) = [ &
    option_type('-o', 'write results to DIR (default: the current directory)', 'DIR', &
                more='DIR is created if it does not exist; its parent directory must exist.'), &
    option_type('--check', 'read and check the decks, then stop'), &
    option_type('--plan', 'print model size, methods, memory and operations, then stop'), &
    option_type('--tables', 'write node and element tables, even if the deck does not ask for them', 'all', &
                more='Default: they are written if the deck has DISPLACEMENT, SPCFORCES or STRESS.'), &
    option_type('--brief', 'write only the listing and the summary, no other tables', &
                more='For many small decks. The listing then contains the requested tables of nodes and '// &
                     'elements.'), &
    option_type('--vtk', 'write DECK.vtu and DECK.contact.vtu for ParaView'), &
    option_type('--vtk-all', 'the same after each increment, and DECK.pvd for all', &
                more='Of increment 1: DECK.inc1.vtu, or DECK.case2.inc1.vtu with several load cases. '// &
                     'The time in DECK.pvd is the load factor, plus the number of the load case less 1.'), &
    option_type('--memory', 'reject decks that need more memory (default 16)', 'GB'), &
    option_type('--progress', 'report every solve on standard error, even without a terminal', &
                more='Default: runs of more than a second show one line on a terminal, erased at the '// &
                     'end: the elapsed time, then the operations of the first solve, or iteration, load '// &
                     'factor, change of the displacements, yielded elements, pairs in contact.'), &
    option_type('--timing', 'print the time of each stage of a run on standard error', &
                more='Wall-clock and processor seconds of each stage, and the peak memory of the process.'), &
    option_type('--quiet', 'print nothing on standard output; show progress only with --progress'), &
    option_type('--cards', 'print the manual of all cards, or of one', '[NAME]'), &
    option_type('--man', 'print the manual page: epcont --man | man -l -'), &
    option_type('--version', 'print the version'), &
    option_type('--help', 'print this text', short='-h')]

contains

  !> Find an option by its exact name; the name is blank if it does not exist.
  pure type(option_type) function find_option(word) result(option)
    character(len=*), intent(in) :: word   !! of the command line
    integer :: k

    if (len_trim(word) < len(word)) return   ! Fortran ignores trailing blanks
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
