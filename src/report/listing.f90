!> The listing: deck and plan once, then the results of each load case.
module epcont_report_listing
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: newline, plural, short_real, text_of
  use epcont_base_tolerances, only: valid_to
  use epcont_base_version, only: program_name, program_version
  use epcont_certificate_scene, only: little, overlap_place
  use epcont_deck_render, only: printable
  use epcont_report_case_table, only: accuracy_text, row_of_case
  use epcont_report_columns, only: estimate_number, right, rounding_number, table_type
  use epcont_report_echo, only: list_cards
  use epcont_messages_attempt_text, only: attempts_text
  use epcont_messages_names, only: centre_name, joined, percent, point_name, when
  use epcont_messages_outcome, only: remark_lines
  use epcont_messages_sentences, only: most_pairs
  use epcont_report_run, only: run_results
  use epcont_report_summary, only: figure_type
  use epcont_report_tables, only: put_table
  use epcont_result_answer, only: pair_slips, pair_sticks
  implicit none
  private
  public :: list_scene, list_case

contains

  !> List title, numbers of cards, warnings and notes (with those of an only load case), and the plan.
  subroutine list_scene(run, plan, listing)
    type(run_results), intent(in) :: run         !! run and its results
    character(len=*), intent(in) :: plan         !! in lines
    type(table_type), intent(inout) :: listing   !! is added to

    call list_deck()
    call list_cards(listing, run%deck)
    if (run%has_cases()) then
      call list_remarks(run%deck_notes, run%faults%warnings, run%faults%notes, listing)
    else
      call list_remarks(run%deck_notes//remark_lines(run%outcome%found, .true.), &
                        run%faults%warnings + run%outcome%found%warnings, &
                        run%faults%notes + run%outcome%found%notes, listing)
    end if
    call listing%line(plan(:len(plan) - 1))

  contains

    !> List title and numbers of cards.
    subroutine list_deck()
      character(len=20) :: units
      integer :: k

      call listing%line(program_name//' '//program_version// &
                        '   elastoplastic contact in two dimensions')
      call listing%line('')
      if (len(run%deck%title) > 0) call listing%say(printable(run%deck%title))
      if (.not. run%has_cases()) call list_titles(run, listing)
      units = run%deck%parameter_word('UNITS')
      if (units == '') units = 'those of the deck'
      call listing%say('units: '//units)
      if (run%deck%restart /= '') call listing%say('starts from the end of '// &
        when(run%from_subcase > 0, 'SUBCASE '//text_of(run%from_subcase), 'its load case')//' in '// &
        printable(run%deck%restart))
      call listing%heading('DECK')
      do k = 1, size(run%deck%card)
        if (run%deck%card(k)%count > 0) &
          call listing%say(run%deck%card(k)%entry%name//'  '//right(text_of(run%deck%card(k)%count), 9))
      end do
    end subroutine list_deck
  end subroutine list_scene

  !> List SUBTITLE and LABEL of a load case.
  subroutine list_titles(run, listing)
    type(run_results), intent(in) :: run
    type(table_type), intent(inout) :: listing

    associate (case => run%deck%subcase(run%case))
      if (len(case%subtitle) > 0) call listing%say(printable(case%subtitle))
      if (len(case%label) > 0) call listing%say(printable(case%label))
    end associate
  end subroutine list_titles

  !> List the results of a load case.
  subroutine list_case(run, figures, all_tables, listing)
    type(run_results), intent(in) :: run              !! run, with the results of this case
    type(figure_type), intent(in) :: figures(:)       !! of its summary
    logical, intent(in) :: all_tables                 !! asked for on the command line
    type(table_type), intent(inout) :: listing        !! is added to

    listing%mark = ''
    if (run%has_cases()) then
      call listing%heading('SUBCASE '//text_of(run%deck%subcase(run%case)%id))
      call list_titles(run, listing)
      call list_remarks(remark_lines(run%outcome%found, .true.), run%outcome%found%warnings, &
                        run%outcome%found%notes, listing)
    end if
    if (len(run%outcome%sentence) > 0) then   ! not valid: the headings that follow say so too
      listing%mark = '  *NOT VALID: '//run%outcome%word//'*'
      call listing%line('')
      call wrap(listing, '  *NOT VALID*  '//run%outcome%word//': '//run%outcome%sentence)
    end if
    if (size(run%attempts%made) > 0) then
      call listing%line('')
      call wrap(listing, '  attempts: '//attempts_text(run))
    end if
    if (.not. run%outcome%has_answer) return
    if (run%iteration%follows) call list_iterations(listing, run)
    if (run%model%contact%pairs > 0) call list_tables([character(len=8) :: 'contact', 'friction', 'zones', &
                                                      'sticks', 'lines', 'bodies'])
    call list_tables([character(len=8) :: 'nodes', 'elements', 'plastic'])
    call list_summary()
    if (run%certificate%scene%looked_through) call list_scene_found(listing, run)
    call listing%heading('ACCURACY')
    call list_rounding()
    call list_mesh(listing, run, figures)
    if (run%model%controls%accuracy > 0.0_wp) call list_wanted(listing, run)

  contains

    !> List the tables that the model has and that are requested.
    subroutine list_tables(names)
      character(len=*), intent(in) :: names(:)
      integer :: k

      do k = 1, size(names)
        if (run%wants_table(names(k), all_tables)) call put_table(run, names(k), listing)
      end do
    end subroutine list_tables

    !> List summary and certificate.
    subroutine list_summary()
      call listing%heading('SUMMARY')
      call list_figures(listing, figures, [character(len=21) :: 'max_pressure', 'total_contact_force', &
        'pairs_in_contact', 'total_friction_force', 'max_shear', 'pairs_sticking', 'pairs_slipping', &
        'max_slip', 'stick_half_width', 'approach_', 'angle_', 'moment_', 'spring_', 'plastic_elements', &
        'max_equivalent_stress', 'max_plastic_strain', 'max_displacement', 'lowest_temperature', &
        'highest_temperature', 'status'])
      call listing%heading('CERTIFICATE  (recomputed from displacements and forces alone; tolerance '// &
                           short_real(valid_to)//')')
      call list_figures(listing, figures, [character(len=25) :: 'equilibrium_residual', 'smallest_', &
        'largest_force_gap_product', 'friction_above_limit', 'largest_force_slip', 'stress_off_curve|', &
        'curve_tolerance', 'stress_off_curve_limit', 'energy_balance'])
    end subroutine list_summary

    !> List iteration error and rounding error.
    subroutine list_rounding()
      call list_figures(listing, figures, ['iteration_error_', 'condition       '])
      call list_figure(listing, 'significant digits after rounding, at least', &
                       text_of(max(0, floor(-log10(run%answer%rounding())))), '')
      if (run%accuracy%sensitivity%known) &
        call list_figure(listing, 'rounding in the contact forces, at most', &
                         rounding_number(run%accuracy%sensitivity%rounding), '   of the largest')
    end subroutine list_rounding
  end subroutine list_case

  !> List a figure: name, value at the right of 13 columns, note.
  subroutine list_figure(listing, name, value, note)
    type(table_type), intent(inout) :: listing
    character(len=*), intent(in) :: name, value, note   ! the name in at most 44 characters
    character(len=44) :: label

    label = name
    call listing%say(label//right(value, 13)//note)
  end subroutine list_figure

  !> List named figures of the summary whose keys begin with `keys`; a key that ends in `|` is a whole key.
  subroutine list_figures(listing, figures, keys)
    type(table_type), intent(inout) :: listing
    type(figure_type), intent(in) :: figures(:)
    character(len=*), intent(in) :: keys(:)
    integer :: i, k

    do k = 1, size(keys)
      do i = 1, size(figures)
        if (figures(i)%name /= '' .and. index(trim(figures(i)%key)//'|', trim(keys(k))) == 1) &
          call list_figure(listing, figures(i)%name, trim(figures(i)%listed), trim(figures(i)%note))
      end do
    end do
  end subroutine list_figures

  !> List one line for each solve, and the number of yielded elements.
  subroutine list_iterations(listing, run)
    type(table_type), intent(inout) :: listing
    type(run_results), intent(in) :: run

    if (run%iteration%yields) call put_table(run, 'history', listing)
    if (run%is_flow()) then
      call put_table(run, 'increments', listing)
      if (run%model%controls%steps_by_accuracy) &
        call listing%say(plural(run%steps, 'increment')//' chosen for PARAM ACCURACY')
      if (size(run%increment) > run%steps) call listing%say( &
        text_of(size(run%increment))//' increments instead of '//text_of(run%steps)// &
        ': one that does not converge is halved')
    end if
    if (.not. run%iteration%yields) return
    call listing%line('')
    if (any(run%answer%history%by_tangent)) call listing%say(&
      'the last step uses the tangent: its change is the error that the other steps have left')
    call listing%say(text_of(count(run%answer%plastic))//' of '// &
             plural(run%model%mesh%elements, 'element')//' yielded')
    if (.not. allocated(run%stress_path)) return
    associate (path => run%stress_path)
      call listing%say('loading: '//when(path%falling == 0, 'no stress component falls with the load', &
        'in '//plural(path%falling, 'yielded element')//' a stress component falls with the load')// &
        '; stress deviators rotated by '//plural(nint(path%mean_turn), 'degree')// &
        ' on average, at most '//text_of(nint(path%turn))//' in element '// &
        text_of(run%model%mesh%element_id(path%worst)))
    end associate
  end subroutine list_iterations

  !> List penetrations and gaps under pressure: the worst of each.
  subroutine list_scene_found(listing, run)
    type(table_type), intent(inout) :: listing
    type(run_results), intent(in) :: run

    associate (scene => run%certificate%scene)
      call list_place('penetration anywhere / tolerance', scene%inside)
      if (scene%passed%side > 0) call list_place('  of bodies that passed through each other', scene%passed)
      if (run%model%contact%pairs == 0) return
      call list_place('gap at a loaded pair / tolerance', scene%apart)
      if (scene%beside%ratio >= little) call list_place('  at a pair beside the other body', scene%beside)
    end associate

  contains

    !> List depth over allowed depth, and the point.
    subroutine list_place(name, place)
      character(len=*), intent(in) :: name
      type(overlap_place), intent(in) :: place

      if (place%ratio < little) then
        call list_figure(listing, name, '< '//short_real(little), '')
      else
        call list_figure(listing, name, estimate_number(place%ratio), &
                         '   '//short_real(place%depth)//' at '//point_name(place%x))
      end if
    end subroutine list_place
  end subroutine list_scene_found

  !> List mesh errors and pairs with uncertain contact state.
  subroutine list_mesh(listing, run, figures)
    type(table_type), intent(inout) :: listing
    type(run_results), intent(in) :: run
    type(figure_type), intent(in) :: figures(:)

    call list_figures(listing, figures, [character(len=21) :: 'contact_amplification', 'mesh_error_', &
      'increment_error_'])
    if (size(run%accuracy%worst) > 0) &
      call listing%say('refine elements '//joined(run%model%mesh%element_id(run%accuracy%worst), ' ')// &
               ' first: '//percent(sum(run%accuracy%element(run%accuracy%worst)), &
                                   sum(run%accuracy%element))//' of the error; element '// &
               text_of(run%model%mesh%element_id(run%accuracy%worst(1)))//' is at '// &
               centre_name(run%model, run%accuracy%worst(1)))
    associate (contact => run%answer%contact, found => run%accuracy, id => run%model%contact%pair_id, &
               pair => run%model%contact%sliding)
      call list_pairs('closed pair', 'carry less force than its estimated error and may be open', &
                      ': the mesh is too coarse', id, contact%touching, found%weak)
      call list_pairs('open pair', 'have a gap below its estimated error and may be closed', '', id, &
                      .not. contact%touching, found%weak)
      if (.not. allocated(found%weak_friction)) return
      call list_pairs('sticking pair', 'are within the estimated error of their limit and may slip', '', &
                      id(pair), run%answer%friction_states(pair) == pair_sticks, found%weak_friction)
      call list_pairs('slipping pair', 'slip less than the estimated error and may stick', '', id(pair), &
                      run%answer%friction_states(pair) == pair_slips, found%weak_friction)
    end associate

  contains

    !> List the pairs of a state that is uncertain.
    subroutine list_pairs(noun, what, if_most, id, chosen, weak)
      character(len=*), intent(in) :: noun, what
      character(len=*), intent(in) :: if_most   !! in place of their ids, if most are uncertain; empty: ids
      integer, intent(in) :: id(:)              !! [pairs]
      logical, intent(in) :: chosen(:), weak(:)   !! in this state, and uncertain [pairs]

      associate (uncertain => chosen .and. weak)
        if (any(uncertain)) call listing%say(text_of(count(uncertain))//' of '// &
            plural(count(chosen), noun)//' '//what// &
            when(2*count(uncertain) > count(chosen) .and. if_most /= '', if_most, &
                 ': '//joined(pack(id, uncertain), ' ', most_pairs)))
      end associate
    end subroutine list_pairs
  end subroutine list_mesh

  !> Say whether the mesh gives the accuracy of PARAM ACCURACY.
  subroutine list_wanted(listing, run)
    type(table_type), intent(inout) :: listing
    type(run_results), intent(in) :: run

    associate (wanted => run%model%controls%accuracy)
      call list_figure(listing, 'wanted error of contact pressures', short_real(wanted), '')
      call listing%say('  '//accuracy_text(row_of_case(run), wanted))
    end associate
  end subroutine list_wanted

  !> List warnings and notes.
  subroutine list_remarks(text, warnings, notes, listing)
    character(len=*), intent(in) :: text         !! in lines
    integer, intent(in) :: warnings, notes       !! how many
    type(table_type), intent(inout) :: listing
    integer :: from, to

    if (len(text) == 0) return
    call listing%heading('WARNINGS AND NOTES  ('//plural(warnings, 'warning')//', '// &
                         plural(notes, 'note')//')')
    from = 1
    do while (from <= len(text))
      to = from + index(text(from:), newline) - 1
      call wrap(listing, '  '//text(from:to - 1))
      from = to + 1
    end do
  end subroutine list_remarks

  !> Add text in lines of at most 132 columns.
  subroutine wrap(listing, text)
    type(table_type), intent(inout) :: listing
    character(len=*), intent(in) :: text
    integer, parameter :: columns = 132
    integer :: from, to

    from = 1
    do while (len(text) - from >= columns - 4)
      to = from + index(text(from:from + columns - 4), ' ', back=.true.) - 1
      if (to <= from) to = from + columns - 4
      call listing%line(repeat(' ', merge(4, 0, from > 1))//text(from:to))
      from = to + 1
    end do
    call listing%line(repeat(' ', merge(4, 0, from > 1))//text(from:))
  end subroutine wrap
end module epcont_report_listing
