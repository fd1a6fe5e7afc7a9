!> The texts of --help and of --man, the manual page epcont(1) as roff. Both use the tables of options, of
!> exit statuses and of files.
module epcont_app_help
  use epcont_app_options, only: option_type, options
  use epcont_base_error, only: status_meaning
  use epcont_base_text, only: newline, text_of
  use epcont_base_version, only: program_date, program_name, program_version
  use epcont_messages_names, only: when
  use epcont_report_results, only: result_files
  use epcont_report_tables, only: columns_in
  implicit none
  private
  public :: help_text, man_page

  !> Macros of an entry; its name follows.
  character(len=*), parameter :: entry = '.TP'//newline//'.B '

  !> The manual page: lines that begin with a point are roff; `@options` and the like are lists; the rest are
  !! paragraphs.
  character(len=*), parameter :: page(*) = [character(len=280) :: &
    '.TH EPCONT 1 '//program_date//' "'//program_name//' '//program_version//'" "User Commands"', &
    '.SH NAME'//newline// &
    program_name//' \- elastoplastic contact of plane and axisymmetric bodies', &
    '.SH SYNOPSIS', &
    '.B '//program_name, &
    '.RI [ options ]', &
    '.IR DECK ...', &
    '.SH DESCRIPTION', &
    'For each deck of NASTRAN bulk data, epcont finds the pairs in contact, their forces and pressures, '// &
    'the approach of the bodies, and the yielded elements.', &
    'Contact is exact to rounding. Yielding follows total theory or flow theory. Separate code checks '// &
    'every answer (certificate): exit status and listing say whether it holds.', &
    'A deck is named DECK.dat. The same deck gives the same files, byte for byte.', &
    'Errors and warnings go to standard error, one line of outcome for each deck to standard output.', &
    '.SH OPTIONS', '@options', &
    '.SH EXIT STATUS', 'For several decks, the largest status.', '@statuses', &
    '.SH FILES', 'In the current directory, or in DIR of option -o.', '@files', &
    '.SH EXAMPLES', &   ! with the deck installed beside the page (a test runs them)
    entry//'epcont hertz44.dat', 'Solve the deck; the answer is in hertz44.lst and tables beside it.', &
    entry//'epcont \-o out \-\-tables all hertz44.dat', &
    'The same in the directory out, with displacements and stresses.', &
    entry//'epcont \-\-check *.dat', 'Report every error of many decks, without solving them.', &
    entry//'epcont \-\-plan hertz44.dat', 'Print the number of unknowns, the methods and the memory.', &
    entry//'epcont \-\-cards PARAM', 'Print the fields of a card and their permitted values.', &
    '.SH ENVIRONMENT', &
    'OMP_NUM_THREADS: number of threads that work on bodies in parallel, if a model has several '// &
    'large ones; default 1. Results are the same bytes for any number.', &
    'OMP_WAIT_POLICY: behaviour of waiting threads. The default is PASSIVE (others can use their core) '// &
    'if OpenBLAS is linked into the program, as the build scripts do.', &
    'OpenBLAS chooses its kernels by the processor, or by OPENBLAS_CORETYPE. Other kernels change the '// &
    'last of the 17 digits of the tables.', &
    '.SH COPYRIGHT', 'The epcont authors; MIT License.']

contains

  !> Return the text of --help.
  pure function help_text() result(text)
    character(len=:), allocatable :: text
    type(option_type) :: option
    character(len=15) :: name
    integer :: k

    text = 'usage: epcont [options] DECK...'//newline//newline// &
           'Solves elastoplastic contact of plane and axisymmetric bodies.'//newline// &
           'Input: NASTRAN bulk data. Results: DECK.lst and DECK.*.csv.'//newline//newline
    do k = 1, size(options)
      option = options(k)
      name = option%usage()
      text = text//'  '//name//trim(option%text)//newline
    end do
    text = text//newline//'exit status, of several decks the largest:'//newline
    do k = 0, size(status_meaning) - 1
      text = text//'  '//text_of(k)//'  '//trim(status_meaning(k))//newline
    end do
  end function help_text

  !> Return the text of --man.
  function man_page() result(text)
    character(len=:), allocatable :: text
    type(option_type) :: option
    integer :: i, k

    text = ''
    do k = 1, size(page)
      select case (page(k))
      case ('@options')
        do i = 1, size(options)
          option = options(i)
          call add_entry('.B '//roff(option%usage()), option%text, option%more)
        end do
      case ('@statuses')
        do i = 0, size(status_meaning) - 1
          call add_entry('.B '//text_of(i), status_meaning(i), '')
        end do
      case ('@files')
        do i = 1, size(result_files)
          call add_entry('.IB DECK '//roff(trim(result_files(i)%suffix)), result_files(i)%text, &
                         columns_in(result_files(i)%suffix))
        end do
      case default
        text = text//when(page(k)(1:1) == '.', trim(page(k)), roff(trim(page(k))))//newline
      end select
    end do

  contains

    !> Add an entry: its name on a line, then the explanation.
    subroutine add_entry(name, explanation, more)
      character(len=*), intent(in) :: name, explanation, more

      text = text//'.TP'//newline//name//newline//roff(trim(explanation))//newline
      if (more /= '') text = text//'.br'//newline//roff(trim(more))//newline
    end subroutine add_entry
  end function man_page

  !> Escape text for roff: hyphens as typed, and no requests.
  pure function roff(text) result(escaped)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: escaped
    integer :: k

    escaped = ''
    if (scan(text, '.''') == 1) escaped = '\&'
    do k = 1, len(text)
      if (text(k:k) == '-' .or. text(k:k) == '\') escaped = escaped//'\'
      escaped = escaped//merge('e', text(k:k), text(k:k) == '\')
    end do
  end function roff
end module epcont_app_help
