!> Cards of contact models that epcont does not support: reason and replacement.
module epcont_deck_refused
  implicit none
  private
  public :: refused_card

  !> Names with a common reason and remedy: `NAMES: reason | remedy`.
  character(len=*), parameter :: table(*) = [character(len=220) :: &
    'CHEXA CPENTA CTETRA CPYRAM: solid elements | model a section with plane elements (CTRIA3 to'// &
    ' CQUAD8) or axisymmetric elements (CTRAX3, CTRAX6)', &
    'CQUAD CQUAD9 CQUADR CTRIAR CSHEAR: shells | use CTRIA3, CTRIA6, CQUAD4 or CQUAD8', &
    'CQUADX CTRIAX CTRIAX6 CQUADX4 CQUADX8: axisymmetric quadrilaterals, or elements in x-z | use'// &
    ' CTRAX3 or CTRAX6, with x as the radius', &
    'CPLSTN3 CPLSTN4 CPLSTN6 CPLSTN8: a formulation chosen by the card name | use CTRIA3, CQUAD4,'// &
    ' CTRIA6 or CQUAD8, and PARAM PLANE STRAIN', &
    'CPLSTS3 CPLSTS4 CPLSTS6 CPLSTS8: a formulation chosen by the card name | use CTRIA3, CQUAD4,'// &
    ' CTRIA6 or CQUAD8, and PARAM PLANE STRESS', &
    'CBEAM CROD CONROD CTUBE CBEND PBAR PBARL PBEAM PBEAML PROD: beams and rods | use plane elements'// &
    ' along it, CELAS2 with stiffness E A/L, or RBE2 if it is stiff', &
    'CBUSH CBUSH1D CBUSH2D CFAST CWELD: connectors with several directions | use one CELAS2 for each'// &
    ' direction', &
    'PBUSH PBUSH1D PBUSHT PELAST PFAST PWELD: properties of connectors or of nonlinear springs | use'// &
    ' PELAS or CELAS2', &
    'CELAS3 CELAS4 SPOINT EPOINT: scalar points | use CELAS1 or CELAS2 between GRIDs, or between a GRID'// &
    ' and the ground', &
    'CONM1 CONM2 CMASS1 CMASS2 CMASS3 CMASS4: point masses | use FORCE for their weight, mass times'// &
    ' acceleration', &
    'RBE3: weighted means of displacements | use MPC with its weights, or FORCE on each of the nodes', &
    'RBAR RBE1 RROD RTRPLT RSPLINE RSSCON: rigid elements of other types | use RBE2, whose GN may'// &
    ' rotate, or MPC', &
    'BCTABLE BCTABL1 BCTSET BCTADD BCBODY BCBODY1 BCONECT BCAUTOP BCBDPRP BCPROP BCPROPS BCGRID'// &
    ' BCPATCH: contact of bodies | use a BLSEG for each line in contact, and a BCONP for each two', &
    'BCTPARM BCTPARA BCPARA BCONPRG BCONPRP BCRGSRF BCRPARA: parameters of contact methods | remove the'// &
    ' card: contact is exact; only PARAM SEARCH and CORNER can be chosen', &
    'BCRIGID BCNURBS BCNURB2 BCMOVE BCSCAP: rigid bodies defined by their shape | use fixed GRIDs along'// &
    ' it, in a BLSEG', &
    'BSURF BSURFS BCPROP1: surfaces of elements | use BLSEG: the nodes of the line in their order', &
    'BCTPARF FRICTION CFRICT: friction | use MU1 of PGAP, or BCONP with FRICID and BFRIC', &
    'BOLT BOLTFOR BOLTFRC BOLTLD BOLTSEQ: bolts with a preload | use an overlap in the joint: PGAP with'// &
    ' U0 below 0.0, or a shorter shank', &
    'CONTACT BGSET BGADD BGPARM BLDOUT: glued contact | use common nodes, or MPC', &
    'PLOAD PLOAD1 PLOAD2 PLOAD4 PLOADB3 PLOADX: pressures on faces | use PLOADX1 on an edge of a plane'// &
    ' element', &
    'FORCE1 FORCE2 MOMENT1 MOMENT2: directions given by nodes | use FORCE with N1 and N2, or MOMENT'// &
    ' with N3', &
    'ACCEL ACCEL1: accelerations of parts | use GRAV, or FORCE at the nodes', &
    'TEMPP1 TEMPP2 TEMPP3 TEMPRB TEMPG TEMPN1 TEMPBC: temperatures of elements | use TEMP at the nodes,'// &
    ' and TEMPD', &
    'MAT2 MAT3 MAT8 MAT9 MATORT MATHE MATHP MATVE MATVP MATG: materials other than isotropic elastic,'// &
    ' or plastic with MATS1 | use MAT1', &
    'MATT1 TABLEM1 TABLEM2 TABLEM3 TABLEM4: moduli that depend on temperature | use MAT1 for the mean'// &
    ' temperature', &
    'MATEP TABLEST TABLES2: other plasticity laws | use MATS1 with a TABLES1', &
    'CORD1R CORD2C CORD2S CORD1C CORD1S: coordinate systems except for gap directions | use coordinates'// &
    ' in x and y; CORD2R for the CID of CGAP', &
    'SPCADD: sets of supports under one id | use one set of SPC and SPC1 for each load case', &
    'SPCOFF SPCR SPCAX: supports of other types | use SPC1, SPC and SPCD', &
    'SUPORT1 SUPAX: SUPORT for a single load case | use SUPORT', &
    'NLSTEP NLAUTO NLCNTL TSTEP TSTEPNL: steps of a solution | use NLPARM, PARAM TOL and MAXIT', &
    'EIGRL EIGR EIGC FREQ FREQ1 TLOAD1 TLOAD2 RLOAD1 DLOAD DAREA: vibration and time | use static loads', &
    'ASET ASET1 OMIT OMIT1 BSET CSET QSET DMIG SPLINE1: reduction of the model | remove the card:'// &
    ' epcont solves for all DOFs']

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
