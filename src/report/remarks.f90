!> Warnings and notes of a run: what the deck has that is not as it seems, and what of the answer is not as it
!> should be. They stand in the listing, are counted in the summary, and warnings go to standard error too.
module epcont_report_remarks
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_tolerances, only: alike
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_render, only: render_notes
  use epcont_deck_source, only: source
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: heading, newline, wrap
  use epcont_report_names, only: centre_name, grid_name, motion_name
  use epcont_report_run, only: remarks_type, run_results
  use epcont_report_scene_text, only: scene_warning, scene_warnings, side_changed
  use epcont_result_answer, only: answer_type
  use epcont_result_locking, only: high_poisson
  implicit none
  private
  public :: remarks_of_deck, remark_answer, list_remarks, poisson_text

  character(len=*), parameter :: warning = 'warning: '

contains

  !> Those of the deck.
  pure function remarks_of_deck(faults, lines) result(remarks)
    type(diagnostics), intent(in) :: faults   !! found in the deck, none of them an error
    type(source), intent(in) :: lines         !! of the deck
    type(remarks_type) :: remarks

    remarks%warnings = faults%warning_count()
    remarks%notes = faults%note_count()
    remarks%of_deck = render_notes(faults, lines)
    remarks%of_answer = ''
    remarks%noted = ''
  end function remarks_of_deck

  !> Add those of an answer: where its equations, solved as they are, are not those of the scene.
  pure subroutine remark_answer(run)
    type(run_results), intent(inout) :: run   !! what is known of the run; its remarks are added to
    integer :: k

    call warn(nothing_touches(run), run%remarks)
    do k = 1, scene_warnings
      if (k == side_changed .and. run%answer%gradient%part > 0.0_wp) then
        call warn(not_small(run), run%remarks)
      else
        call warn(scene_warning(run%model, run%certificate%scene, k), run%remarks)
      end if
    end do
    call warn_of_material(run%answer, run%remarks)
    associate (vague => count(run%answer%contact%indeterminate))
      if (vague > 0) &
        call warn('the forces of '//plural(vague, 'pair')//' are one choice of many, and so are their '// &
                  'pressures: pairs at one place, or parts that cannot bend '// &
                  '(`force not unique` in CONTACT)', run%remarks)
    end associate
    do k = 1, run%motions%count
      if (.not. run%answer%contact%motion_free(k)) cycle
      run%remarks%notes = run%remarks%notes + 1
      run%remarks%noted = run%remarks%noted//'approach of '//motion_name(run, k)// &
                          ': nothing resists or drives this motion: its value is a choice'//newline
    end do
  end subroutine remark_answer

  !> Elements that are too stiff, strained too far, or unloaded.
  pure subroutine warn_of_material(answer, remarks)
    type(answer_type), intent(in) :: answer
    type(remarks_type), intent(inout) :: remarks

    if (answer%locking%elements > 0) call warn(plural(answer%locking%elements, 'three-node element')// &
      ' of nearly constant volume ('//poisson_text(answer)// &
      '): too stiff; six-node elements or CQUAD4 would be right', remarks)
    if (any(answer%beyond)) call warn(plural(count(answer%beyond), 'element')// &
      ' strained beyond the last point of the table, whose last slope goes on', remarks)
    if (answer%unloaded > 0) call warn(plural(answer%unloaded, 'element')// &
      ' unloaded after yielding: the theory takes them back along the curve, not along the elastic line', &
      remarks)
  end subroutine warn_of_material

  !> From which Poisson's ratio on three-node elements lock, and why they have it.
  pure function poisson_text(answer) result(text)
    type(answer_type), intent(in) :: answer   !! the answer
    character(len=:), allocatable :: text

    text = 'Poisson''s ratio '//short_real(high_poisson)//' or more'
    if (any(answer%plastic)) text = text//', as yielding has made it'
  end function poisson_text

  !> Add a warning; an empty text is none.
  pure subroutine warn(text, remarks)
    character(len=*), intent(in) :: text
    type(remarks_type), intent(inout) :: remarks

    if (len(text) == 0) return
    remarks%warnings = remarks%warnings + 1
    remarks%of_answer = remarks%of_answer//warning//text//newline
  end subroutine warn

  !> No pair closes; empty: some do, or there are none.
  pure function nothing_touches(run) result(text)
    type(run_results), intent(in) :: run
    character(len=:), allocatable :: text

    text = ''
    associate (model => run%model, contact => run%answer%contact)
      if (model%pairs == 0 .or. any(contact%touching)) return
      ! Of gaps that are as good as equal the first: rounding chooses no pair.
      associate (nearest => findloc(contact%gap <= (1.0_wp + alike)*minval(contact%gap), .true., dim=1))
        text = 'nothing touches: no pair carries a force; nearest is '// &
               grid_name(model, model%pair_node(1, nearest))// &
               ', '//short_real(contact%gap(nearest))//' away'
      end associate
    end associate
  end function nothing_touches

  !> Displacements that are not small.
  pure function not_small(run) result(text)
    type(run_results), intent(in) :: run
    character(len=:), allocatable :: text

    associate (gradient => run%answer%gradient)
      text = 'displacements are not small: '//text_of(nint(100.0_wp*gradient%part))// &
             ' % of the volume turned or stretched by over 0.1, most at '// &
             centre_name(run%model, gradient%worst)// &
             '; equilibrium and contact are those of the undeformed shape'
    end associate
  end function not_small

  !> The section of the listing; none where there is nothing to say.
  subroutine list_remarks(file, remarks)
    type(text_file), intent(in) :: file         !! the listing
    type(remarks_type), intent(in) :: remarks   !! of the deck and its answer
    character(len=:), allocatable :: text
    integer :: from, to

    if (remarks%warnings + remarks%notes == 0) return
    call heading(file, 'WARNINGS AND NOTES  ('//plural(remarks%warnings, 'warning')//', '// &
                 plural(remarks%notes, 'note')//')')
    text = remarks%of_deck//remarks%of_answer//remarks%noted
    from = 1
    do while (from <= len(text))
      to = from + index(text(from:), newline) - 1
      call wrap(file, '  '//text(from:to - 1))
      from = to + 1
    end do
  end subroutine list_remarks
end module epcont_report_remarks
