!> The manual page epcont(1) as roff, from the tables of options, of exit statuses and of files.
module epcont_app_man_page
  use epcont_app_options, only: option_type, options
  use epcont_base_error, only: status_meaning
  use epcont_base_text, only: upper
  use epcont_base_version, only: program_date, program_name, program_version
  use epcont_report_results, only: result_files
  use epcont_report_tables, only: columns_in
  implicit none
  private
  public :: man_page

  character(len=1), parameter :: newline = new_line('a')

  type :: example_type
    character(len=60) :: command
    character(len=76) :: text
  end type example_type

  !> With the deck that is installed beside the page (a test runs them).
  type(example_type), parameter :: examples(*) = [ &
    example_type('epcont hertz44.dat', &
                 'Solve the deck; the answer is in hertz44.lst and tables beside it.'), &
    example_type('epcont -o out --tables all hertz44.dat', &
                 'The same to the folder out, with displacements and stresses.'), &
    example_type('epcont --check *.dat', 'Name every fault of many decks, and solve none.'), &
    example_type('epcont --plan hertz44.dat', 'How many unknowns, which method and why, how much memory.'), &
    example_type('epcont --cards PARAM', 'The fields of a card, and what may stand in them.')]

contains

  !> The whole page.
  pure function man_page() result(text)
    character(len=:), allocatable :: text

    text = '.TH EPCONT 1 '//program_date//' "'//program_name//' '//program_version//'" '// &
           '"User Commands"'//newline// &
           '.SH NAME'//newline// &
           program_name//' \- contact and yielding of plane bodies and rings, from card decks'//newline// &
           '.SH SYNOPSIS'//newline// &
           '.B '//program_name//newline// &
           '.RI [ options ]'//newline// &
           '.IR DECK ...'//newline// &
           '.SH DESCRIPTION'//newline// &
           paragraph('For each deck of NASTRAN bulk data: what touches, with what force, how far the'// &
                     ' bodies approach, and where they have yielded.')// &
           paragraph('Contact is exact to rounding, yielding follows total theory, and every answer is'// &
                     ' certified by code of its own: the exit status and the listing say whether the'// &
                     ' certificate holds.')// &
           paragraph('A deck is named DECK.dat; the same deck gives the same files, byte for byte.')// &
           paragraph('Faults go to standard error, one line of outcome for each deck to standard output.')// &
           '.SH OPTIONS'//newline//option_list()// &
           '.SH EXIT STATUS'//newline//paragraph('Of several decks the largest counts.')// &
           entries('.B', ['0', '1', '2', '3', '4', '5'], status_meaning)// &
           '.SH FILES'//newline//paragraph('In the current directory, or in DIR.')// &
           file_list()// &
           '.SH EXAMPLES'//newline//entries('.B', examples%command, examples%text)// &
           '.SH ENVIRONMENT'//newline// &
           paragraph('OMP_NUM_THREADS: threads that may work on bodies side by side, where a scene has'// &
                     ' several large ones; one if it is not set. Results are the same bytes on any'// &
                     ' number.')// &
           paragraph('OMP_WAIT_POLICY: what threads do that wait; PASSIVE, which leaves their core to'// &
                     ' others, if it is not set and OpenBLAS is a part of the program, as the scripts'// &
                     ' link it.')// &
           paragraph('OpenBLAS chooses its kernels by the processor, or by OPENBLAS_CORETYPE: '// &
                     'others change the last of the 17 digits of the tables.')// &
           '.SH COPYRIGHT'//newline//paragraph('The epcont authors; MIT License.')
  end function man_page

  pure function option_list() result(text)
    character(len=:), allocatable :: text
    integer :: k

    text = ''
    do k = 1, size(options)
      text = text//entry(heading(options(k)), options(k)%text)
      if (options(k)%more /= '') text = text//'.br'//newline//paragraph(trim(options(k)%more))
    end do
  end function option_list

  !> Names bold, and the value too where it stands for itself.
  pure function heading(option) result(text)
    type(option_type), intent(in) :: option
    character(len=:), allocatable :: text, names

    names = roff(trim(option%name))
    if (option%short /= '') names = roff(option%short)//', '//names
    if (option%value == '') then
      text = '.B '//names
    else if (upper(option%value) == option%value) then
      text = '.BI "'//names//' " '//roff(trim(option%value))
    else
      text = '.B '//names//' '//roff(trim(option%value))
    end if
  end function heading

  !> The files, and the columns of tables.
  pure function file_list() result(text)
    character(len=:), allocatable :: columns, text
    integer :: k

    text = ''
    do k = 1, size(result_files)
      text = text//entry('.IB DECK '//roff(trim(result_files(k)%suffix)), result_files(k)%text)
      columns = columns_in(trim(result_files(k)%suffix))
      if (len(columns) > 0) text = text//'.br'//newline//paragraph('Columns: '//columns//'.')
    end do
  end function file_list

  !> An entry for each name.
  pure function entries(macro, name, explanation) result(text)
    character(len=*), intent(in) :: macro   !! the font of the names, and what stands before them
    character(len=*), intent(in) :: name(:), explanation(:)
    character(len=:), allocatable :: text
    integer :: k

    text = ''
    do k = 1, size(name)
      text = text//entry(macro//' '//roff(trim(name(k))), explanation(k))
    end do
  end function entries

  !> What is explained, in its own line, and the explanation.
  pure function entry(name, explanation) result(text)
    character(len=*), intent(in) :: name, explanation
    character(len=:), allocatable :: text

    text = '.TP'//newline//name//newline//paragraph(trim(explanation))
  end function entry

  !> Text, in lines of a source that can be read.
  pure function paragraph(text)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: paragraph
    integer, parameter :: width = 70
    integer :: from, to

    paragraph = ''
    from = 1
    do while (from <= len(text))
      to = len(text)
      if (to - from >= width) to = from + index(text(from:from + width), ' ', back=.true.) - 2
      paragraph = paragraph//roff(text(from:to))//newline
      from = to + 2
    end do
  end function paragraph

  !> Text as roff prints it: its hyphens are those that are typed, and nothing is a request.
  pure function roff(text) result(escaped)
    character(len=*), intent(in) :: text
    character(len=:), allocatable :: escaped
    integer :: k

    escaped = ''
    if (scan(text, '.''') == 1) escaped = '\&'
    do k = 1, len(text)
      select case (text(k:k))
      case ('-')
        escaped = escaped//'\-'
      case ('\')
        escaped = escaped//'\e'
      case default
        escaped = escaped//text(k:k)
      end select
    end do
  end function roff
end module epcont_app_man_page
