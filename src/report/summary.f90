!> The figures of a run. Each is said once: its key and unit in the file of the summary, its name and digits
!> in the listing. The file has all of them in this order, the listing those that have a name, each in its
!> section.
module epcont_report_summary
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_certificate_scene, only: little, overlap_place
  use epcont_report_file, only: new_text_file, text_file
  use epcont_report_layout, only: figure, newline
  use epcont_report_limit, only: limit_of_largest, limit_of_zone, reason_of, unbounded
  use epcont_report_names, only: motion_name, point_name
  use epcont_report_number, only: estimate, factor, full_numbers, is_known, known, listed_number, number, &
                                  part, percent, rounding, size_of
  use epcont_report_run, only: run_results
  use epcont_result_stresses, only: first_largest, place_of_point
  implicit none
  private
  public :: summary_type, summarise

  character(len=*), parameter :: none = '', stress = 'force/length2', length = 'length'

  type :: figure_type
    character(len=40) :: key = ''      !! in the file
    character(len=26) :: value = ''
    character(len=13) :: unit = ''
    character(len=44) :: name = ''     !! in the listing; empty: it is not there
    character(len=52) :: listed = ''   !! its value there
    character(len=80) :: note = ''     !! what follows that
  end type figure_type

  type :: summary_type
    private
    type(figure_type), allocatable :: figure(:)
  contains
    procedure :: list
    procedure :: write_file
    procedure, private :: put
    procedure, private :: put_word
    procedure, private :: put_error
    procedure, private :: show
  end type summary_type

contains

  !> All that is known of a run.
  function summarise(run) result(all)
    type(run_results), intent(in) :: run   !! what is known of the run
    type(summary_type) :: all

    allocate (all%figure(0))
    call all%put_word('status', run%outcome%word, 'status')
    call all%put_word('warnings', text_of(run%remarks%warnings))
    call all%put_word('notes', text_of(run%remarks%notes))
    if (.not. run%outcome%has_answer) return
    call put_answer(run, all)
    call put_certificate(run, all)
    call put_iteration(run, all)
    call put_accuracy(run, all)
  end function summarise

  !> Contact, yielding and stresses.
  subroutine put_answer(run, all)
    type(run_results), intent(in) :: run
    type(summary_type), intent(inout) :: all
    real(wp) :: largest, place(2)
    integer :: k

    associate (model => run%model, motions => run%motions, answer => run%answer, &
               contact => run%answer%contact)
      if (model%pairs > 0) call all%put('max_pressure', stress, known, answer%largest_pressure(), &
                                        'largest pressure', &
                                        reason_of(limit_of_largest(run)))
      largest = maxval(abs(answer%displacement))
      do k = 1, motions%count
        call all%put('approach_'//key_of(run, k), length, number, contact%approach(k))
        call all%show('approach: '//motion_name(run, k), &
                      listed_number(number, contact%approach(k), largest))
        if (contact%motion_free(k)) all%figure(size(all%figure))%note = newline// &
          '    nothing resists or drives this motion: its value is a choice'
      end do
      call all%put('total_contact_force', 'force', number, sum(contact%force), 'total contact force')
      call all%put_word('pairs_in_contact', text_of(count(contact%touching)), 'pairs in contact')
      call all%put_word('plastic_elements', text_of(count(answer%plastic)), 'elements beyond the yield point')
      call all%put_word('iterations', text_of(size(answer%history)))
      call all%put_word('factorizations', text_of(answer%factorizations))
      call all%put_word('pivots', text_of(sum(answer%history%pivots)))
      associate (e => first_largest(answer%largest_stress))
        place = place_of_point(model, answer%largest_at(e))
        call all%put('max_equivalent_stress', stress, number, answer%largest_stress(e), &
                     'largest equivalent stress', &
                     '   in element '//text_of(model%element_id(e))//' at '//point_name(place))
        call all%put_word('max_equivalent_stress_element', text_of(model%element_id(e)))
      end associate
      call all%put('max_equivalent_stress_x', length, number, place(1))
      call all%put('max_equivalent_stress_y', length, number, place(2))
      call all%put('max_displacement', length, number, maxval(norm2(answer%displacement, dim=1)), &
                   'largest displacement')
    end associate
  end subroutine put_answer

  !> What the certificate has found; forces and gaps in the listing as parts of the largest.
  subroutine put_certificate(run, all)
    type(run_results), intent(in) :: run
    type(summary_type), intent(inout) :: all

    associate (c => run%certificate)
      call all%put('equilibrium_residual', none, rounding, c%equilibrium, 'equilibrium residual')
      call all%put('smallest_force', 'force', number, c%smallest_force)
      call all%show('most negative force, of the largest', &
                    listed_number(rounding, max(0.0_wp, -c%smallest_force)/c%force_scale, 0.0_wp))
      call all%put('smallest_gap', length, number, c%smallest_gap)
      call all%show('most negative gap, of the largest length', &
                    listed_number(rounding, c%overlap/c%length_scale, 0.0_wp))
      call all%put('largest_force_gap_product', 'force*length', number, c%force_gap)
      call all%show('largest force times gap', &
                    listed_number(rounding, c%force_gap/c%force_scale/c%length_scale, 0.0_wp))
      call all%put('stress_off_curve', none, rounding, c%off_curve, 'stress off the curve')
      call all%put('curve_tolerance', none, size_of, c%curve_tolerance, &
                   merge('of which the iteration may leave', repeat(' ', 32), &
                         c%curve_tolerance > c%tolerance))
      call all%put('stress_off_curve_limit', none, size_of, c%off_curve_limit, &
                   merge('and with the rounding of displacements', repeat(' ', 38), &
                         c%off_curve > c%curve_tolerance .and. c%off_curve <= c%off_curve_limit))
      call all%put('energy_balance', none, rounding, c%energy, 'energy balance')
      if (.not. c%scene%looked_through) return
      call put_places('penetration', c%scene%deepest, c%scene%inside, all)
      call put_places('pressed_gap', c%scene%widest, c%scene%apart, all)
    end associate
  end subroutine put_certificate

  !> The largest depth, the one that is worst by what is allowed, and that; 0 where it is so little that
  !! rounding chooses the place.
  subroutine put_places(name, largest, worst, all)
    character(len=*), intent(in) :: name
    type(overlap_place), intent(in) :: largest, worst
    type(summary_type), intent(inout) :: all

    call all%put('largest_'//name, length, number, merge(largest%depth, 0.0_wp, largest%ratio >= little))
    call all%put('worst_'//name, length, number, merge(worst%depth, 0.0_wp, worst%ratio >= little))
    call all%put('allowed_worst_'//name, length, number, merge(worst%allowed, 0.0_wp, worst%ratio >= little))
  end subroutine put_places

  !> How exactly the equations were solved.
  subroutine put_iteration(run, all)
    type(run_results), intent(in) :: run
    type(summary_type), intent(inout) :: all

    call all%put('condition', none, size_of, run%answer%condition, 'condition of the stiffness (1-norm)')
    call all%put('load_factor', none, number, run%answer%load_factor)
    associate (last => run%answer%history(findloc(run%answer%history%load_factor, run%answer%load_factor, &
                                                  dim=1, back=.true.)))
      call all%put('iteration_error_displacement', none, rounding, last%error, &
                   'iteration error, of the largest displacement')
      call all%put('iteration_error_force', none, rounding, last%force_error, &
                   'iteration error, of the largest force')
    end associate
  end subroutine put_iteration

  !> What the mesh and rounding make of the figures; `max_pressure_is` unbounded, or not resolved.
  subroutine put_accuracy(run, all)
    type(run_results), intent(in) :: run
    type(summary_type), intent(inout) :: all
    integer :: k

    associate (model => run%model, motions => run%motions, answer => run%answer, accuracy => run%accuracy)
      call all%put('mesh_error_energy_norm', none, part, accuracy%energy_norm, &
                   'mesh: error in the energy norm')
      if (model%pairs > 0) then
        call all%put_word('max_pressure_is', limit_of_largest(run))
        call all%put('mesh_error_max_pressure', stress, known, accuracy%max_pressure)
      end if
      do k = 1, size(accuracy%zone)
        call all%put_error('pressure_zone_'//text_of(k), stress, 'largest pressure of zone '//text_of(k), &
                           accuracy%zone(k)%pressure, answer%zones(k)%max_pressure, &
                           limit_of_zone(run, k))
        call all%put_error('half_width_zone_'//text_of(k), length, 'half-width of zone '//text_of(k), &
                           accuracy%zone(k)%half_width, answer%zones(k)%half_width)
      end do
      do k = 1, motions%count
        call all%put_error('approach_'//key_of(run, k), length, &
                           'approach of '//motion_name(run, k), &
                           merge(-1.0_wp, accuracy%approach(k), accuracy%approach_unbounded(k)), &
                           abs(answer%contact%approach(k)), &
                           trim(merge(unbounded, repeat(' ', len(unbounded)), &
                                      accuracy%approach_unbounded(k))))
      end do
      if (model%pairs > 0) call all%put_error('total_contact_force', 'force', 'total contact force', &
                                              accuracy%total_force, sum(answer%contact%force))
      if (.not. accuracy%sensitivity%known) return
      call all%put('contact_amplification', none, factor, accuracy%sensitivity%amplification, &
                   'they magnify errors of the stiffness', '   times at most')
      call all%put('rounding_error_force', none, known, &
                   max(accuracy%sensitivity%rounding, answer%rounding_error))
      call all%put_word('weak_pairs', text_of(count(accuracy%weak)))
    end associate
  end subroutine put_accuracy

  !> Of an approach in the names of figures: `12_2`.
  pure function key_of(run, k) result(key)
    type(run_results), intent(in) :: run
    integer, intent(in) :: k   !! free motion
    character(len=:), allocatable :: key

    key = text_of(run%model%node_id(run%motions%node(k)))//'_'//text_of(run%motions%component(k))
  end function key_of

  !> Add a number; it has that many digits in the listing.
  subroutine put(self, key, unit, kind, value, name, note)
    class(summary_type), intent(inout) :: self
    character(len=*), intent(in) :: key, unit
    integer, intent(in) :: kind
    real(wp), intent(in) :: value
    character(len=*), intent(in), optional :: name, note   !! in the listing
    character(len=25) :: full(1)

    full = full_numbers([value])
    if (.not. is_known(kind, value)) full = ''
    self%figure = [self%figure, figure_type(key, full(1), unit)]
    if (present(name)) call self%show(name, listed_number(kind, value, 0.0_wp), note)
  end subroutine put

  !> Add a word.
  subroutine put_word(self, key, word, name)
    class(summary_type), intent(inout) :: self
    character(len=*), intent(in) :: key, word
    character(len=*), intent(in), optional :: name

    self%figure = [self%figure, figure_type(key, word)]
    if (present(name)) call self%show(name, word)
  end subroutine put_word

  !> Show the last figure in the listing.
  subroutine show(self, name, listed, note)
    class(summary_type), intent(inout) :: self
    character(len=*), intent(in) :: name, listed
    character(len=*), intent(in), optional :: note

    associate (last => self%figure(size(self%figure)))
      last%name = name
      last%listed = listed
      if (present(note)) last%note = note
    end associate
  end subroutine show

  !> Add an error of the mesh; the listing has it where it is known, or why it is not.
  subroutine put_error(self, key, unit, name, error, value, limit)
    class(summary_type), intent(inout) :: self
    character(len=*), intent(in) :: key, unit, name   !! key and name are those of the figure
    real(wp), intent(in) :: error, value
    character(len=*), intent(in), optional :: limit   !! of the figure: `bounded`, `unbounded` ...
    character(len=:), allocatable :: reason

    call self%put('mesh_error_'//key, unit, known, error)
    reason = ''
    if (present(limit)) reason = reason_of(limit)
    if (len(reason) > 0) then
      call self%show('mesh: '//name, reason)
    else if (error >= 0.0_wp) then
      call self%show('mesh: '//name, listed_number(estimate, error, value), '   '//percent(error, value))
    end if
  end subroutine put_error

  !> Lines of the listing.
  subroutine list(self, file, keys)
    class(summary_type), intent(in) :: self
    type(text_file), intent(in) :: file   !! the listing
    character(len=*), intent(in) :: keys(:)   !! of the figures; one that ends in `_`: all that begin so
    integer :: i, k, n

    do k = 1, size(keys)
      n = len_trim(keys(k))
      do i = 1, size(self%figure)
        associate (one => self%figure(i))
          if (one%key /= keys(k) .and. .not. (keys(k)(n:n) == '_' .and. one%key(:n) == keys(k))) cycle
          if (one%name /= '') call figure(file, one%name, trim(one%listed), trim(one%note))
        end associate
      end do
    end do
  end subroutine list

  !> The file of the summary.
  subroutine write_file(self, path, error)
    class(summary_type), intent(in) :: self
    character(len=*), intent(in) :: path                  !! of the file
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written
    type(text_file) :: file
    integer :: i

    call new_text_file(path, file, error)
    if (allocated(error)) return
    call file%line('key,value,unit')
    do i = 1, size(self%figure)
      associate (one => self%figure(i))
        call file%line(trim(one%key)//','//trim(one%value)//','//one%unit)
      end associate
    end do
    call file%finish(error)
  end subroutine write_file
end module epcont_report_summary
