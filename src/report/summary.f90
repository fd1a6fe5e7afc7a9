!> The values of a run. Each is defined once: its key and unit in the file of the summary, its name and digits
!> in the listing. The file has all of them in this order; the listing has those with a name, each in its
!> section.
module epcont_report_summary
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, text_of
  use epcont_base_tolerances, only: rounded_off, valid_to
  use epcont_certificate_scene, only: little, overlap_place
  use epcont_element_kinematics, only: directions
  use epcont_report_columns, only: energy, factor, force, known, length, listed_number, number, part, &
      rounding, size_of, stress
  use epcont_model_arrays, only: angle
  use epcont_model_springs, only: spring_stretch
  use epcont_messages_names, only: direction_of, motion_name, point_name, when
  use epcont_messages_outcome, only: limit_of_pressure, reason_of, unbounded
  use epcont_report_figure_list, only: figure_list, figure_type
  use epcont_report_run, only: run_results
  use epcont_result_answer, only: pair_slips, pair_sticks
  use epcont_result_stresses, only: first_largest, place_of_point
  implicit none
  private
  public :: figure_type, summarise

  character(len=*), parameter :: none = '', radian = 'radian'

contains

  !> Collect all values of a run.
  function summarise(run) result(figures)
    type(run_results), intent(in) :: run   !! run and its results
    type(figure_type), allocatable :: figures(:)
    type(figure_list) :: list

    call list%put_word('status', run%outcome%word, 'status')
    call list%put_word('warnings', text_of(run%faults%warnings + run%outcome%found%warnings), '')
    call list%put_word('notes', text_of(run%faults%notes + run%outcome%found%notes), '')
    if (run%outcome%has_answer) then
      call put_answer(run, list)
      call put_certificate(run, list)
      call put_iteration(run, list)
      call put_mesh_errors(run, list)
      call put_increment_errors(run, list)
      call put_sensitivity(run, list)
    end if
    figures = list%figure(:list%count)
  end function summarise

  !> Add contact, yielding and stresses.
  subroutine put_answer(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    integer :: k
    character(len=:), allocatable :: id
    real(wp) :: farthest

    farthest = maxval(abs(run%answer%displacement))
    if (run%model%contact%pairs > 0) call figures%put('max_pressure', stress, known, &
                                                      run%answer%largest_pressure(), &
        'largest pressure', reason_of(limit_of_pressure(run)))
    do k = 1, run%motions%count
      call figures%put('approach_'//motion_key(run, k), motion_unit(run, k), number, &
                       run%answer%contact%approach(k), 'approach: '//motion_name(run, k), &
                       when(run%answer%contact%motion_free(k), newline// &
                            '    undetermined rigid-body mode: the smallest value that the gaps allow'))
      call figures%list_as(listed_number(number, run%answer%contact%approach(k), &
                                         merge(0.0_wp, farthest, run%motions%component(k) == angle)))
    end do
    call put_platens(run, figures)
    do k = 1, size(run%model%constraints%spring)
      id = text_of(run%model%constraints%spring(k)%id)
      call figures%put('spring_'//id, force, number, run%model%constraints%spring(k)%stiffness* &
                       spring_stretch(run%model, k, run%answer%displacement), 'force of spring '//id)
    end do
    call figures%put('total_contact_force', force, number, sum(run%answer%contact%force), &
                     when(run%model%contact%pairs > 0, 'total contact force'))
    call figures%put_word('pairs_in_contact', text_of(count(run%answer%contact%touching)), &
                          when(run%model%contact%pairs > 0, 'pairs in contact'))
    if (run%model%contact%has_friction()) call put_friction(run, figures)
    call figures%put_word('plastic_elements', text_of(count(run%answer%plastic)), &
                          when(any(run%answer%plastic), 'yielded elements'))
    if (allocated(run%stress_path)) then
      call figures%put_word('falling_elements', text_of(run%stress_path%falling), '')
      call figures%put('mean_turn', 'degree', number, run%stress_path%mean_turn)
      call figures%put('largest_turn', 'degree', number, run%stress_path%turn)
    end if
    call figures%put_word('iterations', text_of(size(run%answer%history)), '')
    call figures%put_word('factorizations', text_of(run%answer%factorizations), '')
    call figures%put_word('pivots', text_of(sum(run%answer%history%pivots)), '')
    call put_largest_stress(run, figures, first_largest(run%answer%largest_stress))
    if (allocated(run%answer%plastic_strain)) call put_plastic_strain(run, figures)
    call figures%put('max_displacement', length, number, maxval(norm2(run%answer%displacement, dim=1)), &
                     'largest displacement')
    if (allocated(run%model%loads%free_strain)) call put_temperatures(run, figures)
  end subroutine put_answer

  !> Add friction forces, and how many pairs stick and slip.
  subroutine put_friction(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    real(wp) :: most(size(run%model%contact%sliding))   ! largest possible friction [force]

    associate (contact => run%answer%contact, pair => run%model%contact%sliding, &
               state => run%answer%friction_states(run%model%contact%sliding))
      most = run%model%contact%friction(pair)*contact%force(pair)
      call figures%put('total_friction_force', force, number, sum(abs(contact%friction_force)), &
                       'total friction force')
      call figures%list_as(listed_number(number, sum(abs(contact%friction_force)), sum(most)))
      call figures%put('max_shear', stress, known, maxval(abs(run%answer%shear(pair))), &
                       'largest shear traction')
      call figures%list_as(listed_number(known, maxval(abs(run%answer%shear(pair))), &
                                         maxval(run%answer%pressure(pair)*run%model%contact%friction(pair))))
      call figures%put_word('pairs_sticking', text_of(count(state == pair_sticks)), 'pairs that stick')
      call figures%put_word('pairs_slipping', text_of(count(state == pair_slips)), 'pairs that slip')
      call figures%put('max_slip', length, number, maxval(abs(contact%slip), mask=contact%touching(pair)), &
                       'largest slip in this increment')
      call figures%list_as(listed_number(number, maxval(abs(contact%slip), mask=contact%touching(pair)), &
                                         maxval(abs(run%answer%displacement))))
      if (size(run%answer%stick_zones) > 0) call figures%put('stick_half_width', length, known, &
        maxval(run%answer%stick_zones%half_width), 'largest half-width that sticks')
    end associate
  end subroutine put_friction

  !> Add the lowest and highest temperatures, relative to TREF, of elements with thermal expansion.
  subroutine put_temperatures(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    real(wp) :: lowest, highest
    integer :: e

    lowest = huge(lowest)
    highest = -huge(highest)
    associate (model => run%model)
      do e = 1, model%mesh%elements
        if (model%sections%expansion(model%mesh%section(e)) == 0.0_wp) cycle
        lowest = min(lowest, minval(model%loads%rise(:model%mesh%node_count(e), e)))
        highest = max(highest, maxval(model%loads%rise(:model%mesh%node_count(e), e)))
      end do
    end associate
    call figures%put('lowest_temperature', 'temperature', number, lowest, 'lowest temperature, above TREF')
    call figures%put('highest_temperature', 'temperature', number, highest, 'highest temperature, above TREF')
  end subroutine put_temperatures

  !> Add the rotations of RBE2 master nodes, and the moments of their supports.
  subroutine put_platens(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    integer :: k
    character(len=:), allocatable :: id

    do k = 1, size(run%model%constraints%platen)
      id = text_of(run%model%mesh%node_id(run%model%constraints%platen(k)%leader))
      call figures%put('angle_'//id, radian, number, run%answer%angle(k), &
                       'rotation of GRID '//id//' [radian]')
      if (run%model%constraints%platen(k)%held) call figures%put('moment_'//id, energy, number, &
                                                     run%answer%moment(k), &
                                             'moment of the support of GRID '//id)
    end do
  end subroutine put_platens

  !> Add the largest equivalent stress, and its element.
  subroutine put_largest_stress(run, figures, element)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    integer, intent(in) :: element
    character(len=:), allocatable :: id
    real(wp) :: place(directions)

    id = text_of(run%model%mesh%element_id(element))
    place = place_of_point(run%model, run%answer%largest_at(element))
    call figures%put('max_equivalent_stress', stress, number, run%answer%largest_stress(element), &
                     'largest equivalent stress', '   in element '//id//' at '//point_name(place))
    call figures%put_word('max_equivalent_stress_element', id, '')
    call figures%put('max_equivalent_stress_x', length, number, place(1))
    call figures%put('max_equivalent_stress_y', length, number, place(2))
  end subroutine put_largest_stress

  !> Add the largest accumulated plastic strain of flow theory, and its element.
  subroutine put_plastic_strain(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures

    associate (strain => run%answer%plastic_strain(5, :), id => run%model%mesh%element_id)
      call figures%put('max_plastic_strain', none, number, maxval(strain), &
                       when(any(strain > 0.0_wp), 'largest accumulated plastic strain'), &
                       '   in element '//text_of(id(first_largest(strain)))//' (mean)')
    end associate
  end subroutine put_plastic_strain

  !> Add the values of the certificate; in the listing, forces and gaps are relative to the largest.
  subroutine put_certificate(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures

    associate (c => run%certificate)
      call figures%put('equilibrium_residual', none, rounding, c%equilibrium, 'equilibrium residual')
      call figures%put_relative('smallest_force', force, c%smallest_force, 'largest pull / largest force', &
                                max(0.0_wp, -c%smallest_force)/c%force_scale)
      call figures%put_relative('smallest_gap', length, c%smallest_gap, &
                                'largest overlap of a pair / largest length', c%overlap/c%length_scale)
      call figures%put_relative('largest_force_gap_product', energy, c%force_gap, &
                                'largest force times gap', c%force_gap/c%force_scale/c%length_scale)
      if (run%model%contact%has_friction()) then
        call figures%put_relative('friction_above_limit', force, c%excess, &
                                  'friction above mu R / largest force', c%excess/c%force_scale)
        call figures%put_relative('largest_force_slip_product', energy, c%force_slip, &
                                  'largest missing friction times slip', &
                                  c%force_slip/c%force_scale/c%length_scale)
      end if
      call figures%put('stress_off_curve', none, rounding, c%off_curve, 'stress error')
      call figures%put('curve_tolerance', none, size_of, c%curve_tolerance, &
                       when(c%curve_tolerance > valid_to, '  tolerance, from the iteration'))
      call figures%put('stress_off_curve_limit', none, size_of, c%off_curve_limit, &
                       when(c%off_curve > c%curve_tolerance .and. c%off_curve <= c%off_curve_limit, &
                            '  tolerance, with rounding of displacements'))
      call figures%put('energy_balance', none, rounding, c%energy, 'energy balance')
      if (.not. c%scene%looked_through) return
      call put_place(figures, 'penetration', c%scene%inside)
      call put_place(figures, 'pressed_gap', c%scene%apart)
    end associate
  end subroutine put_certificate

  !> Add the depth that is worst by its tolerance, and this tolerance; 0 if the depth is so small that
  !! rounding chooses the point.
  subroutine put_place(figures, name, worst)
    type(figure_list), intent(inout) :: figures
    character(len=*), intent(in) :: name
    type(overlap_place), intent(in) :: worst

    call figures%put('worst_'//name, length, number, merge(worst%depth, 0.0_wp, worst%ratio >= little))
    call figures%put('allowed_worst_'//name, length, number, &
                     merge(worst%allowed, 0.0_wp, worst%ratio >= little))
  end subroutine put_place

  !> Add iteration error, condition number and rounding.
  subroutine put_iteration(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    integer :: last   ! the solve for the loads of the answer; 0 if they are those at the start

    last = findloc(run%answer%history%load_factor, run%answer%load_factor, dim=1, back=.true.)
    call figures%put('condition', none, size_of, run%answer%condition, &
                     'condition number of the stiffness (1-norm)')
    call figures%put('load_factor', none, number, run%answer%load_factor)
    if (last > 0) then
      call figures%put('iteration_error_displacement', none, rounding, run%answer%history(last)%error, &
                       when(size(run%answer%history) > 1, 'iteration error / largest displacement'))
      call figures%put('iteration_error_force', none, rounding, run%answer%history(last)%force_error, &
                       when(size(run%answer%history) > 1 .and. run%model%contact%pairs > 0, &
                            'iteration error / largest force'))
    end if
    if (run%model%controls%paper_ratio .and. run%iteration%yields) &
      call figures%put('stress_below_curve', none, part, run%answer%shortfall)
  end subroutine put_iteration

  !> Add the mesh errors; `max_pressure_is` says whether the largest pressure is singular, or the mesh too
  !! coarse.
  subroutine put_mesh_errors(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    integer :: k

    call figures%put('mesh_error_energy_norm', none, part, run%accuracy%energy_norm, &
                     'mesh: error in the energy norm')
    if (run%model%contact%pairs > 0) then
      call figures%put_word('max_pressure_is', limit_of_pressure(run), '')
      call figures%put('mesh_error_max_pressure', stress, known, run%accuracy%max_pressure)
    end if
    do k = 1, size(run%accuracy%zone)
      call figures%put_error('mesh_error_pressure_zone_'//text_of(k), stress, &
                             'mesh: largest pressure of zone '//text_of(k), &
                             run%accuracy%zone(k)%pressure, run%answer%zones(k)%max_pressure, &
                             limit_of_pressure(run, k))
      call figures%put_error('mesh_error_half_width_zone_'//text_of(k), length, &
                             'mesh: half-width of zone '//text_of(k), &
                             run%accuracy%zone(k)%half_width, run%answer%zones(k)%half_width, '')
    end do
    do k = 1, size(run%accuracy%zone)
      if (run%accuracy%zone(k)%largest_shear <= 0.0_wp) cycle   ! without friction
      associate (zone => run%accuracy%zone(k))
        call figures%put_error('mesh_error_shear_zone_'//text_of(k), stress, &
                               'mesh: largest shear traction of zone '//text_of(k), zone%shear, &
                               zone%largest_shear, limit_of_pressure(run, k))
      end associate
    end do
    do k = 1, run%motions%count
      call figures%put_error('mesh_error_approach_'//motion_key(run, k), motion_unit(run, k), &
                             'mesh: approach of '//motion_name(run, k), &
                     merge(-1.0_wp, run%accuracy%approach(k), run%accuracy%approach_unbounded(k)), &
                     abs(run%answer%contact%approach(k)), when(run%accuracy%approach_unbounded(k), unbounded))
    end do
    if (run%model%contact%pairs > 0) call figures%put_error('mesh_error_total_contact_force', force, &
                                                            'mesh: total contact force', &
        run%accuracy%total_force, sum(run%answer%contact%force), '')
  end subroutine put_mesh_errors

  !> Add the errors by the size of the increments of flow theory.
  subroutine put_increment_errors(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures
    integer :: k

    if (.not. run%is_flow() .or. size(run%increment) == 0) return
    call figures%put_word('increments', text_of(size(run%increment)), '')
    if (.not. allocated(run%increment_error)) return
    associate (error => run%increment_error, found => run%increment(size(run%increment)))
      if (run%model%contact%pairs > 0) then
        call put('max_pressure', stress, 'largest pressure', error%pressure, found%pressure)
        call put('half_width', length, 'half-width of its zone', error%half_width, found%half_width)
      end if
      do k = 1, run%motions%count
        call put('approach_'//motion_key(run, k), motion_unit(run, k), motion_name(run, k), &
                 beyond_rounding(error%approach(k)), abs(found%approach(k)))
      end do
      if (run%model%contact%has_friction()) then
        call put('friction_force', force, 'friction forces of pairs', error%friction, &
                 maxval(run%model%contact%friction*run%answer%contact%force))
        call put('stick_half_width', length, 'half-width that sticks', error%sticks, found%sticks)
      end if
      call put('stress', stress, 'stresses of elements', error%stress, maxval(run%answer%equivalent_stress))
    end associate

  contains

    !> Add one error.
    subroutine put(key, unit, name, error, value)
      character(len=*), intent(in) :: key, unit, name
      real(wp), intent(in) :: error, value

      call figures%put_error('increment_error_'//key, unit, 'increments: '//name, error, value, '')
    end subroutine put

    !> An error of a displacement; 0 if it is rounding of the largest displacement.
    real(wp) function beyond_rounding(error)
      real(wp), intent(in) :: error

      beyond_rounding = merge(error, 0.0_wp, error > rounded_off*maxval(abs(run%answer%displacement)))
    end function beyond_rounding
  end subroutine put_increment_errors

  !> Add the effects of rounding and stiffness errors on contact forces.
  subroutine put_sensitivity(run, figures)
    type(run_results), intent(in) :: run
    type(figure_list), intent(inout) :: figures

    if (.not. run%accuracy%sensitivity%known) return
    call figures%put('contact_amplification', none, factor, run%accuracy%sensitivity%amplification, &
                     when(run%accuracy%sensitivity%amplification > 0.0_wp, &
                          'contact forces amplify stiffness errors'), '   times at most')
    call figures%put('rounding_error_force', none, known, run%accuracy%sensitivity%rounding)
    call figures%put_word('weak_pairs', text_of(count(run%accuracy%weak)), '')
  end subroutine put_sensitivity

  !> Unit of the displacement of rigid-body mode k.
  function motion_unit(run, k) result(unit)
    type(run_results), intent(in) :: run
    integer, intent(in) :: k
    character(len=:), allocatable :: unit

    unit = length
    if (run%motions%component(k) == angle) unit = radian
  end function motion_unit

  !> Key of rigid-body mode k: `12_2`.
  function motion_key(run, k) result(key)
    type(run_results), intent(in) :: run
    integer, intent(in) :: k
    character(len=:), allocatable :: key

    key = text_of(run%model%mesh%node_id(run%motions%node(k)))//'_'//direction_of(run%motions, k)
  end function motion_key
end module epcont_report_summary
