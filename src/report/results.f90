!> All that a run writes: the listing for people, ASCII, at most 132 columns, with nothing in it that varies
!> from run to run; and the tables beside it. Of several load cases each is added once it is solved, and
!> nothing is written before the last.
module epcont_report_results
  use epcont_base_error, only: error_type
  use epcont_report_case_table, only: case_row, put_cases, put_worst_case, row_of_case
  use epcont_base_text, only: text_of
  use epcont_report_columns, only: table_type
  use epcont_report_file, only: new_text_file, remove_file, text_file
  use epcont_report_listing, only: list_case, list_scene
  use epcont_messages_names, only: joined
  use epcont_report_plan_text, only: plan_text
  use epcont_report_run, only: run_results
  use epcont_report_summary, only: figure_type, summarise
  use epcont_report_tables, only: put_table
  use epcont_report_vtk, only: collected, write_collection, write_vtk
  implicit none
  private
  public :: results_type, remove_results

  !> A file of results: what stands behind the name of the deck, and what it holds.
  type :: result_file
    character(len=14) :: suffix
    character(len=76) :: text
  end type result_file

  type(result_file), parameter, public :: result_files(*) = [ &
    result_file('.lst', 'the listing, for people and for diffing: the same bytes on every run'), &
    result_file('.summary.csv', &
                'outcome, approaches, certificate and accuracy, in 17 digits like all tables'), &
    result_file('.contact.csv', 'the pairs'), &
    result_file('.zones.csv', 'runs of touching pairs'), &
    result_file('.bodies.csv', 'what contact exerts on each body'), &
    result_file('.history.csv', 'the iterations'), &
    result_file('.pivots.csv', 'the pivots of each iteration by RULE CONRY, with --tables all'), &
    result_file('.nodes.csv', 'the nodes, where the deck or --tables all asks for it'), &
    result_file('.elements.csv', 'the elements, where the deck or --tables all asks for it'), &
    result_file('.cases.csv', 'the load cases, where the deck has more than one'), &
    result_file('.vtu', 'the bodies, for ParaView, with --vtk: displacements, stresses, states'), &
    result_file('.contact.vtu', 'the boundary in contact, for ParaView, with --vtk: pressures, gaps'), &
    result_file('.pvd', 'of several load cases: DECK.caseN.vtu and .caseN.contact.vtu, for ParaView')]

  !> The tables that are files, and have rows of each load case.
  character(len=8), parameter :: table_name(*) = [character(len=8) :: &
    'summary', 'contact', 'zones', 'bodies', 'history', 'pivots', 'nodes', 'elements']

  !> What there is to write of one of several load cases.
  type :: case_results
    type(case_row) :: row
    type(table_type) :: listing
    type(table_type) :: table(size(table_name))
  end type case_results

  !> What a run writes, and what of several load cases is written already, in memory.
  type :: results_type
    character(len=:), allocatable :: stem             !! path of the files, without their suffixes
    !> Asked for on the command line: tables of nodes and elements though the deck does not, the listing and
    !! the summary alone, and files for ParaView
    logical :: all_tables = .false., brief = .false., vtk = .false.
    type(case_results), allocatable, private :: case(:)
    character(len=:), allocatable :: plan    !! of all scenes that cases make, in lines
  contains
    procedure :: begin
    procedure :: add_plan
    procedure :: add_case
    procedure :: finish
  end type results_type

  !> Load cases that a plan is of are named, up to so many.
  integer, parameter :: most_named = 12

contains

  !> Nothing is taken yet.
  subroutine begin(self, run)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run   !! whose load cases will come

    if (.not. allocated(self%case)) allocate (self%case(size(run%deck%subcase)))
    self%plan = ''
  end subroutine begin

  !> Take the plan of some load cases.
  subroutine add_plan(self, run, cases)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run   !! with the plan
    integer, intent(in) :: cases(:)        !! which

    if (.not. run%has_cases()) then
      self%plan = plan_text(run%planned_model)
    else if (size(cases) == size(self%case)) then
      self%plan = plan_text(run%planned_model, text_of(size(cases))//' load cases')
    else
      self%plan = self%plan//plan_text(run%planned_model, &
                                       'SUBCASE '//joined(run%deck%subcase(cases)%id, ' ', most_named))
    end if
  end subroutine add_plan

  !> Take what came of a load case; that of the only one is written.
  subroutine add_case(self, run, error)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run                  !! what is known of the run, with that case
    type(error_type), allocatable, intent(out) :: error   !! a file cannot be written
    type(figure_type), allocatable :: figures(:)
    integer :: k

    if (run%case == 1) call remove_results(self%stem)
    ! Of a run that is stopped, too, the next one finds what to remove.
    if (run%case == 1 .and. self%vtk .and. run%has_cases()) &
      call write_collection(self%stem, run%deck%subcase%id, error)
    if (allocated(error)) return
    figures = summarise(run)
    if (run%has_cases()) then
      call hold_case(self%case(run%case))
    else
      call write_listing()
    end if
    do k = 1, size(table_name)
      if (is_wanted(trim(table_name(k)))) &
        call write_table(trim(table_name(k)), self%case(run%case)%table(k))
    end do
    if (self%vtk .and. run%outcome%has_answer .and. .not. allocated(error)) &
      call write_vtk(run, self%stem//run%case_suffix(), error)

  contains

    !> One of several is added to no file yet.
    subroutine hold_case(case)
      type(case_results), intent(inout) :: case

      case%row = row_of_case(run)
      case%listing = table_type(text='')
      call list_case(run, figures, self%all_tables, case%listing)
      do k = 1, size(table_name)
        case%table(k) = table_type(text='', listed=.false., subcase=case%row%subcase)
      end do
    end subroutine hold_case

    !> Has the case such a table, and is it asked for?
    pure logical function is_wanted(name)
      character(len=*), intent(in) :: name

      is_wanted = run%outcome%has_answer .and. .not. self%brief
      select case (name)
      case ('summary')
        is_wanted = .true.
      case ('bodies')
        is_wanted = is_wanted .and. run%model%pairs > 0
      case ('pivots')
        is_wanted = is_wanted .and. self%all_tables
        if (is_wanted) is_wanted = size(run%answer%pivot) > 0
      case ('nodes')
        is_wanted = is_wanted .and. run%wants_nodes(self%all_tables)
      case ('elements')
        is_wanted = is_wanted .and. run%wants_elements(self%all_tables)
      end select
    end function is_wanted

    !> The listing of the only case.
    subroutine write_listing()
      type(table_type) :: listing

      call new_text_file(self%stem//'.lst', listing, error)
      if (allocated(error)) return
      call list_scene(run, plan_text(run%planned_model), listing)
      call list_case(run, figures, self%all_tables, listing)
      call listing%finish(error)
    end subroutine write_listing

    !> The rows of a table, in a file of its own or held, where all has gone well so far.
    subroutine write_table(name, held)
      character(len=*), intent(in) :: name
      type(table_type), intent(inout) :: held   !! of one of several cases
      type(table_type) :: table

      if (allocated(error)) return
      if (run%has_cases()) then
        call put_rows(name, held)
      else
        call new_text_file(self%stem//'.'//name//'.csv', table, error)
        if (allocated(error)) return
        table%listed = .false.
        call put_rows(name, table)
        call table%finish(error)
      end if
    end subroutine write_table

    !> The rows.
    subroutine put_rows(name, table)
      character(len=*), intent(in) :: name
      type(table_type), intent(inout) :: table

      if (name == 'summary') then
        call put_summary(figures, table)
      else
        call put_table(run, name, table)
      end if
    end subroutine put_rows
  end subroutine add_case

  !> Write what several load cases have left.
  subroutine finish(self, run, error)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run                  !! what is known of the run
    type(error_type), allocatable, intent(out) :: error   !! a file cannot be written
    type(table_type) :: file
    integer :: k

    if (.not. run%has_cases()) return
    call new_text_file(self%stem//'.lst', file, error)
    if (allocated(error)) return
    call list_scene(run, self%plan, file)
    do k = 1, size(self%case)
      call file%add(self%case(k)%listing)
    end do
    call put_cases(self%case%row, file)
    call put_worst_case(self%case%row, run%model%controls%accuracy, file)
    call file%finish(error)
    do k = 1, size(table_name)
      call write_table(k)
    end do
    if (.not. self%brief) call write_cases()
    if (self%vtk .and. .not. allocated(error)) &
      call write_collection(self%stem, pack(self%case%row%subcase, self%case%row%has_answer), error)

  contains

    !> The rows of all cases, below one line of heads.
    subroutine write_table(t)
      integer, intent(in) :: t   !! which table
      type(text_file) :: file
      logical :: begun
      integer :: k

      if (all([(self%case(k)%table(t)%is_empty(), k=1, size(self%case))])) return
      if (.not. allocated(error)) &
        call new_text_file(self%stem//'.'//trim(table_name(t))//'.csv', file, error)
      if (allocated(error)) return
      begun = .false.
      do k = 1, size(self%case)
        if (self%case(k)%table(t)%is_empty()) cycle
        call file%add(self%case(k)%table(t), without_head=begun)
        begun = .true.
      end do
      call file%finish(error)
    end subroutine write_table

    !> What came of each case.
    subroutine write_cases()
      type(table_type) :: file

      if (.not. allocated(error)) call new_text_file(self%stem//'.cases.csv', file, error)
      if (allocated(error)) return
      file%listed = .false.
      call put_cases(self%case%row, file)
      call file%finish(error)
    end subroutine write_cases
  end subroutine finish

  !> Figures in full.
  subroutine put_summary(figures, table)
    type(figure_type), intent(in) :: figures(:)
    type(table_type), intent(inout) :: table
    integer :: k

    call table%head('key,value,unit')
    do k = 1, size(figures)
      call table%csv(trim(figures(k)%key)//','//trim(figures(k)%value)//','//trim(figures(k)%unit))
    end do
  end subroutine put_summary

  !> Remove what an earlier run has left, also where this one is stopped, or has nothing to say.
  subroutine remove_results(stem)
    character(len=*), intent(in) :: stem   !! path of the files, without their suffixes
    integer, allocatable :: drawn(:)       ! load cases
    integer :: i

    drawn = collected(stem)
    do i = 1, size(drawn)
      call remove_file(stem//'.case'//text_of(drawn(i))//'.vtu')
      call remove_file(stem//'.case'//text_of(drawn(i))//'.contact.vtu')
    end do
    do i = 1, size(result_files)
      call remove_file(stem//trim(result_files(i)%suffix))
    end do
  end subroutine remove_results
end module epcont_report_results
