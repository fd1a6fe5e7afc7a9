!> Whether contact joins all bodies to one system (`linear/joined_contact.f90`), or is found from the
!> flexibility of each: of few pairs that takes less, of many much more.
module epcont_plan_joining
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_model_controls, only: rule_auto, rule_joined
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: joins, many_of

  !> Operations that the flexibility takes, for each node, from which on the bodies are joined. Measured on a
  !! dovetail (.89 of the time at 7E4, .74 at 1.3E5), two blocks (1.1 at 7E4, level at 1.2E5, .4 at 4E5) and
  !! strips (1.07 at 4E4, .8 at 1.3E5).
  real(wp), parameter :: many_of_pairs = 7.0e4_wp
  !> The same where something yields: F is made in each iteration, and the set of contacts hardly changes then
  !! (dovetails .83 at 1.2E4, .72 at 2.4E4, .55 at 4E4, blocks .83 at 1.4E4, .85 at 5E4).
  real(wp), parameter :: many_where_yielding = 2.0e4_wp
  !> Free motions up to which AUTO joins bodies: what a load along each does is looked at on all of them.
  integer, parameter :: most_motions = 40

contains

  !> Does the scene get joined bodies?
  logical function joins(model, motions)
    type(model_type), intent(in) :: model   !! the scene
    integer, intent(in) :: motions          !! that are free

    joins = model%controls%rule == rule_joined
    if (model%controls%rule == rule_auto .and. motions <= most_motions) &
      joins = operations_of_flexibility(model) > many_of(model)*model%nodes
    if (joins) joins = can_join(model)
  end function joins

  !> Of each body the inverse of its part, and of F two thirds of its cube.
  pure real(wp) function operations_of_flexibility(model) result(operations)
    type(model_type), intent(in) :: model
    real(wp) :: own(model%bodies)   ! pairs of each body
    type(incidence) :: pairs

    pairs = new_incidence(model%bodies_of_pairs(), model%bodies)
    own = pairs%start(2:) - pairs%start(:model%bodies)
    operations = sum(own**3) + 2.0_wp/3.0_wp*(0.5_wp*sum(own**2))**1.5_wp
  end function operations_of_flexibility

  !> Operations of the flexibility, for each node, from which on AUTO joins the bodies.
  pure real(wp) function many_of(model)
    type(model_type), intent(in) :: model   !! the scene
    integer :: e

    many_of = merge(many_where_yielding, many_of_pairs, any([(model%can_yield(e), e=1, model%elements)]))
  end function many_of

  !> Can it have? At each pair something gives way, and no freedom is a sum of others or has a spring.
  logical function can_join(model)
    type(model_type), intent(in) :: model   !! the scene
    logical :: gives(model%nodes)
    integer :: i, k

    can_join = size(model%sum%first) + size(model%spring) == 0
    if (.not. can_join) return
    gives = [(model%around%start(i + 1) > model%around%start(i), i=1, model%nodes)]
    do i = 1, model%nodes
      gives(i) = gives(i) .and. .not. (model%held(1, model%leader(1, i)) .and. &
                                       model%held(2, model%leader(2, i)))
    end do
    can_join = model%pairs > 0 .and. all([(any(gives(model%row_node(model%row_start(k): &
        model%row_start(k + 1) - 1))), k=1, model%pairs)])
  end function can_join
end module epcont_plan_joining
