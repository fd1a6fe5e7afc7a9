!> Text about attempts and their reasons.
module epcont_messages_attempt_text
  use epcont_attempts, only: attempt_type, more_pairs, more_steps, other_rule, refinement
  use epcont_base_text, only: plural, text_of
  use epcont_messages_names, only: when
  use epcont_solution, only: solution_type
  implicit none
  private
  public :: attempts_text

  !> Reasons for another attempt, in the order of their numbers.
  character(len=*), parameter :: reason(7) = [character(len=30) :: &
    'not converged', 'no active set found', 'contact forces not unique', 'singular stiffness', &
    'not certified', 'residuals, or digits lost', 'nodes without a pair came near']

contains

  !> `(1) JOINED: no active set found; (2) CONRY: valid`; empty if the first solve was the only one.
  pure function attempts_text(solution) result(text)
    class(solution_type), intent(in) :: solution
    character(len=:), allocatable :: text
    logical :: joined   ! in the attempt at hand
    integer :: k

    text = ''
    associate (made => solution%attempts%made)
      if (size(made) == 0) return
      joined = solution%iteration%joined .neqv. mod(count(made%what == other_rule), 2) == 1
      text = '(1) '//when(joined, 'JOINED', 'CONRY')
      do k = 1, size(made)
        if (made(k)%what == other_rule) joined = .not. joined
        text = text//': '//trim(reason(made(k)%why))//'; ('//text_of(k + 1)//') '//what_text(made(k), joined)
      end do
    end associate
    text = text//': '//solution%verdict%word()
  end function attempts_text

  !> Describe the change.
  pure function what_text(attempt, joined) result(text)
    type(attempt_type), intent(in) :: attempt
    logical, intent(in) :: joined
    character(len=:), allocatable :: text

    select case (attempt%what)
    case (more_steps)
      text = plural(attempt%many, 'load step')
    case (other_rule)
      text = when(joined, 'JOINED', 'CONRY')
    case (refinement)
      text = plural(attempt%many, 'step')//' of refinement'
    case (more_pairs)
      text = 'more pairs'
    end select
  end function what_text
end module epcont_messages_attempt_text
