!> What a scene is given by: arrays, with nothing in them that follows from others. They may be changed as one
!> likes between two solves: each looks at all of them (epcont_model_given).
module epcont_model_arrays
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_controls, only: controls_type, uniaxial_curve
  implicit none
  private
  public :: scene_type, new_scene, set_sections, add_elements, set_pairs, count_from_one
  public :: body_load, element_block, line_couple, named_line, side_pressure
  public :: dof_tie, linear_equation, spring_type, turning_platen

  !> The component of what turns: behind those of displacements.
  integer, parameter, public :: angle = directions + 1

  !> Elements of one kind.
  type :: element_block
    character(len=8) :: name = ''             !! of their card: CTRIA3, CTRIA6, CQUAD4, CQUAD8, CTRAX3, CTRAX6
    !> Corners in either turning sense, then middles of sides, the first behind the first corner
    !! [nodes, elements]
    integer, allocatable :: node(:, :)
    integer, allocatable :: section(:)        !! of each [elements]
  end type element_block

  !> A pressure along a side of an element, linear from one of its corners to the other.
  type :: side_pressure
    integer :: element = 0                    !! whose side it is
    integer :: corner(2) = 0                  !! nodes at the ends of the side
    real(wp) :: pressure(2) = 0.0_wp          !! at these, positive into the element [stress]
    real(wp) :: theta = 0.0_wp                !! counter-clockwise from the inward normal [degree]
  end type side_pressure

  !> What acts on all mass (GRAV, RFORCE): a uniform acceleration, and what a spin about a centre makes.
  type :: body_load
    real(wp) :: factor = 1.0_wp                   !! of its forces
    real(wp) :: acceleration(directions) = 0.0_wp !! uniform, such as gravity [length/time**2]
    !> What the axis of the spin, across the plane, goes through; rings spin about theirs [length]
    real(wp) :: centre(directions) = 0.0_wp
    real(wp) :: spin = 0.0_wp                     !! pushes away from the axis [revolutions/time]
    !> Counter-clockwise; forces go along it, against those of inertia. None of rings [revolutions/time**2]
    real(wp) :: spin_up = 0.0_wp
  end type body_load

  !> A boundary line (BLSEG).
  type :: named_line
    !> In their order along the boundary, in either sense; none: they were not sound
    integer, allocatable :: node(:)
    integer :: id = 0                         !! of its card
    logical :: is_named = .false.             !! by a contact, perhaps one that is off in this load case
    integer, allocatable :: side(:)           !! of the outline, with the body to the left; found
    !> Least and largest coordinates of their ends [length] [2, 2]; found
    real(wp) :: box(directions, 2) = 0.0_wp
  end type named_line

  !> Two lines that may touch (BCONP).
  type :: line_couple
    integer :: line(2) = 0                    !! slave and master, by their positions
    integer :: id = 0                         !! of its card
  end type line_couple

  !> A node that leads others as a rigid body does (RBE2), and turns: its angle is one more unknown.
  type :: turning_platen
    integer :: leader = 0                     !! the node
    integer, allocatable :: follower(:)       !! u = u of the leader + angle x arm
    logical :: held = .false.                 !! the angle is prescribed
    real(wp) :: prescribed = 0.0_wp           !! that angle, counter-clockwise [radian]
    logical :: reference = .false.            !! it is a SUPORT freedom
    real(wp) :: moment = 0.0_wp               !! at the leader, counter-clockwise [force*length]
  end type turning_platen

  !> A DOF that has the displacement of another one in the same direction (RBE2 whose master node does not
  !! rotate).
  type :: dof_tie
    integer :: component = 0                  !! 1: x, 2: y
    integer :: node = 0                       !! dependent node
    integer :: leader = 0                     !! master node
  end type dof_tie

  !> Sum of coefficients times displacements = 0 (MPC); the first freedom follows the others.
  type :: linear_equation
    integer, allocatable :: component(:), node(:)
    real(wp), allocatable :: coefficient(:)
  end type linear_equation

  !> A spring between two freedoms, or one and the ground (CELAS1, CELAS2).
  type :: spring_type
    integer :: component(2) = 0               !! 1: x, 2: y, of each end
    integer :: node(2) = 0                    !! 0: the ground
    real(wp) :: stiffness = 0.0_wp            !! [force/length]
    integer :: id = 0                         !! of its card
  end type spring_type

  type :: scene_type
    real(wp), allocatable :: x(:, :)            !! coordinates [length] [2, nodes]
    type(element_block), allocatable :: block(:)   !! elements, numbered through all blocks [any]
    real(wp), allocatable :: young(:)           !! [stress] [sections]
    real(wp), allocatable :: poisson(:)         !! [sections]
    integer, allocatable :: kinematics(:)       !! plane_strain, plane_stress or axisymmetric [sections]
    real(wp), allocatable :: thickness(:)       !! [length] [sections]
    real(wp), allocatable :: density(:)         !! [mass/length**3] [sections]
    type(uniaxial_curve), allocatable :: curve(:)  !! how each section yields, if it does [sections]
    real(wp), allocatable :: expansion(:)       !! strain for each degree [1/temperature] [sections]
    real(wp), allocatable :: reference_temperature(:)   !! at which there is none [temperature] [sections]
    logical, allocatable :: held(:, :)          !! the freedom has a prescribed displacement [2, nodes]
    real(wp), allocatable :: prescribed(:, :)   !! that displacement [length] [2, nodes]
    type(dof_tie), allocatable :: tie(:)        !! [any]
    logical, allocatable :: reference(:, :)     !! SUPORT freedoms [2, nodes]
    real(wp), allocatable :: load(:, :)         !! nodal forces [force] [2, nodes]
    type(side_pressure), allocatable :: pressure(:)   !! in addition to these [any]
    !> Not allocated: that of reference everywhere [temperature] [nodes]
    real(wp), allocatable :: temperature(:)
    type(body_load), allocatable :: body_load(:)      !! and to those [any]
    type(turning_platen), allocatable :: platen(:)    !! nodes that lead others and turn [any]
    type(linear_equation), allocatable :: equation(:) !! between displacements [any]
    type(spring_type), allocatable :: spring(:)       !! [any]
    integer, allocatable :: pair_node(:, :)     !! nodes A and B that name the pair [2, pairs]
    real(wp), allocatable :: normal(:, :)       !! unit, along which B is pushed [2, pairs]
    real(wp), allocatable :: initial_gap(:)     !! [length] [pairs]
    !> The distance from A to B along the normal is added to these gaps (PARAM GAPGEOM YES).
    logical :: gap_by_geometry = .false.
    type(named_line), allocatable :: line(:)    !! lines of nodes [any]
    type(line_couple), allocatable :: couple(:) !! which of these may touch [any]
    logical :: contact_is_off = .false.         !! bodies may pass through each other, which is warned of
    type(controls_type) :: controls             !! of the plastic iteration
  end type scene_type

contains

  !> A scene of nodes alone: no elements, supports, ties, loads, pairs and lines.
  function new_scene(x) result(scene)
    real(wp), intent(in) :: x(:, :)            !! their coordinates [length] [2, nodes]
    type(scene_type) :: scene
    integer :: nodes

    nodes = size(x, 2)
    scene%x = x
    allocate (scene%held(directions, nodes), scene%reference(directions, nodes), source=.false.)
    allocate (scene%prescribed(directions, nodes), scene%load(directions, nodes), source=0.0_wp)
    allocate (scene%block(0), scene%pressure(0), scene%body_load(0), scene%line(0), scene%couple(0))
    allocate (scene%tie(0), scene%platen(0), scene%equation(0), scene%spring(0))
    call set_sections(scene, [real(wp) ::], [real(wp) ::], [integer ::])
    call set_pairs(scene, reshape([integer ::], [2, 0]), reshape([real(wp) ::], [2, 0]), [real(wp) ::])
  end function new_scene

  !> What elements are made of; of thickness 1, without mass, and nothing yields or expands: that may be
  !! changed.
  pure subroutine set_sections(scene, young, poisson, kinematics)
    type(scene_type), intent(inout) :: scene   !! is changed
    real(wp), intent(in) :: young(:)           !! [stress] [sections]
    real(wp), intent(in) :: poisson(:)         !! [sections]
    integer, intent(in) :: kinematics(:)       !! plane_strain, plane_stress or axisymmetric [sections]

    scene%young = young
    scene%poisson = poisson
    scene%kinematics = kinematics
    scene%thickness = spread(1.0_wp, 1, size(young))
    scene%expansion = spread(0.0_wp, 1, size(young))
    scene%reference_temperature = scene%expansion
    scene%density = spread(0.0_wp, 1, size(young))
    if (allocated(scene%curve)) deallocate (scene%curve)
    allocate (scene%curve(size(young)))
  end subroutine set_sections

  !> Elements of one kind, behind those that the scene has; their numbers go on.
  pure subroutine add_elements(scene, name, node, section)
    type(scene_type), intent(inout) :: scene   !! is added to
    !> Of their card: CTRIA3, CTRIA6, CQUAD4, CQUAD8, CTRAX3, CTRAX6
    character(len=*), intent(in) :: name
    !> Corners in either turning sense, then middles of sides, the first behind the first corner
    !! [nodes, elements]
    integer, intent(in) :: node(:, :)
    integer, intent(in) :: section(:)          !! of each [elements]
    type(element_block), allocatable :: longer(:)
    integer :: blocks, i

    if (size(section) == 0 .and. size(node, 2) == 0) return
    blocks = 0
    if (allocated(scene%block)) blocks = size(scene%block)
    allocate (longer(blocks + 1))
    do i = 1, blocks   ! the lists of blocks before are not copied for each that comes
      longer(i)%name = scene%block(i)%name
      call move_alloc(scene%block(i)%node, longer(i)%node)
      call move_alloc(scene%block(i)%section, longer(i)%section)
    end do
    longer(blocks + 1)%name = name
    longer(blocks + 1)%node = node
    longer(blocks + 1)%section = section
    call move_alloc(longer, scene%block)
  end subroutine add_elements

  !> Pairs of nodes that may touch, numbered from 1 on.
  pure subroutine set_pairs(scene, node, normal, gap)
    type(scene_type), intent(inout) :: scene   !! is changed
    integer, intent(in) :: node(:, :)          !! A and B [2, pairs]
    real(wp), intent(in) :: normal(:, :)       !! unit, along which B is pushed; zero: from A to B [2, pairs]
    real(wp), intent(in) :: gap(:)             !! initial [length] [pairs]

    scene%pair_node = node
    scene%normal = normal
    scene%initial_gap = gap
  end subroutine set_pairs

  !> The same scene with all its arrays counted from 1, which those of a caller need not be, and of lines
  !! nothing but what is given.
  subroutine count_from_one(given, scene)
    type(scene_type), intent(in) :: given    !! its arrays are there, and of the shapes that they must have
    type(scene_type), intent(out) :: scene   !! with them

    scene = new_scene(given%x)   ! of arrays counted from 1, which stay so where the shape is the same
    scene%held = given%held
    scene%prescribed = given%prescribed
    scene%reference = given%reference
    scene%load = given%load
    call set_sections(scene, given%young, given%poisson, given%kinematics)
    scene%thickness = given%thickness
    if (allocated(given%density)) scene%density = given%density
    call set_pairs(scene, given%pair_node, given%normal, given%initial_gap)
    scene%pressure = given%pressure(:)
    if (allocated(given%temperature)) then
      scene%temperature = given%temperature(:)
      scene%expansion = given%expansion
      scene%reference_temperature = given%reference_temperature
    end if
    if (allocated(given%body_load)) scene%body_load = given%body_load(:)
    if (allocated(given%spring)) scene%spring = given%spring(:)
    if (allocated(given%tie)) scene%tie = given%tie(:)
    scene%couple = given%couple(:)
    deallocate (scene%block, scene%line)
    allocate (scene%block(size(given%block)), scene%line(size(given%line)))
    scene%controls = given%controls
    scene%contact_is_off = given%contact_is_off
    scene%gap_by_geometry = given%gap_by_geometry
    call copy_lists(given%block, given%curve, given%line)
    if (allocated(given%platen)) call copy_platens(given%platen)
    if (allocated(given%equation)) call copy_equations(given%equation)

  contains

    !> Arrays within arrays, where they are allocated.
    subroutine copy_lists(block, curve, line)
      type(element_block), intent(in) :: block(:)
      type(uniaxial_curve), intent(in) :: curve(:)
      type(named_line), intent(in) :: line(:)
      integer :: i

      do i = 1, size(block)
        scene%block(i)%name = block(i)%name
        if (allocated(block(i)%node)) scene%block(i)%node = block(i)%node(:, :)
        if (allocated(block(i)%section)) scene%block(i)%section = block(i)%section(:)
      end do
      do i = 1, size(curve)
        if (allocated(curve(i)%strain)) scene%curve(i)%strain = curve(i)%strain(:)
        if (allocated(curve(i)%stress)) scene%curve(i)%stress = curve(i)%stress(:)
        scene%curve(i)%endless = curve(i)%endless
      end do
      do i = 1, size(line)
        if (allocated(line(i)%node)) scene%line(i)%node = line(i)%node(:)
      end do
    end subroutine copy_lists

    subroutine copy_platens(platen)
      type(turning_platen), intent(in) :: platen(:)
      integer :: i

      deallocate (scene%platen)
      allocate (scene%platen(size(platen)))
      do i = 1, size(platen)
        scene%platen(i) = platen(i)
        if (allocated(platen(i)%follower)) scene%platen(i)%follower = platen(i)%follower(:)
      end do
    end subroutine copy_platens

    subroutine copy_equations(equation)
      type(linear_equation), intent(in) :: equation(:)
      integer :: i

      deallocate (scene%equation)
      allocate (scene%equation(size(equation)))
      do i = 1, size(equation)
        if (allocated(equation(i)%component)) scene%equation(i)%component = equation(i)%component(:)
        if (allocated(equation(i)%node)) scene%equation(i)%node = equation(i)%node(:)
        if (allocated(equation(i)%coefficient)) scene%equation(i)%coefficient = equation(i)%coefficient(:)
      end do
    end subroutine copy_equations
  end subroutine count_from_one
end module epcont_model_arrays
