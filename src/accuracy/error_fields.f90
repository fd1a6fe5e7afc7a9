!> Errors of strains of the answer and of adjoint fields: differences from recovered strains, their energies
!> (Zienkiewicz and Zhu 1987), and their products. The comparison runs body by body, since only few loads
!> differ on one body (`body_loads.f90`).
module epcont_accuracy_error_fields
  use epcont_accuracy_body_loads, only: body_loads, choose_fields, find_displacements, load_batch, &
    new_body_loads
  use epcont_accuracy_element_errors, only: element_errors, new_element_errors
  use epcont_accuracy_field_sums, only: field_sums, new_field_sums
  use epcont_accuracy_patches, only: patch_table
  use epcont_accuracy_recovery, only: body_samples, place_samples, recover
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_nodes, most_points
  use epcont_element_kinematics, only: components, directions
  use epcont_linear_contact_rule, only: contact_loads
  use epcont_linear_linear_problem, only: linear_problem
  use epcont_linear_solved_state, only: solved_state
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_threads, only: threads_over, use_one_thread_each
  implicit none
  private
  public :: body_fields, compare_fields, error_fields

  !> Number of elements that a thread takes at once.
  integer, parameter :: at_once = 8192

  !> Data kept for the next load case take at most this part of the forecast memory.
  real(wp), parameter :: part_of_memory = 0.1_wp
  integer, parameter :: real_bytes = 8

  !> Adjoint fields of a batch of loads on a body. If the batch represents all loads, they are kept for the
  !! next load case.
  type :: body_fields
    type(load_batch) :: batch
    real(wp), allocatable :: u(:, :, :)   !! displacements under them [length] [directions, fields, places]
    !> Strains of the answer and of all fields at the sampling points, and recovered strains; not allocated if
    !! unknown [components, 0:fields, samples], [components, 0:fields, places]
    real(wp), allocatable :: sample(:, :, :), smooth(:, :, :)
    real(wp), allocatable :: energy(:, :)   !! of each load, as in `field_sums` [energy] [2, loads]
  contains
    procedure :: hand_over
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
    real(wp), allocatable :: missing(:)     !! error energy, as a part of the energy of each adjoint load
                                            !! [loads]
  end type error_fields

  !> State of the comparison, body by body.
  type :: comparison
    type(planned_model), pointer :: scene => null()
    type(linear_problem), pointer :: linear => null()          !! of its last solve
    class(solved_state), pointer :: answer => null()
    type(patch_table), pointer :: table => null()              !! of its elements
    type(contact_loads), pointer :: unit_loads => null()       !! contact forces under adjoint loads
    integer :: b = 0                         !! the body
    integer, allocatable :: element(:)       !! its elements
    type(body_loads) :: loads
    type(body_fields) :: now                 !! of these loads
    type(body_samples) :: samples            !! of its strains
    real(wp), allocatable :: total(:, :)     !! sums of `field_sums` over all bodies [4, loads]
  end type comparison

contains

  !> Find the errors of the answer's strains, and their products with the errors of adjoint fields.
  subroutine compare_fields(scene, linear, answer, table, unit_loads, known, field)
    type(planned_model), target, intent(in) :: scene     !! solved model
    type(linear_problem), target, intent(inout) :: linear   !! of the last solve
    class(solved_state), target, intent(in) :: answer     !! solution of the model
    type(patch_table), target, intent(in) :: table       !! of its elements
    type(contact_loads), target, intent(in) :: unit_loads   !! contact forces under adjoint loads
    type(body_fields), intent(inout) :: known(:) !! in: of the previous load case, if its loads are the same;
                                                 !! out: of this one [bodies]
    type(error_fields), intent(out) :: field     !! errors
    type(incidence) :: elements, pairs           ! of each body
    type(comparison) :: work
    real(wp) :: kept                             ! memory for the next load case [bytes]
    integer :: b, k, p

    work%scene => scene
    work%linear => linear
    work%answer => answer
    work%table => table
    work%unit_loads => unit_loads
    allocate (field%smooth(components, table%places), field%element(scene%model%mesh%elements), &
              field%missing(size(unit_loads%unit)), source=0.0_wp)
    pairs = new_incidence(scene%model%bodies_of_rows(), scene%model%mesh%bodies)
    allocate (work%total(4, size(unit_loads%unit)), source=0.0_wp)
    kept = 0.0_wp
    elements = scene%model%mesh%elements_of_bodies()
    do b = 1, scene%model%mesh%bodies
      work%b = b
      work%element = elements%of(b)
      if (size(work%element) == 0) cycle
      if (allocated(known(b)%smooth)) then
        call known(b)%hand_over(work%now)
        call compare_on_body(work, field, table%of_body%of(b))
      else
        work%loads = new_body_loads(pairs%of(b), unit_loads)
        do k = 1, size(unit_loads%unit) + 1
          call find_fields(work, table%of_body%of(b))
          call compare_on_body(work, field, table%of_body%of(b))
          if (size(work%loads%load) == 0) exit
        end do
        if (k > 1) cycle
      end if
      kept = kept + real_bytes*(size(work%now%u) + size(work%now%sample) + size(work%now%smooth))
      if (linear%rule%keeps .and. kept <= part_of_memory*scene%expected%bytes) &
        call work%now%hand_over(known(b))
    end do
    work%total = work%total*spread(unit_loads%unit, 1, 4)**spread([1, 1, 2, 2], 2, size(unit_loads%unit))
    field%along = work%total(:2, :)
    where (work%total(3, :) > 0.0_wp) field%missing = work%total(3, :)/(work%total(3, :) + work%total(4, :))
    field%energy = sum(linear%operator%volume*sum(answer%strain*answer%point_stress, dim=1))
    ! Residual stresses do no work in the total strains.
    if (scene%model%controls%by_increments) field%energy = max(field%energy, sum([( &
      linear%operator%volume(p)* &
      linear%materials%section(linear%materials%of_point(p))%elastic_work(answer%point_stress(:, p)), &
      p=1, scene%model%mesh%points)]))
  end subroutine compare_fields

  !> Choose the next batch of loads, and find displacements under its fields, if they are unknown.
  subroutine find_fields(work, place)
    type(comparison), intent(inout) :: work
    integer, intent(in) :: place(:)   !! of the body
    integer :: f

    if (allocated(work%now%smooth)) deallocate (work%now%sample, work%now%smooth)   ! of the previous batch
    call choose_fields(work%loads, work%now%batch)
    if (.not. allocated(work%unit_loads%displacement)) then
      call find_displacements(work%scene, work%linear, work%b, work%loads%pair, work%now%batch, &
          work%table%node(place), work%now%u)
      return
    end if
    if (size(work%now%batch%field) == 0) then   ! the solver needs at least one load
      work%now%u = reshape([real(wp) ::], [directions, 0, size(place)])
      return
    end if
    work%now%u = work%unit_loads%displacement(:, work%now%batch%field, work%table%node(place))
    do f = 1, size(work%now%u, 2)
      work%now%u(:, f, :) = work%now%u(:, f, :)/work%unit_loads%unit(work%now%batch%field(f))
    end do
  end subroutine find_fields

  !> Add the contribution of a body's elements under a batch of loads. Threads share the elements in fixed
  !! parts, whose sums are added in order, so that results do not depend on the number of threads.
  subroutine compare_on_body(work, field, place)
    type(comparison), intent(inout) :: work
    type(error_fields), intent(inout) :: field      !! errors are added
    integer, intent(in) :: place(:)   !! those of the body
    type(field_sums) :: part, sums
    integer :: fields, first, width
    logical :: told   ! all fields are known, except the answer

    fields = size(work%now%u, 2)
    width = components*(1 + fields)
    told = allocated(work%now%smooth)
    sums = new_field_sums(work%now%batch%share, 0)
    call place_samples(work%scene%model, work%element, work%samples)
    if (.not. told) allocate (work%now%sample(components, 0:fields, size(work%samples%x, 2)), &
                              work%now%smooth(components, 0:fields, size(place)))
    if (told) fields = 0
    !$omp parallel do num_threads(threads_over(size(work%element)))
    do first = 1, size(work%element), at_once
      call sample_elements(work, work%element(first:min(first + at_once - 1, size(work%element))), &
          fields, width, &
                           work%now%sample)
    end do
    !$omp end parallel do
    call recover(work%scene%model, work%table, work%b, work%samples, fields, work%now%sample, work%now%smooth)
    !$omp parallel do num_threads(threads_over(size(work%element))) schedule(dynamic) ordered private(part)
    do first = 1, size(work%element), at_once
      call use_one_thread_each()
      part = new_field_sums(work%now%batch%share, min(at_once, size(work%element) - first + 1))
      part%finds_energies = .not. told
      call compare_elements(work, field, work%element(first:min(first + at_once - 1, &
          size(work%element))), width, work%now%sample, &
                            work%now%smooth, part)
      !$omp ordered
      call sums%include(part)
      !$omp end ordered
    end do
    !$omp end parallel do
    field%smooth(:, place) = work%now%smooth(:, 0, :)
    if (width == components) return
    call sums%finish()
    if (.not. told) work%now%energy = sums%energy
    work%total(:2, work%now%batch%load) = work%total(:2, work%now%batch%load) + sums%along
    work%total(3:, work%now%batch%load) = work%total(3:, work%now%batch%load) + work%now%energy
  end subroutine compare_on_body

  !> Find the strains of some elements at their sampling points: of the answer, then of the fields.
  subroutine sample_elements(work, element, fields, width, sample)
    type(comparison), intent(in) :: work
    integer, intent(in) :: element(:)   !! numbers of the elements
    integer, intent(in) :: fields       !! number of fields: zero or all; strains of other fields are kept
    integer, intent(in) :: width        !! components of all fields
    real(wp), intent(inout) :: sample(width, *)   !! of the body
    real(wp) :: strain(width, most_points)
    integer :: i

    do i = 1, size(element)
      associate (e => element(i), kind => work%scene%model%mesh%kinds(work%scene%model%mesh%kind(element(i))))
        if (kind%points == 1) then
          call find_strains(work, e, fields, sample(1, work%samples%before(e) + 1))
        else if (kind%degree == 1) then
          call find_means(work, e, fields, sample(1, work%samples%before(e) + 1))
        else
          call find_strains(work, e, size(work%now%u, 2), strain)
          call work%samples%take(kind, e, width, strain, sample)
        end if
      end associate
    end do
  end subroutine sample_elements

  !> Find the errors of some elements. The strains are computed again; if they were stored for all points,
  !! they would be the largest array.
  subroutine compare_elements(work, field, element, width, sample, smooth, sums)
    type(comparison), intent(in) :: work
    type(error_fields), intent(inout) :: field      !! errors are added
    integer, intent(in) :: element(:)            !! numbers of the elements
    integer, intent(in) :: width                 !! components of all fields
    real(wp), intent(in) :: sample(width, *), smooth(width, *)   !! of the body
    type(field_sums), intent(inout) :: sums      !! sums, to which their errors are added
    type(element_errors) :: errors
    real(wp) :: strain(width, most_points)
    integer :: i

    errors = new_element_errors(size(work%now%u, 2))
    do i = 1, size(element)
      associate (e => element(i), &
                 kind => work%scene%model%mesh%kinds(work%scene%model%mesh%kind(element(i))), &
                 first => work%scene%model%mesh%first_point(element(i)))
        if (kind%points == 1) then
          strain(:, 1) = sample(:, work%samples%before(e) + 1)
        else
          call find_strains(work, e, size(work%now%u, 2), strain)
        end if
        call errors%compare(kind, work%linear%operator%volume(first), strain, places_of(work, e), smooth)
        call errors%find_stress(kind, work%linear%materials, first, work%answer%point)
        field%element(e) = errors%energy(0)
        if (size(work%now%u, 2) > 0) call sums%add(errors, &
            work%linear%materials%section(work%scene%model%mesh%section(e)))
      end associate
    end do
  end subroutine compare_elements

  !> Find the positions of the nodes of an element in the list of recovery points of its body.
  pure function places_of(work, e) result(own)
    type(comparison), intent(in) :: work
    integer, intent(in) :: e
    integer :: own(most_nodes), k

    do k = 1, work%scene%model%mesh%node_count(e)
      own(k) = work%table%own(work%table%place(k, e))
    end do
  end function places_of

  !> Find the strains of an element at its integration points: those of the answer, then those of the fields.
  subroutine find_strains(work, e, fields, strain)
    type(comparison), intent(in) :: work
    integer, intent(in) :: e, fields
    real(wp), intent(inout) :: strain(components*(1 + size(work%now%u, 2)), *)   !! at its points
    integer :: p

    do p = work%scene%model%mesh%first_point(e), work%scene%model%mesh%first_point(e + 1) - 1
      strain(:components, p - work%scene%model%mesh%first_point(e) + 1) = work%answer%strain(:, p)
    end do
    call work%linear%operator%add_fields(work%scene%model, e, places_of(work, e), fields, work%now%u, strain)
  end subroutine find_strains

  !> Find the mean strains of an element that has one sampling point.
  subroutine find_means(work, e, fields, strain)
    type(comparison), intent(in) :: work
    integer, intent(in) :: e, fields
    real(wp), intent(inout) :: strain(components*(1 + size(work%now%u, 2)))
    integer :: p

    strain(:components) = 0.0_wp
    associate (first => work%scene%model%mesh%first_point(e), &
               last => work%scene%model%mesh%first_point(e + 1) - 1, &
               volume => work%linear%operator%volume)
      do p = first, last
        strain(:components) = strain(:components) + volume(p)/sum(volume(first:last))*work%answer%strain(:, p)
      end do
    end associate
    call work%linear%operator%add_means(work%scene%model, e, places_of(work, e), fields, work%now%u, strain)
  end subroutine find_means

  !> Move the known fields to another object.
  subroutine hand_over(self, to)
    class(body_fields), intent(inout) :: self
    type(body_fields), intent(inout) :: to

    to%batch = self%batch
    call move_alloc(self%u, to%u)
    call move_alloc(self%sample, to%sample)
    call move_alloc(self%smooth, to%smooth)
    call move_alloc(self%energy, to%energy)
  end subroutine hand_over
end module epcont_accuracy_error_fields
