!> The known name that a misspelt one was probably meant to be.
module epcont_deck_spelling
  implicit none
  private
  public :: suggestion

contains

  !> Remedy for an unknown word: the nearest name with the same first letter, if they differ by at most two
  !! letters in any order, or `otherwise`. Digits agree: CTRIA6 is not a misspelt CTRIA3.
  pure function suggestion(word, names, otherwise) result(remedy)
    character(len=*), intent(in) :: word        !! in upper case
    character(len=*), intent(in) :: names(:)    !! known names
    character(len=*), intent(in) :: otherwise   !! remedy if no name is near
    character(len=:), allocatable :: apart, remedy
    integer :: i, least

    remedy = otherwise
    least = 3
    do i = 1, size(names)
      if (index(word, names(i)(1:1)) /= 1) cycle
      apart = unshared(trim(word), trim(names(i)))//unshared(trim(names(i)), trim(word))
      if (len(apart) >= least .or. scan(apart, '0123456789') > 0) cycle
      least = len(apart)
      remedy = 'did you mean '//trim(names(i))//'?'
    end do
  end function suggestion

  !> Characters of a word that another one lacks.
  pure function unshared(word, other) result(apart)
    character(len=*), intent(in) :: word, other
    character(len=:), allocatable :: apart
    character(len=len(other)) :: rest
    integer :: at, i

    apart = ''
    rest = other
    do i = 1, len(word)
      at = index(rest, word(i:i))
      if (at > 0) rest(at:at) = ' '
      if (at == 0) apart = apart//word(i:i)
    end do
  end function unshared
end module epcont_deck_spelling
