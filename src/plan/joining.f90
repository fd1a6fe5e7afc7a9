!> Whether all bodies form one joined system (`linear/joined_rule.f90`), or contact is found from the
!> flexibility of each body. With few pairs the flexibility takes less time, with many pairs much more.
module epcont_plan_joining
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: rule_auto, rule_joined
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: can_join, joins, many_of

  !> Operations of flexibility and simplex for each node above which the bodies are joined. Time of the
  !! simplex over that of joined bodies, measured at these numbers: crowned blocks .77 at 4.3e4, .86 at 8.5e4,
  !! .92 at 1.3e5, 1.4 at 3.1e5; strips .97 at 2.1e4, 1.3 at 5.6e4, .87 at 6.5e4; dovetails .87 at 3.6e4, .93
  !! at 6.4e4, 1.5 at 1.0e5; stacks .80 at 2.9e4, 1.08 at 6.8e4, 1.6 at 1.6e5, 2.7 at 3.6e5.
  real(wp), parameter :: many_of_pairs = 5.2e4_wp
  !> The same for bodies that yield: F is made in each iteration, and the active set hardly changes (dovetails
  !! 1.2 at 1.8e4, 1.4 at 3.6e4, 1.8 at 6e4; crowned blocks .73 at 1.1e4, .95 at 4.3e4, 1.2 at 7.5e4).
  real(wp), parameter :: many_where_yielding = 1.4e4_wp
  !> Operations for each pair cubed: two inverses, and pivots over the tableau.
  real(wp), parameter :: of_pairs = 4.0_wp

contains

  !> Are the bodies joined?
  logical function joins(model)
    type(model_type), intent(in) :: model

    joins = model%controls%rule == rule_joined .or. model%controls%rule == rule_auto .and. &
            of_pairs*real(model%contact%rows(), wp)**3 > many_of(model)*model%mesh%nodes
    if (joins) joins = can_join(model)
  end function joins

  !> Operations of flexibility and simplex for each node above which AUTO joins the bodies.
  pure real(wp) function many_of(model)
    type(model_type), intent(in) :: model
    integer :: e

    many_of = merge(many_where_yielding, many_of_pairs, any([(model%can_yield(e), e=1, model%mesh%elements)]))
  end function many_of

  !> Can the bodies be joined? At least one pair needs a body that deforms.
  logical function can_join(model)
    type(model_type), intent(in) :: model
    integer :: i

    can_join = any([(model%mesh%around%start(model%contact%row_node(i) + &
                                             1) > model%mesh%around%start(model%contact%row_node(i)) .and. &
                     .not. all(model%constraints%is_held([1, 2], model%contact%row_node(i))), i=1, &
                       size(model%contact%row_node))])
  end function can_join
end module epcont_plan_joining
