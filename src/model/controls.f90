!> What the deck asks of the solvers, of contact and of equations, and of the plastic iteration.
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
    integer :: rule = rule_auto        !! one of its kind above
    integer :: method = method_auto    !! one of its kind above
    integer :: solver = solver_auto    !! one of its kind above
    real(wp) :: accuracy = 0.0_wp      !! PARAM ACCURACY, relative, of contact pressures; 0: none asked for
    real(wp) :: tolerance = 0.0_wp     !! PARAM TOL; 0: that of the method
    integer :: most_iterations = 100   !! of a load step
    integer :: load_steps = 1          !! PARAM NLOAD, or NINC of NLPARM
    !> PARAM SEARCH, how far lines look for each other [length]; 0: by their sides
    real(wp) :: search = 0.0_wp
    !> PARAM CORNER, turns above it are corners [degree]; 0: by how boundaries turn
    real(wp) :: corner = 0.0_wp
    logical :: by_inversion = .false.  !! PARAM FLEXIB INVERT: flexibility by inversion, whatever it costs
    logical :: paper_ratio = .false.   !! PARAM MUP PAPER: Poisson's ratio (2-4) in the equivalent strain
    logical :: flow_theory = .false.   !! PARAM THEORY FLOW: each increment goes on from the one before
    logical :: original = .false.      !! PARAM ORIGINAL YES: as the program of about 1980 did it all
  end type controls_type

  !> What PARAM ORIGINAL YES chooses. Each contact problem is solved from the start, by pivots, too.
  type(controls_type), parameter, public :: original_controls = controls_type( &
    rule=rule_conry, method=method_secant, solver=solver_band, tolerance=0.01_wp, &
    by_inversion=.true., paper_ratio=.true., original=.true.)

  !> Uniaxial curve of a material that yields: total strain and stress, from (0, 0) over the yield point on.
  !! Beyond the last point its last slope goes on. Not allocated: the material does not yield.
  type :: uniaxial_curve
    real(wp), allocatable :: strain(:)   !! [points]
    real(wp), allocatable :: stress(:)   !! [stress] [points]
    !> The last point, where it is not the end of a table but of a line without end: strain, stress
    real(wp) :: endless(2) = -1.0_wp
  end type uniaxial_curve
end module epcont_model_controls
