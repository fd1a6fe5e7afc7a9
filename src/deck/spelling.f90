!> The known name that a misspelt one was probably meant to be.
module epcont_deck_spelling
  implicit none
  private
  public :: suggestion

contains

  !> Remedy for an unknown word: the nearest name with the same first letter and one slip (two for words with
  !! more than five letters), or `otherwise`. Digits do not count as slips: CTRIA6 is not a misspelt CTRIA3.
  pure function suggestion(word, names, otherwise) result(remedy)
    character(len=*), intent(in) :: word        !! in upper case
    character(len=*), intent(in) :: names(:)    !! known names
    character(len=*), intent(in) :: otherwise   !! remedy if no name is near
    character(len=:), allocatable :: remedy
    integer :: i, least, slips

    remedy = otherwise
    if (word == '') return
    least = merge(3, 2, len_trim(word) > 5)
    do i = 1, size(names)
      if (names(i)(1:1) /= word(1:1) .or. digits_of(names(i)) /= digits_of(word)) cycle
      slips = distance(trim(word), trim(names(i)))
      if (slips >= least) cycle
      least = slips
      remedy = 'did you mean '//trim(names(i))//'?'
    end do
  end function suggestion

  !> Digits of a word, in order.
  pure function digits_of(word)
    character(len=*), intent(in) :: word
    character(len=8) :: digits_of
    integer :: i

    digits_of = ''
    do i = 1, len(word)
      if (scan(word(i:i), '0123456789') > 0) digits_of = trim(digits_of)//word(i:i)
    end do
  end function digits_of

  !> Number of letters to insert, delete, replace or exchange with a neighbour (Damerau, optimal string
  !! alignment).
  pure integer function distance(a, b)
    character(len=*), intent(in) :: a, b
    integer :: slips(0:len(a), 0:len(b))
    integer :: i, j

    slips(:, 0) = [(i, i=0, len(a))]
    slips(0, :) = [(j, j=0, len(b))]
    do j = 1, len(b)
      do i = 1, len(a)
        slips(i, j) = min(slips(i - 1, j) + 1, slips(i, j - 1) + 1, &
                          slips(i - 1, j - 1) + merge(0, 1, a(i:i) == b(j:j)))
        if (i < 2 .or. j < 2) cycle
        if (a(i - 1:i) == b(j:j)//b(j - 1:j - 1)) &
          slips(i, j) = min(slips(i, j), slips(max(i - 2, 0), max(j - 2, 0)) + 1)
      end do
    end do
    distance = slips(len(a), len(b))
  end function distance
end module epcont_deck_spelling
