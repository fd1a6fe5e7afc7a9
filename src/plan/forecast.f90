!> Memory and work that a scene will take, from the numbering alone.
module epcont_plan_forecast
  use epcont_base_error, only: error_type, raise, status_usage
  use epcont_base_kinds, only: i8, wp
  use epcont_base_memory, only: has_memory, memory_of_libraries
  use epcont_base_text, only: short_real
  use epcont_linalg_panel_layout, only: panel_entries
  use epcont_model_controls, only: precision_double, solver_frontal, solver_sparse
  use epcont_model_model, only: model_type
  use epcont_plan_iteration_plan, only: iteration_plan
  use epcont_plan_numbering, only: numbering_type
  implicit none
  private
  public :: forecast_type, forecast, check_memory, memory_of_run

  type :: forecast_type
    integer(i8) :: bytes = 0            !! of the matrices
    integer(i8) :: double_bytes = 0     !! of the same in double precision
    real(wp) :: operations = 0.0_wp     !! floating-point operations of factor, flexibility and simplex
  end type forecast_type

  real(wp), parameter :: giga = 1.0e9_wp

contains

  !> Refuse matrices that are above the limit, or for which, and for the scene, the system has not enough memory.
  subroutine check_memory(model, matrices, limit, error)
    type(model_type), intent(in) :: model
    integer(i8), intent(in) :: matrices   !! [bytes]
    real(wp), intent(in) :: limit         !! [GB]
    type(error_type), allocatable, intent(out) :: error
    integer(i8) :: bytes

    bytes = memory_of_run(model, matrices)
    if (real(matrices, wp) > giga*limit) then
      call raise(error, status_usage, 'the matrices need '//gigabytes(real(matrices, wp))//', and --memory allows '// &
                 gigabytes(giga*limit))
    else if (.not. has_memory(bytes)) then
      call raise(error, status_usage, 'the scene needs up to '//gigabytes(real(bytes, wp))// &
                 ' of memory, and the system does not give it (ulimit -v)')
    end if
  end subroutine check_memory

  !> What a run takes in all, at most [bytes].
  pure integer(i8) function memory_of_run(model, matrices)
    type(model_type), intent(in) :: model
    integer(i8), intent(in) :: matrices   !! [bytes]
    integer(i8), parameter :: part = 10000_i8   !! of a node or an element, with all that is kept of it: up to here [bytes]

    memory_of_run = matrices + part*(model%nodes + model%elements) + memory_of_libraries
  end function memory_of_run

  pure function gigabytes(bytes) result(text)
    real(wp), intent(in) :: bytes
    character(len=:), allocatable :: text

    text = short_real(bytes/giga)//' GB'
  end function gigabytes

  pure function forecast(model, numbering, plan) result(expected)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering
    type(iteration_plan), intent(in) :: plan
    type(forecast_type) :: expected
    integer(i8) :: entries, factor, pairs
    integer :: b

    pairs = model%pairs
    entries = 0
    do b = 1, size(numbering%body)
      associate (body => numbering%body(b))
        select case (body%solver)
        case (solver_sparse)
          factor = sparse_entries(body%equations)
        case (solver_frontal)
          factor = body%fronts%entries() + body%fronts%remainders(body%can_yield)
        case default
          factor = panel_entries(body%reach)
        end select
        expected%bytes = expected%bytes + factor*merge(8, 4, body%solver == solver_sparse .or. plan%precision == precision_double)
        expected%double_bytes = expected%double_bytes + 8_i8*factor
        entries = entries + int(body%equations, i8)*body%border
        if (body%contact_last) then
          entries = entries + int(body%contact_equations, i8)**2
        else
          entries = entries + pairs*(pairs + body%half_bandwidth)
        end if
        expected%operations = expected%operations + 4.0_wp*body%border*factor + &
                              merge(sparse_operations(body%equations), body%operations, body%solver == solver_sparse)
      end associate
    end do
    ! F, its scaled copy, and the tableau or factors.
    expected%bytes = expected%bytes + 8_i8*(entries + 3_i8*pairs**2)
    expected%double_bytes = expected%double_bytes + 8_i8*(entries + 3_i8*pairs**2)
    if (plan%contact%by_blocks) then
      ! The full set factored twice; the sets on the way to it are smaller, or little of them is factored.
      expected%operations = expected%operations + 2.0_wp/3.0_wp*real(pairs, wp)**3
    else
      ! A pivot runs over the whole tableau, about one pivot a pair.
      expected%operations = expected%operations + 2.0_wp*real(pairs, wp)**3
    end if
  end function forecast

  !> Entries that MUMPS takes for its factor and its work: of nested fronts in the plane, n log n.
  pure integer(i8) function sparse_entries(equations)
    integer, intent(in) :: equations

    sparse_entries = int(12.0_wp*equations*log(real(max(2, equations), wp)), i8)
  end function sparse_entries

  !> Operations of its factorization, n**1.5.
  pure real(wp) function sparse_operations(equations)
    integer, intent(in) :: equations

    sparse_operations = 65.0_wp*real(equations, wp)**1.5_wp
  end function sparse_operations
end module epcont_plan_forecast
