!> The statements before BEGIN BULK: which load cases there are, which sets each uses, titles, and what output
!> is wanted. What stands before the first SUBCASE is said for all of them.
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

  !> The set that a statement chooses; 0: no choice.
  type :: set_choice
    integer :: id = 0
    type(place_type) :: place
  end type set_choice

  !> What the statements say of a load case.
  type :: subcase_control
    integer :: id = 0                                        !! 0: the deck has no SUBCASE
    type(place_type) :: place                                !! of its SUBCASE
    character(len=:), allocatable :: subtitle, label         !! empty where not given
    type(set_choice) :: spc, load, mpc, temperature, nlparm
    type(set_choice) :: contact                              !! the only BCONP; 0: all; -1: none
    logical :: displacement = .false., stress = .false., spcforces = .false.  !! tables wanted
  end type subcase_control

  !> What the statements say.
  type :: case_control
    character(len=:), allocatable :: title                   !! empty where not given
    type(subcase_control), allocatable :: subcase(:)         !! one at least
    logical :: echo_unsorted = .false., echo_sorted = .false.   !! cards listed as they stand, by their names
  end type case_control

  !> Their words. From the first on that a load case may have for itself, all are its own.
  character(len=*), parameter, public :: keyword(17) = [character(len=12) :: &
    'SOL', 'CEND', 'TITLE', 'ECHO', 'CNTNLSUB', 'SUBCASE', 'SUBTITLE', 'LABEL', 'SPC', 'LOAD', 'MPC', &
    'BCONTACT', 'DISPLACEMENT', 'STRESS', 'SPCFORCES', 'NLPARM', 'TEMPERATURE']
  integer, parameter :: first_own = 7
  !> Those of SOL that are static, linear or not.
  character(len=*), parameter :: static = &
    '  1 24 66 101 106 400 401 402 600 601 SESTATIC NLSTATIC '
  !> Of these, those whose load cases are a sequence where CNTNLSUB does not say.
  character(len=*), parameter :: sequential = ' 66 106 NLSTATIC '

  !> One statement, cut into its parts. Columns count from the first of the line.
  type :: statement
    character(len=:), allocatable :: word      !! in capitals
    character(len=:), allocatable :: value     !! behind `=`, or behind the word
    character(len=:), allocatable :: option    !! in parentheses between, with these; no blanks
    type(place_type) :: word_place, option_place, value_place   !! of line 0: there is none
  end type statement

contains

  !> Read the statements up to BEGIN BULK. `bulk` is the first line behind it; without it, the whole file is
  !! bulk data, and `bulk` is 1.
  subroutine read_case_control(lines, control, bulk, faults)
    type(source), intent(in) :: lines   !! of the deck
    type(case_control), intent(out) :: control   !! what they say
    integer, intent(out) :: bulk   !! the first line of bulk data
    type(diagnostics), intent(inout) :: faults   !! what is wrong is added to them
    logical :: stated(size(keyword))
    type(statement) :: parts
    type(subcase_control) :: common, now   ! what is said before the first, and of that which lines are about
    type(place_type) :: sequence     ! what makes a sequence of them; of line 0: nothing
    integer :: cases, line

    bulk = behind_begin_bulk(lines)
    allocate (control%subcase(max(1, count([(is_subcase(lines, line), line=1, bulk - 2)]))))
    control%title = ''
    now%subtitle = ''
    now%label = ''
    cases = 0
    stated = .false.
    do line = 1, bulk - 2
      if (lines%blank(line)) cycle
      parts = cut(lines%text_of_line(line), line)
      call check_word(now, faults, stated, parts)
      call take_statement()
    end do
    control%subcase(max(1, cases)) = now
    if (sequence%line > 0 .and. size(control%subcase) > 1) call faults%add_error( &
      sequence, 'the SUBCASEs are a sequence, each from the end of the one before: that is not here', &
      'CNTNLSUB = NO: each from the unloaded state')

  contains

    !> Take one statement.
    subroutine take_statement()
      character(len=:), allocatable :: words

      select case (parts%word)
      case ('SOL')
        words = ' '//upper(parts%value(:scan(parts%value//' ', ' ,') - 1))//' '
        if (index(static, words) == 0) &
          call faults%add_note(parts%value_place, 'SOL: not static, as the loads here are')
        if (index(sequential, words) > 0 .and. .not. any(stated .and. keyword == 'CNTNLSUB')) &
          sequence = parts%value_place
      case ('CEND')
        if (len(parts%value) > 0) &
          call faults%add_error(parts%value_place, 'CEND takes no value', 'nothing here')
      case ('CNTNLSUB')
        sequence = place_type()
        if (len(parts%value) == 0 .or. upper(parts%value) == 'YES') then
          sequence = parts%word_place
        else if (upper(parts%value) /= 'NO') then
          call refuse(parts, 'a word', ' known here', &
                      'NO or YES: the SUBCASEs of a list (SID) are not here', faults)
        end if
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
          call refuse_option(parts, faults)
        end if
      case ('MPC')
        call take_set(parts, now%mpc, faults)
      case ('BCONTACT')
        now%contact%place = parts%value_place
        if (all(upper(parts%value) /= ['ALL ', 'NONE'])) call take_set(parts, now%contact, faults)
        if (upper(parts%value) == 'ALL') now%contact%id = 0
        if (upper(parts%value) == 'NONE') now%contact%id = -1
      case ('ECHO')
        ! Words with commas between, some with options: `SORT(EXCEPT GRID), PUNCH`.
        words = ' '//upper(parts%value)
        control%echo_unsorted = index(words, 'UNSORT') + index(words, 'BOTH') > 0
        control%echo_sorted = index(words, ' SORT') + index(words, ',SORT') + index(words, 'BOTH') > 0
        if (all(words /= [' UNSORT', ' SORT  ', ' BOTH  ', ' NONE  '])) &
          call faults%add_note(parts%value_place, 'ECHO: only UNSORT, SORT and BOTH have an effect')
      case ('DISPLACEMENT')
        now%displacement = says_all(parts, faults)
      case ('STRESS')
        now%stress = says_all(parts, faults)
      case ('SPCFORCES')
        now%spcforces = says_all(parts, faults)
      case ('NLPARM')
        call take_set(parts, now%nlparm, faults)
      end select
    end subroutine take_statement

    !> A load case: what was said before the first of all holds for it, too.
    subroutine begin_subcase()
      if (cases == 0) common = now
      if (cases > 0) control%subcase(cases) = now
      now = common
      cases = cases + 1
      call take_number(parts, now%id, faults)
      now%place = parts%word_place
      if (now%id > 0 .and. any(control%subcase(:cases - 1)%id == now%id)) call faults%add_error( &
        parts%value_place, 'SUBCASE '//text_of(now%id)//' is there twice', 'a number of its own')
      stated(first_own:) = .false.
    end subroutine begin_subcase
  end subroutine read_case_control

  !> A value that is missing, or cannot be taken.
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

  !> The number that a statement says.
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
      call refuse(parts, 'a number', ' that can be used', 'a whole number from 1 to '//text_of(largest_id), &
                  faults)
    end if
  end subroutine take_number

  !> The set of a statement such as `SPC = 1`.
  subroutine take_set(parts, set, faults)
    type(statement), intent(in) :: parts
    type(set_choice), intent(inout) :: set
    type(diagnostics), intent(inout) :: faults

    set%place = parts%value_place
    call take_number(parts, set%id, faults)
  end subroutine take_set

  !> Does a statement say ALL? Else it must say NONE.
  logical function says_all(parts, faults)
    type(statement), intent(in) :: parts
    type(diagnostics), intent(inout) :: faults

    says_all = upper(parts%value) == 'ALL'
    if (.not. says_all .and. upper(parts%value) /= 'NONE') &
      call refuse(parts, 'a word', ' known here', 'ALL or NONE', faults)
  end function says_all

  !> Temperatures that are no load.
  subroutine refuse_option(parts, faults)
    type(statement), intent(in) :: parts
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: remedy

    remedy = 'TEMPERATURE(LOAD)'
    if (index(parts%option, '(INI') == 1) remedy = 'TREF of MAT1: bodies are at it before they are loaded'
    if (index(parts%option, '(MAT') == 1) remedy = 'moduli on MAT1: they do not depend on temperature'
    call faults%add_error(parts%option_place, 'TEMPERATURE'//parts%option//' is not known here', remedy)
  end subroutine refuse_option

  !> A statement must be known, and stand once; its options have no effect.
  subroutine check_word(now, faults, stated, parts)
    type(subcase_control), intent(in) :: now
    type(diagnostics), intent(inout) :: faults
    logical, intent(inout) :: stated(:)
    type(statement), intent(inout) :: parts
    integer :: k

    k = findloc(keyword == parts%word, .true., dim=1)
    if (k == 0 .and. len(parts%word) > 3) k = findloc(index(keyword, parts%word) == 1, .true., dim=1)
    if (k == 0) then
      call faults%add_error(parts%word_place, 'unknown case control statement '//parts%word, &
        suggestion(parts%word, keyword, listed(all_keywords())))
      return
    end if
    if (stated(k)) &
      call faults%add_error(parts%word_place, parts%word//' is stated twice', 'one '//parts%word// &
                            trim(merge(' a SUBCASE', '          ', now%id > 0 .and. k >= first_own)))
    stated(k) = keyword(k) /= 'SUBCASE'
    parts%word = trim(keyword(k))
    if (parts%option_place%line > 0 .and. parts%word /= 'TEMPERATURE') &
      call faults%add_note(parts%option_place, parts%word//': options have no effect')
  end subroutine check_word

  !> Does a load case begin on a line?
  logical function is_subcase(lines, line)
    type(source), intent(in) :: lines
    integer, intent(in) :: line
    type(statement) :: parts

    is_subcase = .false.
    if (lines%blank(line)) return
    parts = cut(lines%text_of_line(line), line)
    is_subcase = len(parts%word) > 3 .and. index('SUBCASE', parts%word) == 1
  end function is_subcase

  !> All keywords, with a blank between two of them.
  pure function all_keywords() result(words)
    character(len=:), allocatable :: words
    integer :: k

    words = trim(keyword(1))
    do k = 2, size(keyword)
      words = words//' '//trim(keyword(k))
    end do
  end function all_keywords

  !> The line behind BEGIN BULK; 1 where there is none.
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
    integer, intent(in) :: line   !! its number
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
