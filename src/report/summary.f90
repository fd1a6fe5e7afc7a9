!> The figures of a run. Each is said once: its key and unit in the file of the summary, its name and digits
!> in the listing. The file has all of them in this order, the listing those that have a name, each in its
!> section.
module epcont_report_summary
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, text_of
  use epcont_base_tolerances, only: valid_to
  use epcont_certificate_scene, only: little, overlap_place
  use epcont_element_kinematics, only: directions
  use epcont_report_columns, only: estimate, factor, force, full_number, known, length, listed_number, &
      number, part, rounding, size_of, stress
  use epcont_model_arrays, only: angle
  use epcont_model_springs, only: spring_stretch
  use epcont_messages_names, only: direction_of, motion_name, percent, point_name, when
  use epcont_messages_outcome, only: limit_of_pressure, reason_of, unbounded
  use epcont_report_run, only: run_results
  use epcont_result_stresses, only: first_largest, place_of_point
  implicit none
  private
  public :: figure_type, summarise

  character(len=*), parameter :: none = '', radian = 'radian'

  integer, parameter :: room_at_first = 64   !! figures

  type :: figure_type
    character(len=40) :: key = ''      !! in the file
    character(len=26) :: value = ''
    character(len=13) :: unit = ''
    character(len=44) :: name = ''     !! in the listing; empty: it is not there
    character(len=52) :: listed = ''   !! its value there
    character(len=80) :: note = ''     !! what follows that
  end type figure_type

contains

  !> All that is known of a run.
  function summarise(run) result(figures)
    type(run_results), intent(in) :: run   !! what is known of the run
    type(figure_type), allocatable :: figures(:)
    integer :: k, last

    allocate (figures(room_at_first))
    last = 0
    call put_word('status', run%outcome%word, 'status')
    call put_word('warnings', text_of(run%faults%warnings + run%outcome%found%warnings), '')
    call put_word('notes', text_of(run%faults%notes + run%outcome%found%notes), '')
    if (run%outcome%has_answer) then
      call put_answer()
      call put_certificate()
      call put_iteration()
      call put_mesh_errors()
      call put_sensitivity()
    end if
    figures = figures(:last)

  contains

    !> Contact, yielding and stresses.
    subroutine put_answer()
      character(len=:), allocatable :: id
      real(wp) :: farthest

      farthest = maxval(abs(run%answer%displacement))
      if (run%model%pairs > 0) call put('max_pressure', stress, known, run%answer%largest_pressure(), &
          'largest pressure', reason_of(limit_of_pressure(run)))
      do k = 1, run%motions%count
        call put('approach_'//motion_key(), motion_unit(), number, run%answer%contact%approach(k), &
                 'approach: '//motion_name(run, k), &
                 when(run%answer%contact%motion_free(k), newline// &
                      '    nothing resists or drives this motion: its value is a choice'), &
                 listed_number(number, run%answer%contact%approach(k), &
                               merge(0.0_wp, farthest, run%motions%component(k) == angle)))
      end do
      call put_platens()
      do k = 1, size(run%model%spring)
        id = text_of(run%model%spring(k)%id)
        call put('spring_'//id, force, number, run%model%spring(k)%stiffness* &
                 spring_stretch(run%model, k, run%answer%displacement), 'pull of spring '//id)
      end do
      call put('total_contact_force', force, number, sum(run%answer%contact%force), &
               when(run%model%pairs > 0, 'total contact force'))
      call put_word('pairs_in_contact', text_of(count(run%answer%contact%touching)), &
                    when(run%model%pairs > 0, 'pairs in contact'))
      call put_word('plastic_elements', text_of(count(run%answer%plastic)), &
                    when(any(run%answer%plastic), 'elements beyond the yield point'))
      call put_word('iterations', text_of(size(run%answer%history)), '')
      call put_word('factorizations', text_of(run%answer%factorizations), '')
      call put_word('pivots', text_of(sum(run%answer%history%pivots)), '')
      call put_largest_stress(first_largest(run%answer%largest_stress))
      call put('max_displacement', length, number, maxval(norm2(run%answer%displacement, dim=1)), &
               'largest displacement')
      if (allocated(run%model%free_strain)) call put_temperatures()
    end subroutine put_answer

    !> How far from those without strain they are, in elements that expand.
    subroutine put_temperatures()
      real(wp) :: lowest, highest
      integer :: e

      lowest = huge(lowest)
      highest = -huge(highest)
      associate (model => run%model)
        do e = 1, model%elements
          associate (node => model%connectivity(:model%node_count(e), e), s => model%section(e))
            if (model%expansion(s) == 0.0_wp) cycle
            lowest = min(lowest, minval(model%temperature(node)) - model%reference_temperature(s))
            highest = max(highest, maxval(model%temperature(node)) - model%reference_temperature(s))
          end associate
        end do
      end associate
      call put('lowest_temperature', 'temperature', number, lowest, 'lowest temperature, above TREF')
      call put('highest_temperature', 'temperature', number, highest, 'highest temperature, above TREF')
    end subroutine put_temperatures

    !> How far the leaders of RBE2 have turned, and with which moments supports hold them.
    subroutine put_platens()
      character(len=:), allocatable :: id

      do k = 1, size(run%model%platen)
        id = text_of(run%model%node_id(run%model%platen(k)%leader))
        call put('angle_'//id, radian, number, run%answer%angle(k), 'turn of GRID '//id//' [radian]')
        if (run%model%platen(k)%held) call put('moment_'//id, 'force*length', number, run%answer%moment(k), &
                                               'moment of the support of GRID '//id)
      end do
    end subroutine put_platens

    !> Of the element that has it.
    subroutine put_largest_stress(element)
      integer, intent(in) :: element
      character(len=:), allocatable :: id
      real(wp) :: place(directions)

      id = text_of(run%model%element_id(element))
      place = place_of_point(run%model, run%answer%largest_at(element))
      call put('max_equivalent_stress', stress, number, run%answer%largest_stress(element), &
               'largest equivalent stress', '   in element '//id//' at '//point_name(place))
      call put_word('max_equivalent_stress_element', id, '')
      call put('max_equivalent_stress_x', length, number, place(1))
      call put('max_equivalent_stress_y', length, number, place(2))
    end subroutine put_largest_stress

    !> What the certificate has found; forces and gaps in the listing as parts of the largest.
    subroutine put_certificate()
      associate (c => run%certificate)
        call put('equilibrium_residual', none, rounding, c%equilibrium, 'equilibrium residual')
        call put('smallest_force', force, number, c%smallest_force, 'most negative force, of the largest', &
                 listed=listed_number(rounding, max(0.0_wp, -c%smallest_force)/c%force_scale, 0.0_wp))
        call put('smallest_gap', length, number, c%smallest_gap, 'most negative gap, of the largest length', &
                 listed=listed_number(rounding, c%overlap/c%length_scale, 0.0_wp))
        call put('largest_force_gap_product', 'force*length', number, c%force_gap, &
                 'largest force times gap', &
                 listed=listed_number(rounding, c%force_gap/c%force_scale/c%length_scale, 0.0_wp))
        call put('stress_off_curve', none, rounding, c%off_curve, 'stress off the curve')
        call put('curve_tolerance', none, size_of, c%curve_tolerance, &
                 when(c%curve_tolerance > valid_to, 'of which the iteration may leave'))
        call put('stress_off_curve_limit', none, size_of, c%off_curve_limit, &
                 when(c%off_curve > c%curve_tolerance .and. c%off_curve <= c%off_curve_limit, &
                      'and with the rounding of displacements'))
        call put('energy_balance', none, rounding, c%energy, 'energy balance')
        if (.not. c%scene%looked_through) return
        call put_places('penetration', c%scene%deepest, c%scene%inside)
        call put_places('pressed_gap', c%scene%widest, c%scene%apart)
      end associate
    end subroutine put_certificate

    !> The largest depth, the one that is worst by what is allowed, and that; 0 where it is so little that
    !! rounding chooses the place.
    subroutine put_places(name, largest, worst)
      character(len=*), intent(in) :: name
      type(overlap_place), intent(in) :: largest, worst

      call put('largest_'//name, length, number, merge(largest%depth, 0.0_wp, largest%ratio >= little))
      call put('worst_'//name, length, number, merge(worst%depth, 0.0_wp, worst%ratio >= little))
      call put('allowed_worst_'//name, length, number, merge(worst%allowed, 0.0_wp, worst%ratio >= little))
    end subroutine put_places

    !> How exactly the equations were solved.
    subroutine put_iteration()
      integer :: last   ! solve for the loads that the answer is for

      last = findloc(run%answer%history%load_factor, run%answer%load_factor, dim=1, back=.true.)
      call put('condition', none, size_of, run%answer%condition, 'condition of the stiffness (1-norm)')
      call put('load_factor', none, number, run%answer%load_factor)
      call put('iteration_error_displacement', none, rounding, run%answer%history(last)%error, &
               when(size(run%answer%history) > 1, 'iteration error, of the largest displacement'))
      call put('iteration_error_force', none, rounding, run%answer%history(last)%force_error, &
               when(size(run%answer%history) > 1 .and. run%model%pairs > 0, &
                    'iteration error, of the largest force'))
      if (run%model%controls%paper_ratio .and. run%iteration%yields) &
        call put('stress_below_curve', none, part, run%answer%shortfall)
    end subroutine put_iteration

    !> What the mesh makes of the figures; `max_pressure_is` unbounded, or not resolved.
    subroutine put_mesh_errors()
      call put('mesh_error_energy_norm', none, part, run%accuracy%energy_norm, &
               'mesh: error in the energy norm')
      if (run%model%pairs > 0) then
        call put_word('max_pressure_is', limit_of_pressure(run), '')
        call put('mesh_error_max_pressure', stress, known, run%accuracy%max_pressure)
      end if
      do k = 1, size(run%accuracy%zone)
        call put_error('pressure_zone_'//text_of(k), stress, 'largest pressure of zone '//text_of(k), &
                       run%accuracy%zone(k)%pressure, run%answer%zones(k)%max_pressure, &
                       limit_of_pressure(run, k))
        call put_error('half_width_zone_'//text_of(k), length, 'half-width of zone '//text_of(k), &
                       run%accuracy%zone(k)%half_width, run%answer%zones(k)%half_width, '')
      end do
      do k = 1, run%motions%count
        call put_error('approach_'//motion_key(), motion_unit(), 'approach of '//motion_name(run, k), &
                       merge(-1.0_wp, run%accuracy%approach(k), run%accuracy%approach_unbounded(k)), &
                       abs(run%answer%contact%approach(k)), &
                       when(run%accuracy%approach_unbounded(k), unbounded))
      end do
      if (run%model%pairs > 0) call put_error('total_contact_force', force, 'total contact force', &
          run%accuracy%total_force, sum(run%answer%contact%force), '')
    end subroutine put_mesh_errors

    !> What rounding and errors of the stiffness make of the contact forces.
    subroutine put_sensitivity()
      if (.not. run%accuracy%sensitivity%known) return
      call put('contact_amplification', none, factor, run%accuracy%sensitivity%amplification, &
               'contact forces amplify stiffness errors', '   times at most')
      call put('rounding_error_force', none, known, run%accuracy%sensitivity%rounding)
      call put_word('weak_pairs', text_of(count(run%accuracy%weak)), '')
    end subroutine put_sensitivity

    !> Of free motion k.
    function motion_unit() result(unit)
      character(len=:), allocatable :: unit

      unit = length
      if (run%motions%component(k) == angle) unit = radian
    end function motion_unit

    !> Of free motion k in the keys of figures: `12_2`.
    function motion_key() result(key)
      character(len=:), allocatable :: key

      key = text_of(run%model%node_id(run%motions%node(k)))//'_'//direction_of(run%motions, k)
    end function motion_key

    !> Add a number; it has that many digits in the listing, or stands there as `listed`.
    subroutine put(key, unit, kind, value, name, note, listed)
      character(len=*), intent(in) :: key, unit
      integer, intent(in) :: kind
      real(wp), intent(in) :: value
      character(len=*), intent(in), optional :: name, note, listed   !! in the listing
      type(figure_type) :: figure

      figure = figure_type(key, full_number(kind, value), unit)
      if (present(name)) figure%name = name
      figure%listed = listed_number(kind, value, 0.0_wp)
      if (present(listed)) figure%listed = listed
      if (present(note)) figure%note = note
      call append(figure)
    end subroutine put

    !> Add a word.
    subroutine put_word(key, word, name)
      character(len=*), intent(in) :: key, word
      character(len=*), intent(in) :: name   !! in the listing; empty: it is not there

      call append(figure_type(key, word, '', name, word))
    end subroutine put_word

    !> Room doubles, since many bodies have many figures.
    subroutine append(figure)
      type(figure_type), intent(in) :: figure
      type(figure_type), allocatable :: more(:)

      if (last == size(figures)) then
        allocate (more(2*last))
        more(:last) = figures
        call move_alloc(more, figures)
      end if
      last = last + 1
      figures(last) = figure
    end subroutine append

    !> Add an error of the mesh; the listing has it where it is known, or why it is not.
    subroutine put_error(key, unit, name, error, value, limit)
      character(len=*), intent(in) :: key, unit, name   !! key and name are those of the figure
      real(wp), intent(in) :: error, value
      character(len=*), intent(in) :: limit             !! of the figure: `bounded`, `unbounded` ...
      character(len=:), allocatable :: reason

      reason = reason_of(limit)
      call put('mesh_error_'//key, unit, known, error, &
               when(reason /= '' .or. error >= 0.0_wp, 'mesh: '//name), &
               when(reason == '', '   '//percent(error, value)), &
               when(reason == '', listed_number(estimate, error, value), reason))
    end subroutine put_error
  end function summarise
end module epcont_report_summary
