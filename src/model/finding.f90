!> Errors and warnings of a model, collected to report all of them at once. For a model made from arrays, the
!> first error is returned as a sentence; for one made from a deck, each names its card and
!> field.
module epcont_model_finding
  use epcont_base_diagnostic, only: findings => diagnostics
  use epcont_base_text, only: text_of
  implicit none
  private
  public :: findings, and_more

  !> Items of the model data that a finding can be about; a finding also has the position of the item. A body
  !! is known by one of its nodes, and named in the sentence. The text of a finding continues after the name
  !! of the item: `: lies on the axis`.
  integer, parameter, public :: of_scene = 0, of_node = -1, of_element = -2, of_section = -3, of_pair = -4, &
    of_line = -5, of_couple = -6, of_paper_ratio = -7, of_body = -8, of_body_load = -9, of_equation = -10, &
    of_theory = -11, of_tie = -12, of_reference = -13, of_spring = -14, of_platen = -15, of_pressure = -16

  !> Parts of an item. By default, a number is a column of its card (0: all, 1: the id), and -k is the k-th
  !! entry of its list (of an element: node k of the model). Parts of sections and body loads are named here;
  !! the part of a SUPORT DOF is its component, that of a spring is the end whose component is meant.
  integer, parameter, public :: item_density = 1, item_hardening = 2, &
    item_acceleration = 1, item_centre = 2, item_spin_up = 3

contains

  !> Number of items not named: `; so do 3 more`; empty if there is only one.
  pure function and_more(count, before, behind) result(text)
    integer, intent(in) :: count                    !! all, including the named one
    character(len=*), intent(in) :: before, behind  !! words around the number
    character(len=:), allocatable :: text

    text = ''
    if (count > 1) text = before//text_of(count - 1)//behind
  end function and_more
end module epcont_model_finding
