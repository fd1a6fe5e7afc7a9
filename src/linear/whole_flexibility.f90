!> F of all bodies, from that of each body.
module epcont_linear_whole_flexibility
  use epcont_assembly_stiffness, only: body_stiffness
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_flexibility_flexibility, only: body_flexibility, find_flexibility
  use epcont_plan_planned_model, only: planned_model
  use epcont_plan_side_by_side, only: threads_for
  use epcont_system_threads, only: use_one_thread_each
  implicit none
  private
  public :: add_flexibilities, add_part, complete_flexibility

contains

  !> Add the contributions of some bodies to the flexibility, each computed separately, in their order, so
  !! that rounding is the same for any number of threads.
  subroutine add_flexibilities(scene, body, chosen, threads, flexibility)
    type(planned_model), intent(in) :: scene          !! the model
    type(body_stiffness), intent(in) :: body(:)       !! factored
    logical, intent(in) :: chosen(:)                  !! [bodies]
    integer, intent(in) :: threads                    !! number of threads
    real(wp), intent(inout) :: flexibility(:, :)      !! its lower triangle is updated [pairs, pairs]
    type(body_flexibility) :: own
    type(incidence) :: pair   ! pairs of each body
    integer :: b, many

    associate (model => scene%model, numbering => scene%numbering)
      pair = new_incidence(model%bodies_of_rows(), model%mesh%bodies)
      many = threads_for(merge(numbering%body%operations, 0.0_wp, chosen), &
                         spread(.false., 1, size(chosen)), threads)
      !$omp parallel do num_threads(many) if (many > 1) schedule(dynamic) ordered private(own)
      do b = 1, model%mesh%bodies
        call use_one_thread_each()
        if (chosen(b)) call find_flexibility(model, numbering, b, pair%of(b), body(b), own)
        !$omp ordered
        if (chosen(b)) call add_part(own, flexibility)
        !$omp end ordered
      end do
      !$omp end parallel do
    end associate
  end subroutine add_flexibilities

  !> Add the contribution of one body, whose pairs ascend.
  pure subroutine add_part(own, flexibility)
    type(body_flexibility), intent(in) :: own
    real(wp), intent(inout) :: flexibility(:, :)   !! [pairs, pairs]
    integer :: k

    do k = 1, size(own%pair)
      associate (column => flexibility(:, own%pair(k)))
        column(own%pair(k:)) = column(own%pair(k:)) + own%matrix(k:, k)
      end associate
    end do
  end subroutine add_part

  !> Copy the lower triangle to the upper one, after all parts have been added.
  pure subroutine complete_flexibility(f)
    real(wp), intent(inout) :: f(:, :)   !! [pairs, pairs]
    integer :: k

    do k = 1, size(f, 1)
      f(k, k + 1:) = f(k + 1:, k)
    end do
  end subroutine complete_flexibility
end module epcont_linear_whole_flexibility
