!> Stiffness of the springs of joined bodies, relative to their elements; motion and forces of SUPORT DOFs.
module epcont_linear_joined_springs
  use epcont_assembly_bodies, only: factored_bodies
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle
  use epcont_model_ties, only: add_moment, platen_angle
  use epcont_plan_numbering, only: most_freedoms
  use epcont_plan_planned_model, only: planned_model
  use epcont_system_stopwatch, only: stage_contact, stage_factor, stopwatch
  implicit none
  private
  public :: add_suport_forces, joined_springs, new_springs, suport_values

  !> Stiffness of a spring over that of the softer body at its pair. A step leaves 1E-3 of the gaps, usually
  !! 1E-4; stiffer springs would cost digits of the factor, which further steps regain slowly.
  real(wp), parameter :: of_pairs = 1.0e3_wp
  !> Stiffness at a SUPORT DOF, over the largest of a node of the softest body. It may be the only restraint
  !! of a body, and is so weak that steps hardly depend on it, and unit loads not at all.
  real(wp), parameter :: of_suport = 1.0e-9_wp
  !> But at least this fraction of that of its node, so that a pivot remains if no pair restrains the body.
  real(wp), parameter :: least_pivot = 1.0e-13_wp
  !> Compliance of a half-plane at a boundary node, relative to a point a hundred edges
  !! below it (2 ln(200)/pi), over the inverse of the node's own stiffness.
  real(wp), parameter :: half_plane = 3.4_wp
  !> Factor by which springs of SUPORT DOFs become stiffer if rounding leaves no pivot of a body without
  !! contact, repeated if necessary: they do not change the result.
  real(wp), parameter :: stiffer = 1.0e3_wp
  integer, parameter :: most_stiffened = 2
  !> Factor by which springs of pairs become stiffer if stiff bodies carry each other through soft ones: some
  !! pairs deform there by far less than their softer side.
  real(wp), parameter :: firmer = 100.0_wp

  !> Springs of a joined system.
  type :: joined_springs
    real(wp), allocatable :: gamma(:)      !! of the pairs [force/length] [pairs]
    real(wp), allocatable :: hold(:)       !! of SUPORT DOFs [force/length] [motions]
    logical, allocatable :: closed(:)      !! pairs whose springs belong in the factor [pairs]
    !> Compliance of a pair for a unit force on it, approximately [length/force] [pairs]
    real(wp), allocatable :: compliance(:)
    integer, private :: stiffened = 0      !! number of increases of gamma
    logical :: unique = .false.            !! forces are known to be unique with the present factor
  contains
    procedure :: factor
    procedure :: make_firmer
  end type joined_springs

contains

  !> Factor the bodies with the springs of the pairs in contact, if law or springs have changed.
  subroutine factor(self, scene, bodies, threads, sound, watch)
    class(joined_springs), intent(inout) :: self
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(inout) :: bodies
    integer, intent(in) :: threads               !! number of threads
    logical, intent(out) :: sound                !! the factor can be used
    class(stopwatch), intent(inout) :: watch     !! measures the time
    real(wp) :: wanted(scene%model%contact%rows())
    integer :: k

    wanted = merge(self%gamma, 0.0_wp, self%closed)
    associate (stiffness => bodies%spring%stiffness(:size(wanted)), &
               changed => bodies%spring%changed(:size(wanted)))
      changed = changed .or. abs(stiffness - wanted) > 0.0_wp
      stiffness = wanted
    end associate
    if (any(bodies%spring%changed) .or. any(bodies%law%changed)) then
      call watch%lap(stage_contact)
      call bodies%factor_system(scene, threads)
      do k = 1, most_stiffened
        if (bodies%body(1)%is_sound() .or. bodies%body(1)%lacks_memory .or. size(self%hold) == 0) exit
        self%hold = stiffer*self%hold
        call hold_suports(scene, self%hold, bodies)
        call bodies%factor_system(scene, threads)
      end do
      self%unique = .false.
      call watch%lap(stage_factor)
    end if
    sound = bodies%body(1)%is_sound()
  end subroutine factor

  !> Make the springs of pairs stiffer, if this may help.
  subroutine make_firmer(self, done)
    class(joined_springs), intent(inout) :: self
    logical, intent(out) :: done

    done = self%stiffened < most_stiffened
    if (.not. done) return
    self%stiffened = self%stiffened + 1
    self%gamma = firmer*self%gamma
  end subroutine make_firmer

  !> Make springs of SUPORT DOFs, in the factor from now on, and of pairs, in the factor if in contact. Modes
  !! without restraint have springs as stiff as their node.
  subroutine new_springs(scene, bodies, redundant, new)
    type(planned_model), intent(in) :: scene          !! numbered as one system
    class(factored_bodies), intent(inout) :: bodies   !! with a law
    logical, intent(in) :: redundant(:)               !! nothing restrains the mode [modes]
    type(joined_springs), intent(out) :: new          !! all pairs closed
    real(wp) :: softest, stiffness(scene%model%mesh%nodes)
    integer :: k, springs

    call measure(scene, bodies, stiffness, bodies%spring%norm)
    softest = stiffness_of_softest()
    new%gamma = [(of_pairs*softer_side(k), k=1, scene%model%contact%rows())]
    where (new%gamma <= 0.0_wp) new%gamma = of_pairs*softest   ! nothing deforms: no entry in the matrix
    springs = size(scene%numbering%body(1)%spring%start) - 1
    bodies%spring%stiffness = [spread(0.0_wp, 1, springs - size(scene%model%constraints%spring)), &
                               scene%model%constraints%spring%stiffness]
    bodies%spring%changed = spread(.true., 1, springs)
    associate (own => stiffness(scene%motions%node))
      new%hold = merge(own, max(of_suport*softest, least_pivot*own), redundant)
    end associate
    do k = 1, size(new%hold)
      if (scene%motions%component(k) == angle) new%hold(k) = new%hold(k)*longest_arm(scene, k)**2
    end do
    call hold_suports(scene, new%hold, bodies)
    new%compliance = half_plane*of_pairs/new%gamma
    new%closed = spread(.true., 1, scene%model%contact%rows())

  contains

    !> Least stiffness of a body at its stiffest node.
    pure real(wp) function stiffness_of_softest() result(softest)
      real(wp) :: largest(scene%model%mesh%bodies)
      integer :: i

      largest = 0.0_wp
      do i = 1, scene%model%mesh%nodes
        associate (body => scene%model%mesh%body(i))
          if (body > 0) largest(body) = max(largest(body), stiffness(i))
        end associate
      end do
      softest = minval(largest, mask=largest > 0.0_wp)
    end function stiffness_of_softest

    !> Stiffness of the softer deformable body at a pair, 0 if both are rigid.
    pure real(wp) function softer_side(pair) result(softer)
      integer, intent(in) :: pair
      real(wp) :: side
      integer :: first, i, last

      softer = huge(1.0_wp)
      first = scene%model%contact%row_start(pair)
      last = scene%model%contact%row_start(pair + 1) - 1
      associate (node => scene%model%contact%row_node(first:last), &
                 weight => scene%model%contact%row_weight(first:last))
        do i = 1, size(node)
          side = sum(abs(weight)*stiffness(node), &
                     mask=scene%model%mesh%body(node) == scene%model%mesh%body(node(i)) &
                     .and. .not. all(scene%model%constraints%held(:, node), dim=1))
          if (side > 0.0_wp) softer = min(softer, side)
        end do
      end associate
      if (softer >= huge(1.0_wp)) softer = 0.0_wp
    end function softer_side
  end subroutine new_springs

  !> Put the springs of SUPORT DOFs in the next factor.
  subroutine hold_suports(scene, hold, bodies)
    type(planned_model), intent(in) :: scene          !! numbered as one system
    real(wp), intent(in) :: hold(:)                   !! [force/length] [motions]
    class(factored_bodies), intent(inout) :: bodies
    integer :: k

    do k = 1, size(hold)
      associate (spring => spring_of_motion(scene, k))
        bodies%spring%stiffness(spring) = hold(k)
        bodies%spring%changed(spring) = .true.
      end associate
    end do
  end subroutine hold_suports

  !> Displacements of SUPORT DOFs [length, or radian] [modes].
  function suport_values(scene, u) result(value)
    type(planned_model), intent(in) :: scene   !! with its modes
    real(wp), intent(in) :: u(:, :)            !! [length] [directions, nodes]
    real(wp) :: value(scene%motions%count)
    integer :: k

    do k = 1, size(value)
      associate (c => scene%motions%component(k), node => scene%motions%node(k))
        if (c == angle) value(k) = platen_angle(scene%model, platen_of(scene, k), u)
        if (c /= angle) value(k) = u(c, node)
      end associate
    end do
  end function suport_values

  !> Add forces, or moments, at SUPORT DOFs to the nodal forces.
  subroutine add_suport_forces(scene, value, force)
    type(planned_model), intent(in) :: scene     !! with its modes
    real(wp), intent(in) :: value(:)             !! [force, or force*length] [motions]
    real(wp), intent(inout) :: force(:, :)       !! [force] [directions, nodes]
    integer :: k

    do k = 1, size(value)
      associate (c => scene%motions%component(k), node => scene%motions%node(k))
        if (c == angle) call add_moment(scene%model, platen_of(scene, k), value(k), force)
        if (c /= angle) force(c, node) = force(c, node) + value(k)
      end associate
    end do
  end subroutine add_suport_forces

  !> RBE2 whose rotation measures a mode.
  pure integer function platen_of(scene, motion) result(platen)
    type(planned_model), intent(in) :: scene
    integer, intent(in) :: motion

    platen = findloc(scene%model%constraints%platen%leader, scene%motions%node(motion), dim=1)
  end function platen_of

  !> Largest distance of its nodes from the master node [length].
  pure real(wp) function longest_arm(scene, motion)
    type(planned_model), intent(in) :: scene
    integer, intent(in) :: motion

    associate (platen => scene%model%constraints%platen(platen_of(scene, motion)))
      longest_arm = maxval(norm2(scene%model%mesh%x(:, platen%follower) - &
        spread(scene%model%mesh%x(:, platen%leader), 2, size(platen%follower)), dim=1))
    end associate
  end function longest_arm

  !> Spring of the SUPORT DOF that measures a mode.
  pure integer function spring_of_motion(scene, motion)
    type(planned_model), intent(in) :: scene   !! numbered as one system
    integer, intent(in) :: motion              !! index of the mode

    associate (reference => scene%model%constraints%reference, c => scene%motions%component(motion), &
               node => scene%motions%node(motion))
      if (c == angle) then
        spring_of_motion = scene%model%contact%rows() + count(reference) + &
                           count(scene%model%constraints%platen(:platen_of(scene, motion))%reference)
      else
        spring_of_motion = scene%model%contact%rows() + count(reference(:, :node - 1)) + &
          count(reference(:c, node))
      end if
    end associate
  end function spring_of_motion

  !> Diagonal of the stiffness at each node from elements and springs; a master node has that of the stiffest
  !! dependent node. And the largest row sum of magnitudes.
  subroutine measure(scene, bodies, stiffness, norm)
    type(planned_model), intent(in) :: scene
    class(factored_bodies), intent(in) :: bodies
    real(wp), intent(out) :: stiffness(:)   !! [force/length] [nodes]
    real(wp), intent(out) :: norm           !! [force/length]
    real(wp) :: k(most_freedoms**2), row(directions, scene%model%mesh%nodes)
    integer :: c, e, i, j, n

    stiffness = 0.0_wp
    row = 0.0_wp
    do e = 1, scene%model%mesh%elements
      n = directions*scene%model%mesh%node_count(e)
      call bodies%operator%element_stiffness(scene%model, e, bodies%law, n, k)
      do i = 1, n
        associate (node => scene%model%mesh%connectivity((i + 1)/directions, e), c => 2 - mod(i, 2))
          stiffness(node) = stiffness(node) + k(1 + (i - 1)*(n + 1))/directions
          row(c, node) = row(c, node) + sum(abs(k((i - 1)*n + 1:i*n)))
        end associate
      end do
    end do
    norm = maxval(row)
    do i = 1, size(scene%model%constraints%spring)
      do j = 1, 2
        associate (node => scene%model%constraints%spring(i)%node(j))
          if (node > 0) stiffness(node) = max(stiffness(node), scene%model%constraints%spring(i)%stiffness)
        end associate
      end do
    end do
    do i = 1, scene%model%mesh%nodes
      do c = 1, directions
        associate (leader => scene%model%constraints%leader(c, i))
          stiffness(leader) = max(stiffness(leader), stiffness(i))
        end associate
        if (scene%model%constraints%sum_of(c, i) == 0) cycle
        associate (sum => scene%model%constraints%sum(scene%model%constraints%sum_of(c, i)))
          do j = 1, size(sum%node)
            if (sum%component(j) /= angle) stiffness(sum%node(j)) = &
              max(stiffness(sum%node(j)), sum%coefficient(j)**2*stiffness(i))
          end do
        end associate
      end do
    end do
  end subroutine measure
end module epcont_linear_joined_springs
