!> Cards of contact models that epcont does not support: reason and replacement.
module epcont_deck_refused
  implicit none
  private
  public :: refused_card

  !> Names with a common reason and remedy: `NAMES: reason | remedy`.
  character(len=*), parameter :: table(*) = [character(len=220) :: &
    'CHEXA CPENTA CTETRA CPYRAM: three dimensions | a section of plane elements (CTRIA3 to CQUAD8) or of'// &
    ' rings (CTRAX3, CTRAX6)', &
    'CQUADR CTRIAR CSHEAR: shells | CTRIA3, CTRIA6, CQUAD4 or CQUAD8', &
    'CQUADX CTRIAX CTRIAX6 CQUADX4 CQUADX8: rings of four and more sides, or in x-z | CTRAX3 or CTRAX6,'// &
    ' with x for the radius', &
    'CPLSTN3 CPLSTN4 CPLSTN6 CPLSTN8: a formulation by its name | CTRIA3, CQUAD4, CTRIA6 or CQUAD8 and'// &
    ' PARAM PLANE STRAIN', &
    'CPLSTS3 CPLSTS4 CPLSTS6 CPLSTS8: a formulation by its name | CTRIA3, CQUAD4, CTRIA6 or CQUAD8 and'// &
    ' PARAM PLANE STRESS', &
    'CBEAM CROD CONROD CTUBE CBEND PBAR PBARL PBEAM PBEAML PROD: beams and rods | plane elements along'// &
    ' it, CELAS2 of stiffness E A/L, or RBE2 where it is stiff', &
    'CBUSH CBUSH1D CBUSH2D CFAST CWELD: connectors of several directions | one CELAS2 for each direction', &
    'PBUSH PBUSH1D PBUSHT PELAST PFAST PWELD: properties of connectors, or of springs that are not'// &
    ' linear | PELAS, or CELAS2', &
    'CELAS3 CELAS4 SPOINT EPOINT: scalar points | CELAS1 or CELAS2 between GRIDs, or one of them and the'// &
    ' ground', &
    'CONM1 CONM2 CMASS1 CMASS2 CMASS3 CMASS4: masses at points | FORCE of their weight, mass times'// &
    ' acceleration', &
    'RBE3: means of displacements as dependent freedoms | MPC with its weights, or FORCE on each of the'// &
    ' nodes', &
    'RBAR RBE1 RROD RTRPLT RSPLINE RSSCON: rigid elements of other kinds | RBE2, whose GN may turn, or MPC', &
    'BCTABLE BCTABL1 BCTSET BCTADD BCBODY BCBODY1 BCONECT BCAUTOP BCBDPRP BCPROP BCPROPS BCGRID BCPATCH:'// &
    ' contact of bodies | BLSEG for each line that may touch, and BCONP for each two of them', &
    'BCTPARM BCTPARA BCPARA BCONPRG BCONPRP BCRGSRF BCRPARA: choices of the method | nothing: contact is'// &
    ' exact, and PARAM SEARCH and CORNER are all there is to choose', &
    'BCRIGID BCNURBS BCNURB2 BCMOVE BCSCAP: rigid bodies by their shape | held GRIDs along it, in a BLSEG', &
    'BSURF BSURFS BCPROP1: surfaces of elements | BLSEG: the nodes of the line in their order', &
    'BFRIC BCTPARF FRICTION CFRICT: friction | nothing: contact is frictionless', &
    'BOLT BOLTFOR BOLTFRC BOLTLD BOLTSEQ: bolts with a preload | an overlap in the joint: PGAP with U0'// &
    ' below 0.0, or a shank drawn too short', &
    'CONTACT BGSET BGADD BGPARM BLDOUT: glued contact | shared nodes, or MPC', &
    'PLOAD PLOAD1 PLOAD2 PLOAD4 PLOADB3 PLOADX: pressures on faces | PLOADX1 on a side of a plane element', &
    'FORCE1 FORCE2 MOMENT1 MOMENT2: directions by nodes | FORCE with N1 and N2, MOMENT with N3', &
    'ACCEL ACCEL1: accelerations of parts | GRAV, or FORCE at the nodes', &
    'TEMPP1 TEMPP2 TEMPP3 TEMPRB TEMPG TEMPN1 TEMPBC: temperatures of elements | TEMP at the nodes, and'// &
    ' TEMPD', &
    'MAT2 MAT3 MAT8 MAT9 MATORT MATHE MATHP MATVE MATVP MATG: materials that are not isotropic, elastic'// &
    ' and plastic by MATS1 | MAT1', &
    'MATT1 TABLEM1 TABLEM2 TABLEM3: moduli that depend on temperature | MAT1 of the mean temperature', &
    'MATEP TABLEST TABLES2: other laws of yielding | MATS1 with a TABLES1', &
    'CORD1R CORD2C CORD2S CORD1C CORD1S: coordinate systems but for gap directions | coordinates in x'// &
    ' and y; CORD2R for the CID of CGAP', &
    'SPCADD: sets of supports under one id | one set of SPC and SPC1 for each load case', &
    'SPCOFF SPCR SPCAX: supports of other kinds | SPC1, SPC and SPCD', &
    'SUPORT1 SUPAX: reference freedoms of one case | SUPORT', &
    'NLSTEP NLAUTO NLCNTL TSTEP TSTEPNL: steps of a solution | NLPARM, PARAM TOL and MAXIT', &
    'EIGRL EIGR EIGC FREQ FREQ1 TLOAD1 TLOAD2 RLOAD1 DLOAD DAREA: vibration and time | a static load', &
    'ASET ASET1 OMIT OMIT1 BSET CSET QSET DMIG SPLINE1: reduction of the scene | nothing: all freedoms'// &
    ' are solved for']

contains

  !> Reason why a card is not supported, and its remedy; empty if the card is not in this list.
  pure subroutine refused_card(name, why, remedy)
    character(len=*), intent(in) :: name
    character(len=:), allocatable, intent(out) :: why, remedy
    integer :: bar, colon, k

    why = ''
    remedy = ''
    do k = 1, size(table)
      colon = index(table(k), ':')
      if (index(' '//table(k)(:colon - 1)//' ', ' '//name//' ') == 0) cycle
      bar = index(table(k), ' |')
      why = trim(table(k)(colon + 1:bar))
      remedy = trim(adjustl(table(k)(bar + 2:)))
      return
    end do
  end subroutine refused_card
end module epcont_deck_refused
