!> The command line.
module epcont_app_arguments
  use epcont_app_options, only: find_option, option_type, options
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_kinds, only: wp
  use epcont_deck_field, only: scan_no_point, scan_real, scan_sound
  implicit none
  private
  public :: arguments_type, command_line, read_arguments, stem_of

  !> A path or a word of the command line.
  type, public :: word_type
    character(len=:), allocatable :: text
  end type word_type

  type :: arguments_type
    type(word_type), allocatable :: deck(:)         !! paths
    character(len=:), allocatable :: directory      !! for the results; empty for the current directory
    character(len=:), allocatable :: card           !! name after --cards, or empty
    real(wp) :: memory = 16.0_wp                    !! limit for matrices [GB]
    logical, private :: asked(size(options)) = .false.
  contains
    procedure :: asks
  end type arguments_type

contains

  !> Return the words of the command line.
  function command_line() result(words)
    type(word_type), allocatable :: words(:)
    integer :: i, length

    allocate (words(command_argument_count()))
    do i = 1, size(words)
      call get_command_argument(i, length=length)
      allocate (character(len=length) :: words(i)%text)
      call get_command_argument(i, words(i)%text)
    end do
  end function command_line

  !> Read the words of a command line: options of the table, and decks.
  subroutine read_arguments(words, arguments, error)
    type(word_type), intent(in) :: words(:)   !! without the name of the program
    type(arguments_type), intent(out) :: arguments   !! requested options and decks
    type(error_type), allocatable, intent(out) :: error   !! of usage
    logical :: is_deck(size(words))
    integer :: i

    arguments%directory = ''
    arguments%card = ''
    is_deck = .false.
    i = 0
    do while (i < size(words) .and. .not. allocated(error))
      i = i + 1
      is_deck(i) = index(words(i)%text, '-') /= 1
      if (.not. is_deck(i)) call take_option()
    end do
    if (allocated(error)) return
    arguments%deck = pack(words, is_deck)
    if (.not. (arguments%asks('--help') .or. arguments%asks('--man') .or. arguments%asks('--version') .or. &
               arguments%asks('--cards'))) call check_decks()

  contains

    !> Take an option, and the next word if the option has a value.
    subroutine take_option()
      type(option_type) :: option
      character(len=:), allocatable :: right   ! expected value, if the value is wrong
      character(len=:), allocatable :: value
      integer :: outcome

      option = find_option(words(i)%text)
      value = ''
      if (option%name == '') then
        call refuse(words(i)%text//': no such option; epcont --help lists them')
      else if (option%value /= '' .and. i < size(words)) then
        i = i + 1
        value = words(i)%text
      else if (option%value /= '' .and. option%value(1:1) /= '[') then
        call refuse(words(i)%text//' needs a value')
      end if
      if (allocated(error)) return
      arguments%asked = arguments%asked .or. options%name == option%name
      right = ''
      select case (option%name)
      case ('-o')
        arguments%directory = value
      case ('--tables')
        if (value /= 'all') right = 'all'
      case ('--memory')
        call scan_real(value, arguments%memory, outcome)
        if (all(outcome /= [scan_sound, scan_no_point]) .or. verify(value, '0123456789.') > 0 .or. &
            .not. arguments%memory > 0.0_wp) right = 'a positive number of GB'
      case ('--cards')
        arguments%card = value
      end select
      if (len(right) > 0) call refuse(trim(option%name)//' '//value//': give '//right)
    end subroutine take_option

    !> Check that there are decks, that no deck has the name of a result, and that no two decks have the same
    !! stem, since their results would have the same names.
    subroutine check_decks()
      integer :: j

      associate (deck => arguments%deck)
        if (size(deck) == 0) call refuse('no deck given: epcont [options] DECK...; epcont --help says more')
        do i = 1, size(deck)
          if (any(deck(i)%text(max(1, len(deck(i)%text) - 3):) == ['.lst', '.csv', '.vtu'])) &
            call refuse(deck(i)%text//': results have such names: name the deck DECK.dat')
          do j = 1, i - 1
            if (stem_of(deck(i)%text) == stem_of(deck(j)%text)) &
              call refuse(deck(j)%text//' and '//deck(i)%text// &
                          ' would write the same files: run them apart, each with its own -o DIR')
          end do
        end do
      end associate
    end subroutine check_decks

    !> Report a fault; the first one counts.
    subroutine refuse(message)
      character(len=*), intent(in) :: message

      if (.not. allocated(error)) call raise(error, status_usage, message)
    end subroutine refuse
  end subroutine read_arguments

  !> Has an option been given?
  pure logical function asks(self, name)
    class(arguments_type), intent(in) :: self
    character(len=*), intent(in) :: name   !! of the option in its table

    asks = any(self%asked .and. options%name == name)
  end function asks

  !> Find the name of a file without directory and extension.
  pure function stem_of(path) result(stem)
    character(len=*), intent(in) :: path   !! of a deck
    character(len=:), allocatable :: stem
    integer :: point

    stem = path(index(path, '/', back=.true.) + 1:)
    point = index(stem, '.', back=.true.)
    if (point > 1) stem = stem(:point - 1)
  end function stem_of
end module epcont_app_arguments
