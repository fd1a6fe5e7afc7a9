!> Strain errors of the answer, body by body. The error is the difference from recovered strains (Zienkiewicz
!> and Zhu 1987). Its products with the errors of adjoint fields estimate the errors of figures.
module epcont_accuracy_error_fields
  use epcont_accuracy_element_errors, only: element_errors
  use epcont_accuracy_patches, only: patch_table
  use epcont_accuracy_recovery, only: recover
  use epcont_assembly_bodies, only: force_fields
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_kinematics, only: components, directions
  use epcont_linear_contact_rule, only: contact_loads
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_model_model, only: model_type
  use epcont_plan_forecast, only: loads_at_once
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_threads, only: threads_over
  implicit none
  private
  public :: body_fields, compare_fields, error_fields

  !> Number of elements that a thread takes at once.
  integer, parameter :: at_once = 8192

  !> Data kept for the next load case take at most this part of the forecast memory.
  real(wp), parameter :: part_of_memory = 0.1_wp
  integer, parameter :: real_bytes = 8

  !> Adjoint fields on a body; kept for the next load case if they are all of its fields.
  type :: body_fields
    real(wp), allocatable :: u(:, :, :)       !! displacements [length] [directions, fields, places]
    real(wp), allocatable :: smooth(:, :, :)  !! recovered strains [components, fields, places]
  end type body_fields

  !> Errors are strains minus recovered strains: their energies, and their products with errors of adjoint
  !! fields.
  type :: error_fields
    real(wp), allocatable :: smooth(:, :)   !! recovered strains of the answer [components, places of the
                                            !! patches]
    real(wp), allocatable :: element(:)     !! [energy] [elements]
    real(wp) :: energy = 0.0_wp             !! of the answer
    real(wp), allocatable :: along(:, :)    !! sum over elements: with signs, of absolute values [energy] [2,
                                            !! loads]
  end type error_fields

  !> A body whose errors are found.
  type :: compared_body
    type(planned_model), pointer :: scene => null()
    type(linear_problem), pointer :: linear => null()   !! of its last solve
    class(solved_state), pointer :: answer => null()
    type(patch_table), pointer :: table => null()       !! of its elements
    integer :: b = 0                                    !! the body
    integer, allocatable :: element(:), place(:)        !! its elements and recovery points
    real(wp), allocatable :: smooth(:, :)               !! recovered strains [components, places]
  end type compared_body

contains

  !> Find the errors of the answer's strains, and their products with the errors of adjoint fields.
  subroutine compare_fields(scene, linear, answer, table, unit_loads, known, field)
    type(planned_model), target, intent(in) :: scene     !! solved model
    type(linear_problem), target, intent(inout) :: linear   !! of the last solve
    class(solved_state), target, intent(in) :: answer     !! solution of the model
    type(patch_table), target, intent(in) :: table       !! of its elements
    type(contact_loads), intent(in) :: unit_loads        !! contact forces under adjoint loads
    type(body_fields), intent(inout) :: known(:) !! in: of the previous load case, if its loads are the same;
                                                 !! out: of this one [bodies]
    type(error_fields), intent(out) :: field     !! errors
    type(compared_body) :: body
    type(incidence) :: elements, rows            ! of each body
    integer, allocatable :: load(:)              ! adjoint loads that act on the body
    real(wp) :: kept                             ! memory for the next load case [bytes]
    integer :: b, first, j, p

    body%scene => scene
    body%linear => linear
    body%answer => answer
    body%table => table
    allocate (field%smooth(components, table%places), field%element(scene%model%mesh%elements), &
              field%along(2, size(unit_loads%unit)), source=0.0_wp)
    rows = new_incidence(scene%model%bodies_of_rows(), scene%model%mesh%bodies)
    elements = scene%model%mesh%elements_of_bodies()
    kept = 0.0_wp
    do b = 1, scene%model%mesh%bodies
      body%b = b
      body%element = elements%of(b)
      if (size(body%element) == 0) cycle
      body%place = table%of_body%of(b)
      load = pack([(j, j=1, size(unit_loads%unit))], unit_loads%unit > 0.0_wp .and. &
                  any(unit_loads%force(rows%of(b), :) /= 0.0_wp, dim=1))
      associate (fields => known(b))
        do first = 1, max(1, size(load)), loads_at_once
          associate (batch => load(first:min(first + loads_at_once - 1, size(load))))
            if (.not. allocated(fields%u)) &
              call find_displacements(body, unit_loads, batch, rows%of(b), fields%u)
            call recover_strains(body, fields)
            call add_products(body, fields, batch, field)
          end associate
          kept = kept + real_bytes*(size(fields%u) + size(fields%smooth))
          if (size(load) > loads_at_once .or. .not. linear%rule%keeps .or. &
              kept > part_of_memory*scene%expected%bytes) deallocate (fields%u, fields%smooth)
        end do
      end associate
    end do
    field%energy = sum(linear%operator%volume*sum(answer%strain*answer%point_stress, dim=1))
    ! Residual stresses do no work in the total strains.
    if (scene%model%controls%by_increments) field%energy = max(field%energy, sum([( &
      linear%operator%volume(p)* &
      linear%materials%section(linear%materials%of_point(p))%elastic_work(answer%point_stress(:, p)), &
      p=1, scene%model%mesh%points)]))
  end subroutine compare_fields

  !> Find the displacements of a body under some adjoint loads.
  subroutine find_displacements(body, unit_loads, load, rows, u)
    type(compared_body), intent(in) :: body
    type(contact_loads), intent(in) :: unit_loads      !! contact forces under all adjoint loads
    integer, intent(in) :: load(:)                     !! numbers of these loads
    integer, intent(in) :: rows(:)                     !! gap rows of the body
    real(wp), allocatable, intent(out) :: u(:, :, :)   !! [length] [directions, loads, its places]

    associate (node => body%table%node(body%place))
      allocate (u(directions, size(load), size(node)))
      if (size(u) == 0) return
      if (allocated(unit_loads%displacement)) then
        u = unit_loads%displacement(:, load, node)
      else
        call body%linear%body_displacements(body%scene, body%b, &
          forces_on(body%scene%model, body%b, rows, unit_loads%force(:, load)), node, u)
      end if
    end associate
  end subroutine find_displacements

  !> List the nodal forces of gap rows on a body. A node may occur twice.
  pure type(force_fields) function forces_on(model, b, rows, force) result(loads)
    type(model_type), intent(in) :: model
    integer, intent(in) :: b, rows(:)        !! the body, its gap rows
    real(wp), intent(in) :: force(:, :)      !! [force] [rows of the model, fields]
    integer :: c, i, k, n

    n = sum(model%contact%row_start(rows + 1) - model%contact%row_start(rows))
    allocate (loads%node(n), loads%force(directions, size(force, 2), n))
    n = 0
    do k = 1, size(rows)
      if (all(force(rows(k), :) == 0.0_wp)) cycle
      do i = model%contact%row_start(rows(k)), model%contact%row_start(rows(k) + 1) - 1
        if (model%mesh%body(model%contact%row_node(i)) /= b) cycle
        n = n + 1
        loads%node(n) = model%contact%row_node(i)
        do c = 1, directions
          loads%force(c, :, n) = &
            model%contact%row_weight(i)*model%contact%normal(c, rows(k))*force(rows(k), :)
        end do
      end do
    end do
    loads%node = loads%node(:n)   ! drop unused entries
  end function forces_on

  !> Recover the strains of the answer in a body. Those of adjoint fields are recovered once.
  subroutine recover_strains(body, fields)
    type(compared_body), intent(inout) :: body
    type(body_fields), intent(inout) :: fields
    real(wp), allocatable :: sample(:, :, :), smooth(:, :, :)   ! at sampling points and places; 0: the answer
    integer :: i, last

    last = merge(0, size(fields%u, 2), allocated(fields%smooth))
    allocate (sample(components, 0:last, size(body%table%points_of(body%b), 2)), &
              smooth(components, 0:last, size(body%place)))
    !$omp parallel do num_threads(threads_over(size(body%element)))
    do i = 1, size(body%element)
      call sample_element(body, body%element(i), fields%u, sample)
    end do
    !$omp end parallel do
    call recover(body%scene%model, body%table, body%b, components*(1 + last), sample, smooth)
    body%smooth = smooth(:, 0, :)
    if (.not. allocated(fields%smooth)) fields%smooth = smooth(:, 1:, :)
  end subroutine recover_strains

  !> Find the strains of an element at its sampling points.
  subroutine sample_element(body, e, u, sample)
    type(compared_body), intent(in) :: body
    integer, intent(in) :: e
    real(wp), contiguous, intent(in) :: u(:, :, :)            !! displacements of the fields
    !> Of the body: of the answer, then of the fields if they are requested [components, 0:fields or 0, any]
    real(wp), contiguous, intent(inout) :: sample(:, 0:, :)
    real(wp) :: weight(most_points)                           ! of the integration points
    integer :: k, p, place(most_nodes), points, s

    associate (kind => body%scene%model%mesh%kinds(body%scene%model%mesh%kind(e)), &
               first => body%scene%model%mesh%first_point(e), operator => body%linear%operator)
      points = kind%points
      if (ubound(sample, 2) > 0) place = places_of(body, e)
      do k = 1, kind%samples
        weight(:points) = 1.0_wp
        if (kind%degree > 1) then
          weight(:points) = kind%sample_of(:points, k)
        else if (points > 1) then
          weight(:points) = operator%volume(first:first + points - 1)
          weight(:points) = weight(:points)/sum(weight(:points))
        end if
        s = body%table%before(e) + k
        sample(:, 0, s) = 0.0_wp
        do p = 1, points
          sample(:, 0, s) = sample(:, 0, s) + weight(p)*body%answer%strain(:, first + p - 1)
        end do
        if (ubound(sample, 2) > 0) &
          call operator%weigh_strains(first, kind%nodes, weight(:points), place, u, sample(:, 1:, s))
      end do
    end associate
  end subroutine sample_element

  !> Find the errors of the answer in a body, and add their products with the errors of adjoint fields.
  !! Threads share the elements in fixed parts, whose sums are added in order, so that results do not depend
  !! on the number of threads.
  subroutine add_products(body, fields, load, field)
    type(compared_body), intent(in) :: body
    type(body_fields), intent(in) :: fields
    integer, intent(in) :: load(:)               !! the load of each field
    type(error_fields), intent(inout) :: field
    real(wp), allocatable :: part(:, :, :)       ! of `along`, by the elements of each part
    integer :: k

    associate (n => size(body%element))
      allocate (part(2, size(load), (n - 1)/at_once + 1), source=0.0_wp)
      !$omp parallel do num_threads(threads_over(n)) schedule(dynamic)
      do k = 1, size(part, 3)
        call compare_elements(body, fields, body%element(at_once*(k - 1) + 1:min(at_once*k, n)), &
                              field%element, part(:, :, k))
      end do
      !$omp end parallel do
    end associate
    field%smooth(:, body%place) = body%smooth
    do k = 1, size(part, 3)
      field%along(:, load) = field%along(:, load) + part(:, :, k)
    end do
  end subroutine add_products

  !> Find the errors of some elements, and the sums of their products with those of adjoint fields.
  subroutine compare_elements(body, fields, element, energy, along)
    type(compared_body), intent(in) :: body
    type(body_fields), intent(in) :: fields
    integer, intent(in) :: element(:)              !! numbers of the elements
    real(wp), intent(inout) :: energy(:)           !! errors of the answer [energy] [elements]
    real(wp), intent(inout) :: along(:, :)         !! sums [energy] [2, fields]
    type(element_errors) :: errors
    real(wp) :: product(size(along, 2))
    integer :: e, f, i, k, place(most_nodes)

    do i = 1, size(element)
      e = element(i)
      associate (kind => body%scene%model%mesh%kinds(body%scene%model%mesh%kind(e)), &
                 first => body%scene%model%mesh%first_point(e), linear => body%linear)
        place = places_of(body, e)
        call errors%compare(kind, linear%operator%volume(first), body%answer%strain(1, first), place, &
                            body%smooth)
        call errors%find_stress(kind, linear%materials, first, body%answer%point)
        energy(e) = errors%energy(kind)
        if (size(product) == 0) cycle
        call errors%find_weights(kind, linear%operator%b(1, linear%operator%column(first) + 1))
        product = 0.0_wp
        do k = 1, kind%nodes
          do f = 1, size(product)
            associate (s => errors%of_strain, d => errors%of_displacement, at => place(k))
              product(f) = product(f) + (s(1, k)*fields%smooth(1, f, at) + s(2, k)*fields%smooth(2, f, at)) &
                + (s(3, k)*fields%smooth(3, f, at) + s(4, k)*fields%smooth(4, f, at)) &
                - (d(1, k)*fields%u(1, f, at) + d(2, k)*fields%u(2, f, at))
            end associate
          end do
        end do
      end associate
      along(1, :) = along(1, :) + product
      along(2, :) = along(2, :) + abs(product)
    end do
  end subroutine compare_elements

  !> Find the positions of the nodes of an element in the list of recovery points of its body.
  pure function places_of(body, e) result(own)
    type(compared_body), intent(in) :: body
    integer, intent(in) :: e
    integer :: own(most_nodes), k

    own = 0
    do k = 1, body%scene%model%mesh%node_count(e)
      own(k) = body%table%own(body%table%place(k, e))
    end do
  end function places_of
end module epcont_accuracy_error_fields
