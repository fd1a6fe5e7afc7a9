!> Load cases of a model: the contents of sets of loads and supports, and the sets of each case. A model
!> has the loads of one case at a time (`put_case`).
module epcont_model_load_cases
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle, body_load, scene_type, side_pressure
  use epcont_model_body_forces, only: put_body_forces
  use epcont_model_expansion, only: find_free_strains
  use epcont_model_freedoms, only: find_travels
  use epcont_model_model, only: model_type
  use epcont_model_pressure, only: add_pressure
  use epcont_model_ties, only: add_moment
  implicit none
  private
  public :: find_still, load_case, load_cases, put_case, single_case

  !> Contacts of a case, if it is not the id of a single BCONP.
  integer, parameter, public :: contact_all = 0, contact_none = -1

  !> A force at a node.
  type, public :: nodal_force
    integer :: set = 0                          !! id of its set
    integer :: node = 0
    real(wp) :: force(directions) = 0.0_wp      !! [force]
  end type nodal_force

  !> A pressure on an edge of an element.
  type, public :: set_pressure
    integer :: set = 0                          !! id of its set
    type(side_pressure) :: given
  end type set_pressure

  !> A load on all mass.
  type, public :: set_body_load
    integer :: set = 0                          !! id of its set
    type(body_load) :: given                    !! factor 0: no case uses it
  end type set_body_load

  !> A moment at the master node of a rotating platen.
  type, public :: set_moment
    integer :: set = 0                          !! id of its set
    integer :: platen = 0
    real(wp) :: moment = 0.0_wp                 !! [force*length]
  end type set_moment

  !> A displacement of a fixed DOF.
  type, public :: set_displacement
    integer :: set = 0                          !! id of its set
    integer :: c = 0, node = 0                  !! direction and node; or `angle` and platen
    real(wp) :: displacement = 0.0_wp           !! [length]
    integer :: card = 0, field = 0              !! its SPC or SPCD, and the field of the node
  end type set_displacement

  !> Temperatures of all nodes.
  type, public :: set_temperatures
    integer :: set = 0                          !! id of its set
    real(wp), allocatable :: temperature(:)     !! [nodes]
  end type set_temperatures

  !> Sets of a load case.
  type :: load_case
    integer :: id = 0                           !! of its SUBCASE, 0 if absent
    integer, allocatable :: set(:)              !! ids of its sets of loads
    real(wp), allocatable :: factor(:)          !! of each set
    integer :: supports = 0                     !! id of its set of supports, 0 if absent
    integer :: temperatures = 0                 !! id of its set of temperatures, 0 if absent
    integer :: contact = 0                      !! its single BCONP; contact_all or contact_none
    integer :: load_steps = 1                   !! in which its loads are applied
    logical :: steps_by_accuracy = .false.      !! PARAM ACCURACY chooses their number
    integer :: most_iterations = 100            !! of a load step
    real(wp) :: tolerance = 0.0_wp              !! of the iteration; 0: default of the method
    integer :: pattern = 1                      !! group of cases with the same supports and contacts
  contains
    procedure :: share_of
    procedure :: where_text
  end type load_case

  !> All load cases, and the contents of their sets.
  type :: load_cases
    type(load_case), allocatable :: case(:)
    logical :: sequence = .false.                          !! each starts from the end of the one before
    integer :: patterns = 1                                !! number of groups that are solved separately
    type(nodal_force), allocatable :: force(:)             !! FORCE
    type(set_pressure), allocatable :: pressure(:)         !! PLOADX1
    type(set_body_load), allocatable :: body(:)            !! each GRAV, then each RFORCE
    type(set_moment), allocatable :: moment(:)             !! MOMENT
    type(set_displacement), allocatable :: held_at(:)      !! SPC with a displacement, in sets of supports
    type(set_displacement), allocatable :: moved(:)        !! SPCD in sets of loads: replaces `held_at`
    type(set_temperatures), allocatable :: heat(:)         !! TEMP and TEMPD of the sets that cases use
  contains
    procedure :: of_pattern
  end type load_cases

contains

  !> Make the only load case of model data from arrays: set 1 of each load.
  pure function single_case(data) result(cases)
    type(scene_type), intent(in) :: data   !! model data, checked
    type(load_cases) :: cases
    integer :: c, i

    allocate (cases%case(1))
    cases%sequence = data%controls%sequence
    cases%case(1)%set = [1]
    cases%case(1)%factor = [1.0_wp]
    cases%case(1)%supports = 1
    cases%case(1)%load_steps = data%controls%load_steps
    cases%case(1)%most_iterations = data%controls%most_iterations
    cases%case(1)%tolerance = data%controls%tolerance
    cases%force = [(nodal_force(1, i, data%load(:, i)), i=1, size(data%load, 2))]
    cases%pressure = [(set_pressure(1, data%pressure(i)), i=1, size(data%pressure))]
    cases%body = [(set_body_load(1, data%body_load(i)), i=1, size(data%body_load))]
    cases%moment = [(set_moment(1, i, data%platen(i)%moment), i=1, size(data%platen))]
    cases%held_at = [((set_displacement(1, c, i, data%prescribed(c, i)), c=1, directions), &
                      i=1, size(data%prescribed, 2)), &
                     (set_displacement(1, angle, i, data%platen(i)%prescribed), i=1, size(data%platen))]
    allocate (cases%moved(0), cases%heat(merge(1, 0, allocated(data%temperature))))
    if (.not. allocated(data%temperature)) return
    cases%case(1)%temperatures = 1
    cases%heat(1)%set = 1
    cases%heat(1)%temperature = data%temperature
  end function single_case

  !> Cases of a pattern, in their order.
  pure function of_pattern(self, pattern) result(cases)
    class(load_cases), intent(in) :: self
    integer, intent(in) :: pattern   !! number of the pattern
    integer, allocatable :: cases(:)
    integer :: k

    cases = pack([(k, k=1, size(self%case))], self%case%pattern == pattern)
  end function of_pattern

  !> Apply a load case to a model, replacing the one before.
  pure subroutine put_case(cases, k, model)
    type(load_cases), intent(in) :: cases      !! all of them
    integer, intent(in) :: k                   !! number of the case
    type(model_type), intent(inout) :: model   !! the model
    real(wp) :: share
    integer :: i

    associate (case => cases%case(k))
      model%loads%load = 0.0_wp
      do i = 1, size(cases%force)
        share = case%share_of(cases%force(i)%set)
        associate (load => model%loads%load(:, cases%force(i)%node))
          if (share /= 0.0_wp) load = load + share*cases%force(i)%force
        end associate
      end do
      do i = 1, size(cases%pressure)
        share = case%share_of(cases%pressure(i)%set)
        if (share /= 0.0_wp) call add_pressure(model, cases%pressure(i)%given, share)
      end do
      model%loads%body_load = cases%body%given
      do i = 1, size(cases%body)
        model%loads%body_load(i)%factor = case%share_of(cases%body(i)%set)*model%loads%body_load(i)%factor
      end do
      call put_body_forces(model)
      do i = 1, size(cases%moment)
        share = case%share_of(cases%moment(i)%set)
        call add_moment(model, cases%moment(i)%platen, share*cases%moment(i)%moment, model%loads%load)
      end do
    end associate
    model%controls%sequence = cases%sequence
    model%controls%load_steps = cases%case(k)%load_steps
    model%controls%steps_by_accuracy = cases%case(k)%steps_by_accuracy
    model%controls%most_iterations = cases%case(k)%most_iterations
    model%controls%tolerance = cases%case(k)%tolerance
    call put_displacements(cases, cases%case(k), model)
    call find_travels(model)
    call put_temperatures(cases, cases%case(k), model)
  end subroutine put_case

  !> Apply the temperatures of a case and their thermal strains.
  pure subroutine put_temperatures(cases, case, model)
    type(load_cases), intent(in) :: cases
    type(load_case), intent(in) :: case
    type(model_type), intent(inout) :: model
    integer :: e, k, n

    if (allocated(model%loads%rise)) deallocate (model%loads%rise)
    k = findloc(cases%heat%set, case%temperatures, dim=1)
    if (k > 0) then
      allocate (model%loads%rise, source=0.0_wp*model%mesh%connectivity)
      do e = 1, model%mesh%elements
        n = model%mesh%node_count(e)
        model%loads%rise(:n, e) = cases%heat(k)%temperature(model%mesh%connectivity(:n, e)) - &
                                  model%sections%reference_temperature(model%mesh%section(e))
      end do
    end if
    call find_free_strains(model)
  end subroutine put_temperatures

  !> Apply the prescribed displacements of a case.
  pure subroutine put_displacements(cases, case, model)
    type(load_cases), intent(in) :: cases
    type(load_case), intent(in) :: case
    type(model_type), intent(inout) :: model
    real(wp), allocatable :: prescribed(:, :)   ! with the angles of platens
    integer :: i

    allocate (prescribed(angle, max(model%mesh%nodes, size(model%constraints%platen))), source=0.0_wp)
    do i = 1, size(cases%held_at)
      associate (at => cases%held_at(i))
        if (at%set == case%supports) prescribed(at%c, at%node) = at%displacement
      end associate
    end do
    do i = 1, size(cases%moved)   ! SPCD replaces SPC
      associate (at => cases%moved(i))
        if (any(case%set == at%set)) prescribed(at%c, at%node) = case%share_of(at%set)*at%displacement
      end associate
    end do
    model%loads%prescribed = prescribed(:directions, :model%mesh%nodes)
    model%loads%rotation = prescribed(angle, :size(model%constraints%platen))
  end subroutine put_displacements

  !> Find the DOFs that are held and not displaced in any load case [2, nodes].
  pure subroutine find_still(cases, held, still)
    type(load_cases), intent(in) :: cases
    logical, intent(in) :: held(:, :)   !! [2, nodes]
    logical, allocatable, intent(out) :: still(:, :)
    integer :: i

    still = held
    do i = 1, size(cases%held_at)
      associate (at => cases%held_at(i))
        if (at%c <= directions .and. at%displacement /= 0.0_wp) still(at%c, at%node) = .false.
      end associate
    end do
    do i = 1, size(cases%moved)
      associate (at => cases%moved(i))
        if (at%c <= directions) still(at%c, at%node) = .false.
      end associate
    end do
  end subroutine find_still

  !> Factor of a set of loads in a case; 0 if the case does not use it.
  pure real(wp) function share_of(case, set) result(share)
    class(load_case), intent(in) :: case
    integer, intent(in) :: set
    integer :: i

    share = 0.0_wp
    do i = 1, size(case%set)
      if (case%set(i) == set) share = share + case%factor(i)
    end do
  end function share_of

  !> ` in SUBCASE 2`; empty if the deck has no SUBCASE.
  pure function where_text(case) result(text)
    class(load_case), intent(in) :: case
    character(len=:), allocatable :: text

    text = ''
    if (case%id > 0) text = ' in SUBCASE '//text_of(case%id)
  end function where_text
end module epcont_model_load_cases
