!> The load cases that share a plan and its factors. The first is solved alone; the others go on from what it
!> has left, in streams that threads take side by side, and each case of a stream from the one before. Where
!> streams begin follows from the deck alone, so that every number of threads writes the same bytes.
module epcont_app_case_streams
  use epcont_app_case_words, only: case_words, words_of
  use epcont_base_diagnostic, only: place_type
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: plural
  use epcont_model_load_cases, only: put_case
  use epcont_plan_forecast, only: check_memory, forecast_type, most_memory
  use epcont_plan_planned_model, only: planned_model
  use epcont_plasticity_observer, only: observer
  use epcont_messages_outcome, only: judge
  use epcont_report_results, only: results_type
  use epcont_report_run, only: run_results
  use epcont_system_memory, only: has_memory, memory_of_thread
  use epcont_system_stopwatch, only: stage_writing, stages
  use epcont_system_threads, only: granted_threads, use_one_thread_each
  implicit none
  private
  public :: run_names, solve_pattern

  !> What a run is called, and may take.
  type :: run_names
    character(len=:), allocatable :: path   !! of the deck
    character(len=:), allocatable :: name   !! in its lines of standard output
    real(wp) :: memory = huge(1.0_wp)       !! [GB]
  end type run_names

  !> Cases that follow each other, and what came of them.
  type :: case_stream
    integer :: from = 1, to = 0                       !! places in their pattern
    type(observer) :: watch
    type(planned_model), allocatable :: changed       !! by a case, before which all are solved again
    type(error_type), allocatable :: error
  end type case_stream

contains

  !> Solve the cases of a pattern and take their results; from the first again if another has changed the plan
  !! of the scene.
  subroutine solve_pattern(run, pattern, names, results, words, watch, error)
    type(run_results), intent(inout) :: run          !! whose plan is that of the pattern
    integer, intent(in) :: pattern                   !! which
    type(run_names), intent(in) :: names
    type(results_type), intent(inout) :: results
    type(case_words), intent(inout) :: words(:)      !! what there is to say [cases]
    class(observer), intent(inout) :: watch
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: cases(:)
    type(case_stream), allocatable :: stream(:)
    integer :: threads

    cases = run%cases%of_pattern(pattern)
    do
      call solve_case(run, 1, watch, error)
      if (allocated(error) .or. size(cases) == 1) return
      stream = streams_of(size(cases), run%expected%streams(size(cases)))
      if (size(stream) == 1) then
        call solve_cases(run, 2, size(cases), watch, error)
        if (allocated(error) .or. .not. run%replanned) return
      else
        call choose_threads(run%expected, size(stream), names%memory, threads, error)
        if (allocated(error)) error%message = names%path//': '//error%message
        if (.not. allocated(error)) call solve_streams()
        if (allocated(error) .or. .not. run%replanned) return
      end if
    end do

  contains

    !> Solve a case and take what came of it.
    subroutine solve_case(run, k, watch, error)
      type(run_results), intent(inout) :: run
      integer, intent(in) :: k                     !! its place in the pattern
      class(observer), intent(inout) :: watch
      type(error_type), allocatable, intent(out) :: error

      run%case = cases(k)
      if (run%has_cases()) call put_case(run%cases, run%case, run%model)
      run%kept%another = k < size(cases)
      call run%solve(names%memory, watch, error)
      if (allocated(error)) error%message = names%path//': '//error%message
      if (.not. (allocated(error) .or. run%replanned .and. k > 1)) then
        ! gfortran 12 keeps the length of each text that a function returns in one place for all threads.
        !$omp critical (texts)
        run%outcome = judge(run)
        if (size(cases) > 1 .and. allocated(run%as_given)) call run%outcome%found%add_note(place_type(), &
          'nodes came near that had no pair: solved again, in this load case alone, with '// &
          plural(run%model%pairs - run%as_given%model%pairs, 'more pair'))
        words(run%case) = words_of(run, names%path, names%name)
        call results%add_case(run, error)
        !$omp end critical (texts)
      end if
      if (size(cases) > 1) call run%return_to_given()
      call watch%lap(stage_writing)
    end subroutine solve_case

    !> Solve cases in their order, up to one that changes the scene.
    subroutine solve_cases(run, from, to, watch, error)
      type(run_results), intent(inout) :: run
      integer, intent(in) :: from, to              !! places in the pattern
      class(observer), intent(inout) :: watch
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      do k = from, to
        call solve_case(run, k, watch, error)
        if (allocated(error) .or. run%replanned) return
      end do
    end subroutine solve_cases

    !> All but the first, in streams. What comes first in the deck counts, not in time.
    subroutine solve_streams()
      real(wp) :: spent(2, stages)
      integer :: s

      !$omp parallel do schedule(dynamic) num_threads(threads) if(threads > 1)
      do s = 1, size(stream)
        if (threads > 1) call use_one_thread_each()
        call solve_stream(stream(s))
      end do
      !$omp end parallel do
      spent = 0.0_wp
      run%replanned = .false.
      do s = size(stream), 1, -1
        spent = spent + stream(s)%watch%spent
        if (allocated(stream(s)%error)) error = stream(s)%error
        if (.not. allocated(stream(s)%changed)) cycle
        run%planned_model = stream(s)%changed
        run%replanned = .true.
      end do
      if (threads > 1) call watch%share(spent)
      if (run%replanned) call run%kept%forget()
    end subroutine solve_streams

    !> A stream goes on from a copy of what the first case has left.
    subroutine solve_stream(self)
      type(case_stream), intent(inout) :: self
      type(run_results), allocatable :: own

      allocate (own)
      own = run
      if (threads > 1) then
        call self%watch%start()
        call solve_cases(own, self%from, self%to, self%watch, self%error)
      else
        call solve_cases(own, self%from, self%to, watch, self%error)
      end if
      if (own%replanned) self%changed = own%planned_model
    end subroutine solve_stream
  end subroutine solve_pattern

  !> Streams of all cases of a pattern but the first.
  pure function streams_of(cases, count) result(stream)
    integer, intent(in) :: cases        !! of the pattern
    integer, intent(in) :: count        !! of streams
    type(case_stream), allocatable :: stream(:)
    integer :: s

    allocate (stream(count))
    do s = 1, count
      stream(s)%from = 2 + (s - 1)*(cases - 1)/count
      stream(s)%to = 1 + s*(cases - 1)/count
    end do
  end function streams_of

  !> Threads for streams, each of which takes as much memory as the scene, beside what they go on from.
  subroutine choose_threads(expected, streams, memory, threads, error)
    type(forecast_type), intent(in) :: expected
    integer, intent(in) :: streams
    real(wp), intent(in) :: memory      !! that is allowed [GB]
    integer, intent(out) :: threads
    type(error_type), allocatable, intent(out) :: error   !! there is not enough memory for one
    integer(i8) :: bytes

    threads = min(granted_threads(), streams)
    do
      bytes = expected%kept_bytes + threads*expected%bytes
      call check_memory(bytes, memory, error)
      if (threads == 1) return
      if (.not. allocated(error)) then
        if (has_memory(most_memory(bytes) + (threads - 1)*memory_of_thread)) return
      end if
      threads = threads - 1
    end do
  end subroutine choose_threads
end module epcont_app_case_streams
