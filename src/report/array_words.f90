!> Messages for programs that make their scenes from arrays: what is said of cards, in the words of arrays.
module epcont_report_array_words
  use epcont_base_text, only: upper
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
    'PARAM MUP: PAPER', 'controls%paper_ratio', 'MUP EXACT', '.false.', &
    'PARAM MAXIT', 'controls%most_iterations', 'METHOD', 'controls%method', '--memory', 'memory', &
    '`force not unique` in CONTACT', 'answer%contact%indeterminate']

contains

  !> A message, with each word of the deck replaced.
  pure function in_array_words(text) result(told)
    character(len=*), intent(in) :: text   !! as it is said of decks
    character(len=:), allocatable :: told
    integer :: at, behind, from, k

    told = text
    do k = 1, size(word), 2
      from = 1
      do
        at = index(told(from:), trim(word(k)))
        if (at == 0) exit
        at = from + at - 1
        behind = at + len_trim(word(k))
        from = at + 1
        if (goes_on(at - 1) .or. goes_on(behind) .and. word(k)(behind - at:behind - at) /= ',') cycle
        told = told(:at - 1)//trim(word(k + 1))//told(behind:)
        from = at + len_trim(word(k + 1))
      end do
    end do

  contains

    !> Is a character part of a word?
    pure logical function goes_on(i)
      integer, intent(in) :: i

      goes_on = i >= 1 .and. i <= len(told)
      if (goes_on) goes_on = scan(upper(told(i:i)), 'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789') > 0
    end function goes_on
  end function in_array_words
end module epcont_report_array_words
