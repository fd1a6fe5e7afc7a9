!> Outcome of a run as data: the answer is valid, or the reason why not. `messages/sentences.f90` puts it into
!> words.
module epcont_verdict
  use epcont_base_error, only: status_no_answer, status_numerical, status_usage, status_valid
  use epcont_base_tolerances, only: lost_digits
  use epcont_certificate_certificate, only: certificate_type
  use epcont_contact_problem, only: contact_no_equilibrium, contact_overlap, contact_solved
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: find_verdict, verdict_type

  !> Reasons. From `reason_unsound` on, displacements and forces are available.
  integer, parameter, public :: &
    reason_memory = 1, &           !! memory does not suffice to factor a body
    reason_singular = 2, &         !! a stiffness cannot be factored
    reason_no_equilibrium = 3, &   !! a body is unconstrained
    reason_overlap = 4, &          !! pairs overlap and no body can deform
    reason_rounding = 5, &         !! no active set passes the test
    reason_unsound = 6, &          !! bodies penetrate each other
    reason_not_converged = 7, &    !! the plasticity iteration did not converge
    reason_limit_load = 8, &       !! the loads exceed the limit load
    reason_doubtful = 9, &         !! the certificate rejects the answer
    reason_ill_conditioned = 10, & !! rounding takes too many digits
    reason_lost_contact = 11, &    !! flow theory: valid up to the loss of the last contact
    reason_none = 12               !! valid
  integer, parameter :: status_of(12) = [ &
    status_usage, status_numerical, status_no_answer, status_no_answer, status_numerical, &
    status_numerical, status_no_answer, status_no_answer, status_numerical, status_numerical, &
    status_valid, status_valid]
  character(len=*), parameter :: word_of(12) = [character(len=18) :: &
    'out of memory', 'singular stiffness', 'no equilibrium', 'overlap', 'contact not found', &
    'not certified', 'not converged', 'limit load', 'not certified', 'ill-conditioned', &
    'contact lost', 'valid']

  type :: verdict_type
    integer :: reason = reason_none
  contains
    procedure :: status
    procedure :: word
    procedure :: has_answer
  end type verdict_type

contains

  !> Find the verdict on a run.
  pure type(verdict_type) function find_verdict(answer, certificate, contact_is_off) result(verdict)
    type(answer_type), intent(in) :: answer
    type(certificate_type), intent(in) :: certificate   !! of the answer, if there is one
    logical, intent(in) :: contact_is_off               !! bodies may pass through each other
    logical :: is_exact

    is_exact = answer%lost() <= lost_digits
    if (answer%lacks_memory) then
      verdict%reason = reason_memory
    else if (answer%failed_body > 0) then
      verdict%reason = reason_singular
    else if (answer%contact%state == contact_no_equilibrium) then
      verdict%reason = reason_no_equilibrium
    else if (answer%contact%state == contact_overlap) then
      verdict%reason = reason_overlap
    else if (answer%contact%state /= contact_solved) then
      verdict%reason = reason_rounding
    else if (answer%lost_contact .and. certificate%valid .and. is_exact) then
      verdict%reason = reason_lost_contact
    else if (answer%converged .and. certificate%valid .and. is_exact) then
      verdict%reason = merge(reason_none, reason_unsound, certificate%scene%sound() .or. contact_is_off)
    else if (.not. answer%converged .and. &
             (certificate%balanced .and. is_exact .or. answer%runs_away)) then
      verdict%reason = merge(reason_limit_load, reason_not_converged, answer%runs_away)
    else
      verdict%reason = merge(reason_ill_conditioned, reason_doubtful, &
                             certificate%valid .or. certificate%balanced .and. .not. is_exact)
    end if
  end function find_verdict

  !> Exit status of the verdict.
  pure integer function status(self)
    class(verdict_type), intent(in) :: self

    status = status_of(self%reason)
  end function status

  !> Word for the verdict: `valid`, `no equilibrium` and so on.
  pure function word(self)
    class(verdict_type), intent(in) :: self
    character(len=:), allocatable :: word

    word = trim(word_of(self%reason))
  end function word

  !> Are displacements and forces available?
  pure logical function has_answer(self)
    class(verdict_type), intent(in) :: self

    has_answer = self%reason >= reason_unsound
  end function has_answer
end module epcont_verdict
