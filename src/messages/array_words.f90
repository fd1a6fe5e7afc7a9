!> Messages for programs that make their scenes from arrays: what is said of cards, in the words of arrays.
module epcont_messages_array_words
  implicit none
  private
  public :: in_array_words

  !> Words of a deck, and what they are in a scene from arrays. Phrases come before their words.
  character(len=48), parameter :: word(*) = [character(len=48) :: &
    'field 9 (CID) is blank', 'its normal is zero', &
    'the id of a CORD2R whose x-axis is the normal', 'a normal', &
    'the x-axis of CID turned round', 'the normal turned round', &
    'by SPC1', '(held)', 'by SUPORT,', '(reference) at node,direction:', 'SUPORT', 'reference', &
    'an RBE2', 'a leader', 'RBE2', 'leader', 'GN', 'the leader', &
    'GA and GB', 'nodes A and B', 'of GA', 'of node A', 'of GB', 'of node B', &
    'GRID', 'node', 'CGAPs', 'pairs', 'CGAP', 'pair', &
    'BLSEG lines', 'lines', 'BLSEG', 'line', 'BCONP', 'couple', 'SLAVE', 'slave', 'MASTER', 'master', &
    'PSHELL', 'section', 'PSOLID', 'section', 'the MAT1', 'young', &
    'PARAM MUP', 'controls%paper_ratio', ' (MUP PAPER)', '', &
    'MUP EXACT (ORIGINAL takes PAPER)', '.false.', 'MUP EXACT', '.false.', &
    'PARAM THEORY', 'controls%flow_theory', 'THEORY TOTAL', '.false.', 'MUP PAPER', 'paper_ratio', &
    'PARAM MAXIT', 'controls%most_iterations', 'METHOD', 'controls%method', '--memory', 'memory', &
    'what follows is', 'the answer is', '`force not unique` in CONTACT', 'answer%contact%indeterminate']

contains

  !> A message, with each word of the deck replaced.
  pure function in_array_words(text) result(told)
    character(len=*), intent(in) :: text   !! as it is said of decks
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
