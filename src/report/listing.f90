!> The listing for people: ASCII, at most 132 columns, nothing in it that varies from run to run.
module epcont_report_listing
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_version, only: program_name, program_version
  use epcont_contact_problem, only: contact_solution
  use epcont_deck_deck, only: deck_type
  use epcont_deck_render, only: printable
  use epcont_model_controls, only: precision_single
  use epcont_model_model, only: model_type
  use epcont_report_columns, only: table_type
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: figure, heading, right, wrap
  use epcont_report_names, only: centre_name, joined
  use epcont_report_number, only: estimate_number, listed_number, number, percent, rounding_number
  use epcont_report_outcome, only: outcome_type
  use epcont_report_remarks, only: poisson_text
  use epcont_report_run, only: run_results
  use epcont_report_scene_text, only: list_scene
  use epcont_report_summary, only: summary_type
  use epcont_report_tables, only: put_contact, put_history, put_pivots
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: list_deck, list_outcome, list_iterations, list_contact, list_summary, list_accuracy

  !> Pairs that are named.
  integer, parameter :: most_pairs = 8

contains

  !> Title, and what the deck holds.
  subroutine list_deck(file, deck)
    type(text_file), intent(in) :: file   !! the listing
    type(deck_type), intent(in) :: deck   !! the deck
    integer :: k

    call file%line(program_name//' '//program_version//'   elastoplastic contact of plane bodies and rings')
    call file%line('')
    if (len(deck%title) > 0) call file%line('  '//printable(deck%title))
    if (len(deck%subtitle) > 0) call file%line('  '//printable(deck%subtitle))
    if (len(deck%label) > 0) call file%line('  '//printable(deck%label))
    if (len_trim(deck%parameter_word('UNITS', '')) > 0) then
      call file%line('  units: '//trim(deck%parameter_word('UNITS', '')))
    else
      call file%line('  units: as the deck has them')
    end if
    call heading(file, 'DECK')
    do k = 1, size(deck%card)
      if (deck%card(k)%count > 0) &
        call file%line('  '//deck%card(k)%entry%name//'  '//right(text_of(deck%card(k)%count), 9))
    end do
  end subroutine list_deck

  !> What came of the run, where the answer is not valid; the headings that follow say so too.
  subroutine list_outcome(file, outcome)
    type(text_file), intent(inout) :: file      !! the listing; its headings are marked from here on
    type(outcome_type), intent(in) :: outcome   !! what came of the run

    if (len(outcome%sentence) == 0) return
    call file%line('')
    file%mark = '  *NOT VALID: '//outcome%word//'*'
    call wrap(file, '  *NOT VALID*  '//outcome%word//': '//outcome%sentence)
  end subroutine list_outcome

  !> One line a solve, and what is to be known of the yielding.
  subroutine list_iterations(listing, run)
    type(table_type), intent(inout) :: listing   !! the listing
    type(run_results), intent(in) :: run         !! what is known of the run
    integer :: k

    associate (file => listing%file, model => run%model, answer => run%answer)
      if (.not. any([(model%can_yield(k), k=1, model%elements)])) return
      call put_history(run, listing)
      call file%line('')
      if (answer%load_steps > answer%asked_load_steps) &
        call file%line('  in '//plural(answer%asked_load_steps, 'load step')// &
                       ' no answer was found; tried again in '// &
                       text_of(answer%load_steps)//' (AUTO)')
      if (any(answer%history%by_tangent)) &
        call file%line('  the last step is one by the tangent: its change is what the others have left')
      call file%line('  '//plural(count(answer%plastic), 'element')//' of '//text_of(model%elements)// &
                     ' beyond the yield point')
      if (any(answer%beyond)) &
        call file%line('  beyond the last point of its table, whose last slope goes on: '// &
                       named(model, count(answer%beyond), findloc(answer%beyond, .true., dim=1)))
      if (answer%unloaded > 0) &
        call file%line('  the strain fell as the load grew, and went back along the curve '// &
                       '(elastic unloading is not modelled): '// &
                       named(model, answer%unloaded, answer%first_unloaded))
    end associate
  end subroutine list_iterations

  !> A number of elements, and one of them.
  pure function named(model, count, first) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: count, first
    character(len=:), allocatable :: text

    text = 'element '//text_of(model%element_id(first))
    if (count > 1) text = text//' and '//text_of(count - 1)//' more'
  end function named

  !> Forces, pressures and gaps of the pairs, and the pivots that led to them.
  subroutine list_contact(listing, run)
    type(table_type), intent(inout) :: listing   !! the listing
    type(run_results), intent(in) :: run         !! what is known of the run

    call put_contact(run, listing)
    call listing%file%line('')
    associate (contact => run%answer%contact)
      call listing%file%line('  '//exchanges(contact)// &
                             trim(merge(', in the last solve', repeat(' ', 19), &
                                        size(run%answer%history) > 1)))
      if (size(contact%history) == 0) return
      call put_pivots(run, listing)
      if (contact%pivots > size(contact%history)) &
        call listing%file%line('  and '//text_of(contact%pivots - size(contact%history))//' more')
    end associate
  end subroutine list_contact

  !> How the set of contacts was found.
  pure function exchanges(contact) result(text)
    type(contact_solution), intent(in) :: contact
    character(len=:), allocatable :: text

    if (contact%by_blocks) then
      text = 'block pivoting: '//plural(contact%block_steps, 'set')//', '// &
             plural(contact%pivots, 'exchange')//' of pairs'
      return
    end if
    text = plural(contact%pivots, 'pivot')//', '//text_of(contact%degenerate_pivots)//' degenerate'
    if (contact%block_steps > 0) &
      text = text//' (CONRY, after '//plural(contact%block_steps, 'set')//' of block pivoting)'
  end function exchanges

  !> Summary and certificate.
  subroutine list_summary(file, run, summary)
    type(text_file), intent(in) :: file         !! the listing
    type(run_results), intent(in) :: run        !! what is known of the run
    type(summary_type), intent(in) :: summary   !! its figures

    call heading(file, 'SUMMARY')
    if (run%model%pairs > 0) &
      call summary%list(file, [character(len=19) :: 'max_pressure', 'total_contact_force', &
                               'pairs_in_contact'])
    call summary%list(file, ['approach_'])
    if (any(run%answer%plastic)) call summary%list(file, ['plastic_elements'])
    call summary%list(file, [character(len=21) :: 'max_equivalent_stress', 'max_displacement', 'status'])
    call heading(file, 'CERTIFICATE  (recomputed from displacements and forces alone; tolerance '// &
                 short_real(run%certificate%tolerance)//')')
    call summary%list(file, [character(len=25) :: 'equilibrium_residual', 'smallest_', &
                             'largest_force_gap_product', 'stress_off_curve', 'curve_tolerance', &
                             'stress_off_curve_limit', 'energy_balance'])
    call list_scene(file, run%model, run%certificate%scene)
  end subroutine list_summary

  !> What the figures are worth.
  subroutine list_accuracy(file, run, summary)
    type(text_file), intent(in) :: file         !! the listing
    type(run_results), intent(in) :: run        !! what is known of the run
    type(summary_type), intent(in) :: summary   !! its figures

    call heading(file, 'ACCURACY')
    associate (answer => run%answer, sensitivity => run%accuracy%sensitivity)
      if (size(answer%history) > 1) call summary%list(file, ['iteration_error_displacement'])
      if (size(answer%history) > 1 .and. run%model%pairs > 0) &
        call summary%list(file, ['iteration_error_force'])
      call summary%list(file, ['condition'])
      call list_precision(file, answer)
      if (answer%precision /= precision_single) call figure(file, 'digits that rounding leaves, at least', &
                                                            text_of(max(0, floor(-log10(answer%rounding())))))
      call figure(file, 'linear residual', rounding_number(run%certificate%equilibrium))
      if (sensitivity%known .and. answer%precision /= precision_single) &
        call figure(file, 'rounding in the contact forces, at most', rounding_number(sensitivity%rounding), &
                    '   of the largest')
      call summary%list(file, [character(len=21) :: 'contact_amplification', 'mesh_error_'])
      call list_worst(file, run)
      if (any(run%accuracy%weak)) then
        call list_some('pressed by less than the error of the force', &
                       run%accuracy%weak .and. answer%contact%touching)
        call list_some('open by less than the error of the gap', &
                       run%accuracy%weak .and. .not. answer%contact%touching)
      end if
      if (answer%locking%elements > 0) call list_locking(file, run)
      if (answer%gradient%part > 0.0_wp) call list_gradient(file, run)
    end associate
    if (run%model%controls%accuracy > 0.0_wp) call list_wanted(file, run)

  contains

    !> Pairs that may as well be open, or touch.
    subroutine list_some(what, chosen)
      character(len=*), intent(in) :: what
      logical, intent(in) :: chosen(:)

      if (any(chosen)) call file%line('  '//what//', '//plural(count(chosen), 'pair')//': '// &
                                      joined(pack(run%model%pair_id, chosen), ' ', most_pairs))
    end subroutine list_some
  end subroutine list_accuracy

  !> The elements that would gain most by being smaller.
  subroutine list_worst(file, run)
    type(text_file), intent(in) :: file
    type(run_results), intent(in) :: run

    associate (worst => run%accuracy%worst, error => run%accuracy%element)
      if (size(worst) == 0) return
      call file%line('  refine first: element '//joined(run%model%element_id(worst), ' ')// &
                     ', the first at '//centre_name(run%model, worst(1))//'; '// &
                     percent(sum(error(worst)), sum(error))//' of the error')
    end associate
  end subroutine list_worst

  !> Elements that are too stiff for what their material does.
  subroutine list_locking(file, run)
    type(text_file), intent(in) :: file
    type(run_results), intent(in) :: run

    call figure(file, 'three-node elements of constant volume', text_of(run%answer%locking%elements))
    call figure(file, 'scatter of their mean stress / equivalent', &
                listed_number(number, run%answer%locking%scatter, 1.0_wp))
    call file%line('    ('//poisson_text(run%answer)// &
                   ': they are too stiff there; six-node elements and CQUAD4 are not)')
  end subroutine list_locking

  !> Displacements that are not small.
  subroutine list_gradient(file, run)
    type(text_file), intent(in) :: file
    type(run_results), intent(in) :: run

    associate (gradient => run%answer%gradient)
      call figure(file, 'not small: turned, stretched by over 0.1', &
                  right(percent(gradient%part, 1.0_wp), 15), &
                  '   of the volume')
      call file%line('    (most at '//centre_name(run%model, gradient%worst)//', '// &
                     estimate_number(gradient%largest)// &
                     '; equilibrium and contact are those of the undeformed shape: loads, moduli, units?)')
    end associate
  end subroutine list_gradient

  !> For the listing: what single precision has left, and why it was given up.
  subroutine list_precision(file, answer)
    type(text_file), intent(in) :: file
    type(answer_type), intent(in) :: answer

    if (answer%precision == precision_single) &
      call figure(file, 'error that single precision leaves', short_real(answer%rounding_error))
    if (answer%precision == answer%asked_precision) return
    if (answer%asked_precision == precision_single) then
      call file%line('    (factors in double: in single precision they left an error of more than '// &
                     short_real(answer%largest_rounding_error)//', or no answer)')
    else
      call file%line('    (factors in double: '// &
                     'in single precision there was no answer that refinement could reach)')
    end if
  end subroutine list_precision

  !> The wish, and what stands in its way: PARAM ACCURACY sets the solution, but the mesh has the last word.
  subroutine list_wanted(file, run)
    type(text_file), intent(in) :: file
    type(run_results), intent(in) :: run
    real(wp) :: error

    associate (wish => run%model%controls%accuracy, accuracy => run%accuracy)
      call figure(file, 'wanted error of contact pressures', short_real(wish))
      if (accuracy%pressure_unbounded) then
        call file%line('    not to be had: the largest pressure is unbounded: it grows with every finer mesh')
        return
      end if
      if (accuracy%max_pressure < 0.0_wp .or. .not. any(run%answer%contact%force > 0.0_wp)) then
        call file%line('    (of the mesh''s error nothing is known: '// &
                       'no pressure, or too few pairs in contact)')
        return
      end if
      error = accuracy%max_pressure/maxval(run%answer%pressure)
      if (error > wish) then
        call file%line('    not reached: the mesh, not the dial, is the limit: its error is estimated at '// &
                       estimate_number(error)//'; refine the elements named above')
      else
        call file%line('    reached: the error of the mesh is estimated at '//estimate_number(error))
      end if
    end associate
  end subroutine list_wanted
end module epcont_report_listing
