!> Measure epcont's solver stage by stage: bench_ours DECK [SYSTEM]
!>
!> Prints the number of equations; processor seconds of numbering, factor, F, gaps due to the loads (N K^-1 f), contact,
!> displacements; of their sum; of seven repetitions starting at the factor; of assembly (including clearing the factor's storage)
!> and of the condition estimate, which are not in a sum. Fronts are factored during assembly: the time of the factor is
!> that of both minus that of the element matrices alone, which counts as assembly. All bodies are elastic. Medians of as many runs as
!> fit into three tenths of a second, without the first of several.
!> SYSTEM receives the input of tools/benchmark/bare, in the order of the nodes.
program bench_ours
  use epcont_assembly_bodies, only: factored_bodies, half_solved_body, new_bodies
  use epcont_assembly_strain_operator, only: new_strain_operator, strain_operator
  use epcont_base_error, only: error_type
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_system_memory, only: prepare_heap
  use epcont_contact_problem, only: contact_problem, contact_solution, contact_solved
  use epcont_contact_solver, only: solve_contact
  use epcont_deck_deck, only: deck_type, read_deck
  use epcont_base_diagnostic, only: diagnostics
  use epcont_flexibility_flexibility, only: body_flexibility, find_flexibility, &
    gap_opening, pair_forces, see_motions
  use epcont_linear_whole_flexibility, only: add_part, complete_flexibility
  use epcont_material_linear_law, only: elastic_law, linear_law
  use epcont_material_model_materials, only: find_materials, model_materials
  use epcont_build_build, only: build_model
  use epcont_model_controls, only: solver_frontal
  use epcont_model_finding, only: findings
  use epcont_model_model, only: model_type
  use epcont_element_element_kind, only: most_nodes
  use epcont_plan_free_motion, only: find_free_motions, free_motions
  use epcont_plan_iteration_plan, only: iteration_plan, plan_iteration
  use epcont_plan_numbering, only: number_equations, numbering_type
  use epcont_plan_planned_model, only: planned_model
  use statistics, only: argument, median
  implicit none

  integer, parameter :: ordering = 1, factor = 2, flexibility = 3, load_gap = 4, contact = 5, displacing = 6
  integer, parameter :: all_stages = 7, more = 8, assembly = 9, conditioning = 10, times = 10
  integer, parameter :: most_runs = 200, further = 7
  real(wp), parameter :: least_seconds = 0.3_wp

  type(model_type) :: model
  type(free_motions) :: motions
  type(strain_operator) :: operator
  type(linear_law) :: law
  type(model_materials) :: materials
  type(numbering_type) :: numbering
  type(incidence) :: pairs
  type(planned_model) :: scene   ! for both
  type(factored_bodies) :: bodies
  type(contact_problem) :: problem
  type(contact_solution) :: solution
  type(iteration_plan) :: plan
  real(wp), allocatable, save :: displacement(:, :)   ! saved: otherwise gfortran 12 puts it where leak detectors find no reference at the end
  real(wp) :: seconds(times, most_runs), condition, spent
  real(wp) :: begun = 0.0_wp   !! of the last `lap`
  integer :: first, k, runs

  call prepare_heap()   ! as in the program
  call read_scene(argument(1))
  runs = 0
  spent = 0.0_wp
  do while (runs == 0 .or. (runs < most_runs .and. spent < least_seconds))
    runs = runs + 1
    call run_once(seconds(:, runs))
    spent = spent + sum(seconds(all_stages:, runs))
  end do
  first = merge(2, 1, runs > 1)
  print '(i9, 10es12.4)', sum(numbering%body%equations), (median(seconds(k, first:runs)), k=1, times)
  if (command_argument_count() > 1) call write_system(argument(2))

contains

  subroutine read_scene(path)
    character(*), intent(in) :: path
    type(deck_type) :: deck
    type(diagnostics) :: faults
    type(error_type), allocatable :: error
    type(findings) :: loose

    call read_deck(path, deck, faults, error)
    if (allocated(error)) error stop 'this deck cannot be read'
    call build_model(deck, model, faults)
    if (faults%errors > 0) error stop 'this deck has faults'
    call find_free_motions(model, motions, loose)
    plan = plan_iteration(model, .false.)
    operator = new_strain_operator(model)
    call find_materials(model, materials)
    law = elastic_law(materials)
    problem%initial_gap = model%contact%initial_gap
    call see_motions(model, motions, problem%motion, problem%resultant)
  end subroutine read_scene

  !> Run everything once, then seven more times with the same numbering.
  subroutine run_once(spent)
    real(wp), intent(out) :: spent(times)
    real(wp) :: again(times)
    integer :: k

    spent = 0.0_wp
    begun = now()
    numbering = number_equations(model, .false.)
    spent(ordering) = lap()
    scene%model = model
    scene%numbering = numbering
    bodies = new_bodies(scene)
    bodies%law = law
    call solve_once(spent)
    spent(all_stages) = sum(spent(ordering:displacing))
    begun = now()
    call bodies%estimate_condition(condition)
    spent(conditioning) = lap()
    do k = 1, further
      call solve_once(again)
      spent(more) = spent(more) + sum(again(factor:displacing))
    end do
  end subroutine run_once

  !> Run from assembly to displacements.
  subroutine solve_once(spent)
    real(wp), intent(inout) :: spent(times)
    logical, allocatable :: start(:)   !! none
    real(wp) :: alone                  !! seconds of the element matrices alone
    type(body_flexibility) :: part
    type(half_solved_body), allocatable :: half(:)
    integer :: b

    begun = now()
    spent(assembly) = 0.0_wp
    spent(factor) = 0.0_wp
    do b = 1, model%mesh%bodies
      if (numbering%body(b)%solver == solver_frontal) then
        call make_elements(numbering%body(b)%element)
        alone = lap()
        spent(assembly) = spent(assembly) + alone
        spent(factor) = spent(factor) - alone
        call bodies%body(b)%assemble(scene, operator, law, bodies%spring, b)
      else
        call bodies%body(b)%assemble(scene, operator, law, bodies%spring, b)
        spent(assembly) = spent(assembly) + lap()
      end if
      call bodies%body(b)%factor()
      spent(factor) = spent(factor) + lap()
    end do
    if (allocated(problem%flexibility)) deallocate (problem%flexibility)
    allocate (problem%flexibility(model%contact%pairs, model%contact%pairs), source=0.0_wp)
    pairs = new_incidence(model%bodies_of_rows(), model%mesh%bodies)
    do b = 1, model%mesh%bodies
      call find_flexibility(model, numbering, b, pairs%of(b), bodies%body(b), part)
      call add_part(part, problem%flexibility)
    end do
    call complete_flexibility(problem%flexibility)
    spent(flexibility) = lap()
    call bodies%add_forces(scene, model%loads%load, .true., half)
    problem%load_gap = gap_opening(model, bodies%finish(scene, half, moved=.true., at_contact=.true.))
    spent(load_gap) = lap()
    call solve_contact(problem, solution, start)
    spent(contact) = lap()
    if (solution%state /= contact_solved) error stop 'no contact found'
    call bodies%add_forces(scene, pair_forces(model, solution%force), .false., half)
    displacement = bodies%finish(scene, half, moved=.true., at_contact=.false.)
    spent(displacing) = lap()
  end subroutine solve_once

  !> Compute the element matrices only.
  subroutine make_elements(element)
    integer, intent(in) :: element(:)
    real(wp) :: k((2*most_nodes)**2)
    integer :: e

    do e = 1, size(element)
      call operator%element_stiffness(model, element(e), law, 2*model%mesh%node_count(element(e)), k)
    end do
  end subroutine make_elements

  !> Processor time [s].
  real(wp) function now()
    call cpu_time(now)
  end function now

  !> Seconds since the last call.
  real(wp) function lap()
    real(wp) :: ended

    ended = now()
    lap = ended - begun
    begun = ended
  end function lap

  !> Write all bodies as one matrix, with equations in the order of the nodes.
  subroutine write_system(path)
    character(*), intent(in) :: path
    integer, allocatable :: column(:), equation(:, :), n_equation(:), n_start(:), row(:)
    real(wp), allocatable :: force(:, :), n_weight(:), value(:)
    integer :: n, unit

    call number_along_nodes(equation, n)
    call list_entries(equation, row, column, value)
    call list_rows(equation, n_start, n_equation, n_weight)
    force = model%loads%load + bodies%settlement
    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', action='write')
    write (unit) n, size(row), model%contact%pairs, size(n_equation), motions%count, row, column, value
    write (unit) n_start, n_equation, n_weight, problem%initial_gap + problem%load_gap, problem%motion%dense(), problem%resultant
    write (unit) merge(1, 0, solution%touching), gathered(equation, n, force), taken(equation, n, displacement)
    close (unit)
  end subroutine write_system

  !> A number for each equation of a body, in the order of the nodes; 0 if fixed.
  subroutine number_along_nodes(equation, n)
    integer, allocatable, intent(out) :: equation(:, :)
    integer, intent(out) :: n
    integer :: c, node

    allocate (equation(2, model%mesh%nodes), source=0)
    n = 0
    do node = 1, model%mesh%nodes
      do c = 1, 2
        if (model%constraints%leader(c, node) /= node .or. numbering%equation(c, node) == 0) cycle
        n = n + 1
        equation(c, node) = n
      end do
    end do
    do c = 1, 2
      equation(c, :) = equation(c, model%constraints%leader(c, :))
    end do
  end subroutine number_along_nodes

  !> Write the lower triangle, element by element: entries of one position are to be summed.
  subroutine list_entries(equation, row, column, value)
    integer, intent(in) :: equation(:, :)
    integer, allocatable, intent(out) :: row(:), column(:)
    real(wp), allocatable, intent(out) :: value(:)
    real(wp) :: k((2*most_nodes)**2)
    integer, allocatable :: number(:)
    integer :: e, i, j, last, n

    last = sum((2*model%mesh%node_count)**2)
    allocate (row(last), column(last), value(last))
    last = 0
    do e = 1, model%mesh%elements
      n = model%mesh%node_count(e)
      call operator%element_stiffness(model, e, law, 2*n, k)
      number = reshape(equation(:, model%mesh%connectivity(:n, e)), [2*n])
      do j = 1, 2*n
        do i = 1, 2*n
          if (number(j) == 0 .or. number(i) < number(j)) cycle
          last = last + 1
          row(last) = number(i)
          column(last) = number(j)
          value(last) = k(i + 2*n*(j - 1))
        end do
      end do
    end do
    row = row(:last)
    column = column(:last)
    value = value(:last)
  end subroutine list_entries

  !> Write N: pair k has entries start(k) to start(k+1)-1.
  subroutine list_rows(equation, start, number, weight)
    integer, intent(in) :: equation(:, :)
    integer, allocatable, intent(out) :: start(:), number(:)
    real(wp), allocatable, intent(out) :: weight(:)
    integer :: c, i, k

    allocate (start(1), source=1)
    allocate (number(0), weight(0))
    do k = 1, model%contact%pairs
      do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
        do c = 1, 2
          if (equation(c, model%contact%row_node(i)) == 0 .or. model%contact%normal(c, k) == 0.0_wp) cycle
          number = [number, equation(c, model%contact%row_node(i))]
          weight = [weight, model%contact%row_weight(i)*model%contact%normal(c, k)]
        end do
      end do
      start = [start, size(number) + 1]
    end do
  end subroutine list_rows

  !> Sums of nodal values over the DOFs that share an equation [n].
  function gathered(equation, n, nodal) result(values)
    integer, intent(in) :: equation(:, :), n
    real(wp), intent(in) :: nodal(:, :)
    real(wp) :: values(n)
    integer :: c, node

    values = 0.0_wp
    do node = 1, model%mesh%nodes
      do c = 1, 2
        if (equation(c, node) > 0) values(equation(c, node)) = values(equation(c, node)) + nodal(c, node)
      end do
    end do
  end function gathered

  !> Nodal values by equation [n].
  function taken(equation, n, nodal) result(values)
    integer, intent(in) :: equation(:, :), n
    real(wp), intent(in) :: nodal(:, :)
    real(wp) :: values(n)
    integer :: c, node

    do node = 1, model%mesh%nodes
      do c = 1, 2
        if (equation(c, node) > 0) values(equation(c, node)) = nodal(c, node)
      end do
    end do
  end function taken
end program bench_ours
