!> Table of all cards and fields. The reader checks cards with it, and `epcont --cards` prints it. Columns are
!> defined nowhere else.
module epcont_deck_catalogue
  use epcont_deck_card_kinds, only: card_kinds
  use epcont_deck_entry, only: card_entry, field_entry, new_field
  implicit none
  private
  public :: catalogue, parameters

  !> Cards in the order of `epcont_deck_card_kinds`: name and meaning. Under each card are its fields in their
  !! order (fields 2 to 9, then 12 to 19, and so on), as `new_field` reads them; `like` copies the first
  !! fields of an earlier card. A list may follow: `ids`, with `ranges` and `steps`; or records, whose fields
  !! have the word `each`, one record after the other or `two_a_line`. ENDT follows the last record.
  character(len=*), parameter :: scene_cards(*) = [character(len=140) :: &
    'GRID: node', &
    '  ID; id; node', &
    '  CP; system only_zero; system of X1 to X3: the basic one', &
    '  X1; real zero point_optional; coordinate x [length]', &
    '  X2; real zero point_optional; coordinate y [length]', &
    '  X3; real only_zero point_optional; coordinate z [length] | models are in the x-y plane', &
    '  CD; system only_zero; system of the displacements: the basic one', &
    '  PS; digits optional; permanent supports', &
    'CTRIA3: constant-strain triangle', &
    '  EID; id; element', &
    '  PID; id; its PSHELL', &
    '  G1; id; first node, in either turning sense', &
    '  G2; id; second node', &
    '  G3; id; third node', &
    'PSHELL: plane section', &
    '  PID; id; property', &
    '  MID1; id; its MAT1', &
    '  T; real needed positive; thickness [length]', &
    '  MID2; whole from=-1 to=99999999 heard_to=-1; -1: plane strain; else as PARAM PLANE says', &
    '  ; any ignored times=3; bending', &
    '  NSM; real; non-structural mass of a unit of area', &
    '  ; any ignored times=3; bending', &
    'MAT1: isotropic elastic material; two of E, G, NU', &
    '  MID; id; material', &
    '  E; real positive; Young''s modulus [stress]', &
    '  G; real positive; shear modulus [stress]', &
    '  NU; real from=0 below=0.5; Poisson''s ratio | with 0.5 the bulk modulus is infinite', &
    '  RHO; real; density', &
    '  A; real cause zero; thermal expansion: strain by one degree', &
    '  TREF; real zero; temperature without thermal strain', &
    '  GE; real ignored; damping', &
    '  ST; real ignored; limit of tension [stress]', &
    '  SC; real ignored; limit of compression [stress]', &
    '  SS; real ignored; limit of shear [stress]', &
    '  MCSID; system ignored; material system', &
    'SPC: supports, with prescribed displacements', &
    '  SID; id; set', &
    '  G1; id; node', &
    '  C1; digits; directions', &
    '  D1; real zero cause; displacement [length]', &
    '  G2; id with_next; second node', &
    '  C2; digits with_last with_next; directions', &
    '  D2; real zero cause; displacement [length]', &
    'SPC1: supports', &
    '  SID; id; set', &
    '  C; digits; directions; 3 to 6 have no effect in plane models', &
    '  G; ids ranges; nodes, or G1 THRU G2', &
    'FORCE: force F*N at a node', &
    '  SID; id; set', &
    '  G; id; node', &
    '  CID; system only_zero; system of N1 to N3: the basic one', &
    '  F; real needed cause; factor [force]', &
    '  N1; real zero; direction x', &
    '  N2; real zero; direction y', &
    '  N3; real only_zero; direction z | models are in the x-y plane', &
    'PLOADX1: pressure on the edge of an element', &
    '  SID; id; set', &
    '  EID; id; element', &
    '  PA; real needed cause; pressure at GA, positive into the element [stress]', &
    '  PB; real as_last cause; pressure at GB [stress]', &
    '  GA; id; corner at which the edge begins', &
    '  GB; id; corner at which it ends', &
    '  THETA; real zero; counter-clockwise from the inward normal [degree]', &
    'RBE2: rigid platen: nodes with the same displacement', &
    '  EID; id; element', &
    '  GN; id; master node', &
    '  CM; digits; tied directions', &
    '  GM; ids; dependent nodes', &
    'SUPORT: DOFs that measure rigid-body modes: their displacement is the approach', &
    '  ID1; id; node', &
    '  C1; digits; directions', &
    '  ID2; id with_next; node', &
    '  C2; digits with_last; directions', &
    '  ID3; id with_next; node', &
    '  C3; digits with_last; directions', &
    '  ID4; id with_next; node', &
    '  C4; digits with_last; directions', &
    'CORD2R: rectangular coordinate system, for gap directions', &
    '  CID; id; system', &
    '  RID; system only_zero; system of the points: the basic one', &
    '  A1; real zero; origin [length]', &
    '  A2; real zero; origin [length]', &
    '  A3; real zero; origin [length]', &
    '  B1; real zero; point on z [length]', &
    '  B2; real zero; point on z [length]', &
    '  B3; real zero; point on z [length]', &
    '  C1; real zero; point in x-z half [length]', &
    '  C2; real zero; point in x-z half [length]', &
    '  C3; real zero; point in x-z half [length]', &
    'CGAP: contact pair', &
    '  EID; id; pair', &
    '  PID; id; its PGAP', &
    '  GA; id; node A', &
    '  GB; id; node B; contact pushes it along the normal', &
    '  X1; any ignored; orientation, or node G0', &
    '  X2; real ignored; orientation', &
    '  X3; real ignored; orientation', &
    '  CID; system; system whose x is the normal; blank: from GA to GB', &
    'PGAP: property of contact pairs', &
    '  PID; id; property', &
    '  U0; real zero cause; initial gap [length]', &
    '  F0; real only_zero; preload | there is no preload', &
    '  KA; real ignored; closed stiffness: contact is exact', &
    '  KB; real ignored; open stiffness', &
    '  KT; real ignored; tangential stiffness', &
    '  MU1; real zero from=0 to=100; coefficient of friction', &
    '  MU2; real from=0 to=100; of kinetic friction: as MU1, or blank', &
    '  TMAX; real ignored; largest penetration', &
    '  MAR; real ignored; largest adjustment', &
    '  TRMIN; real ignored; smallest penetration', &
    'CBAR: boundary line of a mesher: ignored', &
    '  EID; id ignored; element', &
    '  PID; id optional ignored; property, not looked up', &
    '  GA; id ignored; first node', &
    '  GB; id ignored; second node', &
    '  ; any ignored times=12; anything', &
    'PARAM: a choice for the whole deck', &
    '  NAME; word; parameter', &
    '  VALUE; word; its value', &
    'MATS1: yielding of a MAT1: von Mises', &
    '  MID; id; its MAT1', &
    '  TID; id optional; its TABLES1; blank: bilinear from LIMIT1 and H', &
    '  TYPE; word PLASTIC NLELAST; NLELAST: nonlinear elastic, always total theory', &
    '  H; real zero from=0; stress over plastic strain beyond LIMIT1; blank with TID [stress]', &
    '  YF; whole from=1 to=1 default=1; yield criterion: 1, von Mises', &
    '  HR; whole from=1 to=3 default=1; hardening: 1 isotropic, 2 kinematic, 3 both (PARAM HRFRAC)', &
    '  LIMIT1; real positive; yield stress; with TID that of its second point [stress]', &
    'TABLES1: uniaxial curve of stress over total strain', &
    '  TID; id; table', &
    '  ; blank times=7;', &
    '  X; real needed each; strain: 0.0, that of the yield point, ...', &
    '  Y; real needed each ENDT; stress: 0.0, the yield stress, ...; ENDT after the last [stress]', &
    'CTRIA6: six-node triangle', &
    '  like 2 CTRIA3', &
    '  G1; id; first corner, in either turning sense', &
    '  G2; id; second corner', &
    '  G3; id; third corner', &
    '  G4; id; between the first and the second', &
    '  G5; id; between the second and the third', &
    '  G6; id; between the third and the first', &
    'CQUAD4: four-node quadrilateral, B-bar', &
    '  like 5 CTRIA3', &
    '  G4; id; fourth node', &
    'CTRAX3: axisymmetric three-node triangle; x is the radius', &
    '  EID; id; element', &
    '  PID; id; its PSOLID', &
    '  G1; id; first node, in either turning sense', &
    '  G2; id; second node', &
    '  G3; id; third node', &
    'CTRAX6: axisymmetric six-node triangle; x is the radius', &
    '  like 2 CTRAX3', &
    '  G1; id; first corner, in either turning sense', &
    '  G2; id; between the first and the second', &
    '  G3; id; second corner', &
    '  G4; id; between the second and the third', &
    '  G5; id; third corner', &
    '  G6; id; between the third and the first', &
    'PSOLID: property of axisymmetric elements', &
    '  PID; id; property', &
    '  MID; id; its MAT1', &
    'BLSEG: line of nodes along the boundary of a body', &
    '  ID; id; line', &
    '  G; ids ranges steps; nodes in their order, in either sense; G1 THRU G2, or G1 THRU G2 BY'// &
    ' step; a closed line ends with its first node', &
    'BCONP: contact of the nodes of one line with the edges of another', &
    '  ID; id; contact', &
    '  SLAVE; id; slave line (BLSEG): its nodes may not penetrate the master line', &
    '  MASTER; id; master line (BLSEG)', &
    '  ; blank;', &
    '  SFAC; real ignored; stiffness factor: contact is exact', &
    '  FRICID; system; its BFRIC; blank: no friction', &
    '  PTYPE; whole from=1 to=1 default=1; forces from slave and master: 1', &
    '  CID; system only_zero; system of the contact plane: the basic one', &
    'CQUAD8: eight-node quadrilateral', &
    '  like 5 CTRIA6', &
    '  G4; id; fourth corner', &
    '  G5; id; between the first and the second', &
    '  G6; id; between the second and the third', &
    '  G7; id; between the third and the fourth', &
    '  G8; id; between the fourth and the first']

  !> Loads and ties.
  character(len=*), parameter :: load_cards(*) = [character(len=140) :: &
    'LOAD: sum of sets of loads, each with a factor', &
    '  SID; id; set', &
    '  S; real needed; factor of all', &
    '  S; real needed each; factor of a set', &
    '  L; id each; the set', &
    'SPCD: displacements of a load case that replace those of SPC; LOAD chooses its set', &
    '  like 7 SPC', &
    'TEMP: temperatures of nodes', &
    '  SID; id; set', &
    '  G1; id; node', &
    '  T1; real needed; its temperature', &
    '  G2; id with_next; second node', &
    '  T2; real with_last; its temperature', &
    '  G3; id with_next; third node', &
    '  T3; real with_last; its temperature', &
    'TEMPD: temperature of all nodes that TEMP does not name', &
    '  SID1; id; set', &
    '  T1; real needed; temperature', &
    '  SID2; id with_next; second set', &
    '  T2; real with_last; temperature', &
    '  SID3; id with_next; third set', &
    '  T3; real with_last; temperature', &
    '  SID4; id with_next; fourth set', &
    '  T4; real with_last; temperature', &
    'GRAV: gravity A*N, on all mass', &
    '  SID; id; set', &
    '  CID; system only_zero; system of N1 to N3: the basic one', &
    '  A; real needed cause; factor: acceleration', &
    '  N1; real zero; direction x; 0.0 in axisymmetric models', &
    '  N2; real zero; direction y', &
    '  N3; real only_zero; direction z | models are in the x-y plane', &
    '  MB; whole from=-1 to=0 ignored; of superelements', &
    'RFORCE: centrifugal forces of a rotation, on all mass', &
    '  SID; id; set', &
    '  G; system; node that the axis goes through; 0 or blank: the origin', &
    '  CID; system only_zero; system of R1 to R3: the basic one', &
    '  A; real zero cause; factor: revolutions in a unit of time', &
    '  R1; real only_zero; axis x | plane models rotate about z, axisymmetric models about y', &
    '  R2; real zero; axis y; axis of axisymmetric models', &
    '  R3; real zero; axis z; axis of plane models', &
    '  METHOD; whole from=1 to=2 ignored; forces act on the undeformed mass', &
    '  RACC; real zero cause; factor of the angular acceleration: revolutions in a unit of time squared', &
    '  MB; any ignored; of superelements', &
    '  IDRF; system only_zero; elements: all', &
    'MOMENT: moment M*N3 about z at the master node of an RBE2, which rotates', &
    '  like 3 FORCE', &
    '  M; real needed cause; factor [force*length]', &
    '  N1; real only_zero; direction x | models are in the x-y plane', &
    '  N2; real only_zero; direction y | models are in the x-y plane', &
    '  N3; real zero; direction z', &
    'MPC: equation, sum of A times displacement = 0; the first DOF depends on the others', &
    '  SID; id; set', &
    '  G; id each; node', &
    '  C; whole from=1 to=6 needed each; direction: 1 or 2 in plane models', &
    '  A; real needed each two_a_line; coefficient; of the first not 0.0', &
    'MPCADD: union of sets of MPC', &
    '  SID; id; set', &
    '  S; ids; sets of MPC', &
    'CELAS1: spring between two DOFs, or between a DOF and the ground', &
    '  EID; id; spring', &
    '  PID; id; its PELAS', &
    '  G1; system; node; 0 or blank: the ground', &
    '  C1; whole zero from=0 to=2; its direction', &
    '  G2; system; node; 0 or blank: the ground', &
    '  C2; whole zero from=0 to=2; its direction', &
    'CELAS2: the same, with its stiffness', &
    '  EID; id; spring', &
    '  K; real needed positive; stiffness [force/length]', &
    '  G1; system; node; 0 or blank: the ground', &
    '  C1; whole zero from=0 to=2; its direction', &
    '  G2; system; node; 0 or blank: the ground', &
    '  C2; whole zero from=0 to=2; its direction', &
    '  GE; real ignored; damping', &
    '  S; real ignored; stress coefficient', &
    'PELAS: stiffness of springs; two a card', &
    '  PID1; id; property', &
    '  K1; real needed positive; stiffness [force/length]', &
    '  GE1; real ignored; damping', &
    '  S1; real ignored; stress coefficient', &
    '  PID2; id with_next; second property', &
    '  K2; real positive with_last; stiffness [force/length]', &
    '  GE2; real ignored; damping', &
    '  S2; real ignored; stress coefficient', &
    'NLPARM: increments of the loads, in load cases that choose it (NLPARM = ID)', &
    '  ID; id; parameters', &
    '  NINC; whole from=1 to=10000 default=1; increments, of equal size', &
    '  ; any ignored times=3; time and stiffness updates', &
    '  MAXITER; whole from=1 to=100000; iterations of an increment; default PARAM MAXIT', &
    '  ; any ignored times=2; tests of convergence, output', &
    '  EPSU; real positive below=1; instead of PARAM TOL', &
    '  ; any ignored times=15; other tests, line search, step control', &
    'BFRIC: friction of a BCONP', &
    '  FID; id; friction', &
    '  FSTIF; real ignored; stiffness of sticking: exact', &
    '  ; blank;', &
    '  MU1; real needed from=0 to=100; coefficient of friction']

  character(len=*), parameter :: cards(*) = [scene_cards, load_cards]

  !> PARAMs: the field VALUE for each NAME.
  character(len=*), parameter :: choices(*) = [character(len=180) :: &
    'PLANE; word STRAIN STRESS; every PSHELL with blank MID2', &
    'RULE; word AUTO CONRY JOINED BLOCK; contact solver: AUTO, simplex (CONRY), all bodies in one'// &
    ' system (JOINED); BLOCK of earlier versions means AUTO; default AUTO', &
    'GAPGEOM; word NO YES; YES adds the distance of the nodes to each gap; default NO', &
    'UNITS; word; printed with the results; nothing is converted', &
    'METHOD; word AUTO SECANT MODSEC INISTR NEWTON; plastic iteration; default AUTO', &
    'TOL; real positive below=1; largest change of displacements, over the largest, that'// &
    ' ends the iteration; default 0.01, for NEWTON 1.E-8', &
    'MAXIT; whole from=1 to=100000; iterations of a load step; default 100', &
    'THEORY; word TOTAL FLOW; plasticity: stresses follow from the strains at full load'// &
    ' (TOTAL), or increment by increment (FLOW); default FLOW with a sequence or HR 2, 3', &
    'HRFRAC; real positive to=1; kinematic part of the hardening, for HR 3', &
    'MUP; word EXACT PAPER; Poisson''s ratio in the equivalent strain: exact, or formula'// &
    ' (2-4); default EXACT', &
    'ORIGINAL; word NO YES; methods of about 1980: SOLVER BAND, RULE CONRY, METHOD'// &
    ' SECANT, TOL 0.01, NLOAD 1, THEORY TOTAL, MUP PAPER, no ACCURACY; default NO', &
    'NLOAD; whole from=1 to=10000; load steps; default 1', &
    'SAVE; word NO YES; YES saves the end of the last load case in DECK.restart, from which'// &
    ' another deck continues (RESTART); default NO', &
    'SEARCH; real positive; search distance of BCONP; default twice the longest'// &
    ' edge of the two lines [length]', &
    'SOLVER; word AUTO BAND FRONTAL; matrices of the bodies: panels of a band, or nested fronts;'// &
    ' default AUTO', &
    'ACCURACY; real positive below=1; wanted relative error of contact pressures: sets TOL and METHOD'// &
    ' if they are left out', &
    'CORNER; real positive to=180; edges of a boundary line with a larger angle between them'// &
    ' meet at a corner; default: decided from the neighbouring angles [degree]', &
    'FRICTION; word YES NO; NO: all contact without friction; default YES', &
    'WTMASS; real positive; factor of all mass: of RHO and NSM; default 1.0', &
    'LGDISP; whole from=-1 to=-1 ignored; no effect | displacements are small', &
    'INREL; whole only_zero ignored; no effect | supports and contact hold bodies']
  !> PARAMs of other programs, and of earlier versions, that have no effect.
  character(len=*), parameter :: unheard(*) = [character(len=8) :: &
    'AUTOSPC', 'BAILOUT', 'COUPMASS', 'FLEXIB', 'GRDPNT', 'K6ROT', 'MAXRATIO', 'NOCOMPS', 'OGEOM', 'POST', &
    'PRECIS', 'PRGPST', 'PRTMAXIM']

contains

  !> All cards, in the order of their kinds.
  function catalogue() result(card)
    type(card_entry) :: card(card_kinds)
    type(field_entry) :: field
    character(len=len(cards)) :: line
    integer :: at, i, k

    k = 0
    do i = 1, size(cards)
      line = cards(i)
      if (line(1:1) /= ' ') then
        k = k + 1
        at = index(line, ':')
        card(k) = card_entry(line(:at - 1), field=[field_entry ::])
        card(k)%meaning = trim(line(at + 2:))   ! gfortran 12 does not free a trimmed text in the constructor
      else if (line(:6) == '  like') then
        read (line(7:9), *) at
        card(k)%field = card(findloc(card%name == line(10:17), .true., dim=1))%field(:at)
      else
        field = new_field(trim(line))
        if (index(line(:12), '; ids') > 0) then
          card(k)%list_slot = size(card(k)%field) + 1
          card(k)%list_name = trim(field%name)
          card(k)%list_meaning = trim(field%meaning)
          card(k)%has_ranges = index(line, 'ids ranges') > 0
          card(k)%has_steps = index(line, 'ranges steps') > 0
        else if (index(line, ' each') > 0) then
          if (.not. allocated(card(k)%record)) allocate (card(k)%record(0))
          card(k)%list_slot = size(card(k)%field) + 1
          card(k)%record = [card(k)%record, field]
          if (index(line, ' each ENDT') > 0) card(k)%end_word = 'ENDT'
          if (index(line, ' two_a_line') > 0) card(k)%records_a_line = 2
        else
          card(k)%field = [card(k)%field, spread(field, 1, field%times)]
        end if
      end if
    end do
  end function catalogue

  !> All PARAMs.
  function parameters() result(field)
    type(field_entry) :: field(size(choices) + size(unheard))
    integer :: i

    do i = 1, size(choices)
      field(i) = new_field(trim(choices(i)))
    end do
    do i = 1, size(unheard)
      field(size(choices) + i) = new_field(unheard(i)//'; any ignored; no effect')
    end do
    field%required = .true.
  end function parameters
end module epcont_deck_catalogue
