!> All files of a run: the listing (ASCII, at most 132 columns, without data that varies from run to run) and
!> the tables. Load cases are added one by one, and written after the last.
module epcont_report_results
  use epcont_base_error, only: error_type, status_valid
  use epcont_base_kinds, only: wp
  use epcont_report_case_table, only: case_row, put_cases, put_worst_case, row_of_case
  use epcont_base_text, only: text_of
  use epcont_report_columns, only: column, table_type, word
  use epcont_report_file, only: remove_file
  use epcont_report_listing, only: list_case, list_scene
  use epcont_messages_names, only: joined
  use epcont_report_plan_text, only: plan_text
  use epcont_report_run, only: run_results
  use epcont_report_summary, only: figure_type, summarise
  use epcont_report_tables, only: put_table
  use epcont_report_vtk, only: drawing, remove_drawings, write_collection, write_vtk
  implicit none
  private
  public :: results_type, remove_results

  !> A file of results: its suffix after the name of the deck, and its contents.
  type :: result_file
    character(len=16) :: suffix
    character(len=76) :: text
  end type result_file

  type(result_file), parameter, public :: result_files(*) = [ &
    result_file('.lst', 'the listing; the same bytes on every run'), &
    result_file('.summary.csv', &
                'outcome, approaches, certificate and accuracy; 17 digits as in all tables'), &
    result_file('.contact.csv', 'the pairs'), &
    result_file('.friction.csv', 'friction force, shear traction and slip of the pairs with friction'), &
    result_file('.zones.csv', 'the contact zones: runs of neighbouring pairs in contact'), &
    result_file('.bodies.csv', 'the contact resultant on each body'), &
    result_file('.history.csv', 'the iterations'), &
    result_file('.increments.csv', 'the increments of flow theory: approach, pressure, half-width'), &
    result_file('.nodes.csv', 'the nodes, if the deck or --tables all asks for them'), &
    result_file('.elements.csv', 'the elements, if the deck or --tables all asks for them'), &
    result_file('.plastic.csv', 'plastic strains of flow theory, with the table of elements'), &
    result_file('.cases.csv', 'the load cases, if there are several'), &
    result_file('.restart', 'the end of the last load case, with PARAM SAVE YES'), &
    result_file('.vtu', 'the bodies, for ParaView, with --vtk: displacements, stresses, states'), &
    result_file('.contact.vtu', 'the boundary in contact, for ParaView, with --vtk: pressures, gaps'), &
    result_file('.pvd', 'for ParaView: index of the .vtu files of load cases and increments')]

  !> The first files are the listing, the summary, and tables with rows of each load case.
  integer, parameter :: listing = 1, summary = 2, of_each_case = 12

  !> Results of one load case: its part of each file.
  type :: case_results
    type(case_row) :: row
    type(table_type) :: part(of_each_case)
    type(drawing), allocatable :: drawing(:)   !! for ParaView
  end type case_results

  !> Output of a run.
  type :: results_type
    character(len=:), allocatable :: stem             !! path of the files, without their suffixes
    !> Command line: always write tables of nodes and elements; only the listing and the summary; files for
    !! ParaView
    logical :: all_tables = .false., brief = .false., vtk = .false.
    type(case_results), allocatable, private :: case(:)
    character(len=:), allocatable :: plan    !! of all models of the load cases, in lines
  contains
    procedure :: begin
    procedure :: add_plan
    procedure :: add_case
    procedure :: finish
  end type results_type

  type(column), parameter :: summary_columns(*) = [ &
    column(word, 'key'), column(word, 'value'), column(word, 'unit')]

  !> Largest number of load cases that a plan names.
  integer, parameter :: most_named = 12

contains

  !> Begin the results of a run.
  subroutine begin(self, run)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run   !! its load cases will follow

    if (.not. allocated(self%case)) allocate (self%case(size(run%deck%subcase)))
    self%plan = ''
  end subroutine begin

  !> Add the plan of some load cases.
  subroutine add_plan(self, run, cases)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run   !! with the plan
    integer, intent(in) :: cases(:)        !! numbers of the load cases

    if (.not. run%has_cases()) then
      self%plan = plan_text(run%planned_model)
    else if (size(cases) == size(self%case)) then
      self%plan = plan_text(run%planned_model, text_of(size(cases))//' load cases')
    else
      self%plan = self%plan//plan_text(run%planned_model, &
                                       'SUBCASE '//joined(run%deck%subcase(cases)%id, ' ', most_named))
    end if
  end subroutine add_plan

  !> Add the results of a load case. Files for ParaView are written.
  subroutine add_case(self, run, error)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run                  !! with the results of this load case
    type(error_type), allocatable, intent(out) :: error   !! a file cannot be written
    type(figure_type), allocatable :: figures(:)
    integer :: k

    if (run%case == 1) call remove_results(self%stem)
    ! If the run is stopped, the next run still finds the files to remove.
    if (run%case == 1 .and. self%vtk .and. run%has_cases()) &
      call write_collection(self%stem, [(drawing('.case'//text_of(run%deck%subcase(k)%id)), &
                                         k=1, size(run%deck%subcase))], error)
    figures = summarise(run)
    self%case(run%case)%row = row_of_case(run)
    do k = 1, merge(of_each_case, summary, run%outcome%has_answer .and. .not. self%brief)
      call put_part(self, run, figures, k, self%case(run%case)%part(k))
    end do
    if (self%vtk .and. run%outcome%has_answer .and. .not. allocated(error)) &
      call put_drawings(self%stem, run, self%case(run%case)%drawing, error)
  end subroutine add_case

  !> Write the files for ParaView: of the increments that are kept, and of the end of the load case.
  subroutine put_drawings(stem, run, drawings, error)
    character(len=*), intent(in) :: stem
    type(run_results), intent(in) :: run
    type(drawing), allocatable, intent(out) :: drawings(:)
    type(error_type), allocatable, intent(out) :: error
    real(wp) :: start, time
    integer :: k

    allocate (drawings(0))
    start = max(1, run%deck%subcase(run%case)%id) - 1
    do k = 1, size(run%increment)
      associate (increment => run%increment(k))
        if (.not. allocated(increment%state) .or. increment%load_factor >= run%answer%load_factor) exit
        drawings = [drawings, drawing(run%case_suffix()//'.inc'//text_of(k), start + increment%load_factor)]
        call write_vtk(run%model, increment%state, status_valid, stem//trim(drawings(k)%suffix), error)
      end associate
      if (allocated(error)) return
    end do
    time = start + merge(run%answer%load_factor, 1.0_wp, run%keeps_states .and. run%is_flow())
    drawings = [drawings, drawing(run%case_suffix(), time)]
    call write_vtk(run%model, run%answer, run%outcome%status, stem//run%case_suffix(), error)
  end subroutine put_drawings

  !> Write the part of a load case.
  subroutine put_part(self, run, figures, k, part)
    class(results_type), intent(in) :: self
    type(run_results), intent(in) :: run
    type(figure_type), intent(in) :: figures(:)           !! of the summary
    integer, intent(in) :: k                              !! number of the file
    type(table_type), intent(inout) :: part
    character(len=:), allocatable :: name   ! of a table

    if (run%has_cases() .and. k /= listing) part%subcase = run%deck%subcase(run%case)%id
    part%listed = k == listing
    select case (k)
    case (listing)
      call list_case(run, figures, self%all_tables, part)
    case (summary)
      call put_summary(figures, part)
    case default
      name = result_files(k)%suffix(2:index(result_files(k)%suffix, '.csv') - 1)
      if (run%wants_table(name, self%all_tables)) call put_table(run, name, part)
    end select
  end subroutine put_part

  !> Write the results, and the index of files for ParaView.
  subroutine finish(self, run, error)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run                  !! of the last load case
    type(error_type), allocatable, intent(out) :: error   !! a file cannot be written
    type(drawing), allocatable :: drawings(:)
    integer :: c

    call put_tables(self, run, error)
    if (.not. self%vtk .or. allocated(error)) return
    allocate (drawings(0))
    do c = 1, size(self%case)
      if (allocated(self%case(c)%drawing)) drawings = [drawings, self%case(c)%drawing]
    end do
    if (run%has_cases() .or. size(drawings) > 1) call write_collection(self%stem, drawings, error)
  end subroutine finish

  !> Write the listing and the tables.
  subroutine put_tables(self, run, error)
    class(results_type), intent(inout) :: self
    type(run_results), intent(in) :: run
    type(error_type), allocatable, intent(out) :: error
    type(table_type) :: file
    logical :: empty(size(self%case))
    integer :: c, k

    do k = 1, of_each_case
      empty = [(self%case(c)%part(k)%is_empty(), c=1, size(empty))]
      if (all(empty)) cycle
      file = table_type()
      if (k == listing) call list_scene(run, self%plan, file)
      do c = 1, size(empty)
        if (.not. empty(c)) call file%add(self%case(c)%part(k), &   ! one head for all
                                          without_head=k /= listing .and. .not. all(empty(:c - 1)))
      end do
      if (k == listing .and. run%has_cases()) then
        call put_cases(self%case%row, file)
        call put_worst_case(self%case%row, run%model%controls%accuracy, file)
      end if
      call file%write_to(self%stem//trim(result_files(k)%suffix), error)
      if (allocated(error)) return
    end do
    if (self%brief .or. .not. run%has_cases()) return
    file = table_type(listed=.false.)
    call put_cases(self%case%row, file)
    call file%write_to(self%stem//'.cases.csv', error)
  end subroutine put_tables

  !> Write the summary in full digits.
  subroutine put_summary(figures, table)
    type(figure_type), intent(in) :: figures(:)
    type(table_type), intent(inout) :: table
    integer :: k

    call table%begin('', summary_columns)
    do k = 1, size(figures)
      call table%row([integer ::], [real(wp) ::], [character(len=len(figures%key)) :: &
                                                  figures(k)%key, figures(k)%value, figures(k)%unit])
    end do
  end subroutine put_summary

  !> Remove the results of an earlier run, also if this run is stopped or has no results.
  subroutine remove_results(stem)
    character(len=*), intent(in) :: stem   !! path of the files, without their suffixes
    integer :: i

    call remove_drawings(stem)
    do i = 1, size(result_files)
      call remove_file(stem//trim(result_files(i)%suffix))
    end do
  end subroutine remove_results
end module epcont_report_results
