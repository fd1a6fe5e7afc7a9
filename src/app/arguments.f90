!> The command line.
module epcont_app_arguments
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: arguments_type, read_arguments, stem_of, help_text

  !> A path or a word of the command line.
  type, public :: word_type
    character(len=:), allocatable :: text
  end type word_type

  type :: arguments_type
    type(word_type), allocatable :: deck(:)         !! paths
    character(len=:), allocatable :: directory      !! for the results
    logical :: check = .false., plan = .false., all_tables = .false., vtk = .false., quiet = .false.
    logical :: help = .false., version = .false., cards = .false.
    character(len=:), allocatable :: card           !! name behind --cards, or empty
    real(wp) :: memory = 16.0_wp                    !! limit for matrices [GB]
  end type arguments_type

  character(len=1), parameter :: newline = new_line('a')

contains

  !> Read the command line.
  subroutine read_arguments(arguments, error)
    type(arguments_type), intent(out) :: arguments
    type(error_type), allocatable, intent(out) :: error
    character(len=:), allocatable :: value, word
    type(word_type), allocatable :: found(:)
    integer :: decks, i, status

    allocate (found(command_argument_count()))
    decks = 0
    arguments%directory = ''
    arguments%card = ''
    i = 0
    do while (i < command_argument_count())
      i = i + 1
      word = argument(i)
      select case (word)
      case ('--help', '-h')
        arguments%help = .true.
      case ('--version')
        arguments%version = .true.
      case ('--check')
        arguments%check = .true.
      case ('--plan')
        arguments%plan = .true.
      case ('--vtk')
        arguments%vtk = .true.
      case ('--quiet')
        arguments%quiet = .true.
      case ('--cards')
        arguments%cards = .true.
        if (i < command_argument_count()) then
          i = i + 1
          arguments%card = argument(i)
        end if
      case ('-o', '--tables', '--memory')
        i = i + 1
        if (i > command_argument_count()) then
          call raise(error, status_usage, word//' needs a value')
          return
        end if
        status = 0
        if (word == '-o') arguments%directory = argument(i)
        value = argument(i)
        if (word == '--memory') call read_positive(value, arguments%memory, status)
        if (word == '--tables') arguments%all_tables = argument(i) == 'all'
        if (status /= 0 .or. (word == '--tables' .and. .not. arguments%all_tables)) then
          call raise(error, status_usage, word//' '//argument(i)//': '// &
                     trim(merge('a positive number of GB', '--tables all           ', word == '--memory'))//' would be right')
          return
        end if
      case default
        if (index(word, '-') == 1) then
          call raise(error, status_usage, word//': no such option; epcont --help lists them')
          return
        end if
        decks = decks + 1
        found(decks)%text = word
      end select
    end do
    allocate (arguments%deck(decks))
    arguments%deck = found(:decks)
    call check(arguments, error)
  end subroutine read_arguments

  !> A positive number without exponent, which no length makes overflow; `status` is not 0 where `text` is none. READ alone
  !! takes `2 x`, `,` and `nan`.
  subroutine read_positive(text, number, status)
    character(len=*), intent(in) :: text
    real(wp), intent(inout) :: number
    integer, intent(out) :: status
    integer, parameter :: longest = 20

    status = 1
    if (verify(text, '0123456789.') > 0 .or. len(text) > longest) return
    read (text, *, iostat=status) number
    if (status == 0 .and. number <= 0.0_wp) status = 1
  end subroutine read_positive

  !> There are decks, and no two of one stem: their results would have one name.
  subroutine check(arguments, error)
    type(arguments_type), intent(in) :: arguments
    type(error_type), allocatable, intent(out) :: error
    integer :: i, j

    if (arguments%help .or. arguments%version .or. arguments%cards) return
    if (size(arguments%deck) == 0) then
      call raise(error, status_usage, 'no deck given: epcont [options] DECK...; epcont --help says more')
      return
    end if
    do i = 1, size(arguments%deck)
      if (.not. is_result(arguments%deck(i)%text)) cycle
      call raise(error, status_usage, arguments%deck(i)%text//': results are written under such names: a deck is named DECK.dat')
      return
    end do
    do i = 2, size(arguments%deck)
      do j = 1, i - 1
        if (stem_of(arguments%deck(i)%text) /= stem_of(arguments%deck(j)%text)) cycle
        call raise(error, status_usage, arguments%deck(j)%text//' and '//arguments%deck(i)%text// &
                   ' would write the same files: run them apart, each with its own -o DIR')
        return
      end do
    end do
  end subroutine check

  !> Might the results of a deck of this name be written over it?
  pure logical function is_result(path)
    character(len=*), intent(in) :: path

    is_result = .false.
    if (len(path) >= 4) is_result = any(path(len(path) - 3:) == ['.lst', '.csv', '.vtu'])
  end function is_result

  !> One argument, whatever its length.
  function argument(i) result(text)
    integer, intent(in) :: i
    character(len=:), allocatable :: text
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(len=length) :: text)
    call get_command_argument(i, text)
  end function argument

  !> Name of a file without folder and without what follows its last point.
  pure function stem_of(path) result(stem)
    character(len=*), intent(in) :: path
    character(len=:), allocatable :: stem
    integer :: point

    stem = path(index(path, '/', back=.true.) + 1:)
    point = index(stem, '.', back=.true.)
    if (point > 1) stem = stem(:point - 1)
  end function stem_of

  !> What --help prints.
  pure function help_text() result(text)
    character(len=:), allocatable :: text

    text = 'usage: epcont [options] DECK...'//newline// &
           newline// &
           'Solves the contact of plane bodies and rings from card decks. Results go to DECK.lst and DECK.*.csv.'//newline// &
           newline// &
           '  -o DIR         write results to DIR (default: the current directory)'//newline// &
           '  --check        read and check the decks, then stop'//newline// &
           '  --plan         print what would be solved and what it takes, then stop'//newline// &
           '  --tables all   write node and element tables, whatever the deck asks for'//newline// &
           '  --vtk          write DECK.vtu and DECK.contact.vtu, for ParaView'//newline// &
           '  --memory GB    refuse decks whose matrices need more (default 16)'//newline// &
           '  --cards [NAME] print the manual of the cards, or of one'//newline// &
           '  --quiet        print nothing on standard output'//newline// &
           '  --version      print the version'//newline// &
           '  --help         print this'//newline// &
           newline// &
           'exit status: 0 answer valid; 1 no equilibrium or not converged; 2 deck rejected; 3 usage, files or'//newline// &
           'memory; 4 numerical breakdown or certificate beyond tolerance; 5 internal error; of several decks the largest'// &
           newline
  end function help_text
end module epcont_app_arguments
