!> Energy balance of an increment, by the trapezoidal rule: the work of loads, supports and contact forces,
!> friction included, is the change of stored energy, the dissipation and the work in thermal strains.
module epcont_certificate_increment_work
  use epcont_base_archive, only: archive
  use epcont_base_kinds, only: wp
  use epcont_certificate_yielding, only: replayed_history
  use epcont_element_kinematics, only: components
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: point_energies, work_state, work_without_end

  !> Energies of points and pairs [energy].
  type :: point_energies
    real(wp) :: stored = 0.0_wp       !! elastic, and by the back stress, after the increment
    real(wp) :: dissipated = 0.0_wp   !! by yielding, in the increment
    real(wp) :: rubbed = 0.0_wp       !! by friction, with the forces at its end
    real(wp) :: heat = 0.0_wp         !! work of the stresses in thermal strains, in the increment
    real(wp) :: least = 0.0_wp        !! smallest dissipation of a point or pair
  contains
    procedure :: add_point
    procedure :: include
  end type point_energies

  !> Forces, displacements and plastic history at the end of an increment.
  type :: work_state
    !> Sums of loads, reactions and contact forces [force] [directions, nodes]
    real(wp), allocatable :: force(:, :)
    real(wp), allocatable :: friction(:, :)       !! the part of it that is friction
    real(wp), allocatable :: displacement(:, :)   !! [length] [directions, nodes]
    type(replayed_history), allocatable :: history(:)   !! plastic, from displacements alone [points]
    real(wp), allocatable :: moment(:), turn(:)   !! of supports of rotating platens [force*length], [rad]
    real(wp) :: stored = 0.0_wp                   !! energy, springs included
    real(wp) :: dissipated = 0.0_wp               !! energy, by yielding and friction, in the increment
    real(wp) :: friction_work = 0.0_wp            !! by trapezoids; may be negative if increments are large
    real(wp) :: off_curve = 0.0_wp                !! stress error
  contains
    procedure :: imbalance
    procedure :: pass
  end type work_state

contains

  !> State without forces and displacements.
  pure type(work_state) function work_without_end(model) result(state)
    type(model_type), intent(in) :: model

    allocate (state%force, mold=model%mesh%x)
    state%force = 0.0_wp
    state%friction = state%force
    state%displacement = state%force
    allocate (state%history(model%mesh%points))
    allocate (state%moment(size(model%constraints%platen)), source=0.0_wp)
    state%turn = state%moment
  end function work_without_end

  !> Add the energies of an integration point.
  pure subroutine add_point(self, model, section, volume, strain, before, after)
    class(point_energies), intent(inout) :: self
    type(model_type), intent(in) :: model
    integer, intent(in) :: section
    real(wp), intent(in) :: volume               !! [length**3]
    real(wp), intent(in) :: strain(components)   !! without thermal strain
    type(replayed_history), intent(in) :: before, after   !! the increment
    real(wp) :: done, back(2), stress(components)

    back = 0.0_wp
    if (allocated(model%sections%curve(section)%strain)) &
      back = [before%energy_of_back_stress(model, section), after%energy_of_back_stress(model, section)]
    stress = 0.5_wp*(before%stress + after%stress)
    done = volume*(dot_product(stress, after%plastic - before%plastic) - (back(2) - back(1)))
    self%stored = self%stored + volume*(0.5_wp*dot_product(after%stress, strain - after%plastic) + back(2))
    self%dissipated = self%dissipated + done
    self%least = min(self%least, done)
    self%heat = self%heat + volume*sum(stress(:3))*(after%free - before%free)
  end subroutine add_point

  !> Add the energies of other points.
  pure subroutine include(self, other)
    class(point_energies), intent(inout) :: self
    type(point_energies), intent(in) :: other

    self%stored = self%stored + other%stored
    self%dissipated = self%dissipated + other%dissipated
    self%heat = self%heat + other%heat
    self%least = min(self%least, other%least)
  end subroutine include

  !> Store the state in an archive, or restore it.
  pure subroutine pass(self, file)
    class(work_state), intent(inout) :: self
    type(archive), intent(inout) :: file
    real(wp), allocatable :: history(:), numbers(:)

    numbers = [self%stored, self%off_curve]
    if (.not. file%reading) history = transfer(self%history, [0.0_wp])
    call file%pass(history)
    self%history = transfer(history, [replayed_history()])
    call file%pass(self%force)
    call file%pass(self%friction)
    call file%pass(self%displacement)
    call file%pass(self%moment)
    call file%pass(self%turn)
    call file%pass(numbers)
    self%stored = numbers(1)
    self%off_curve = numbers(2)
  end subroutine pass

  !> Find the relative energy error of an increment. It is the larger of the imbalance and the most negative
  !! dissipation at a point or pair, over the sum of absolute energies. Stress errors explain a part of it.
  pure real(wp) function imbalance(self, before, points)
    class(work_state), intent(in) :: self
    type(work_state), intent(in) :: before
    type(point_energies), intent(in) :: points
    real(wp) :: terms, turned(size(self%turn)), work(size(self%force, 1), size(self%force, 2))

    work = 0.5_wp*(before%force + self%force)*(self%displacement - before%displacement)
    turned = 0.5_wp*(before%moment + self%moment)*(self%turn - before%turn)
    terms = sum(abs(work)) + sum(abs(turned)) + abs(before%stored) + abs(self%stored) + &
            abs(points%dissipated) + abs(points%heat)
    imbalance = abs(sum(work) + sum(turned) - (self%stored - before%stored) - points%dissipated - &
                    points%heat)
    imbalance = max(imbalance, -points%least)/max(terms, tiny(terms)) - before%off_curve - self%off_curve
  end function imbalance
end module epcont_certificate_increment_work
