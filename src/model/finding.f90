!> What is wrong with a scene, or looks so: collected, so that one look finds all of it. Of a scene made from
!> arrays the first error is told in a sentence; of one made from a deck everything has its place among the
!> cards.
module epcont_model_finding
  use epcont_base_diagnostic, only: findings => diagnostics
  use epcont_base_text, only: text_of
  implicit none
  private
  public :: findings, and_more

  !> What a finding is of, by its position in the model. PARAM MUP and THEORY are of their own; a body, by one
  !! of its nodes, is named in what is said of it. Of its data the fields of its card are known by their
  !! columns: 0 all, 1 the id; -k: the k-th of its list, of an element the node k of the model. What is wrong
  !! goes on behind its name: `: lies on the axis`.
  integer, parameter, public :: of_scene = 0, of_node = -1, of_element = -2, of_section = -3, of_pair = -4, &
    of_line = -5, of_couple = -6, of_paper_ratio = -7, of_body = -8, of_body_load = -9, of_equation = -10, &
    of_theory = -11

contains

  !> How many more there are than the one that is named: `; so do 3 more`; empty where it is the only one.
  pure function and_more(count, before, behind) result(text)
    integer, intent(in) :: count                    !! all, the one included
    character(len=*), intent(in) :: before, behind  !! words around the number
    character(len=:), allocatable :: text

    text = ''
    if (count > 1) text = before//text_of(count - 1)//behind
  end function and_more
end module epcont_model_finding
