!> Warnings and notes of a run: what the deck has that is not as it seems, and what of the answer is not as it should be. They stand
!> in the listing, are counted in the summary, and warnings go to standard error too.
module epcont_report_remarks
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: plural, short_real, text_of
  use epcont_certificate_scene, only: scene_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_deck_render, only: render_notes
  use epcont_deck_source, only: source
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_report_file, only: text_file
  use epcont_report_layout, only: heading, newline, wrap
  use epcont_report_scene_text, only: changed_text, deep_text, drawn_text, itself_text, mirror_text, slid_text, wide_text
  use epcont_result_answer, only: answer_type
  use epcont_result_locking, only: high_poisson
  implicit none
  private
  public :: remarks_type, remarks_of_deck, remark_answer, list_remarks

  type :: remarks_type
    integer :: warnings = 0, notes = 0
    character(len=:), allocatable :: of_deck     !! in lines; of warnings the place is followed by `warning: `
    character(len=:), allocatable :: of_answer   !! in lines, each a warning
    character(len=:), allocatable :: noted       !! notes of the answer, in lines
  end type remarks_type

  character(len=*), parameter :: warning = 'warning: '
  !> Gaps that differ by less than this part are equally near.
  real(wp), parameter :: as_good = 1.0e-6_wp

contains

  !> Those of the deck.
  pure function remarks_of_deck(faults, lines) result(remarks)
    type(diagnostics), intent(in) :: faults
    type(source), intent(in) :: lines
    type(remarks_type) :: remarks

    remarks%warnings = faults%warning_count()
    remarks%notes = faults%note_count()
    remarks%of_deck = render_notes(faults, lines)
    remarks%of_answer = ''
    remarks%noted = ''
  end function remarks_of_deck

  !> Add those of an answer: where its equations, solved as they are, are not those of the scene.
  pure subroutine remark_answer(model, motions, answer, scene, remarks)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(scene_type), intent(in) :: scene
    type(remarks_type), intent(inout) :: remarks
    integer :: k

    call warn(nothing_touches(model, answer), remarks)
    call warn(itself_text(model, scene), remarks)
    call warn(mirror_text(model, scene), remarks)
    call warn(drawn_text(model, scene), remarks)
    call warn(deep_text(model, scene), remarks)
    call warn(wide_text(model, scene), remarks)
    if (answer%gradient%part > 0.0_wp) then
      call warn(not_small(model, answer), remarks)
    else
      call warn(changed_text(model, scene), remarks)
    end if
    call warn(slid_text(model, scene), remarks)
    if (answer%locking%elements > 0) call warn(plural(answer%locking%elements, 'three-node element')// &
      ' of nearly constant volume (Poisson''s ratio '//short_real(high_poisson)// &
      ' or more'//trim(merge(', as yielding has made it', repeat(' ', 25), any(answer%plastic)))// &
      '): too stiff; six-node elements or CQUAD4 would be right', remarks)
    if (any(answer%beyond)) call warn(plural(count(answer%beyond), 'element')// &
      ' strained beyond the last point of the table, whose last slope goes on', remarks)
    if (answer%unloaded > 0) call warn(plural(answer%unloaded, 'element')// &
      ' unloaded after yielding: the theory takes them back along the curve, not along the elastic line', remarks)
    if (any(answer%contact%indeterminate)) call warn('the forces of '// &
      plural(count(answer%contact%indeterminate), 'pair')//' are one choice of many, and so are their pressures: pairs at one'// &
      ' place, or parts that cannot bend (`force not unique` in CONTACT)', remarks)
    do k = 1, motions%count
      if (.not. answer%contact%motion_free(k)) cycle
      remarks%notes = remarks%notes + 1
      remarks%noted = remarks%noted//'approach of GRID '//text_of(model%node_id(motions%node(k)))//' direction '// &
                      text_of(motions%component(k))//': nothing resists or drives this motion: its value is a choice'//newline
    end do
  end subroutine remark_answer

  !> Add a warning; an empty text is none.
  pure subroutine warn(text, remarks)
    character(len=*), intent(in) :: text
    type(remarks_type), intent(inout) :: remarks

    if (len(text) == 0) return
    remarks%warnings = remarks%warnings + 1
    remarks%of_answer = remarks%of_answer//warning//text//newline
  end subroutine warn

  !> No pair closes; empty: some do, or there are none.
  pure function nothing_touches(model, answer) result(text)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    character(len=:), allocatable :: text

    text = ''
    associate (contact => answer%contact)
      if (model%pairs == 0 .or. any(contact%touching)) return
      ! Of gaps that are as good as equal the first: rounding chooses no pair.
      associate (nearest => findloc(contact%gap <= (1.0_wp + as_good)*minval(contact%gap), .true., dim=1))
        text = 'nothing touches: no pair carries a force; nearest is GRID '//text_of(model%node_id(model%pair_node(1, nearest)))// &
               ', '//short_real(contact%gap(nearest))//' away'
      end associate
    end associate
  end function nothing_touches

  pure function not_small(model, answer) result(text)
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    character(len=:), allocatable :: text
    character(len=12) :: part
    real(wp) :: centre(2)

    associate (gradient => answer%gradient)
      centre = sum(model%coordinates(gradient%worst), dim=2)/model%order(gradient%worst)
      write (part, '(i0)') nint(100.0_wp*gradient%part)
      text = 'displacements are not small: '//trim(part)//' % of the volume turned or stretched by over 0.1, most at '// &
             short_real(centre(1))//' '//short_real(centre(2))//'; equilibrium and contact are those of the undeformed shape'
    end associate
  end function not_small

  !> The section of the listing; none where there is nothing to say.
  subroutine list_remarks(file, remarks)
    type(text_file), intent(in) :: file
    type(remarks_type), intent(in) :: remarks
    character(len=:), allocatable :: text
    integer :: from, to

    if (remarks%warnings + remarks%notes == 0) return
    call heading(file, 'WARNINGS AND NOTES  ('//plural(remarks%warnings, 'warning')//', '//plural(remarks%notes, 'note')//')')
    text = remarks%of_deck//remarks%of_answer//remarks%noted
    from = 1
    do while (from <= len(text))
      to = from + index(text(from:), newline) - 1
      call wrap(file, '  '//text(from:to - 1))
      from = to + 1
    end do
  end subroutine list_remarks
end module epcont_report_remarks
