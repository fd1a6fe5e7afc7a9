!> THE table of cards and fields. The reader checks by it, and `epcont --cards` prints it: there is
!> no other place that knows a column.
module epcont_deck_catalogue
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_deck_card_kinds, only: card_bconp, card_blseg, card_cbar, card_cgap, card_cord2r, card_cquad4, card_ctrax3, &
                                    card_ctrax6, card_ctria3, card_ctria6, card_force, card_grid, card_kinds, card_mat1, &
                                    card_mats1, card_param, card_pgap, card_ploadx1, card_pshell, card_psolid, card_rbe2, &
                                    card_spc, card_spc1, card_suport, card_tables1
  use epcont_deck_entry, only: any_field, card_entry, cause, components_field, field_entry, id_field, integer_field, &
                               largest_id, new_card, noted, number_of, positive, real_field, word_field
  implicit none
  private
  public :: catalogue, parameters

  !> What the nodes of elements are, in their order on the card.
  character(len=*), parameter :: in_turn(4) = ['first node, in either turning sense', 'second node                        ', &
                                               'third node                         ', 'fourth node                        ']
  character(len=*), parameter :: six(6) = ['first corner, in either turning sense', 'second corner                        ', &
                                           'third corner                         ', 'between the first and the second     ', &
                                           'between the second and the third     ', 'between the third and the first      ']
  character(len=*), parameter :: round(6) = ['first corner, in either turning sense', 'between the first and the second     ', &
                                             'second corner                        ', 'between the second and the third     ', &
                                             'third corner                         ', 'between the third and the first      ']

contains

  !> All cards.
  function catalogue() result(card)
    type(card_entry) :: card(card_kinds)

    card(card_grid) = grid()
    card(card_ctria3) = element('CTRIA3', 'constant-strain triangle', 'PSHELL', in_turn(:3))
    card(card_pshell) = pshell()
    card(card_mat1) = mat1()
    card(card_spc) = spc()
    card(card_spc1) = spc1()
    card(card_force) = force()
    card(card_ploadx1) = ploadx1()
    card(card_rbe2) = rbe2()
    card(card_suport) = suport()
    card(card_cord2r) = cord2r()
    card(card_cgap) = cgap()
    card(card_pgap) = pgap()
    card(card_cbar) = cbar()
    card(card_param) = param()
    card(card_mats1) = mats1()
    card(card_tables1) = tables1()
    card(card_ctria6) = element('CTRIA6', 'six-node triangle', 'PSHELL', six)
    card(card_cquad4) = element('CQUAD4', 'four-node quadrilateral, B-bar', 'PSHELL', in_turn(:4))
    card(card_ctrax3) = element('CTRAX3', 'ring of a three-node triangle; x is the radius', 'PSOLID', in_turn(:3))
    card(card_ctrax6) = element('CTRAX6', 'ring of a six-node triangle; x is the radius', 'PSOLID', round)
    card(card_psolid) = psolid()
    card(card_blseg) = blseg()
    card(card_bconp) = bconp()
  end function catalogue

  function grid() result(card)
    type(card_entry) :: card

    card = new_card('GRID', 'node')
    call card%add(id_field(2, 'ID', 'node'))
    call card%add(zero(3, 'CP', 'system of X1 to X3: the basic one'))
    call card%add(coordinate(4, 'X1', 'coordinate x'))
    call card%add(coordinate(5, 'X2', 'coordinate y'))
    call card%add(coordinate(6, 'X3', 'coordinate z; 0.0 in plane scenes'))
    call card%add(zero(7, 'CD', 'system of the displacements: the basic one'))
    call card%add(components_field(8, 'PS', 'permanent supports', required=.false.))
  end function grid

  !> A coordinate. Gmsh writes them in large field by %.9G of C: 3.0 is `3`, 1.0E-5 is `1E-05`.
  function coordinate(number, name, meaning) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    type(field_entry) :: field

    field = real_field(number, name, meaning, 'length', default=0.0_wp)
    field%point_optional = .true.
  end function coordinate

  !> An element: id, property, nodes.
  function element(name, meaning, property, node) result(card)
    character(len=*), intent(in) :: name, meaning, property
    character(len=*), intent(in) :: node(:)   !! what each of its nodes is
    type(card_entry) :: card
    integer :: k

    card = new_card(name, meaning)
    call card%add(id_field(2, 'EID', 'element'))
    call card%add(id_field(3, 'PID', 'its '//property))
    do k = 1, size(node)
      call card%add(id_field(3 + k, 'G'//text_of(k), trim(node(k))))
    end do
  end function element

  function psolid() result(card)
    type(card_entry) :: card

    card = new_card('PSOLID', 'section of rings')
    call card%add(id_field(2, 'PID', 'property'))
    call card%add(id_field(3, 'MID', 'its MAT1'))
  end function psolid

  function pshell() result(card)
    type(card_entry) :: card

    card = new_card('PSHELL', 'plane section')
    call card%add(id_field(2, 'PID', 'property'))
    call card%add(id_field(3, 'MID1', 'its MAT1'))
    call card%add(positive(real_field(4, 'T', 'thickness', 'length', required=.true.)))
    call card%add(integer_field(5, 'MID2', '-1: plane strain; blank: as PARAM PLANE says', -1, -1))
  end function pshell

  function mat1() result(card)
    type(card_entry) :: card
    type(field_entry) :: ratio

    card = new_card('MAT1', 'isotropic elastic material; two of E, G, NU')
    call card%add(id_field(2, 'MID', 'material'))
    call card%add(positive(real_field(3, 'E', 'Young''s modulus', 'stress')))
    call card%add(positive(real_field(4, 'G', 'shear modulus', 'stress')))
    ratio = real_field(5, 'NU', 'Poisson''s ratio', '')
    ratio%lowest = 0.0_wp
    ratio%highest = 0.5_wp
    ratio%below_highest = .true.
    ratio%reason = 'incompressible: the bulk modulus is infinite'
    ratio%instead = '0.4999'
    call card%add(ratio)
    call card%add(noted(real_field(6, 'RHO', 'density', '')))
    call card%add(noted(real_field(7, 'A', 'thermal expansion', '')))
    call card%add(noted(real_field(8, 'TREF', 'reference temperature', '')))
    call card%add(noted(real_field(9, 'GE', 'damping', '')))
    call card%add(noted(real_field(12, 'ST', 'limit of tension', 'stress')))
    call card%add(noted(real_field(13, 'SC', 'limit of compression', 'stress')))
    call card%add(noted(real_field(14, 'SS', 'limit of shear', 'stress')))
    call card%add(noted(integer_field(15, 'MCSID', 'material system', 0, largest_id)))
  end function mat1

  function mats1() result(card)
    type(card_entry) :: card
    type(field_entry) :: slope

    card = new_card('MATS1', 'yielding of a MAT1: von Mises, total theory')
    call card%add(id_field(2, 'MID', 'its MAT1'))
    call card%add(id_field(3, 'TID', 'its TABLES1; blank: bilinear from LIMIT1 and H', required=.false.))
    call card%add(word_field(4, 'TYPE', 'both are taken as total theory', choices='PLASTIC NLELAST'))
    slope = real_field(5, 'H', 'stress over plastic strain beyond LIMIT1; blank with TID', 'stress', default=0.0_wp)
    slope%lowest = 0.0_wp
    call card%add(slope)
    call card%add(integer_field(6, 'YF', 'yield criterion: 1, von Mises', 1, 1, default=1))
    call card%add(integer_field(7, 'HR', 'hardening rule: 1', 1, 1, default=1))
    call card%add(positive(real_field(8, 'LIMIT1', 'yield stress; with TID that of its second point', 'stress')))
  end function mats1

  function tables1() result(card)
    type(card_entry) :: card

    card = new_card('TABLES1', 'uniaxial curve of stress over total strain')
    call card%add(id_field(2, 'TID', 'table'))
    call card%add_points(12, 'strain and stress of each point: 0.0 0.0, the yield point, and on; ENDT behind the last')
  end function tables1

  function spc() result(card)
    type(card_entry) :: card

    card = new_card('SPC', 'supports, with prescribed displacements')
    call card%add(id_field(2, 'SID', 'set'))
    call card%add(id_field(3, 'G1', 'node'))
    call card%add(components_field(4, 'C1', 'directions', required=.true.))
    call card%add(cause(real_field(5, 'D1', 'displacement', 'length', default=0.0_wp)))
    call card%add(id_field(6, 'G2', 'second node', with=7))
    call card%add(components_field(7, 'C2', 'directions', required=.false., with=6))
    call card%add(cause(real_field(8, 'D2', 'displacement', 'length', default=0.0_wp)))
  end function spc

  function spc1() result(card)
    type(card_entry) :: card

    card = new_card('SPC1', 'supports')
    call card%add(id_field(2, 'SID', 'set'))
    call card%add(components_field(3, 'C', 'directions; 3 to 6 have no effect in plane scenes', required=.true.))
    call card%add_list(4, 'G', 'nodes, or G1 THRU G2', has_ranges=.true.)
  end function spc1

  function force() result(card)
    type(card_entry) :: card

    card = new_card('FORCE', 'force F*N at a node')
    call card%add(id_field(2, 'SID', 'set'))
    call card%add(id_field(3, 'G', 'node'))
    call card%add(zero(4, 'CID', 'system of N1 to N3: the basic one'))
    call card%add(cause(real_field(5, 'F', 'factor', 'force', required=.true.)))
    call card%add(real_field(6, 'N1', 'direction x', '', default=0.0_wp))
    call card%add(real_field(7, 'N2', 'direction y', '', default=0.0_wp))
    call card%add(real_field(8, 'N3', 'direction z; 0.0 in plane scenes', '', default=0.0_wp))
  end function force

  function ploadx1() result(card)
    type(card_entry) :: card
    type(field_entry) :: pressure

    card = new_card('PLOADX1', 'pressure on the edge of an element')
    call card%add(id_field(2, 'SID', 'set'))
    call card%add(id_field(3, 'EID', 'element'))
    call card%add(cause(real_field(4, 'PA', 'pressure at GA, positive into the element', 'stress', required=.true.)))
    pressure = cause(real_field(5, 'PB', 'pressure at GB', 'stress'))
    pressure%same_as = 4
    call card%add(pressure)
    call card%add(id_field(6, 'GA', 'corner at which the edge begins'))
    call card%add(id_field(7, 'GB', 'corner at which it ends'))
    call card%add(real_field(8, 'THETA', 'counter-clockwise from the inward normal', 'degree', default=0.0_wp))
  end function ploadx1

  function rbe2() result(card)
    type(card_entry) :: card

    card = new_card('RBE2', 'rigid platen: nodes that move as one')
    call card%add(id_field(2, 'EID', 'element'))
    call card%add(id_field(3, 'GN', 'node that leads'))
    call card%add(components_field(4, 'CM', 'directions tied', required=.true.))
    call card%add_list(5, 'GM', 'nodes that follow', has_ranges=.false.)
  end function rbe2

  function suport() result(card)
    type(card_entry) :: card
    character(len=*), parameter :: digit = '1234'
    integer :: i, number

    card = new_card('SUPORT', 'reference freedoms of free bodies, solved for: the approach')
    do i = 1, len(digit)
      number = 2*i
      call card%add(id_field(number, 'ID'//digit(i:i), 'node', required=i == 1, with=number + 1))
      call card%add(components_field(number + 1, 'C'//digit(i:i), 'directions', required=i == 1, with=number))
    end do
  end function suport

  function cord2r() result(card)
    type(card_entry) :: card
    character(len=*), parameter :: point(3) = ['A', 'B', 'C'], digit(3) = ['1', '2', '3']
    character(len=*), parameter :: meaning(3) = ['origin           ', 'point on z       ', 'point in x-z half']
    integer :: i, j

    card = new_card('CORD2R', 'rectangular coordinate system, for gap directions')
    call card%add(id_field(2, 'CID', 'system'))
    call card%add(zero(3, 'RID', 'system of the points: the basic one'))
    do i = 1, 3
      do j = 1, 3
        call card%add(real_field(number_of(3*i + j - 1), point(i)//digit(j), trim(meaning(i)), 'length', default=0.0_wp))
      end do
    end do
  end function cord2r

  function cgap() result(card)
    type(card_entry) :: card

    card = new_card('CGAP', 'contact pair')
    call card%add(id_field(2, 'EID', 'pair'))
    call card%add(id_field(3, 'PID', 'its PGAP'))
    call card%add(id_field(4, 'GA', 'node A'))
    call card%add(id_field(5, 'GB', 'node B, pushed along the normal'))
    call card%add(any_field(6, 'X1', 'orientation, or node G0'))
    call card%add(noted(real_field(7, 'X2', 'orientation', '')))
    call card%add(noted(real_field(8, 'X3', 'orientation', '')))
    call card%add(integer_field(9, 'CID', 'system whose x is the normal; blank: from GA to GB', 0, largest_id))
  end function cgap

  function pgap() result(card)
    type(card_entry) :: card

    card = new_card('PGAP', 'property of contact pairs')
    call card%add(id_field(2, 'PID', 'property'))
    call card%add(cause(real_field(3, 'U0', 'initial gap', 'length', default=0.0_wp)))
    call card%add(zero_real(4, 'F0', 'preload', 'there is no preload'))
    call card%add(noted(real_field(5, 'KA', 'closed stiffness: contact is exact', '')))
    call card%add(noted(real_field(6, 'KB', 'open stiffness', '')))
    call card%add(noted(real_field(7, 'KT', 'tangential stiffness', '')))
    call card%add(zero_real(8, 'MU1', 'static friction', 'there is no friction'))
    call card%add(zero_real(9, 'MU2', 'kinetic friction', 'there is no friction'))
    call card%add(noted(real_field(12, 'TMAX', 'largest penetration', '')))
    call card%add(noted(real_field(13, 'MAR', 'largest adjustment', '')))
    call card%add(noted(real_field(14, 'TRMIN', 'smallest penetration', '')))
  end function pgap

  function blseg() result(card)
    type(card_entry) :: card

    card = new_card('BLSEG', 'line of nodes along the boundary of a body')
    call card%add(id_field(2, 'ID', 'line'))
    call card%add_list(3, 'G', 'nodes in their order, in either sense; G1 THRU G2, or G1 THRU G2 BY step; a closed line'// &
                       ' ends with its first node', has_ranges=.true.)
    card%has_steps = .true.
  end function blseg

  function bconp() result(card)
    type(card_entry) :: card
    type(field_entry) :: friction

    card = new_card('BCONP', 'contact of the nodes of one line with the segments of another')
    call card%add(id_field(2, 'ID', 'contact'))
    call card%add(id_field(3, 'SLAVE', 'BLSEG whose nodes are held off'))
    call card%add(id_field(4, 'MASTER', 'BLSEG whose segments they are held off'))
    call card%add(noted(real_field(6, 'SFAC', 'stiffness factor: contact is exact', '')))
    friction = zero(7, 'FRICID', 'friction')
    friction%reason = 'there is no friction'
    call card%add(friction)
    call card%add(integer_field(8, 'PTYPE', 'forces from slave and master: 1', 1, 1, default=1))
    call card%add(zero(9, 'CID', 'system of the contact plane: the basic one'))
  end function bconp

  function cbar() result(card)
    type(card_entry) :: card
    integer :: slot

    card = new_card('CBAR', 'boundary line of a mesher: counted, no effect')
    call card%add(noted(id_field(2, 'EID', 'element')))
    call card%add(noted(id_field(3, 'PID', 'property, not looked up', required=.false.)))
    call card%add(noted(id_field(4, 'GA', 'first node')))
    call card%add(noted(id_field(5, 'GB', 'second node')))
    do slot = 5, 16
      call card%add(any_field(number_of(slot), '', 'anything'))
    end do
  end function cbar

  function param() result(card)
    type(card_entry) :: card

    card = new_card('PARAM', 'a choice for the whole deck')
    call card%add(word_field(2, 'NAME', 'parameter'))
    call card%add(word_field(3, 'VALUE', 'its value'))
  end function param

  !> All PARAMs: the field VALUE for each NAME.
  function parameters() result(field)
    type(field_entry) :: field(14)

    field(1) = word_field(3, 'PLANE', 'every PSHELL with blank MID2', choices='STRAIN STRESS')
    field(2) = word_field(3, 'RULE', 'contact entry rule; default AUTO', choices='AUTO CONRY BLOCK')
    field(3) = word_field(3, 'GAPGEOM', 'YES adds the distance of the nodes to each gap; default NO', choices='NO YES')
    field(4) = word_field(3, 'UNITS', 'printed with the results; nothing is converted')
    field(5) = word_field(3, 'METHOD', 'plastic iteration; default AUTO', choices='AUTO SECANT MODSEC INISTR NEWTON')
    field(6) = positive(real_field(3, 'TOL', 'largest change of a displacement, of the largest, that ends the iteration;'// &
                                   ' default 0.01, for NEWTON 1.E-8', ''))
    field(6)%highest = 1.0_wp
    field(6)%below_highest = .true.
    field(7) = integer_field(3, 'MAXIT', 'iterations of a load step; default 100', 1, 100000)
    field(8) = word_field(3, 'MUP', 'Poisson''s ratio in the equivalent strain: exact, or formula (2-4); default EXACT', &
                          choices='EXACT PAPER')
    field(9) = integer_field(3, 'NLOAD', 'load steps; default 1', 1, 10000)
    field(10) = positive(real_field(3, 'SEARCH', 'how far BCONP looks for a segment; default twice the longest segment of the'// &
                                    ' two lines', 'length'))
    field(11) = word_field(3, 'SOLVER', 'matrices of the bodies: panels of a band, or nested fronts; default AUTO', &
                           choices='AUTO BAND FRONTAL')
    field(11)%withdrawn = 'SPARSE'
    field(12) = word_field(3, 'PRECIS', 'factors in double or single precision, these refined to double (MIXED) or not;'// &
                           ' default DOUBLE', choices='DOUBLE MIXED SINGLE')
    field(13) = positive(real_field(3, 'ACCURACY', 'wanted relative error of contact pressures: sets TOL, METHOD and PRECIS'// &
                                    ' where they are left out', ''))
    field(13)%highest = 1.0_wp
    field(13)%below_highest = .true.
    field(14) = positive(real_field(3, 'CORNER', 'sides of a boundary line that turn by more than this meet at a corner;'// &
                                    ' default: decided from the turns beside it', 'degree'))
    field(14)%highest = 180.0_wp
    field%required = .true.
  end function parameters

  !> A field that is zero or blank: there is nothing to choose.
  function zero(number, name, meaning) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning
    type(field_entry) :: field

    field = integer_field(number, name, meaning, 0, 0, default=0)
  end function zero

  function zero_real(number, name, meaning, reason) result(field)
    integer, intent(in) :: number
    character(len=*), intent(in) :: name, meaning, reason
    type(field_entry) :: field

    field = real_field(number, name, meaning, '', default=0.0_wp)
    field%lowest = 0.0_wp
    field%highest = 0.0_wp
    field%reason = reason
  end function zero_real
end module epcont_deck_catalogue
