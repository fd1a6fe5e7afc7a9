!> Memory and work that a scene will take, from the numbering alone.
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
    integer(i8) :: bytes = 0            !! that the process will hold at its peak, on one thread
    real(wp) :: operations = 0.0_wp     !! floating-point operations of factor, flexibility and simplex
    !> Of joined bodies: about the same should they have to be solved apart, with their F
    integer(i8) :: apart_bytes = 0
  contains
    procedure :: keep_unloaded
  end type forecast_type

  real(wp), parameter :: giga = 1.0e9_wp
  integer(i8), parameter :: real_bytes = 8

  !> What a run holds besides its matrices, as measured [bytes]: program and libraries; a node, an integration
  !! point, each node of its element at a point, and a point that can yield. Within 0.8 to 1.3 in all
  !! (`tests/plan`).
  integer(i8), parameter :: of_process = 7700000, of_node = 980, of_point = 250, of_node_of_point = 50, &
      of_yielding_point = 400
  !> Matrices over all pairs that are there at once while the contact is solved: F, the tableau, factors of
  !! those that touch, here half of them to all, and F of the bodies that cannot yield where others can.
  real(wp), parameter :: pair_matrices = 2.6_wp
  !> And over pairs and free motions, if not over motions twice, for the rigid start.
  integer(i8), parameter :: motion_matrices = 8
  !> Unit loads along free motions whose strains are there at once, of one body, when the figures are
  !! assessed: all that a body feels may take more memory than its factor. And what each takes of a node and
  !! of an element [bytes].
  integer, parameter, public :: loads_at_once = 15
  integer(i8), parameter :: load_of_node = 64, load_of_element = 32

  !> Of joined bodies, further sets of contacts and the steps with them: factors made again, over the first,
  !! and what an entry of the factor takes in operations of the same time.
  real(wp), parameter :: of_sets = 1.0_wp, of_solves = 150.0_wp
  !> Rigid-body modes for which the error of the approach is estimated, at most: those with the largest
  !! motions.
  integer, parameter, public :: most_assessed = 12
  !> Sums of forces whose errors are estimated, mostly: of all pairs, and along x and y on two bodies.
  integer, parameter :: usual_sums = 4

contains

  !> Refuse a scene that is above the limit, or for which the system has not enough memory.
  subroutine check_memory(bytes, limit, error)
    integer(i8), intent(in) :: bytes      !! as forecast
    real(wp), intent(in) :: limit         !! [GB]
    type(error_type), allocatable, intent(out) :: error   !! not enough of it

    if (.not. bytes/giga <= limit) then
      call raise(error, status_usage, &
                 'the scene needs about '//gigabytes(bytes/giga)//' of memory, and --memory allows '// &
                 gigabytes(limit))
    else if (.not. has_memory(most_memory(bytes))) then
      call raise(error, status_usage, 'the scene needs up to '//gigabytes(most_memory(bytes)/giga)// &
                 ' of memory, and the system does not give it (ulimit -v)')
    end if

  contains

    pure function gigabytes(number) result(text)
      real(wp), intent(in) :: number
      character(len=:), allocatable :: text

      text = short_real(number)//' GB'
    end function gigabytes
  end subroutine check_memory

  !> What a run takes of addresses, at most: of what is forecast not all is touched, and the heap has its gaps
  !! [bytes].
  pure integer(i8) function most_memory(bytes)
    integer(i8), intent(in) :: bytes   !! as forecast

    most_memory = 2*bytes + memory_of_libraries
  end function most_memory

  !> If several load cases yield, the factors of the unloaded state are held beside those of the last state.
  pure subroutine keep_unloaded(self)
    class(forecast_type), intent(inout) :: self

    self%bytes = 2*self%bytes - of_process
  end subroutine keep_unloaded

  !> What a scene will take.
  function forecast(model, motions, numbering, plan) result(expected)
    type(model_type), intent(in) :: model   !! the scene
    type(free_motions), intent(in) :: motions   !! free ones
    type(numbering_type), intent(in) :: numbering   !! of its equations
    type(iteration_plan), intent(in) :: plan   !! of its iteration
    type(forecast_type) :: expected
    type(incidence) :: of_bodies              ! pairs that have nodes in each
    integer(i8), allocatable :: own_pairs(:)
    integer(i8) :: coupled, done_with, entries, factor, flexibility, last, pairs, passing, unit_loads
    integer :: b

    pairs = model%pairs
    coupled = pairs**2
    if (plan%joined) then
      call foresee_joined()
      return
    end if
    of_bodies = new_incidence(model%bodies_of_pairs(), model%bodies)
    own_pairs = of_bodies%start(2:) - of_bodies%start(:model%bodies)
    entries = 0       ! of the factors
    flexibility = 0   ! entries that are wanted for that of one body
    unit_loads = 0    ! bytes of those that one body feels
    passing = 0       ! and entries that its fronts leave to each other, free when it has been factored
    do b = 1, size(numbering%body)
      associate (body => numbering%body(b))
        if (body%solver == solver_frontal) then
          factor = body%fronts%entries(kept=body%can_yield)
          done_with = factor - body%fronts%entries_of_factor()
        else
          factor = body%panels%entries()
          done_with = 0
        end if
        if (body%can_yield) done_with = 0
        passing = max(passing, done_with)
        entries = entries + factor - done_with + int(body%equations, i8)*body%border
        ! Its part, and the window that right-hand sides go through; or those on the trailing block and this,
        ! then that part; where each pair has one equation of its own, the part alone.
        last = body%contact_equations
        associate (own => own_pairs(b))
          if (.not. body%contact_last) then
            flexibility = max(flexibility, own*(body%half_bandwidth + 2*own))
          else if (last == own) then
            flexibility = max(flexibility, own**2)
          else
            flexibility = max(flexibility, last*own + max(last, own)**2)
          end if
        end associate
        unit_loads = max(unit_loads, min(int(min(motions%count, loads_at_once), i8), own_pairs(b))* &
                         (load_of_node*size(body%node) + load_of_element*size(body%element)))
        expected%operations = expected%operations + 4.0_wp*body%border*factor + body%operations
      end associate
    end do
    entries = entries + max(int(pair_matrices*coupled, i8), flexibility + coupled, passing) + &
              max(int(motions%count, i8)**2, &
                  pairs*motion_matrices*motions%count)
    expected%bytes = real_bytes*entries + beside_matrices() + unit_loads
    ! About one pivot a pair, each over the whole tableau.
    expected%operations = expected%operations + 2*real(pairs, wp)**3

  contains

    !> What joined bodies take: one factor, and a part of it again with each set of contacts; solves, which
    !! wait for memory; and all unit loads at once, of motions and of sums of forces.
    subroutine foresee_joined()
      associate (fronts => numbering%body(1)%fronts, loads => min(most_assessed, motions%count) + usual_sums)
        entries = fronts%entries(kept=.true.)
        expected%bytes = real_bytes*entries + beside_matrices() + load_of_node*model%nodes*loads
        expected%apart_bytes = expected%bytes + int(pair_matrices*coupled, i8)*real_bytes
        expected%operations = (1.0_wp + of_sets)*fronts%operations() + of_solves*entries
      end associate
    end subroutine foresee_joined

    !> What a run holds besides its matrices [bytes].
    pure integer(i8) function beside_matrices() result(bytes)
      integer :: p

      bytes = of_process + of_node*model%nodes + of_point*model%points
      do p = 1, model%points
        bytes = bytes + of_node_of_point*model%node_count(model%point_element(p)) + &
                merge(of_yielding_point, 0_i8, model%can_yield(model%point_element(p)))
      end do
    end function beside_matrices
  end function forecast
end module epcont_plan_forecast
