!> Warnings and notes of a run: what the deck has that is not as it seems, and what of the answer is not as it
!> should be. They stand in the listing, are counted in the summary, and warnings go to standard error too.
module epcont_report_remarks
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_base_tolerances, only: alike
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_render, only: render_notes
  use epcont_deck_source, only: source
  use epcont_model_finding, only: of_node
  use epcont_report_layout, only: newline
  use epcont_report_names, only: centre_name, motion_name, when
  use epcont_report_run, only: remarks_type, run_results
  use epcont_report_scene_text, only: scene_sentence, scene_warnings, side_changed
  use epcont_result_answer, only: answer_type
  use epcont_result_locking, only: high_poisson
  implicit none
  private
  public :: remarks_of_deck, remark_answer, poisson_text

contains

  !> Those of the deck.
  pure function remarks_of_deck(faults, lines) result(remarks)
    type(diagnostics), intent(in) :: faults   !! found in the deck, none of them an error
    type(source), intent(in) :: lines         !! of the deck
    type(remarks_type) :: remarks

    remarks = remarks_type(faults%warnings, faults%notes, render_notes(faults, lines), '', '')
  end function remarks_of_deck

  !> Add those of an answer: where its equations, solved as they are, are not those of the scene.
  subroutine remark_answer(run)
    type(run_results), intent(inout) :: run   !! what is known of the run; its remarks are added to
    integer :: k

    call warn_of_contact()
    do k = 1, scene_warnings
      if (k == side_changed .and. run%answer%gradient%part > 0.0_wp) then
        call warn_of_displacements()
      else
        call warn(scene_sentence(run%model, run%certificate%scene, k))
      end if
    end do
    call warn_of_material()
    associate (vague => count(run%answer%contact%indeterminate))
      if (vague > 0) call warn('the forces of '//plural(vague, 'pair')//' are one choice of many, and so '// &
        'are their pressures: pairs at one place, or parts that cannot bend (`force not unique` in CONTACT)')
    end associate
    do k = 1, run%motions%count
      if (.not. run%answer%contact%motion_free(k)) cycle
      run%remarks%notes = run%remarks%notes + 1
      run%remarks%noted = run%remarks%noted//'approach of '//motion_name(run, k)// &
                          ': nothing resists or drives this motion: its value is a choice'//newline
    end do

  contains

    !> Add a warning; an empty text is none.
    subroutine warn(text)
      character(len=*), intent(in) :: text

      if (len(text) == 0) return
      run%remarks%warnings = run%remarks%warnings + 1
      run%remarks%of_answer = run%remarks%of_answer//'warning: '//text//newline
    end subroutine warn

    !> No pair closes.
    subroutine warn_of_contact()
      integer :: nearest

      associate (model => run%model, contact => run%answer%contact)
        if (model%pairs == 0 .or. any(contact%touching)) return
        ! Of gaps that are as good as equal the first: rounding chooses no pair.
        nearest = findloc(contact%gap <= (1.0_wp + alike)*minval(contact%gap), .true., dim=1)
        call warn('nothing touches: no pair carries a force; nearest is '// &
                  model%name_of(of_node, model%pair_node(1, nearest))//', '// &
                  short_real(contact%gap(nearest))//' away')
      end associate
    end subroutine warn_of_contact

    !> They are not small.
    subroutine warn_of_displacements()
      associate (gradient => run%answer%gradient)
        call warn('displacements are not small: '//text_of(nint(100.0_wp*gradient%part))// &
                  ' % of the volume turned or stretched by over 0.1, most at '// &
                  centre_name(run%model, gradient%worst)// &
                  '; equilibrium and contact are those of the undeformed shape')
      end associate
    end subroutine warn_of_displacements

    !> Elements that are too stiff, strained too far, or unloaded.
    subroutine warn_of_material()
      associate (answer => run%answer)
        if (answer%locking%elements > 0) &
          call warn(plural(answer%locking%elements, 'three-node element')//' of nearly constant volume ('// &
                    poisson_text(answer)//'): too stiff; six-node elements or CQUAD4 would be right')
        if (any(answer%beyond)) &
          call warn(plural(count(answer%beyond), 'element')// &
                    ' strained beyond the last point of the table, whose last slope goes on')
        if (answer%unloaded > 0) &
          call warn(plural(answer%unloaded, 'element')//' unloaded after yielding: '// &
                    'the theory takes them back along the curve, not along the elastic line')
      end associate
    end subroutine warn_of_material
  end subroutine remark_answer

  !> From which Poisson's ratio on three-node elements lock, and why they have it.
  pure function poisson_text(answer) result(text)
    type(answer_type), intent(in) :: answer   !! the answer
    character(len=:), allocatable :: text

    text = 'Poisson''s ratio '//short_real(high_poisson)//' or more'// &
           when(any(answer%plastic), ', as yielding has made it')
  end function poisson_text
end module epcont_report_remarks
