!> The listing for people: ASCII, at most 132 columns, nothing in it that varies from run to run.
module epcont_report_listing
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_version, only: program_name, program_version
  use epcont_certificate_scene, only: little, overlap_place
  use epcont_deck_render, only: printable
  use epcont_model_controls, only: precision_single
  use epcont_report_columns, only: table_type
  use epcont_report_echo, only: list_cards
  use epcont_report_file, only: new_text_file
  use epcont_report_layout, only: figure, heading, newline, right, wrap
  use epcont_report_names, only: centre_name, joined, point_name, when
  use epcont_report_number, only: estimate_number, listed_number, number, part, percent, rounding_number
  use epcont_report_outcome, only: most_pairs
  use epcont_report_plan_text, only: plan_text
  use epcont_report_remarks, only: poisson_text
  use epcont_report_run, only: run_results
  use epcont_report_scene_text, only: deeper
  use epcont_report_summary, only: summary_type
  use epcont_report_tables, only: put_bodies, put_contact, put_elements, put_history, put_lines, put_nodes, &
                                  put_pivots, put_zones
  implicit none
  private
  public :: write_listing

contains

  !> Write all that is known of a run.
  subroutine write_listing(run, summary, nodes, elements, path, error)
    type(run_results), intent(in) :: run                  !! what is known of the run
    type(summary_type), intent(in) :: summary             !! its figures
    logical, intent(in) :: nodes, elements                !! with tables of these
    character(len=*), intent(in) :: path                  !! of the file
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written
    type(table_type) :: listing
    character(len=:), allocatable :: plan
    integer :: k

    call new_text_file(path, listing, error)
    if (allocated(error)) return
    call list_deck()
    call list_cards(listing, run%deck)
    call list_remarks()
    plan = plan_text(run%planned_scene)
    call listing%line(plan(:len(plan) - 1))
    if (len(run%outcome%sentence) > 0) call list_fault()
    if (run%outcome%has_answer) then
      if (any([(run%model%can_yield(k), k=1, run%model%elements)])) call list_iterations()
      if (run%model%pairs > 0) call list_contact()
      if (nodes) call put_nodes(run, listing)
      if (elements) call put_elements(run, listing)
      call list_summary()
      if (run%certificate%scene%looked_through) call list_scene()
      call heading(listing, 'ACCURACY')
      call list_rounding()
      call list_mesh()
      call list_doubtful_elements()
      if (run%model%controls%accuracy > 0.0_wp) call list_wanted()
    end if
    call listing%finish(error)

  contains

    !> Title, and what the deck holds.
    subroutine list_deck()
      character(len=20) :: units

      call listing%line(program_name//' '//program_version// &
                        '   elastoplastic contact of plane bodies and rings')
      call listing%line('')
      associate (deck => run%deck)
        if (len(deck%title) > 0) call listing%line('  '//printable(deck%title))
        if (len(deck%subtitle) > 0) call listing%line('  '//printable(deck%subtitle))
        if (len(deck%label) > 0) call listing%line('  '//printable(deck%label))
        units = deck%parameter_word('UNITS', '')
        if (units == '') units = 'as the deck has them'
        call listing%line('  units: '//units)
        call heading(listing, 'DECK')
        do k = 1, size(deck%card)
          if (deck%card(k)%count > 0) &
            call listing%line('  '//deck%card(k)%entry%name//'  '//right(text_of(deck%card(k)%count), 9))
        end do
      end associate
    end subroutine list_deck

    !> Warnings and notes of the deck and its answer.
    subroutine list_remarks()
      character(len=:), allocatable :: text
      integer :: from, to

      associate (remarks => run%remarks)
        if (remarks%warnings + remarks%notes == 0) return
        call heading(listing, 'WARNINGS AND NOTES  ('//plural(remarks%warnings, 'warning')//', '// &
                     plural(remarks%notes, 'note')//')')
        text = remarks%of_deck//remarks%of_answer//remarks%noted
      end associate
      from = 1
      do while (from <= len(text))
        to = from + index(text(from:), newline) - 1
        call wrap(listing, '  '//text(from:to - 1))
        from = to + 1
      end do
    end subroutine list_remarks

    !> Why the answer is not valid; the headings that follow say so too.
    subroutine list_fault()
      call listing%line('')
      listing%mark = '  *NOT VALID: '//run%outcome%word//'*'
      call wrap(listing, '  *NOT VALID*  '//run%outcome%word//': '//run%outcome%sentence)
    end subroutine list_fault

    !> One line a solve, and what is to be known of the yielding.
    subroutine list_iterations()
      call put_history(run, listing)
      call listing%line('')
      associate (answer => run%answer)
        if (answer%load_steps > answer%asked_load_steps) &
          call listing%line('  in '//plural(answer%asked_load_steps, 'load step')// &
                            ' no answer was found; tried again in '//text_of(answer%load_steps)//' (AUTO)')
        if (any(answer%history%by_tangent)) call listing%line( &
          '  the last step is one by the tangent: its change is what the others have left')
        call listing%line('  '//plural(count(answer%plastic), 'element')//' of '// &
                          text_of(run%model%elements)//' beyond the yield point')
        call list_elements('beyond the last point of its table, whose last slope goes on', &
                           count(answer%beyond), findloc(answer%beyond, .true., dim=1))
        call list_elements('the strain fell as the load grew, and went back along the curve '// &
                           '(elastic unloading is not modelled)', answer%unloaded, answer%first_unloaded)
      end associate
    end subroutine list_iterations

    !> A number of elements, and one of them.
    subroutine list_elements(what, count, first)
      character(len=*), intent(in) :: what
      integer, intent(in) :: count, first

      if (count > 0) call listing%line('  '//what//': element '//text_of(run%model%element_id(first))// &
                                       when(count > 1, ' and '//text_of(count - 1)//' more'))
    end subroutine list_elements

    !> The pairs, how the set of contacts was found, and what contact makes of zones, lines and bodies.
    subroutine list_contact()
      character(len=:), allocatable :: text

      call put_contact(run, listing)
      call listing%line('')
      associate (contact => run%answer%contact)
        text = '  '//plural(contact%pivots, 'pivot')//', '//text_of(contact%degenerate_pivots)// &
               ' degenerate'//when(contact%block_steps > 0, ' (CONRY, after '// &
                                   plural(contact%block_steps, 'set')//' of block pivoting)')
        if (contact%by_blocks) text = '  block pivoting: '//plural(contact%block_steps, 'set')//', '// &
                                      plural(contact%pivots, 'exchange')//' of pairs'
        call listing%line(text//when(size(run%answer%history) > 1, ', in the last solve'))
        if (size(contact%history) > 0) call put_pivots(run, listing)
        if (size(contact%history) > 0 .and. contact%pivots > size(contact%history)) &
          call listing%line('  and '//text_of(contact%pivots - size(contact%history))//' more')
      end associate
      call put_zones(run, listing)
      if (size(run%answer%lines) > 0) call put_lines(run, listing)
      call put_bodies(run, listing)
    end subroutine list_contact

    !> Summary and certificate.
    subroutine list_summary()
      call heading(listing, 'SUMMARY')
      if (run%model%pairs > 0) call summary%list(listing, [character(len=19) :: &
        'max_pressure', 'total_contact_force', 'pairs_in_contact'])
      call summary%list(listing, ['approach_'])
      if (any(run%answer%plastic)) call summary%list(listing, ['plastic_elements'])
      call summary%list(listing, [character(len=21) :: 'max_equivalent_stress', 'max_displacement', 'status'])
      call heading(listing, 'CERTIFICATE  (recomputed from displacements and forces alone; tolerance '// &
                   short_real(run%certificate%tolerance)//')')
      call summary%list(listing, [character(len=25) :: 'equilibrium_residual', 'smallest_', &
        'largest_force_gap_product', 'stress_off_curve', 'curve_tolerance', 'stress_off_curve_limit', &
        'energy_balance'])
    end subroutine list_summary

    !> Bodies in each other and pairs that press across gaps: the worst, and the deepest where that differs.
    subroutine list_scene()
      associate (scene => run%certificate%scene)
        call list_place('bodies in each other, of what is allowed', scene%inside)
        if (scene%deepest%ratio >= little .and. scene%deepest%depth > deeper*scene%inside%depth) &
          call list_place('  at the deepest place, of what is allowed', scene%deepest)
        if (scene%passed%side > 0) call list_place('  on their way through each other', scene%passed)
        if (run%model%pairs == 0) return
        call list_place('pressed across a gap, of what is allowed', scene%apart)
        if (scene%widest%ratio >= little .and. scene%widest%depth > deeper*scene%apart%depth) &
          call list_place('  at the widest place, of what is allowed', scene%widest)
        if (scene%beside%ratio >= little) call list_place('  beside the other body', scene%beside)
      end associate
    end subroutine list_scene

    !> A depth, over what is allowed; and where.
    subroutine list_place(name, place)
      character(len=*), intent(in) :: name
      type(overlap_place), intent(in) :: place

      if (place%ratio < little) then
        call figure(listing, name, '< '//short_real(little))
      else
        call figure(listing, name, estimate_number(place%ratio), &
                    '   '//short_real(place%depth)//' at '//point_name(place%x))
      end if
    end subroutine list_place

    !> What stopping and rounding leave.
    subroutine list_rounding()
      logical :: in_single

      associate (answer => run%answer, sensitivity => run%accuracy%sensitivity)
        in_single = answer%precision == precision_single
        if (size(answer%history) > 1) call summary%list(listing, ['iteration_error_displacement'])
        if (size(answer%history) > 1 .and. run%model%pairs > 0) &
          call summary%list(listing, ['iteration_error_force'])
        call summary%list(listing, ['condition'])
        if (in_single) call figure(listing, 'error that single precision leaves', &
                                   short_real(answer%rounding_error))
        if (answer%precision /= answer%asked_precision) call listing%line( &
          '    (factors in double: in single precision '// &
          when(answer%asked_precision == precision_single, 'they left an error of more than '// &
               short_real(answer%largest_rounding_error)//', or no answer)', &
               'there was no answer that refinement could reach)'))
        if (.not. in_single) call figure(listing, 'digits that rounding leaves, at least', &
                                         text_of(max(0, floor(-log10(answer%rounding())))))
        call figure(listing, 'linear residual', rounding_number(run%certificate%equilibrium))
        if (sensitivity%known .and. .not. in_single) &
          call figure(listing, 'rounding in the contact forces, at most', &
                      rounding_number(sensitivity%rounding), '   of the largest')
      end associate
    end subroutine list_rounding

    !> What the mesh leaves, and the pairs that may as well be open, or touch.
    subroutine list_mesh()
      call summary%list(listing, [character(len=21) :: 'contact_amplification', 'mesh_error_'])
      associate (accuracy => run%accuracy, touching => run%answer%contact%touching)
        if (size(accuracy%worst) > 0) &
          call listing%line('  refine first: element '//joined(run%model%element_id(accuracy%worst), ' ')// &
                            ', the first at '//centre_name(run%model, accuracy%worst(1))//'; '// &
                            percent(sum(accuracy%element(accuracy%worst)), sum(accuracy%element))// &
                            ' of the error')
        if (.not. any(accuracy%weak)) return   ! nor is it known of each pair
        call list_pairs('pressed by less than the error of the force', accuracy%weak .and. touching)
        call list_pairs('open by less than the error of the gap', accuracy%weak .and. .not. touching)
      end associate
    end subroutine list_mesh

    !> Some pairs, if there are any.
    subroutine list_pairs(what, chosen)
      character(len=*), intent(in) :: what
      logical, intent(in) :: chosen(:)

      if (any(chosen)) call listing%line('  '//what//', '//plural(count(chosen), 'pair')//': '// &
                                         joined(pack(run%model%pair_id, chosen), ' ', most_pairs))
    end subroutine list_pairs

    !> Elements that are too stiff for what their material does, and displacements that are not small.
    subroutine list_doubtful_elements()
      associate (locking => run%answer%locking, gradient => run%answer%gradient)
        if (locking%elements > 0) then
          call figure(listing, 'three-node elements of constant volume', text_of(locking%elements))
          call figure(listing, 'scatter of their mean stress / equivalent', &
                      listed_number(number, locking%scatter, 1.0_wp))
          call listing%line('    ('//poisson_text(run%answer)// &
                            ': they are too stiff there; six-node elements and CQUAD4 are not)')
        end if
        if (gradient%part > 0.0_wp) then
          call figure(listing, 'not small: turned, stretched by over 0.1', &
                      listed_number(part, gradient%part, 0.0_wp), '   of the volume')
          call listing%line('    (most at '//centre_name(run%model, gradient%worst)//', '// &
                            estimate_number(gradient%largest)//'; equilibrium and contact are those of '// &
                            'the undeformed shape: loads, moduli, units?)')
        end if
      end associate
    end subroutine list_doubtful_elements

    !> The wish, and what stands in its way: PARAM ACCURACY sets the solution, but the mesh has the last word.
    subroutine list_wanted()
      real(wp) :: left

      associate (wish => run%model%controls%accuracy, accuracy => run%accuracy)
        call figure(listing, 'wanted error of contact pressures', short_real(wish))
        left = accuracy%max_pressure/maxval(run%answer%pressure)
        if (accuracy%pressure_unbounded) then
          call listing%line( &
            '    not to be had: the largest pressure is unbounded: it grows with every finer mesh')
        else if (accuracy%max_pressure < 0.0_wp .or. .not. any(run%answer%contact%force > 0.0_wp)) then
          call listing%line( &
            '    (of the mesh''s error nothing is known: no pressure, or too few pairs in contact)')
        else if (left > wish) then
          call listing%line('    not reached: the mesh, not the dial, is the limit: its error is '// &
                            'estimated at '//estimate_number(left)//'; refine the elements named above')
        else
          call listing%line('    reached: the error of the mesh is estimated at '//estimate_number(left))
        end if
      end associate
    end subroutine list_wanted
  end subroutine write_listing
end module epcont_report_listing
