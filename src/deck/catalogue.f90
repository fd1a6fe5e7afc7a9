!> THE table of cards and fields. The reader checks by it, and `epcont --cards` prints it: there is
!> no other place that knows a column. The fields of a card stand in their order: fields 2 to 9, then 12 to
!> 19, and so on; one that must be blank is `field_entry()`.
module epcont_deck_catalogue
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_deck_card_kinds, only: card_bconp, card_blseg, card_cbar, card_cgap, card_cord2r, card_cquad4, &
                                    card_cquad8, card_ctrax3, card_ctrax6, card_ctria3, card_ctria6, card_force, &
                                    card_grid, card_kinds, card_mat1, card_mats1, card_param, card_pgap, &
                                    card_ploadx1, card_pshell, card_psolid, card_rbe2, card_spc, card_spc1, &
                                    card_suport, card_tables1
  use epcont_deck_entry, only: below, card_entry, cause, components_field, field_entry, id_field, &
                               integer_field, kind_any, largest_id, last_field, new_card, next_field, noted, &
                               positive, real_field, word_field, zero_field
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
  pure function catalogue() result(card)
    type(card_entry) :: card(card_kinds)

    call add_mesh(card)
    call add_materials(card)
    call add_supports(card)
    call add_loads(card)
    call add_pairs(card)
    call add_lines(card)
    card(card_param) = new_card('PARAM', 'a choice for the whole deck', [ &
      word_field('NAME', '', 'parameter'), &
      word_field('VALUE', '', 'its value')])
  end function catalogue

  !> Nodes, elements and their sections.
  pure subroutine add_mesh(card)
    type(card_entry), intent(inout) :: card(:)
    integer :: slot

    card(card_grid) = new_card('GRID', 'node', [ &
      id_field('ID', 'node'), &
      zero('CP', 'system of X1 to X3: the basic one'), &
      zero_field('X1', 'coordinate x', 'length'), &
      zero_field('X2', 'coordinate y', 'length'), &
      zero_field('X3', 'coordinate z; 0.0 in plane scenes', 'length'), &
      zero('CD', 'system of the displacements: the basic one'), &
      components_field('PS', 'permanent supports', required=.false.)])
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
    card(card_pshell) = new_card('PSHELL', 'plane section', [ &
      id_field('PID', 'property'), &
      id_field('MID1', 'its MAT1'), &
      positive(real_field('T', 'thickness', 'length', required=.true.)), &
      integer_field('MID2', '-1: plane strain; blank: as PARAM PLANE says', -1, -1)])
    card(card_psolid) = new_card('PSOLID', 'section of rings', [ &
      id_field('PID', 'property'), &
      id_field('MID', 'its MAT1')])
    card(card_cbar) = new_card('CBAR', 'boundary line of a mesher: counted, no effect', [ &
      noted(id_field('EID', 'element')), &
      noted(id_field('PID', 'property, not looked up', required=.false.)), &
      noted(id_field('GA', 'first node')), &
      noted(id_field('GB', 'second node')), &
      (field_entry('', kind_any, 'anything', used=.false.), slot=5, 16)])
  end subroutine add_mesh

  !> Elasticity, and how materials yield.
  pure subroutine add_materials(card)
    type(card_entry), intent(inout) :: card(:)
    type(field_entry) :: ratio, slope
    integer :: k

    ratio = below(0.5_wp, real_field('NU', 'Poisson''s ratio', ''))
    ratio%lowest = 0.0_wp
    ratio%reason = 'incompressible: the bulk modulus is infinite'
    ratio%instead = '0.4999'
    card(card_mat1) = new_card('MAT1', 'isotropic elastic material; two of E, G, NU', [ &
      id_field('MID', 'material'), &
      positive(real_field('E', 'Young''s modulus', 'stress')), &
      positive(real_field('G', 'shear modulus', 'stress')), &
      ratio, &
      noted(real_field('RHO', 'density', '')), &
      noted(real_field('A', 'thermal expansion', '')), &
      noted(real_field('TREF', 'reference temperature', '')), &
      noted(real_field('GE', 'damping', '')), &
      noted(real_field('ST', 'limit of tension', 'stress')), &
      noted(real_field('SC', 'limit of compression', 'stress')), &
      noted(real_field('SS', 'limit of shear', 'stress')), &
      noted(integer_field('MCSID', 'material system', 0, largest_id))])
    slope = zero_field('H', 'stress over plastic strain beyond LIMIT1; blank with TID', 'stress')
    slope%lowest = 0.0_wp
    card(card_mats1) = new_card('MATS1', 'yielding of a MAT1: von Mises, total theory', [ &
      id_field('MID', 'its MAT1'), &
      id_field('TID', 'its TABLES1; blank: bilinear from LIMIT1 and H', required=.false.), &
      word_field('TYPE', 'PLASTIC NLELAST', 'both are taken as total theory'), &
      slope, &
      integer_field('YF', 'yield criterion: 1, von Mises', 1, 1, default=1), &
      integer_field('HR', 'hardening rule: 1', 1, 1, default=1), &
      positive(real_field('LIMIT1', 'yield stress; with TID that of its second point', 'stress'))])
    card(card_tables1) = new_card('TABLES1', 'uniaxial curve of stress over total strain', [ &
      id_field('TID', 'table'), &
      (field_entry(), k=3, 9)])
    call card(card_tables1)%add_list('', &
      'strain and stress of each point: 0.0 0.0, the yield point, and on; ENDT behind the last')
    card(card_tables1)%has_points = .true.
  end subroutine add_materials

  !> What holds nodes, ties them, or tells the motions of bodies that are free.
  pure subroutine add_supports(card)
    type(card_entry), intent(inout) :: card(:)
    character(len=*), parameter :: digit = '1234'
    type(field_entry) :: reference(8)
    integer :: i

    card(card_spc) = new_card('SPC', 'supports, with prescribed displacements', [ &
      id_field('SID', 'set'), &
      id_field('G1', 'node'), &
      components_field('C1', 'directions', required=.true.), &
      cause(zero_field('D1', 'displacement', 'length')), &
      id_field('G2', 'second node', with=next_field), &
      components_field('C2', 'directions', required=.false., with=last_field), &
      cause(zero_field('D2', 'displacement', 'length'))])
    card(card_spc1) = new_card('SPC1', 'supports', [ &
      id_field('SID', 'set'), &
      components_field('C', 'directions; 3 to 6 have no effect in plane scenes', required=.true.)])
    call card(card_spc1)%add_list('G', 'nodes, or G1 THRU G2')
    card(card_spc1)%has_ranges = .true.
    card(card_rbe2) = new_card('RBE2', 'rigid platen: nodes that move as one', [ &
      id_field('EID', 'element'), &
      id_field('GN', 'node that leads'), &
      components_field('CM', 'directions tied', required=.true.)])
    call card(card_rbe2)%add_list('GM', 'nodes that follow')
    do i = 1, 4
      reference(2*i - 1) = id_field('ID'//digit(i:i), 'node', required=i == 1, with=next_field)
      reference(2*i) = components_field('C'//digit(i:i), 'directions', required=i == 1, with=last_field)
    end do
    card(card_suport) = &
      new_card('SUPORT', 'reference freedoms of free bodies, solved for: the approach', reference)
  end subroutine add_supports

  !> Forces and pressures.
  pure subroutine add_loads(card)
    type(card_entry), intent(inout) :: card(:)
    type(field_entry) :: pressure

    card(card_force) = new_card('FORCE', 'force F*N at a node', [ &
      id_field('SID', 'set'), &
      id_field('G', 'node'), &
      zero('CID', 'system of N1 to N3: the basic one'), &
      cause(real_field('F', 'factor', 'force', required=.true.)), &
      zero_field('N1', 'direction x', ''), &
      zero_field('N2', 'direction y', ''), &
      zero_field('N3', 'direction z; 0.0 in plane scenes', '')])
    pressure = cause(real_field('PB', 'pressure at GB', 'stress'))
    pressure%same_as = last_field
    card(card_ploadx1) = new_card('PLOADX1', 'pressure on the edge of an element', [ &
      id_field('SID', 'set'), &
      id_field('EID', 'element'), &
      cause(real_field('PA', 'pressure at GA, positive into the element', 'stress', required=.true.)), &
      pressure, &
      id_field('GA', 'corner at which the edge begins'), &
      id_field('GB', 'corner at which it ends'), &
      zero_field('THETA', 'counter-clockwise from the inward normal', 'degree')])
  end subroutine add_loads

  !> Pairs of nodes in contact.
  pure subroutine add_pairs(card)
    type(card_entry), intent(inout) :: card(:)
    character(len=*), parameter :: meaning(3) = &
      [character(len=17) :: 'origin', 'point on z', 'point in x-z half']
    integer :: i, j

    card(card_cord2r) = new_card('CORD2R', 'rectangular coordinate system, for gap directions', [ &
      id_field('CID', 'system'), &
      zero('RID', 'system of the points: the basic one'), &
      ((zero_field('ABC'(i:i)//'123'(j:j), meaning(i), 'length'), j=1, 3), i=1, 3)])
    card(card_cgap) = new_card('CGAP', 'contact pair', [ &
      id_field('EID', 'pair'), &
      id_field('PID', 'its PGAP'), &
      id_field('GA', 'node A'), &
      id_field('GB', 'node B, pushed along the normal'), &
      field_entry('X1', kind_any, 'orientation, or node G0', used=.false.), &
      noted(real_field('X2', 'orientation', '')), &
      noted(real_field('X3', 'orientation', '')), &
      integer_field('CID', 'system whose x is the normal; blank: from GA to GB', 0, largest_id)])
    card(card_pgap) = new_card('PGAP', 'property of contact pairs', [ &
      id_field('PID', 'property'), &
      cause(zero_field('U0', 'initial gap', 'length')), &
      none(zero_field('F0', 'preload', ''), 'there is no preload'), &
      noted(real_field('KA', 'closed stiffness: contact is exact', '')), &
      noted(real_field('KB', 'open stiffness', '')), &
      noted(real_field('KT', 'tangential stiffness', '')), &
      none(zero_field('MU1', 'static friction', ''), 'there is no friction'), &
      none(zero_field('MU2', 'kinetic friction', ''), 'there is no friction'), &
      noted(real_field('TMAX', 'largest penetration', '')), &
      noted(real_field('MAR', 'largest adjustment', '')), &
      noted(real_field('TRMIN', 'smallest penetration', ''))])
  end subroutine add_pairs

  !> Boundary lines, and which of them are in contact.
  pure subroutine add_lines(card)
    type(card_entry), intent(inout) :: card(:)

    card(card_blseg) = new_card('BLSEG', 'line of nodes along the boundary of a body', [ &
      id_field('ID', 'line')])
    call card(card_blseg)%add_list('G', 'nodes in their order, in either sense; G1 THRU G2, or'// &
                                   ' G1 THRU G2 BY step; a closed line ends with its first node')
    card(card_blseg)%has_ranges = .true.
    card(card_blseg)%has_steps = .true.
    card(card_bconp) = new_card('BCONP', 'contact of the nodes of one line with the segments of another', [ &
      id_field('ID', 'contact'), &
      id_field('SLAVE', 'BLSEG whose nodes are held off'), &
      id_field('MASTER', 'BLSEG whose segments they are held off'), &
      field_entry(), &
      noted(real_field('SFAC', 'stiffness factor: contact is exact', '')), &
      none(zero('FRICID', 'friction'), 'there is no friction'), &
      integer_field('PTYPE', 'forces from slave and master: 1', 1, 1, default=1), &
      zero('CID', 'system of the contact plane: the basic one')])
  end subroutine add_lines

  !> All PARAMs: the field VALUE for each NAME.
  pure function parameters() result(field)
    type(field_entry), allocatable :: field(:)
    type(field_entry) :: corner, solver

    solver = word_field('SOLVER', 'AUTO BAND FRONTAL', &
                    'matrices of the bodies: panels of a band, or nested fronts; default AUTO')
    solver%withdrawn = 'SPARSE'
    corner = positive(real_field('CORNER', 'sides of a boundary line that turn by more than this meet at'// &
                                 ' a corner; default: decided from the turns beside it', 'degree'))
    corner%highest = 180.0_wp
    field = [ &
      word_field('PLANE', 'STRAIN STRESS', 'every PSHELL with blank MID2'), &
      word_field('RULE', 'AUTO CONRY BLOCK', 'contact entry rule; default AUTO'), &
      word_field('GAPGEOM', 'NO YES', 'YES adds the distance of the nodes to each gap; default NO'), &
      word_field('UNITS', '', 'printed with the results; nothing is converted'), &
      word_field('METHOD', 'AUTO SECANT MODSEC INISTR NEWTON', 'plastic iteration; default AUTO'), &
      below(1.0_wp, positive(real_field('TOL', 'largest change of a displacement, of the largest, that'// &
                                        ' ends the iteration; default 0.01, for NEWTON 1.E-8', ''))), &
      integer_field('MAXIT', 'iterations of a load step; default 100', 1, 100000), &
      word_field('MUP', 'EXACT PAPER', &
             'Poisson''s ratio in the equivalent strain: exact, or formula (2-4); default EXACT'), &
      integer_field('NLOAD', 'load steps; default 1', 1, 10000), &
      positive(real_field('SEARCH', 'how far BCONP looks for a segment; default twice the longest segment'// &
                          ' of the two lines', 'length')), &
      solver, &
      word_field('PRECIS', 'DOUBLE MIXED SINGLE', &
             'factors in double or single precision, these refined to double (MIXED) or not;'// &
             ' default DOUBLE'), &
      below(1.0_wp, positive(real_field('ACCURACY', 'wanted relative error of contact pressures: sets'// &
                                        ' TOL, METHOD and PRECIS where they are left out', ''))), &
      corner]
    field%required = .true.
  end function parameters

  !> An element: id, property, nodes.
  pure type(card_entry) function element(name, meaning, property, node) result(card)
    character(len=*), intent(in) :: name, meaning, property
    character(len=*), intent(in) :: node(:)   !! what each of its nodes is
    integer :: k

    card = new_card(name, meaning, [ &
      id_field('EID', 'element'), &
      id_field('PID', 'its '//property), &
      (id_field('G'//text_of(k), node(k)), k=1, size(node))])
  end function element

  !> A whole number that is zero or blank: there is nothing to choose.
  pure type(field_entry) function zero(name, meaning) result(field)
    character(len=*), intent(in) :: name, meaning

    field = integer_field(name, meaning, 0, 0, default=0)
  end function zero

  !> The field, but zero or blank, and why.
  pure type(field_entry) function none(plain, reason) result(field)
    type(field_entry), intent(in) :: plain
    character(len=*), intent(in) :: reason

    field = plain
    field%lowest = 0.0_wp
    field%highest = 0.0_wp
    field%reason = reason
  end function none
end module epcont_deck_catalogue
