!> How stiff the springs of joined bodies are, measured on their elements, and what pairs put on the nodes.
module epcont_linear_joined_springs
  use epcont_assembly_bodies, only: factored_bodies, force_fields
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_plan_numbering, only: most_freedoms
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: frozen_response, find_springs, put_on_nodes

  !> Stiffness of a spring over that of the softer body at its pair. A step leaves 1E-3 of the gaps, mostly
  !! 1E-4; more would cost digits of the factor, of which steps bring back as many each.
  real(wp), parameter, public :: of_pairs = 1.0e3_wp
  !> And of a SUPORT freedom, over the largest of a node of the softest body, which may be all that holds its
  !! own: so weak that steps hardly feel it, and unit loads not at all.
  real(wp), parameter :: of_suport = 1.0e-9_wp
  !> But over that of its node so strong that a pivot is left where no pair holds the body.
  real(wp), parameter :: least_pivot = 1.0e-13_wp
  !> What a half-plane gives way by at a force on a node of its boundary, against what is a hundred sides
  !! below it (2 ln(200)/pi), over what the node's own stiffness would let it.
  real(wp), parameter, public :: half_plane = 3.4_wp

  !> What joined bodies do under some loads, the set of contacts frozen.
  type :: frozen_response
    real(wp), allocatable :: load(:, :)      !! along the motions [force] [motions, any]
    real(wp), allocatable :: opening(:, :)   !! of the gaps [length] [pairs, any]
    real(wp), allocatable :: force(:, :)     !! [force] [pairs, any]
    real(wp), allocatable :: displacement(:, :, :)   !! [length] [directions, any, nodes]
  end type frozen_response

contains

  !> Springs of SUPORT freedoms, in the factor from now on, and of pairs, in it where these press. What
  !! nothing resists is held as firmly as its node.
  subroutine find_springs(scene, bodies, redundant, gamma, hold)
    type(planned_model), intent(in) :: scene          !! numbered as one system
    class(factored_bodies), intent(inout) :: bodies   !! with a law
    logical, intent(in) :: redundant(:)               !! nothing resists the motion [motions]
    real(wp), allocatable, intent(out) :: gamma(:)    !! [force/length] [pairs]
    real(wp), allocatable, intent(out) :: hold(:)     !! of SUPORT freedoms [force/length] [motions]
    real(wp) :: softest, stiffness(scene%model%nodes)
    integer :: k, springs

    call measure(scene, bodies, stiffness, bodies%spring%norm)
    gamma = [(of_pairs*softer_side(k), k=1, scene%model%pairs)]
    softest = stiffness_of_softest()
    springs = size(scene%numbering%body(1)%spring%start) - 1
    bodies%spring%stiffness = spread(0.0_wp, 1, springs)
    bodies%spring%changed = spread(.true., 1, springs)
    associate (own => stiffness(scene%motions%node))
      hold = merge(own, max(of_suport*softest, least_pivot*own), redundant)
    end associate
    do k = 1, size(hold)
      bodies%spring%stiffness(spring_of_motion(scene, k)) = hold(k)
    end do

  contains

    !> The least that bodies have at their stiffest nodes.
    pure real(wp) function stiffness_of_softest() result(softest)
      real(wp) :: largest(scene%model%bodies)
      integer :: i

      largest = 0.0_wp
      do i = 1, scene%model%nodes
        associate (body => scene%model%body(i))
          if (body > 0) largest(body) = max(largest(body), stiffness(i))
        end associate
      end do
      softest = minval(largest, mask=largest > 0.0_wp)
    end function stiffness_of_softest

    !> Stiffness of the softer body at a pair, of those that give way at all; 0: none does.
    pure real(wp) function softer_side(pair) result(softer)
      integer, intent(in) :: pair
      real(wp) :: side
      integer :: first, i, last

      softer = huge(1.0_wp)
      first = scene%model%row_start(pair)
      last = scene%model%row_start(pair + 1) - 1
      associate (node => scene%model%row_node(first:last), weight => scene%model%row_weight(first:last))
        do i = 1, size(node)
          side = sum(abs(weight)*stiffness(node), mask=scene%model%body(node) == scene%model%body(node(i)) &
                     .and. .not. all(scene%model%held(:, node), dim=1))
          if (side > 0.0_wp) softer = min(softer, side)
        end do
      end associate
      if (softer >= huge(1.0_wp)) softer = 0.0_wp
    end function softer_side
  end subroutine find_springs

  !> Forces of the chosen pairs on the nodes of their rows, behind room for one at each SUPORT freedom.
  subroutine put_on_nodes(scene, chosen, force, loads)
    type(planned_model), intent(in) :: scene     !! numbered as one system
    logical, intent(in) :: chosen(:)             !! [pairs]
    real(wp), intent(in) :: force(:, :)          !! [force] [pairs, fields]
    type(force_fields), intent(out) :: loads     !! none at the SUPORT freedoms
    integer, allocatable :: pair(:)
    integer :: c, i, k, n

    pair = pack([(k, k=1, size(chosen))], chosen)
    associate (model => scene%model, start => scene%model%row_start)
      loads%node = [scene%motions%node, [(model%row_node(start(pair(k)):start(pair(k) + 1) - 1), &
                                          k=1, size(pair))]]
      allocate (loads%force(directions, size(force, 2), size(loads%node)), source=0.0_wp)
      n = scene%motions%count
      do k = 1, size(pair)
        do i = start(pair(k)), start(pair(k) + 1) - 1
          n = n + 1
          do c = 1, directions
            loads%force(c, :, n) = model%row_weight(i)*model%normal(c, pair(k))*force(pair(k), :)
          end do
        end do
      end do
    end associate
  end subroutine put_on_nodes

  !> The spring of the SUPORT freedom that measures a motion.
  pure integer function spring_of_motion(scene, motion)
    type(planned_model), intent(in) :: scene   !! numbered as one system
    integer, intent(in) :: motion              !! which

    associate (reference => scene%model%reference, c => scene%motions%component(motion), &
               node => scene%motions%node(motion))
      spring_of_motion = scene%model%pairs + count(reference(:, :node - 1)) + count(reference(:c, node))
    end associate
  end function spring_of_motion

  !> What elements give to the diagonal of the stiffness at each node; a leader has as much as the stiffest of
  !! its followers. And the largest sum of magnitudes of a row.
  subroutine measure(scene, bodies, stiffness, norm)
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    real(wp), intent(out) :: stiffness(:)   !! [force/length] [nodes]
    real(wp), intent(out) :: norm           !! [force/length]
    real(wp) :: k(most_freedoms**2), row(directions, scene%model%nodes)
    integer :: c, e, i, n

    stiffness = 0.0_wp
    row = 0.0_wp
    do e = 1, scene%model%elements
      n = directions*scene%model%node_count(e)
      call bodies%operator%element_stiffness(scene%model, e, bodies%law, n, k)
      do i = 1, n
        associate (node => scene%model%connectivity((i + 1)/directions, e), c => 2 - mod(i, 2))
          stiffness(node) = stiffness(node) + k(1 + (i - 1)*(n + 1))/directions
          row(c, node) = row(c, node) + sum(abs(k((i - 1)*n + 1:i*n)))
        end associate
      end do
    end do
    norm = maxval(row)
    do i = 1, scene%model%nodes
      do c = 1, directions
        associate (leader => scene%model%leader(c, i))
          stiffness(leader) = max(stiffness(leader), stiffness(i))
        end associate
      end do
    end do
  end subroutine measure
end module epcont_linear_joined_springs
