!> Choices of the deck for the contact solver, the equation solver and the plastic iteration.
module epcont_model_controls
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: controls_type, uniaxial_curve

  !> PARAM METHOD.
  integer, parameter, public :: method_auto = 0, method_secant = 1, method_modsec = 2, method_inistr = 3, &
    method_newton = 4
  !> Their names in a deck, from method_auto on.
  character(len=*), parameter, public :: method_name(0:4) = ['AUTO  ', 'SECANT', 'MODSEC', 'INISTR', 'NEWTON']

  !> PARAM RULE.
  integer, parameter, public :: rule_auto = 0, rule_conry = 1, rule_joined = 2
  !> Their names in a deck, from rule_auto on.
  character(len=*), parameter, public :: rule_name(0:2) = ['AUTO  ', 'CONRY ', 'JOINED']

  !> PARAM SOLVER.
  integer, parameter, public :: solver_auto = 0, solver_band = 1, solver_frontal = 2
  !> Their names in a deck, from solver_auto on.
  character(len=*), parameter, public :: solver_name(0:2) = ['AUTO   ', 'BAND   ', 'FRONTAL']

  type :: controls_type
    integer :: rule = rule_auto        !! one of the values above
    integer :: method = method_auto    !! one of the values above
    integer :: solver = solver_auto    !! one of the values above
    real(wp) :: accuracy = 0.0_wp      !! PARAM ACCURACY, relative, of contact pressures; 0 if absent
    real(wp) :: tolerance = 0.0_wp     !! PARAM TOL; 0: default of the method
    integer :: most_iterations = 100   !! of a load step
    integer :: load_steps = 1          !! PARAM NLOAD, or NINC of NLPARM
    !> PARAM SEARCH, largest distance between opposite lines [length]; 0: derived from their edges
    real(wp) :: search = 0.0_wp
    !> PARAM CORNER, smallest angle of a sharp corner [degree]; 0: derived from the boundaries
    real(wp) :: corner = 0.0_wp
    logical :: paper_ratio = .false.   !! PARAM MUP PAPER: Poisson's ratio (2-4) in the equivalent strain
    logical :: steps_by_accuracy = .false.   !! flow theory: PARAM ACCURACY chooses the number of increments
    !> Each increment continues from the one before: PARAM THEORY FLOW, and elastic models with friction
    logical :: by_increments = .false.
    logical :: sequence = .false.      !! each load case starts from the end of the one before
    logical :: original = .false.      !! PARAM ORIGINAL YES: the methods of the program of about 1980
  end type controls_type

  !> Choices of PARAM ORIGINAL YES. In addition, pivots solve each contact problem from the start.
  type(controls_type), parameter, public :: original_controls = controls_type( &
    rule=rule_conry, method=method_secant, solver=solver_band, tolerance=0.01_wp, &
    paper_ratio=.true., original=.true.)

  !> Uniaxial stress-strain curve of a material that yields: total strain and stress, from (0, 0) through the
  !! yield point; extrapolated with the last slope. Not allocated if the material does not yield.
  type :: uniaxial_curve
    real(wp), allocatable :: strain(:)   !! [points]
    real(wp), allocatable :: stress(:)   !! [stress] [points]
    logical :: elastic = .false.         !! nonlinear elastic: always total theory
    real(wp) :: kinematic = 0.0_wp       !! part of the hardening by motion of the yield surface, 0 to 1
    !> Strain and stress of the last point if it only gives a slope, and no table ends there
    real(wp) :: endless(2) = -1.0_wp
  end type uniaxial_curve
end module epcont_model_controls
