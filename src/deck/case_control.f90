!> Case control: the statements before BEGIN BULK. They name the load cases, their sets, titles and output.
!> Statements before the first SUBCASE apply to all load cases.
module epcont_deck_case_control
  use epcont_base_diagnostic, only: diagnostics, place_type
  use epcont_base_kinds, only: i8
  use epcont_base_text, only: text_of, upper
  use epcont_deck_entry, only: largest_id, listed
  use epcont_deck_field, only: scan_integer, scan_sound
  use epcont_deck_source, only: source
  use epcont_deck_spelling, only: suggestion
  implicit none
  private
  public :: case_control, set_choice, subcase_control, read_case_control

  !> Set that a statement chooses; 0 if it chooses no set.
  type :: set_choice
    integer :: id = 0
    type(place_type) :: place
  end type set_choice

  !> Statements of a load case.
  type :: subcase_control
    integer :: id = 0                                        !! 0 if the deck has no SUBCASE
    type(place_type) :: place                                !! columns of its SUBCASE
    character(len=:), allocatable :: subtitle, label         !! empty if not given
    type(set_choice) :: spc, load, mpc, temperature, nlparm
    type(set_choice) :: contact                              !! chosen BCONP; 0: all; -1: no contact
    logical :: displacement = .false., stress = .false., spcforces = .false.  !! requested tables
  end type subcase_control

  !> All statements.
  type :: case_control
    character(len=:), allocatable :: title                   !! empty if not given
    type(subcase_control), allocatable :: subcase(:)         !! at least one
    type(place_type) :: sequence   !! statement that makes the load cases a sequence; line 0: absent
    type(place_type) :: linear     !! SOL of a linear solution, such as 101; line 0: absent
    !> File with the end of earlier loads, from which the first load case starts; empty if not given
    character(len=:), allocatable :: restart
    type(place_type) :: restart_place                        !! of its name
    logical :: echo_unsorted = .false., echo_sorted = .false.   !! list the cards as they are, sorted by name
  end type case_control

  !> Keywords. Beginning with `first_own`, all may be given for a single load case.
  character(len=*), parameter, public :: keyword(18) = [character(len=12) :: &
    'SOL', 'CEND', 'TITLE', 'ECHO', 'CNTNLSUB', 'RESTART', 'SUBCASE', 'SUBTITLE', 'LABEL', 'SPC', 'LOAD', &
    'MPC', 'BCONTACT', 'DISPLACEMENT', 'STRESS', 'SPCFORCES', 'NLPARM', 'TEMPERATURE']
  integer, parameter :: first_own = 8
  !> Statements without effect: requests for output, and limits of a run.
  character(len=*), parameter :: idle(*) = [character(len=9) :: &
    'ANALYSIS', 'BCRESULTS', 'BOUTPUT', 'ELFORCE', 'ESE', 'FORCE', 'GPFORCE', 'GPSTRESS', 'ID', 'LINE', &
    'MAXLINES', 'MPCFORCES', 'NLSTRESS', 'OLOAD', 'OUTPUT', 'SET', 'STRAIN', 'TIME', 'VECTOR']
  !> Values of SOL that are static, linear or not.
  character(len=*), parameter :: static = &
    '  1 24 66 101 106 400 401 402 600 601 SESTATIC NLSTATIC '
  !> Values of SOL whose load cases are a sequence unless CNTNLSUB says otherwise.
  character(len=*), parameter :: sequential = ' 66 106 NLSTATIC '
  !> Values of SOL for which other programs use elastic material only.
  character(len=*), parameter :: linear = ' 1 24 101 SESTATIC '

  !> A statement, cut into its parts. Columns are counted in its line.
  type :: statement
    character(len=:), allocatable :: word      !! in upper case
    character(len=:), allocatable :: value     !! text after `=`, or after the word
    character(len=:), allocatable :: option    !! `(text)` between them, without blanks
    type(place_type) :: word_place, option_place, value_place   !! line 0: absent
  end type statement

contains

  !> Read the statements before BEGIN BULK. `bulk` is the line after it. Without BEGIN BULK, the whole file is
  !! bulk data, and `bulk` is 1.
  subroutine read_case_control(lines, control, bulk, faults)
    type(source), intent(in) :: lines   !! of the deck
    type(case_control), intent(out) :: control   !! result
    integer, intent(out) :: bulk   !! first line of bulk data
    type(diagnostics), intent(inout) :: faults   !! errors are added
    logical :: stated(size(keyword))
    type(statement) :: parts
    type(subcase_control) :: common, now   ! statements before the first SUBCASE, and of the current load case
    type(subcase_control), allocatable :: subcase(:)   ! [cases or more]
    integer :: cases, line
    logical :: goes_on   ! the list of a statement without effect goes on in the next line

    bulk = behind_begin_bulk(lines)
    allocate (subcase(bulk))
    control%title = ''
    control%restart = ''
    now%subtitle = ''
    now%label = ''
    cases = 0
    stated = .false.
    goes_on = .false.
    do line = 1, bulk - 2
      if (lines%blank(line)) cycle
      parts = cut(lines%text_of_line(line), line)
      if (.not. goes_on) call check_word(now, faults, stated, parts)
      goes_on = (goes_on .or. parts%word == '') .and. &
                scan(trim(lines%text_of_line(line)), ',', back=.true.) == len_trim(lines%text_of_line(line))
      if (goes_on .or. parts%word == '') cycle
      call take_statement()
    end do
    subcase(max(1, cases)) = now
    control%subcase = subcase(:max(1, cases))

  contains

    !> Take one statement.
    subroutine take_statement()
      character(len=:), allocatable :: words

      select case (parts%word)
      case ('SOL')
        words = ' '//upper(parts%value(:scan(parts%value//' ', ' ,') - 1))//' '
        if (index(static, words) == 0) &
          call faults%add_note(parts%value_place, 'SOL: epcont solves for static loads only')
        if (index(sequential, words) > 0 .and. .not. any(stated .and. keyword == 'CNTNLSUB')) &
          control%sequence = parts%value_place
        if (index(linear, words) > 0) control%linear = parts%value_place
      case ('CEND')
        if (len(parts%value) > 0) &
          call faults%add_error(parts%value_place, 'CEND takes no value', 'remove it')
      case ('CNTNLSUB')
        control%sequence = place_type()
        if (len(parts%value) == 0) parts%value = 'YES'
        if (says(parts, 'YES', 'NO', faults)) control%sequence = parts%word_place
      case ('RESTART')
        control%restart = trim(parts%value)
        if (scan(parts%value, '''"') == 1) control%restart = parts%value(2:len(parts%value) - 1)
        control%restart_place = parts%value_place
        if (control%restart == '') &
          call refuse(parts, 'the name of a file', '', 'give the DECK.restart that PARAM SAVE YES writes', &
                      faults)
      case ('SUBCASE')
        call begin_subcase()
      case ('TITLE')
        control%title = parts%value
      case ('SUBTITLE')
        now%subtitle = parts%value
      case ('LABEL')
        now%label = parts%value
      case ('SPC')
        call take_set(parts, now%spc, faults)
      case ('LOAD')
        call take_set(parts, now%load, faults)
      case ('TEMPERATURE')
        if (any(parts%option == [character(len=6) :: '', '(LOAD)', '(BOTH)'])) then
          call take_set(parts, now%temperature, faults)
        else
          call faults%add_error(parts%option_place, 'TEMPERATURE'//parts%option//' is not supported', &
                                'use TEMPERATURE(LOAD), and TREF of MAT1 for the unloaded bodies')
        end if
      case ('MPC')
        call take_set(parts, now%mpc, faults)
      case ('BCONTACT')
        now%contact%place = parts%value_place
        if (all(upper(parts%value) /= ['ALL ', 'NONE'])) call take_set(parts, now%contact, faults)
        if (upper(parts%value) == 'ALL') now%contact%id = 0
        if (upper(parts%value) == 'NONE') now%contact%id = -1
      case ('ECHO')
        ! Words with commas between them, some with options: `SORT(EXCEPT GRID), PUNCH`.
        words = ' '//upper(parts%value)
        control%echo_unsorted = index(words, 'UNSORT') + index(words, 'BOTH') > 0
        control%echo_sorted = index(words, ' SORT') + index(words, ',SORT') + index(words, 'BOTH') > 0
        if (all(words /= [' UNSORT', ' SORT  ', ' BOTH  ', ' NONE  '])) &
          call faults%add_note(parts%value_place, 'ECHO: only UNSORT, SORT and BOTH have an effect')
      case ('DISPLACEMENT')
        now%displacement = says(parts, 'ALL', 'NONE', faults)
      case ('STRESS')
        now%stress = says(parts, 'ALL', 'NONE', faults)
      case ('SPCFORCES')
        now%spcforces = says(parts, 'ALL', 'NONE', faults)
      case ('NLPARM')
        call take_set(parts, now%nlparm, faults)
      end select
    end subroutine take_statement

    !> Begin a load case. Statements before the first SUBCASE apply to it too.
    subroutine begin_subcase()
      if (cases == 0) common = now
      if (cases > 0) subcase(cases) = now
      now = common
      cases = cases + 1
      call take_number(parts, now%id, faults)
      now%place = parts%word_place
      if (now%id > 0 .and. any(subcase(:cases - 1)%id == now%id)) call faults%add_error( &
        parts%value_place, 'SUBCASE '//text_of(now%id)//' is used twice', 'use another number')
      stated(first_own:) = .false.
    end subroutine begin_subcase
  end subroutine read_case_control

  !> Report a value that is missing or not accepted.
  subroutine refuse(parts, needed, which, remedy, faults)
    type(statement), intent(in) :: parts
    character(len=*), intent(in) :: needed, which, remedy
    type(diagnostics), intent(inout) :: faults

    if (len(parts%value) == 0) then
      call faults%add_error(parts%word_place, parts%word//' needs '//needed, remedy)
    else
      call faults%add_error(parts%value_place, parts%word//': not '//needed//which, remedy)
    end if
  end subroutine refuse

  !> Read the number of a statement.
  subroutine take_number(parts, number, faults)
    type(statement), intent(in) :: parts
    integer, intent(inout) :: number
    type(diagnostics), intent(inout) :: faults
    integer(i8) :: value
    integer :: outcome

    call scan_integer(parts%value, value, outcome)
    if (outcome == scan_sound .and. value > 0 .and. value <= largest_id) then
      number = int(value)
    else
      call refuse(parts, 'a number', ' that can be used', &
                  'give a whole number from 1 to '//text_of(largest_id), faults)
    end if
  end subroutine take_number

  !> Read the set of a statement such as `SPC = 1`.
  subroutine take_set(parts, set, faults)
    type(statement), intent(in) :: parts
    type(set_choice), intent(inout) :: set
    type(diagnostics), intent(inout) :: faults

    set%place = parts%value_place
    call take_number(parts, set%id, faults)
  end subroutine take_set

  !> Is the value the word `yes`? Report an error if it is neither this nor `no`.
  logical function says(parts, yes, no, faults)
    type(statement), intent(in) :: parts
    character(len=*), intent(in) :: yes, no
    type(diagnostics), intent(inout) :: faults

    says = upper(parts%value) == yes
    if (.not. says .and. upper(parts%value) /= no) &
      call refuse(parts, 'a word', ' known to epcont', 'give '//yes//' or '//no, faults)
  end function says

  !> Check that a statement is known and given once; its options have no effect.
  subroutine check_word(now, faults, stated, parts)
    type(subcase_control), intent(in) :: now
    type(diagnostics), intent(inout) :: faults
    logical, intent(inout) :: stated(:)
    type(statement), intent(inout) :: parts
    character(len=:), allocatable :: words
    integer :: k

    k = findloc(keyword == parts%word, .true., dim=1)
    if (k == 0 .and. len(parts%word) > 3) k = findloc(index(keyword, parts%word) == 1, .true., dim=1)
    if (k == 0 .and. is_idle(parts%word)) then
      call faults%add_note(parts%word_place, parts%word//' has no effect')
      parts%word = ''
      return
    end if
    if (k == 0) then
      words = ''
      do k = 1, size(keyword)
        words = words//' '//trim(keyword(k))
      end do
      call faults%add_error(parts%word_place, 'unknown case control statement '//parts%word, &
                            suggestion(parts%word, keyword, listed(words(2:))))
      return
    end if
    if (stated(k)) &
      call faults%add_error(parts%word_place, parts%word//' is stated twice', 'write one '//parts%word// &
                            trim(merge(' a SUBCASE', '          ', now%id > 0 .and. k >= first_own)))
    stated(k) = keyword(k) /= 'SUBCASE'
    parts%word = trim(keyword(k))
    if (parts%option_place%line > 0 .and. parts%word /= 'TEMPERATURE') &
      call faults%add_note(parts%option_place, parts%word//': options have no effect')
  end subroutine check_word

  !> Has a statement no effect? Words may be cut to four letters.
  pure logical function is_idle(word)
    character(len=*), intent(in) :: word

    is_idle = any(idle == word)
    if (len(word) > 3) is_idle = is_idle .or. any(index(idle, word) == 1)
  end function is_idle

  !> Number of the line after BEGIN BULK; 1 if there is no such line.
  pure integer function behind_begin_bulk(lines) result(bulk)
    type(source), intent(in) :: lines
    character(len=:), allocatable :: text
    integer :: line

    bulk = 1
    do line = 1, lines%count
      if (scan(lines%text(lines%line(line)%first:lines%line(line)%first), 'Bb ') == 0) cycle
      text = upper(adjustl(lines%text_of_line(line)))
      if (index(text, 'BEGIN ') == 1 .and. adjustl(text(6:)) == 'BULK') then
        bulk = line + 1
        return
      end if
    end do
  end function behind_begin_bulk

  !> Cut a line into word, option and value.
  pure type(statement) function cut(text, line) result(parts)
    character(len=*), intent(in) :: text
    integer, intent(in) :: line   !! number of the line
    integer :: at, first, k, last

    first = verify(text, ' ')
    last = first + scan(text(first:)//' ', ' =(') - 2
    parts%word = upper(text(first:last))
    parts%word_place = place_type(line, first, max(first, last))
    at = last + verify(text(last + 1:)//'.', ' ')
    parts%option = ''
    if (text(at:min(at, len(text))) == '(') then
      last = at + index(text(at:)//')', ')') - 1
      parts%option_place = place_type(line, at, min(last, len(text)))
      do k = at, min(last, len(text))
        if (text(k:k) /= ' ') parts%option = parts%option//upper(text(k:k))
      end do
      at = last + verify(text(last + 1:)//'.', ' ')
    end if
    if (text(at:min(at, len(text))) == '=') at = at + verify(text(at + 1:)//'.', ' ')
    parts%value = text(at:)
    parts%value_place = place_type(line, at, max(at, len(text)))
  end function cut
end module epcont_deck_case_control
