!> THE table of cards and fields. The reader checks by it, and `epcont --cards` prints it: there is
!> no other place that knows a column. The fields of a card stand in their order: fields 2 to 9, then 12 to
!> 19, and so on: name, what it may hold, meaning, unit; one that must be blank is `field_entry()`.
module epcont_deck_catalogue
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_deck_card_kinds, only: card_bconp, card_blseg, card_cbar, card_cgap, card_cord2r, card_cquad4, &
                                    card_cquad8, card_ctrax3, card_ctrax6, card_ctria3, card_ctria6, card_force, &
                                    card_grid, card_kinds, card_mat1, card_mats1, card_param, card_pgap, &
                                    card_ploadx1, card_pshell, card_psolid, card_rbe2, card_spc, card_spc1, &
                                    card_suport, card_tables1
  use epcont_deck_entry, only: card_entry, field, field_entry, integer_field, last_field, word_field
  implicit none
  private
  public :: catalogue, parameters

  !> What the nodes of elements are, in their order on the card.
  character(len=*), parameter :: in_turn(4) = [character(len=35) :: &
    'first node, in either turning sense', 'second node', 'third node', 'fourth node']
  character(len=*), parameter :: six(6) = [character(len=37) :: &
    'first corner, in either turning sense', 'second corner', 'third corner', &
    'between the first and the second', 'between the second and the third', 'between the third and the first']
  character(len=*), parameter :: eight(8) = [character(len=37) :: &
    'first corner, in either turning sense', 'second corner', 'third corner', 'fourth corner', &
    'between the first and the second', 'between the second and the third', 'between the third and the fourth', &
    'between the fourth and the first']
  integer, parameter :: round(6) = [1, 4, 2, 5, 3, 6]   !! the same, in their order along the boundary

contains

  !> All cards, by their kinds.
  function catalogue() result(card)
    type(card_entry) :: card(card_kinds)

    call add_mesh()
    call add_materials()
    call add_supports()
    call add_loads()
    call add_pairs()
    call add_lines()
    card(card_param) = card_entry('PARAM', 'a choice for the whole deck', [ &
      word_field('NAME', '', 'parameter'), &
      word_field('VALUE', '', 'its value')])

  contains

    !> Nodes, elements and their sections.
    subroutine add_mesh()
      integer :: slot

      card(card_grid) = card_entry('GRID', 'node', [ &
        field('ID', 'id', 'node'), &
        field('CP', 'system only_zero', 'system of X1 to X3: the basic one'), &
        field('X1', 'real zero', 'coordinate x', 'length'), &
        field('X2', 'real zero', 'coordinate y', 'length'), &
        field('X3', 'real zero', 'coordinate z; 0.0 in plane scenes', 'length'), &
        field('CD', 'system only_zero', 'system of the displacements: the basic one'), &
        field('PS', 'digits optional', 'permanent supports')])
      ! Gmsh writes coordinates in large field by %.9G of C: 3.0 is `3`, 1.0E-5 is `1E-05`.
      card(card_grid)%field(3:5)%point_optional = .true.
      card(card_ctria3) = element('CTRIA3', 'constant-strain triangle', 'PSHELL', in_turn(:3))
      card(card_ctria6) = element('CTRIA6', 'six-node triangle', 'PSHELL', six)
      card(card_cquad4) = element('CQUAD4', 'four-node quadrilateral, B-bar', 'PSHELL', in_turn)
      card(card_cquad8) = element('CQUAD8', 'eight-node quadrilateral', 'PSHELL', eight)
      card(card_ctrax3) = &
        element('CTRAX3', 'ring of a three-node triangle; x is the radius', 'PSOLID', in_turn(:3))
      card(card_ctrax6) = &
        element('CTRAX6', 'ring of a six-node triangle; x is the radius', 'PSOLID', six(round))
      card(card_pshell) = card_entry('PSHELL', 'plane section', [ &
        field('PID', 'id', 'property'), &
        field('MID1', 'id', 'its MAT1'), &
        field('T', 'real needed positive', 'thickness', 'length'), &
        integer_field('MID2', '-1: plane strain; blank: as PARAM PLANE says', -1, -1)])
      card(card_psolid) = card_entry('PSOLID', 'section of rings', [ &
        field('PID', 'id', 'property'), &
        field('MID', 'id', 'its MAT1')])
      card(card_cbar) = card_entry('CBAR', 'boundary line of a mesher: counted, no effect', [ &
        field('EID', 'id noted', 'element'), &
        field('PID', 'id optional noted', 'property, not looked up'), &
        field('GA', 'id noted', 'first node'), &
        field('GB', 'id noted', 'second node'), &
        (field('', 'any noted', 'anything'), slot=5, 16)])
    end subroutine add_mesh

    !> Elasticity, and how materials yield.
    subroutine add_materials()
      type(field_entry) :: ratio, slope
      integer :: k

      ratio = field('NU', 'real', 'Poisson''s ratio')
      ratio%lowest = 0.0_wp
      ratio%highest = 0.5_wp
      ratio%below_highest = .true.
      ratio%reason = 'incompressible: the bulk modulus is infinite'
      ratio%instead = '0.4999'
      card(card_mat1) = card_entry('MAT1', 'isotropic elastic material; two of E, G, NU', [ &
        field('MID', 'id', 'material'), &
        field('E', 'real positive', 'Young''s modulus', 'stress'), &
        field('G', 'real positive', 'shear modulus', 'stress'), &
        ratio, &
        field('RHO', 'real noted', 'density'), &
        field('A', 'real noted', 'thermal expansion'), &
        field('TREF', 'real noted', 'reference temperature'), &
        field('GE', 'real noted', 'damping'), &
        field('ST', 'real noted', 'limit of tension', 'stress'), &
        field('SC', 'real noted', 'limit of compression', 'stress'), &
        field('SS', 'real noted', 'limit of shear', 'stress'), &
        field('MCSID', 'system noted', 'material system')])
      slope = field('H', 'real zero', 'stress over plastic strain beyond LIMIT1; blank with TID', 'stress')
      slope%lowest = 0.0_wp
      card(card_mats1) = card_entry('MATS1', 'yielding of a MAT1: von Mises, total theory', [ &
        field('MID', 'id', 'its MAT1'), &
        field('TID', 'id optional', 'its TABLES1; blank: bilinear from LIMIT1 and H'), &
        word_field('TYPE', 'PLASTIC NLELAST', 'both are taken as total theory'), &
        slope, &
        integer_field('YF', 'yield criterion: 1, von Mises', 1, 1, default=1), &
        integer_field('HR', 'hardening rule: 1', 1, 1, default=1), &
        field('LIMIT1', 'real positive', 'yield stress; with TID that of its second point', 'stress')])
      card(card_tables1) = card_entry('TABLES1', 'uniaxial curve of stress over total strain', [ &
        field('TID', 'id', 'table'), &
        (field_entry(), k=3, 9)])
      call card(card_tables1)%add_list('', &
        'strain and stress of each point: 0.0 0.0, the yield point, and on; ENDT behind the last')
      card(card_tables1)%has_points = .true.
    end subroutine add_materials

    !> What holds nodes, ties them, or tells the motions of bodies that are free.
    subroutine add_supports()
      character(len=*), parameter :: digit = '1234'
      type(field_entry) :: reference(8)
      integer :: i

      card(card_spc) = card_entry('SPC', 'supports, with prescribed displacements', [ &
        field('SID', 'id', 'set'), &
        field('G1', 'id', 'node'), &
        field('C1', 'digits', 'directions'), &
        field('D1', 'real zero cause', 'displacement', 'length'), &
        field('G2', 'id with_next', 'second node'), &
        field('C2', 'digits with_last', 'directions'), &
        field('D2', 'real zero cause', 'displacement', 'length')])
      card(card_spc1) = card_entry('SPC1', 'supports', [ &
        field('SID', 'id', 'set'), &
        field('C', 'digits', 'directions; 3 to 6 have no effect in plane scenes')])
      call card(card_spc1)%add_list('G', 'nodes, or G1 THRU G2')
      card(card_spc1)%has_ranges = .true.
      card(card_rbe2) = card_entry('RBE2', 'rigid platen: nodes that move as one', [ &
        field('EID', 'id', 'element'), &
        field('GN', 'id', 'node that leads'), &
        field('CM', 'digits', 'directions tied')])
      call card(card_rbe2)%add_list('GM', 'nodes that follow')
      do i = 1, 4
        reference(2*i - 1) = field('ID'//digit(i:i), 'id with_next', 'node')
        reference(2*i) = field('C'//digit(i:i), 'digits with_last', 'directions')
      end do
      reference(:2)%required = .true.
      card(card_suport) = &
        card_entry('SUPORT', 'reference freedoms of free bodies, solved for: the approach', reference)
    end subroutine add_supports

    !> Forces and pressures.
    subroutine add_loads()
      type(field_entry) :: pressure

      card(card_force) = card_entry('FORCE', 'force F*N at a node', [ &
        field('SID', 'id', 'set'), &
        field('G', 'id', 'node'), &
        field('CID', 'system only_zero', 'system of N1 to N3: the basic one'), &
        field('F', 'real needed cause', 'factor', 'force'), &
        field('N1', 'real zero', 'direction x'), &
        field('N2', 'real zero', 'direction y'), &
        field('N3', 'real zero', 'direction z; 0.0 in plane scenes')])
      pressure = field('PB', 'real cause', 'pressure at GB', 'stress')
      pressure%same_as = last_field
      card(card_ploadx1) = card_entry('PLOADX1', 'pressure on the edge of an element', [ &
        field('SID', 'id', 'set'), &
        field('EID', 'id', 'element'), &
        field('PA', 'real needed cause', 'pressure at GA, positive into the element', 'stress'), &
        pressure, &
        field('GA', 'id', 'corner at which the edge begins'), &
        field('GB', 'id', 'corner at which it ends'), &
        field('THETA', 'real zero', 'counter-clockwise from the inward normal', 'degree')])
    end subroutine add_loads

    !> Pairs of nodes in contact.
    subroutine add_pairs()
      character(len=*), parameter :: meaning(3) = &
        [character(len=17) :: 'origin', 'point on z', 'point in x-z half']
      integer :: i, j

      card(card_cord2r) = card_entry('CORD2R', 'rectangular coordinate system, for gap directions', [ &
        field('CID', 'id', 'system'), &
        field('RID', 'system only_zero', 'system of the points: the basic one'), &
        ((field('ABC'(i:i)//'123'(j:j), 'real zero', meaning(i), 'length'), j=1, 3), i=1, 3)])
      card(card_cgap) = card_entry('CGAP', 'contact pair', [ &
        field('EID', 'id', 'pair'), &
        field('PID', 'id', 'its PGAP'), &
        field('GA', 'id', 'node A'), &
        field('GB', 'id', 'node B, pushed along the normal'), &
        field('X1', 'any noted', 'orientation, or node G0'), &
        field('X2', 'real noted', 'orientation'), &
        field('X3', 'real noted', 'orientation'), &
        field('CID', 'system', 'system whose x is the normal; blank: from GA to GB')])
      card(card_pgap) = card_entry('PGAP', 'property of contact pairs', [ &
        field('PID', 'id', 'property'), &
        field('U0', 'real zero cause', 'initial gap', 'length'), &
        field('F0', 'real only_zero', 'preload', reason='there is no preload'), &
        field('KA', 'real noted', 'closed stiffness: contact is exact'), &
        field('KB', 'real noted', 'open stiffness'), &
        field('KT', 'real noted', 'tangential stiffness'), &
        field('MU1', 'real only_zero', 'static friction', reason='there is no friction'), &
        field('MU2', 'real only_zero', 'kinetic friction', reason='there is no friction'), &
        field('TMAX', 'real noted', 'largest penetration'), &
        field('MAR', 'real noted', 'largest adjustment'), &
        field('TRMIN', 'real noted', 'smallest penetration')])
    end subroutine add_pairs

    !> Boundary lines, and which of them are in contact.
    subroutine add_lines()
      card(card_blseg) = card_entry('BLSEG', 'line of nodes along the boundary of a body', [ &
        field('ID', 'id', 'line')])
      call card(card_blseg)%add_list('G', 'nodes in their order, in either sense; G1 THRU G2, or'// &
                                     ' G1 THRU G2 BY step; a closed line ends with its first node')
      card(card_blseg)%has_ranges = .true.
      card(card_blseg)%has_steps = .true.
      card(card_bconp) = card_entry('BCONP', 'contact of the nodes of one line with the segments of another', [ &
        field('ID', 'id', 'contact'), &
        field('SLAVE', 'id', 'BLSEG whose nodes are held off'), &
        field('MASTER', 'id', 'BLSEG whose segments they are held off'), &
        field_entry(), &
        field('SFAC', 'real noted', 'stiffness factor: contact is exact'), &
        field('FRICID', 'system only_zero', 'friction', reason='there is no friction'), &
        integer_field('PTYPE', 'forces from slave and master: 1', 1, 1, default=1), &
        field('CID', 'system only_zero', 'system of the contact plane: the basic one')])
    end subroutine add_lines
  end function catalogue

  !> All PARAMs: the field VALUE for each NAME.
  pure function parameters() result(entry)
    type(field_entry), allocatable :: entry(:)
    type(field_entry) :: corner, solver

    solver = word_field('SOLVER', 'AUTO BAND FRONTAL', &
                    'matrices of the bodies: panels of a band, or nested fronts; default AUTO')
    solver%withdrawn = 'SPARSE'
    corner = field('CORNER', 'real positive', 'sides of a boundary line that turn by more than this meet at'// &
                   ' a corner; default: decided from the turns beside it', 'degree')
    corner%highest = 180.0_wp
    entry = [ &
      word_field('PLANE', 'STRAIN STRESS', 'every PSHELL with blank MID2'), &
      word_field('RULE', 'AUTO CONRY BLOCK', 'contact entry rule; default AUTO'), &
      word_field('GAPGEOM', 'NO YES', 'YES adds the distance of the nodes to each gap; default NO'), &
      word_field('UNITS', '', 'printed with the results; nothing is converted'), &
      word_field('METHOD', 'AUTO SECANT MODSEC INISTR NEWTON', 'plastic iteration; default AUTO'), &
      field('TOL', 'real positive below_one', 'largest change of a displacement, of the largest, that'// &
            ' ends the iteration; default 0.01, for NEWTON 1.E-8'), &
      integer_field('MAXIT', 'iterations of a load step; default 100', 1, 100000), &
      word_field('MUP', 'EXACT PAPER', &
             'Poisson''s ratio in the equivalent strain: exact, or formula (2-4); default EXACT'), &
      word_field('ORIGINAL', 'NO YES', 'all as in about 1980: BAND, INVERT, CONRY, SECANT, TOL 0.01, MUP'// &
                 ' PAPER; default NO'), &
      integer_field('NLOAD', 'load steps; default 1', 1, 10000), &
      field('SEARCH', 'real positive', 'how far BCONP looks for a segment; default twice the longest segment'// &
            ' of the two lines', 'length'), &
      solver, &
      word_field('FLEXIB', 'AUTO INVERT', 'flexibility of the contact by inversion always, or by'// &
                 ' substitution where that is cheaper; default AUTO'), &
      word_field('PRECIS', 'DOUBLE MIXED SINGLE', &
             'factors in double or single precision, these refined to double (MIXED) or not;'// &
             ' default DOUBLE'), &
      field('ACCURACY', 'real positive below_one', 'wanted relative error of contact pressures: sets'// &
            ' TOL, METHOD and PRECIS where they are left out'), &
      corner]
    entry%required = .true.
  end function parameters

  !> An element: id, property, nodes.
  pure type(card_entry) function element(name, meaning, property, node) result(card)
    character(len=*), intent(in) :: name, meaning, property
    character(len=*), intent(in) :: node(:)   !! what each of its nodes is
    integer :: k

    card = card_entry(name, meaning, [ &
      field('EID', 'id', 'element'), &
      field('PID', 'id', 'its '//property), &
      (field('G'//text_of(k), 'id', node(k)), k=1, size(node))])
  end function element
end module epcont_deck_catalogue
