!> The scene made complete: from what is given of it, by a deck or by arrays, to a model that is checked and
!> can be solved.
!>
!> From arrays: `new_scene` of the nodes, `set_sections`, `add_elements`, `set_pairs` (epcont_model_given); in
!> the components of the model, where there are any, supports (held, prescribed), ties (leader), reference
!> freedoms, loads, curves, lines of nodes (line) and which of these may touch (couple), and what a deck says
!> by PARAM (controls). Nodes are known by their columns. `complete_model` checks it all and finds the rest.
!> Pressures come last (add_pressure).
module epcont_contact_geometry_complete
  use epcont_base_diagnostic, only: severity_error
  use epcont_base_error, only: error_type, raise, status_deck
  use epcont_contact_geometry_line_contacts, only: find_contacts
  use epcont_contact_geometry_loose_nodes, only: warn_of_hanging_nodes, warn_of_lying_together
  use epcont_contact_geometry_pair_checks, only: check_pairs
  use epcont_element_kinematics, only: components, directions, plane_strain
  use epcont_geometry_outline_shape, only: new_outline_shape, outline_shape
  use epcont_model_controls, only: method_newton
  use epcont_model_element_shapes, only: check_axis, complete_elements, warn_of_elements_twice
  use epcont_model_finding, only: findings, of_node, of_paper_ratio, of_scene, of_section
  use epcont_model_freedoms, only: find_travels, follow_to_the_end, set_reference, tie
  use epcont_model_given, only: check_given
  use epcont_model_model, only: model_type
  use epcont_model_single_pairs, only: complete_pairs
  implicit none
  private
  public :: complete_model, is_complete, raise_first, check_controls, finish_model

contains

  !> A model made from arrays, checked and made complete.
  subroutine complete_model(model, found, error)
    type(model_type), intent(inout) :: model   !! what is given; read-only from then on
    type(findings), intent(out) :: found       !! all that is wrong with it, or looks so
    !> The first thing that is wrong: the model does not serve
    type(error_type), allocatable, intent(out) :: error

    if (is_complete(model)) &
      call found%add_error(of_scene, 0, 0, 'the scene is complete', 'complete_model once, on a new scene')
    if (found%errors == 0) call check_given(model, found)
    if (found%errors == 0) then
      call complete_elements(model, found)
      call complete_freedoms()
      call check_axis(model, found)
      call complete_pairs(model, .false., found)
      call find_contacts(model, found)
      call check_controls(model, found)
    end if
    if (found%errors == 0) call finish_model(model, found)
    call raise_first(model, found, error)

  contains

    !> Ties and reference freedoms, one by one: each is checked against those before it.
    subroutine complete_freedoms()
      integer :: c, i, leader(directions, model%nodes)

      leader = model%leader
      model%leader = spread([(i, i=1, model%nodes)], 1, directions)
      do i = 1, model%nodes
        do c = 1, directions
          if (leader(c, i) /= i) call tie(model, c, i, leader(c, i), [of_node, i, 0], found)
        end do
      end do
      call follow_to_the_end(model%leader)
      do i = 1, model%nodes
        do c = 1, directions
          if (model%reference(c, i)) call set_reference(model, c, i, [of_node, i, 0], found)
        end do
      end do
    end subroutine complete_freedoms
  end subroutine complete_model

  !> Has `complete_model` made all of the scene?
  pure logical function is_complete(model)
    type(model_type), intent(in) :: model   !! the scene

    is_complete = allocated(model%travel)
  end function is_complete

  !> The first error of what was found, as a sentence: `CTRIA3 5: its corners 1, 2 and 3 lie on one line
  !! (wanted: corners that span an area)`.
  pure subroutine raise_first(model, found, error)
    type(model_type), intent(in) :: model                 !! the scene
    type(findings), intent(in) :: found                   !! what is wrong with it
    type(error_type), allocatable, intent(out) :: error   !! there is one
    integer :: i

    do i = 1, found%count
      associate (one => found%list(i))
        if (one%severity /= severity_error) cycle
        call raise(error, status_deck, model%name_of(one%of, one%which)//one%what// &
                                       ' (wanted: '//one%remedy//')')
        return
      end associate
    end do
  end subroutine raise_first

  !> What a scene without errors must still be refused or warned of, and its travels.
  subroutine finish_model(model, found)
    type(model_type), intent(inout) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    type(outline_shape) :: drawn

    call check_pairs(model, found)
    call warn_of_elements_twice(model, found)
    call find_travels(model)
    drawn = new_outline_shape(model%body_outline, model%x)
    call warn_of_hanging_nodes(model, drawn, found)
    call warn_of_lying_together(model, drawn, found)
  end subroutine finish_model

  !> MUP PAPER is of the secant stiffness, and of plane strain.
  pure subroutine check_controls(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: s

    if (.not. model%controls%paper_ratio) return
    if (model%controls%method == method_newton) &
      call found%add_error(of_paper_ratio, 0, 2, ': PAPER does not go with METHOD NEWTON', &
                           'METHOD SECANT, MODSEC or INISTR, or MUP EXACT')
    do s = 1, size(model%curve)
      if (model%kinematics(s) == plane_strain .or. .not. allocated(model%curve(s)%strain)) cycle
      call found%add_error(of_paper_ratio, 0, 2, &
        ': formula (2-4) for Poisson''s ratio beyond yield (MUP PAPER) is of plane strain; '// &
        model%name_of(of_section, s)//' can yield, and is not', &
        'plane strain, or MUP EXACT (ORIGINAL takes PAPER)')
      return
    end do
  end subroutine check_controls
end module epcont_contact_geometry_complete
