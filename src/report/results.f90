!> All that a run writes: the listing, and the tables beside it.
module epcont_report_results
  use epcont_base_error, only: error_type
  use epcont_report_columns, only: table_type
  use epcont_report_file, only: new_text_file, remove_file
  use epcont_report_listing, only: write_listing
  use epcont_report_run, only: run_results
  use epcont_report_summary, only: summarise, summary_type
  use epcont_report_tables, only: put_bodies, put_contact, put_elements, put_history, put_nodes, &
                                  put_pivots, put_zones
  use epcont_report_vtk, only: write_vtk_bodies, write_vtk_contact
  implicit none
  private
  public :: write_results, remove_results, result_file

  !> A file of results: what stands behind the name of the deck, and what it holds.
  type :: result_file
    character(len=14) :: suffix
    character(len=76) :: text
  end type result_file

  type(result_file), parameter, public :: result_files(*) = [ &
    result_file('.lst', 'the listing, for people and for diffing: the same bytes on every run'), &
    result_file('.summary.csv', &
                'outcome, approaches, certificate and accuracy, in 17 digits like all tables'), &
    result_file('.contact.csv', 'the pairs'), &
    result_file('.zones.csv', 'runs of touching pairs'), &
    result_file('.bodies.csv', 'what contact exerts on each body'), &
    result_file('.history.csv', 'the iterations'), &
    result_file('.pivots.csv', 'the pivots of each iteration''s simplex, with --tables all'), &
    result_file('.nodes.csv', 'the nodes, where the deck or --tables all asks for it'), &
    result_file('.elements.csv', 'the elements, where the deck or --tables all asks for it'), &
    result_file('.vtu', 'the bodies, for ParaView, with --vtk: displacements, stresses, states'), &
    result_file('.contact.vtu', 'the boundary in contact, for ParaView, with --vtk: pressures, gaps')]

contains

  !> The listing and the tables; those of nodes and elements where the deck, or `all_tables`, asks for them.
  !! With `vtk` also files for ParaView.
  subroutine write_results(run, stem, all_tables, vtk, error)
    type(run_results), intent(in) :: run                  !! what is known of the run
    character(len=*), intent(in) :: stem                  !! path of the files, without their suffixes
    logical, intent(in) :: all_tables, vtk                !! asked for on the command line
    type(error_type), allocatable, intent(out) :: error   !! the file cannot be written
    type(summary_type) :: summary
    logical :: nodes, elements

    call remove_results(stem)
    nodes = all_tables .or. run%deck%displacement .or. run%deck%spcforces
    elements = all_tables .or. run%deck%stress
    summary = summarise(run)
    call write_listing(run, summary, nodes, elements, stem//'.lst', error)
    if (.not. allocated(error)) call summary%write_file(stem//'.summary.csv', error)
    if (.not. run%outcome%has_answer) return
    call write_table('.contact.csv', put_contact)
    call write_table('.zones.csv', put_zones)
    if (run%model%pairs > 0) call write_table('.bodies.csv', put_bodies)
    call write_table('.history.csv', put_history)
    if (all_tables .and. run%model%pairs > 0) call write_table('.pivots.csv', put_pivots)
    if (nodes) call write_table('.nodes.csv', put_nodes)
    if (elements) call write_table('.elements.csv', put_elements)
    if (vtk .and. .not. allocated(error)) call write_vtk_bodies(run, stem//'.vtu', error)
    if (vtk .and. .not. allocated(error) .and. run%model%pairs > 0) &
      call write_vtk_contact(run, stem//'.contact.vtu', error)

  contains

    !> A table in a file of its own, where all has gone well so far.
    subroutine write_table(suffix, put)
      character(len=*), intent(in) :: suffix
      procedure(put_contact) :: put
      type(table_type) :: table

      if (allocated(error)) return
      call new_text_file(stem//suffix, table, error)
      if (allocated(error)) return
      table%listed = .false.
      call put(run, table)
      call table%finish(error)
    end subroutine write_table
  end subroutine write_results

  !> Remove what an earlier run has left: what is there is of one run, also where this one is stopped, or has
  !! nothing to say.
  subroutine remove_results(stem)
    character(len=*), intent(in) :: stem   !! path of the files, without their suffixes
    integer :: i

    do i = 1, size(result_files)
      call remove_file(stem//trim(result_files(i)%suffix))
    end do
  end subroutine remove_results
end module epcont_report_results
