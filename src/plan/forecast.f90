!> Memory and operations of a run, from the numbering.
module epcont_plan_forecast
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: i8, wp
  use epcont_base_text, only: short_real
  use epcont_model_controls, only: solver_frontal
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_numbering, only: numbering_type
  use epcont_system_memory, only: has_memory, memory_of_libraries
  implicit none
  private
  public :: forecast_type, forecast, check_memory, most_memory

  type :: forecast_type
    integer(i8) :: bytes = 0            !! peak of the process on one thread
    integer(i8) :: apart_bytes = 0      !! about the peak if joined bodies are solved one by one, with F
    real(wp) :: operations = 0.0_wp     !! floating-point operations of factor, flexibility and simplex
  end type forecast_type

  real(wp), parameter :: giga = 1.0e9_wp
  integer(i8), parameter :: real_bytes = 8

  !> Memory besides the matrices, as measured [bytes]: program and libraries; for each node, integration
  !! point, node of the element at a point, point that can yield, and load case (its texts and its parts of
  !! the heap, 20 000 to 60 000). The forecast is 0.8 to 1.3 times the
  !! peak (`tests/extremes/test_memory.py`).
  integer(i8), parameter :: of_process = 7700000, of_node = 980, of_point = 250, of_node_of_point = 50, &
      of_yielding_point = 400, of_case = 30000
  !> Matrices over all pairs at once while the contact is solved: F, the tableau, factors of the pairs in
  !! contact (half of all to all), and F of the bodies that cannot yield if others can.
  real(wp), parameter :: pair_matrices = 2.6_wp
  !> Matrices over pairs and rigid-body modes for the rigid start, unless modes squared are more.
  integer(i8), parameter :: motion_matrices = 8
  !> Adjoint loads of one body whose strains are computed at once for the error estimates: all of them may
  !! take more memory than its factor. Memory of each for a node and for an element [bytes].
  integer, parameter, public :: loads_at_once = 15
  integer(i8), parameter :: load_of_node = 64, load_of_element = 32

  !> For joined bodies: operations of further active sets over those of the first factorization, and
  !! operations for each entry of the factor that take the time of the solves.
  real(wp), parameter :: of_sets = 1.0_wp, of_solves = 150.0_wp
  !> Rigid-body modes for which the error of the approach is estimated, at most: those with the largest
  !! motions.
  integer, parameter, public :: most_assessed = 12
  !> Usual number of sums of forces with error estimates: of all pairs, and along x and y on two bodies.
  integer, parameter :: usual_sums = 4

contains

  !> Reject a model that needs more memory than the limit, or than the system has.
  subroutine check_memory(bytes, limit, error)
    integer(i8), intent(in) :: bytes      !! forecast memory
    real(wp), intent(in) :: limit         !! [GB]
    type(error_type), allocatable, intent(out) :: error   !! memory does not suffice

    if (.not. bytes/giga <= limit) then
      call raise(error, status_usage, &
                 'the model needs about '//gigabytes(bytes/giga)//' of memory, and --memory allows '// &
                 gigabytes(limit))
    else if (.not. has_memory(most_memory(bytes))) then
      call raise(error, status_usage, 'the model needs up to '//gigabytes(most_memory(bytes)/giga)// &
                 ' of memory, and the system does not give it (ulimit -v)')
    end if

  contains

    pure function gigabytes(number) result(text)
      real(wp), intent(in) :: number
      character(len=:), allocatable :: text

      text = short_real(number)//' GB'
    end function gigabytes
  end subroutine check_memory

  !> Bound of the addresses of a run: not all of the forecast memory is touched, and the heap has gaps
  !! [bytes].
  pure integer(i8) function most_memory(bytes)
    integer(i8), intent(in) :: bytes   !! forecast memory

    most_memory = 2*bytes + memory_of_libraries
  end function most_memory

  !> Memory and operations of a run.
  function forecast(model, motions, numbering, plan, cases) result(expected)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(iteration_plan), intent(in) :: plan
    integer, intent(in) :: cases              !! load cases that share the plan
    type(forecast_type) :: expected
    integer :: p

    if (plan%joined) then
      call add_joined(model, motions, numbering, expected)
    else
      call add_bodies(model, motions, numbering, expected)
    end if
    expected%bytes = expected%bytes + of_process + of_node*model%mesh%nodes + of_point*model%mesh%points
    do p = 1, model%mesh%points
      expected%bytes = expected%bytes + &
        of_node_of_point*model%mesh%node_count(model%mesh%point_element(p)) + &
                       merge(of_yielding_point, 0_i8, model%can_yield(model%mesh%point_element(p)))
    end do
    expected%apart_bytes = expected%bytes + &
      int(pair_matrices*real(model%contact%rows(), wp)**2, i8)*real_bytes
    ! The factors of the unloaded state are kept beside those of the last state.
    if ((cases > 1 .or. model%controls%by_increments) .and. plan%yields) &
      expected%bytes = 2*expected%bytes - of_process
    ! Elastic bodies with friction have the states at the ends of increments.
    if (model%controls%by_increments .and. .not. plan%yields) &
      expected%bytes = expected%bytes + of_node*model%mesh%nodes + of_point*model%mesh%points
    expected%bytes = expected%bytes + of_case*(cases - 1)
  end function forecast

  !> Joined bodies have one factor. A part of it is made again with each active set. Solves wait for memory.
  !! The adjoint fields of modes and of sums of forces exist all at once.
  pure subroutine add_joined(model, motions, numbering, expected)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(forecast_type), intent(inout) :: expected

    associate (fronts => numbering%body(1)%fronts, entries => numbering%body(1)%fronts%entries(kept=.true.))
      expected%bytes = real_bytes*entries + &
                       load_of_node*model%mesh%nodes*(min(most_assessed, motions%count) + usual_sums)
      expected%operations = (1.0_wp + of_sets)*fronts%operations() + of_solves*entries
    end associate
  end subroutine add_joined

  !> Bodies one by one have a factor and a part of F each.
  pure subroutine add_bodies(model, motions, numbering, expected)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(numbering_type), intent(in) :: numbering
    type(forecast_type), intent(inout) :: expected
    type(incidence) :: of_bodies       ! pairs with nodes in each body
    integer(i8) :: entries, factor, flexibility, last, own, pairs, passing, updates, unit_loads
    integer :: b

    pairs = model%contact%rows()
    of_bodies = new_incidence(model%bodies_of_rows(), model%mesh%bodies)
    entries = 0       ! of the factors
    flexibility = 0   ! of the part of F of one body
    unit_loads = 0    ! bytes of the adjoint fields of one body
    passing = 0       ! entries of the update matrices of one body, which are freed after its factorization
    do b = 1, size(numbering%body)
      own = of_bodies%start(b + 1) - of_bodies%start(b)
      associate (body => numbering%body(b))
        if (body%solver == solver_frontal) then
          factor = body%fronts%entries(kept=body%can_yield)
          updates = merge(0_i8, factor - body%fronts%entries_of_factor(), body%can_yield)
        else
          factor = body%panels%entries()
          updates = 0
        end if
        passing = max(passing, updates)
        entries = entries + factor - updates
        ! Right-hand sides on the trailing block, this block, and the part of F
        last = body%contact_equations
        flexibility = max(flexibility, last*own + last**2 + own**2)
        unit_loads = max(unit_loads, min(int(min(motions%count, loads_at_once), i8), own)* &
                         (load_of_node*size(body%node) + load_of_element*size(body%element)))
        expected%operations = expected%operations + body%operations
      end associate
    end do
    entries = entries + max(int(pair_matrices*pairs**2, i8), flexibility + pairs**2, passing) + &
              max(int(motions%count, i8)**2, pairs*motion_matrices*motions%count)
    expected%bytes = real_bytes*entries + unit_loads
    ! About one pivot a pair, each over the whole tableau.
    expected%operations = expected%operations + 2*real(pairs, wp)**3
  end subroutine add_bodies
end module epcont_plan_forecast
