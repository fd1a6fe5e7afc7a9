!> Whether contact joins all bodies to one system (`linear/joined_rule.f90`), or is found from the
!> flexibility of each: of few pairs that takes less, of many much more.
module epcont_plan_joining
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: rule_auto, rule_joined
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: can_join, joins, many_of

  !> Operations of flexibility and simplex, for each node, from which on the bodies are joined. Measured: two
  !! blocks .9 to 1.1 of the time of the simplex from 2E4 to 1E5, .8 at 1.2E5; strips .92 at 3.6E4, .66 at
  !! 6.5E4; stacks .98 at 3E4, .89 at 6.5E4, .69 at 8E4; walls .8 at 4.3E4.
  real(wp), parameter :: many_of_pairs = 4.0e4_wp
  !> The same where something yields: F is made in each iteration, and the set of contacts hardly changes then
  !! (dovetails .83 at 1.8E4, .72 at 3.6E4, .55 at 6E4, blocks .83 at 2.1E4, .85 at 7.5E4).
  real(wp), parameter :: many_where_yielding = 1.5e4_wp
  !> Operations of the simplex, for each pair cubed.
  real(wp), parameter :: of_simplex = 2.0_wp

contains

  !> Does the scene get joined bodies?
  logical function joins(model)
    type(model_type), intent(in) :: model   !! the scene

    joins = model%controls%rule == rule_joined .or. model%controls%rule == rule_auto .and. &
            operations_of_flexibility(model) > many_of(model)*model%nodes
    if (joins) joins = can_join(model)
  end function joins

  !> Of each body the inverse of its part, and of F what the simplex takes.
  pure real(wp) function operations_of_flexibility(model) result(operations)
    type(model_type), intent(in) :: model
    real(wp) :: own(model%bodies)   ! pairs of each body
    type(incidence) :: pairs

    pairs = new_incidence(model%bodies_of_pairs(), model%bodies)
    own = pairs%start(2:) - pairs%start(:model%bodies)
    operations = sum(own**3) + of_simplex*real(model%pairs, wp)**3
  end function operations_of_flexibility

  !> Operations of the flexibility, for each node, from which on AUTO joins the bodies.
  pure real(wp) function many_of(model)
    type(model_type), intent(in) :: model   !! the scene
    integer :: e

    many_of = merge(many_where_yielding, many_of_pairs, any([(model%can_yield(e), e=1, model%elements)]))
  end function many_of

  !> Can it have? At one pair at least something gives way.
  logical function can_join(model)
    type(model_type), intent(in) :: model   !! the scene
    integer :: i

    can_join = any([(model%around%start(model%row_node(i) + 1) > model%around%start(model%row_node(i)) .and. &
                     .not. all(model%is_held([1, 2], model%row_node(i))), i=1, size(model%row_node))])
  end function can_join
end module epcont_plan_joining
