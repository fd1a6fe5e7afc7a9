!> Messages for programs that build their models from arrays: names of cards become names of arrays.
module epcont_messages_array_words
  use epcont_base_diagnostic, only: diagnostic
  use epcont_base_text, only: text_of
  use epcont_model_finding, only: of_body_load, of_equation, of_node, of_paper_ratio, of_platen, &
      of_pressure, of_reference, of_spring, of_section, of_theory, of_tie
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: in_array_words, name_item

  !> Words of decks, each with its replacement for models from arrays. Phrases come before their words.
  character(len=56), parameter :: word(*) = [character(len=56) :: &
    'remove the MOMENT, SUPORT or SPC of its direction 6', 'use tie: it does not rotate', &
    'GA and GB are not the ends', 'its corners are not the ends', &
    'field 9 (CID) is blank', 'its normal is zero', &
    'give a CORD2R whose x-axis is the normal', 'give a normal', &
    'the x-axis of CID', 'the normal', &
    'with SPC1', '(held)', 'with SUPORT,', '(reference) at node,direction:', 'SUPORT', 'reference', &
    'an RBE2', 'a tie', 'RBE2', 'tie', 'GN', '`leader`', &
    'GA and GB', 'nodes A and B', 'of GA', 'of node A', 'of GB', 'of node B', &
    'GRID', 'node', 'CGAPs', 'pairs', 'CGAP', 'pair', &
    'BLSEG lines', 'lines', 'BLSEG', 'line', 'BCONP', 'couple', 'SLAVE', 'slave', 'MASTER', 'master', &
    'PSHELL', 'section', 'PSOLID', 'section', 'the MAT1', 'young', &
    'field 5 (N1)', 'acceleration(1)', 'field 3 (G)', 'centre(1)', 'field 12 (RACC)', 'spin_up', &
    'give a node on it, or leave it blank', 'give a centre on it', 'field 6 (RHO)', 'density', &
    'GRAV and RFORCE act', 'body_load acts', 'GRAV or RFORCE', 'body_load', &
    'the deck has no elements', 'there are no elements', &
    'elements, such as CTRIA3', 'elements: call add_elements', &
    ' (MUP PAPER)', '', &
    'MUP EXACT (ORIGINAL takes PAPER)', '.false.', 'MUP EXACT', '.false.', &
    'THEORY TOTAL', '.false.', 'MUP PAPER', 'paper_ratio', &
    'PARAM MAXIT', 'controls%most_iterations', 'METHOD', 'controls%method', '--memory', 'memory', &
    'load steps (NLPARM)', 'controls%load_steps', &
    '`force not unique` in CONTACT', 'answer%contact%indeterminate']

  !> Items that are known by their position in a list, and the names of these lists.
  integer, parameter :: listed(*) = [of_tie, of_platen, of_equation, of_spring, of_pressure, of_body_load]
  character(len=*), parameter :: list(*) = ['tie      ', 'platen   ', 'equation ', 'spring   ', 'pressure ', &
                                            'body_load']

contains

  !> Put the name of its array before a finding, and replace the words of decks.
  subroutine name_item(model, one)
    type(model_type), intent(in) :: model    !! model from arrays
    type(diagnostic), intent(inout) :: one   !! finding about it
    character(len=:), allocatable :: name
    integer :: k

    name = ''
    k = findloc(listed, one%of, dim=1)
    if (k > 0) then
      name = trim(list(k))//'('//text_of(one%which)//')'
    else if (one%of == of_paper_ratio) then
      name = 'controls%paper_ratio'
    else if (one%of == of_theory) then
      name = 'controls%by_increments'
    else if (one%of /= of_section) then   ! sentences about sections name the array
      name = model%name_of(merge(of_node, one%of, one%of == of_reference), one%which)
    end if
    if (name == '' .and. index(one%what, ': ') == 1) one%what = one%what(3:)
    one%what = in_array_words(name//one%what)
    one%remedy = in_array_words(one%remedy)
  end subroutine name_item

  !> Replace each word of decks in a message.
  pure function in_array_words(text) result(told)
    character(len=*), intent(in) :: text   !! message for decks
    character(len=:), allocatable :: told
    integer :: at, from, k

    told = text
    do k = 1, size(word), 2
      from = 1
      do
        at = index(told(from:), trim(word(k))) + from - 1
        if (at < from) exit
        told = told(:at - 1)//trim(word(k + 1))//told(at + len_trim(word(k)):)
        from = at + len_trim(word(k + 1))
      end do
    end do
  end function in_array_words
end module epcont_messages_array_words
