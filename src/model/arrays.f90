!> Model data: arrays, without anything that follows from other arrays. A caller may change them between two
!> solves; each solve checks all of them (epcont_model_given).
module epcont_model_arrays
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: directions
  use epcont_model_controls, only: controls_type, uniaxial_curve
  use epcont_model_sections, only: sections_type
  implicit none
  private
  public :: scene_type, new_scene, set_sections, add_elements, set_pairs, count_from_one
  public :: body_load, element_block, line_couple, named_line, side_pressure
  public :: dof_tie, linear_equation, spring_type, turning_platen

  !> Component of rotations, after those of displacements.
  integer, parameter, public :: angle = directions + 1

  !> Elements of one type.
  type :: element_block
    character(len=8) :: name = ''             !! of their card: CTRIA3, CTRIA6, CQUAD4, CQUAD8, CTRAX3, CTRAX6
    !> Corners in either sense of rotation, then mid-side nodes, the first after the first corner
    !! [nodes, elements]
    integer, allocatable :: node(:, :)
    integer, allocatable :: section(:)        !! section of each element [elements]
  end type element_block

  !> A pressure on an edge of an element, linear between its corners.
  type :: side_pressure
    integer :: element = 0                    !! element that the edge belongs to
    integer :: corner(2) = 0                  !! nodes at the ends of the edge
    real(wp) :: pressure(2) = 0.0_wp          !! at these nodes, positive into the element [stress]
    real(wp) :: theta = 0.0_wp                !! counter-clockwise from the inward normal [degree]
  end type side_pressure

  !> Body load on all mass (GRAV, RFORCE): a uniform acceleration, and rotation about an axis.
  type :: body_load
    real(wp) :: factor = 1.0_wp                   !! factor of its forces
    real(wp) :: acceleration(directions) = 0.0_wp !! uniform, such as gravity [length/time**2]
    !> Point on the rotation axis, which is normal to the plane; unused for axisymmetric bodies [length]
    real(wp) :: centre(directions) = 0.0_wp
    real(wp) :: spin = 0.0_wp                     !! angular velocity about the axis [revolutions/time]
    !> Angular acceleration, counter-clockwise; forces have its sense; not axisymmetric [revolutions/time**2]
    real(wp) :: spin_up = 0.0_wp
  end type body_load

  !> A boundary line (BLSEG).
  type :: named_line
    !> In their order along the boundary, in either sense; not allocated if the card is wrong
    integer, allocatable :: node(:)
    integer :: id = 0                         !! of its card
    logical :: is_named = .false.             !! a contact names it, perhaps one of other load cases
    integer, allocatable :: side(:)           !! edges of the outline, with the body to the left; computed
    !> Least and largest coordinates of the ends of these edges [length] [2, 2]; computed
    real(wp) :: box(directions, 2) = 0.0_wp
  end type named_line

  !> Two lines that may come into contact (BCONP).
  type :: line_couple
    integer :: line(2) = 0                    !! slave and master, by their positions
    real(wp) :: friction = 0.0_wp             !! coefficient of friction
    integer :: id = 0                         !! of its card
  end type line_couple

  !> A rigid body (RBE2) whose master node rotates: its angle is an additional unknown.
  type :: turning_platen
    integer :: leader = 0                     !! master node
    integer, allocatable :: follower(:)       !! dependent nodes: u = u of the master node + angle x arm
    logical :: held = .false.                 !! the angle is prescribed
    real(wp) :: prescribed = 0.0_wp           !! the prescribed angle, counter-clockwise [radian]
    logical :: reference = .false.            !! the angle is a SUPORT DOF
    real(wp) :: moment = 0.0_wp               !! at the master node, counter-clockwise [force*length]
  end type turning_platen

  !> A DOF that has the displacement of another one in the same direction (RBE2 whose master node does not
  !! rotate).
  type :: dof_tie
    integer :: component = 0                  !! 1: x, 2: y
    integer :: node = 0                       !! dependent node
    integer :: leader = 0                     !! master node
  end type dof_tie

  !> Sum of coefficients times displacements = 0 (MPC); the first DOF depends on the others.
  type :: linear_equation
    integer, allocatable :: component(:), node(:)
    real(wp), allocatable :: coefficient(:)
  end type linear_equation

  !> A spring between two DOFs, or one and the ground (CELAS1, CELAS2).
  type :: spring_type
    integer :: component(2) = 0               !! 1: x, 2: y, of each end
    integer :: node(2) = 0                    !! 0: the ground
    real(wp) :: stiffness = 0.0_wp            !! [force/length]
    integer :: id = 0                         !! of its card
  end type spring_type

  type, extends(sections_type) :: scene_type
    real(wp), allocatable :: x(:, :)            !! coordinates [length] [2, nodes]
    type(element_block), allocatable :: block(:)   !! elements, numbered through all blocks [any]
    logical, allocatable :: held(:, :)          !! the DOF has a prescribed displacement [2, nodes]
    real(wp), allocatable :: prescribed(:, :)   !! that displacement [length] [2, nodes]
    type(dof_tie), allocatable :: tie(:)        !! [any]
    logical, allocatable :: reference(:, :)     !! SUPORT DOFs [2, nodes]
    real(wp), allocatable :: load(:, :)         !! nodal forces [force] [2, nodes]
    type(side_pressure), allocatable :: pressure(:)   !! in addition to `load` [any]
    !> Not allocated: reference temperature everywhere [temperature] [nodes]
    real(wp), allocatable :: temperature(:)
    type(body_load), allocatable :: body_load(:)      !! in addition to `load` [any]
    type(turning_platen), allocatable :: platen(:)    !! rotating rigid bodies (RBE2) [any]
    type(linear_equation), allocatable :: equation(:) !! between displacements [any]
    type(spring_type), allocatable :: spring(:)       !! [any]
    integer, allocatable :: pair_node(:, :)     !! nodes A and B that name the pair [2, pairs]
    real(wp), allocatable :: normal(:, :)       !! unit, along which B is pushed [2, pairs]
    real(wp), allocatable :: initial_gap(:)     !! [length] [pairs]
    real(wp), allocatable :: friction(:)        !! coefficient of friction; not allocated: 0 [pairs]
    !> The distance from A to B along the normal is added to these gaps (PARAM GAPGEOM YES).
    logical :: gap_by_geometry = .false.
    type(named_line), allocatable :: line(:)    !! lines of nodes [any]
    type(line_couple), allocatable :: couple(:) !! lines that may come into contact [any]
    logical :: contact_is_off = .false.         !! bodies may penetrate each other; this gives a warning
    type(controls_type) :: controls             !! of the plastic iteration
  end type scene_type

contains

  !> A model of nodes alone: no elements, supports, ties, loads, pairs and lines.
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

  !> Set the sections: of thickness 1, without mass, yielding and expansion. The caller may change
  !! these afterwards.
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

  !> Append elements of one type; their numbers continue those of the model.
  pure subroutine add_elements(scene, name, node, section)
    type(scene_type), intent(inout) :: scene   !! gets the elements
    !> Name of their card: CTRIA3, CTRIA6, CQUAD4, CQUAD8, CTRAX3, CTRAX6
    character(len=*), intent(in) :: name
    !> Corners in either sense of rotation, then mid-side nodes, the first after the first corner
    !! [nodes, elements]
    integer, intent(in) :: node(:, :)
    integer, intent(in) :: section(:)          !! section of each element [elements]
    type(element_block) :: block

    if (size(section) == 0 .and. size(node, 2) == 0) return
    block%name = name
    block%node = node
    block%section = section
    if (.not. allocated(scene%block)) allocate (scene%block(0))
    scene%block = [scene%block, block]
  end subroutine add_elements

  !> Set the pairs of nodes that may come into contact, numbered from 1.
  pure subroutine set_pairs(scene, node, normal, gap)
    type(scene_type), intent(inout) :: scene   !! is changed
    integer, intent(in) :: node(:, :)          !! A and B [2, pairs]
    real(wp), intent(in) :: normal(:, :)       !! unit, along which B is pushed; zero: from A to B [2, pairs]
    real(wp), intent(in) :: gap(:)             !! initial [length] [pairs]

    scene%pair_node = node
    scene%normal = normal
    scene%initial_gap = gap
  end subroutine set_pairs

  !> Copy the model with all arrays counted from 1, which a caller's need not be, and of lines only the
  !! given data.
  subroutine count_from_one(given, scene)
    type(scene_type), intent(in) :: given    !! its arrays are allocated, with correct shapes
    type(scene_type), intent(out) :: scene   !! the copy

    scene = new_scene(given%x)   ! its arrays count from 1, and keep this if the shape is the same
    scene%held = given%held
    scene%prescribed = given%prescribed
    scene%reference = given%reference
    scene%load = given%load
    call set_sections(scene, given%young, given%poisson, given%kinematics)
    scene%thickness = given%thickness
    if (allocated(given%density)) scene%density = given%density
    call set_pairs(scene, given%pair_node, given%normal, given%initial_gap)
    if (allocated(given%friction)) scene%friction = given%friction(:)
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

    !> Copy the arrays within arrays that are allocated.
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
        scene%curve(i)%elastic = curve(i)%elastic
        scene%curve(i)%kinematic = curve(i)%kinematic
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
