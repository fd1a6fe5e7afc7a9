!> The listing of what the figures are worth. Estimates have two digits; what is rounding is a power of ten it is below.
module epcont_report_accuracy_text
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_accuracy_zone_error, only: zone_error
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_certificate_certificate, only: certificate_type
  use epcont_model_controls, only: precision_single
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_report_file, only: text_file
  use epcont_report_iterations, only: list_iteration_error
  use epcont_report_layout, only: figure, heading, right
  use epcont_report_limit, only: not_resolved, reason_of, unbounded
  use epcont_report_number, only: column_number, estimate_number, rounding_number
  use epcont_report_precision, only: list_precision
  use epcont_report_wanted, only: list_wanted
  use epcont_result_answer, only: answer_type
  use epcont_result_displacement_gradient, only: gradient_type
  use epcont_result_locking, only: high_poisson, locking_type
  implicit none
  private
  public :: list_accuracy

  !> Pairs that are named.
  integer, parameter :: most_pairs = 8

contains

  !> What the figures are worth.
  subroutine list_accuracy(file, model, motions, answer, certificate, accuracy)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(certificate_type), intent(in) :: certificate
    type(accuracy_type), intent(in) :: accuracy

    call heading(file, 'ACCURACY')
    if (size(answer%history) > 1) call list_iteration_error(file, model, answer)
    call figure(file, 'condition of the stiffness (1-norm)', right(short_real(answer%condition), 13))
    call list_precision(file, answer)
    if (answer%precision /= precision_single) call figure(file, 'digits that rounding leaves, at least', &
                right(text_of(max(0, floor(-log10(answer%rounding())))), 13))
    call figure(file, 'linear residual', right(rounding_number(certificate%equilibrium), 13))
    if (accuracy%sensitivity%known) then
      associate (found => accuracy%sensitivity)
        if (answer%precision /= precision_single) &
          call figure(file, 'rounding in the contact forces, at most', right(rounding_number(found%rounding), 13)// &
                      '   of the largest')
        call figure(file, 'they magnify errors of the stiffness', right(amplification(found%amplification), 13)// &
                    '   times at most')
      end associate
    end if
    call list_discretisation(file, model, motions, answer, accuracy)
    if (any(accuracy%weak)) call list_weak(file, model, answer, accuracy%weak)
    if (answer%locking%elements > 0) call list_locking(file, answer%locking, any(answer%plastic))
    if (answer%gradient%part > 0.0_wp) call list_gradient(file, model, answer%gradient)
    if (model%controls%accuracy > 0.0_wp) call list_wanted(file, model, answer, accuracy)
  end subroutine list_accuracy

  !> Beyond so much rounding has a say in the figure itself.
  pure function amplification(value) result(text)
    real(wp), intent(in) :: value
    character(len=:), allocatable :: text
    real(wp), parameter :: beyond = 1.0e6_wp

    text = estimate_number(value)
    if (value > beyond) text = '> '//estimate_number(beyond)
  end function amplification

  !> The mesh: its error as a whole, and that of each figure that matters.
  subroutine list_discretisation(file, model, motions, answer, accuracy)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(in) :: accuracy
    integer :: k, z

    call figure(file, 'mesh: error in the energy norm', right(percent(accuracy%energy_norm, 1.0_wp), 15))
    do z = 1, size(accuracy%zone)
      call list_zone(file, z, accuracy%zone(z), answer%zones(z)%max_pressure, answer%zones(z)%half_width)
    end do
    do k = 1, motions%count
      call list_estimate(file, 'mesh: approach of GRID '//text_of(model%node_id(motions%node(k)))//' direction '// &
                         text_of(motions%component(k)), accuracy%approach(k), abs(answer%contact%approach(k)), &
                         accuracy%approach_unbounded(k))
    end do
    call list_estimate(file, 'mesh: total contact force', accuracy%total_force, sum(answer%contact%force), .false.)
    call list_worst(file, model, accuracy)
  end subroutine list_discretisation

  subroutine list_zone(file, z, zone, pressure, half_width)
    type(text_file), intent(in) :: file
    integer, intent(in) :: z
    type(zone_error), intent(in) :: zone
    real(wp), intent(in) :: pressure, half_width

    if (zone%resolved) then
      call list_estimate(file, 'mesh: largest pressure of zone '//text_of(z), zone%pressure, pressure, zone%unbounded)
    else
      call figure(file, 'mesh: largest pressure of zone '//text_of(z), reason_of(not_resolved))
    end if
    call list_estimate(file, 'mesh: half-width of zone '//text_of(z), zone%half_width, half_width, .false.)
  end subroutine list_zone

  !> An error that is known, or why it is not.
  subroutine list_estimate(file, name, error, value, without_end)
    type(text_file), intent(in) :: file
    character(len=*), intent(in) :: name
    real(wp), intent(in) :: error, value
    logical, intent(in) :: without_end   !! the figure is unbounded
    real(wp), parameter :: none = 1.0e-9_wp   ! of the figure: rounding
    character(len=:), allocatable :: text

    text = '0.0'
    if (without_end) then
      call figure(file, name, reason_of(unbounded))
    else if (error >= 0.0_wp) then
      if (error > none*value) text = estimate_number(error)
      call figure(file, name, right(text, 13)//'   '//percent(error, value))
    end if
  end subroutine list_estimate

  !> A part in per cent, two digits of it.
  pure function percent(error, value) result(text)
    real(wp), intent(in) :: error, value
    character(len=:), allocatable :: text
    character(len=12) :: buffer
    real(wp) :: hundredths

    text = ''
    if (value <= 0.0_wp .or. error >= 100.0_wp*value) return
    hundredths = 100.0_wp*error/value
    if (hundredths < 0.00095_wp) then
      buffer = '< 0.001'
    else if (hundredths < 0.095_wp) then
      write (buffer, '(f12.'//text_of(1 - floor(log10(1.05_wp*hundredths)))//')') hundredths
    else
      write (buffer, '(f12.'//text_of(max(0, 1 - floor(log10(1.05_wp*hundredths))))//')') hundredths
    end if
    text = trim(adjustl(buffer))
    if (text(len(text):) == '.') text = text(:len(text) - 1)
    text = text//' %'
  end function percent

  !> The elements that would gain most by being smaller.
  subroutine list_worst(file, model, accuracy)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(accuracy_type), intent(in) :: accuracy
    character(len=:), allocatable :: text
    integer :: k

    if (size(accuracy%worst) == 0) return
    text = ''
    do k = 1, size(accuracy%worst)
      text = text//' '//text_of(model%element_id(accuracy%worst(k)))
    end do
    associate (e => accuracy%worst(1))
      associate (centre => sum(model%coordinates(e), dim=2)/model%order(e))
        call file%line('  refine first: element'//text//', the first at '//short_real(centre(1))//' '//short_real(centre(2))// &
                       '; '//percent(sum(accuracy%element(accuracy%worst)), sum(accuracy%element))//' of the error')
      end associate
    end associate
  end subroutine list_worst

  !> Pairs that may as well be open, or touch.
  subroutine list_weak(file, model, answer, weak)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    logical, intent(in) :: weak(:)

    call list_some('pressed by less than the error of the force', weak .and. answer%contact%touching)
    call list_some('open by less than the error of the gap', weak .and. .not. answer%contact%touching)

  contains

    subroutine list_some(what, chosen)
      character(len=*), intent(in) :: what
      logical, intent(in) :: chosen(:)
      character(len=:), allocatable :: text
      integer :: k, named

      if (.not. any(chosen)) return
      text = ''
      named = 0
      do k = 1, size(chosen)
        if (.not. chosen(k)) cycle
        named = named + 1
        if (named <= most_pairs) text = text//' '//text_of(model%pair_id(k))
      end do
      if (named > most_pairs) text = text//' and '//text_of(named - most_pairs)//' more'
      call file%line('  '//what//', '//plural(named, 'pair')//':'//text)
    end subroutine list_some
  end subroutine list_weak

  !> Elements that are too stiff for what their material does.
  subroutine list_locking(file, locking, yielded)
    type(text_file), intent(in) :: file
    type(locking_type), intent(in) :: locking
    logical, intent(in) :: yielded   !! something has

    call figure(file, 'three-node elements of constant volume', right(text_of(locking%elements), 13))
    call figure(file, 'scatter of their mean stress / equivalent', column_number(locking%scatter, 1.0_wp))
    call file%line('    (Poisson''s ratio '//short_real(high_poisson)// &
                   ' or more'//trim(merge(', as yielding has made it', repeat(' ', 25), yielded))// &
                   ': they are too stiff there; six-node elements and CQUAD4 are not)')
  end subroutine list_locking

  !> Displacements that are not small.
  subroutine list_gradient(file, model, gradient)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(gradient_type), intent(in) :: gradient

    call figure(file, 'not small: turned, stretched by over 0.1', right(percent(gradient%part, 1.0_wp), 15)//'   of the volume')
    associate (centre => sum(model%coordinates(gradient%worst), dim=2)/model%order(gradient%worst))
      call file%line('    (most at '//short_real(centre(1))//' '//short_real(centre(2))//', '// &
                     trim(adjustl(estimate_number(gradient%largest)))// &
                     '; equilibrium and contact are those of the undeformed shape: loads, moduli, units?)')
    end associate
  end subroutine list_gradient
end module epcont_report_accuracy_text
