!> Contact pairs from BCONP: each node of the slave line against what it faces of the master line. Gap and normal are those
!> at the node; what the master nodes share in it comes from epcont_model_mortar.
module epcont_model_line_pairs
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: id_index
  use epcont_base_text, only: short_real, text_of
  use epcont_deck_card_kinds, only: card_bconp, card_blseg
  use epcont_deck_deck, only: deck_type
  use epcont_deck_diagnostic, only: diagnostics
  use epcont_model_boundary_line, only: boundary_line
  use epcont_model_facing, only: facing_type, find_nearest
  use epcont_model_model, only: axisymmetric, line_contact, model_type
  use epcont_model_mortar, only: mortar_rows
  use epcont_model_reference, only: check_unique, index_of_ids, resolve
  use epcont_model_side_boxes, only: new_side_boxes, side_boxes
  implicit none
  private
  public :: build_line_pairs

  !> Where nothing is said of it, a side is looked for within this many times the longest side of the two lines.
  real(wp), parameter :: default_search = 2.0_wp
  !> A node that is left out would face something within this many times the search: its neighbour's touching may spread to it.
  real(wp), parameter :: wider = 2.0_wp
  !> Slave sides shorter than the others by more than this factor: beyond it pressures were seen to be off by 3 % and more.
  real(wp), parameter :: finer = 1.3_wp

  !> Normals that differ by less (cosine) are those of one face.
  real(wp), parameter :: same_face = 0.9_wp

  !> What the nodes of a slave line face.
  type :: faces_type
    integer :: nodes = 0                           !! of the line
    integer :: same_way = 0                        !! of them near sides that look the same way only
    integer, allocatable :: node(:)                !! those that face something [rows]
    type(facing_type), allocatable :: facing(:)    !! what [rows]
    integer, allocatable :: row_of(:, :)           !! of the nodes of each side; 0: they face nothing [3, sides]
  end type faces_type

contains

  !> Add the pairs of all line contacts behind those of CGAP.
  subroutine build_line_pairs(deck, model, faults)
    type(deck_type), intent(in) :: deck
    type(model_type), intent(inout) :: model
    type(diagnostics), intent(inout) :: faults
    type(faces_type) :: faces
    type(id_index) :: lines
    type(side_boxes) :: boxes   !! of the master line
    logical, allocatable :: used(:)
    integer :: i
    logical :: sound

    ! Without sound elements there is no boundary to look at.
    sound = faults%error_count() == 0
    call check_unique(deck, [card_bconp], faults)
    lines = index_of_ids(deck, card_blseg)
    allocate (used(size(model%line)), source=.false.)
    associate (bconp => deck%card(card_bconp))
      allocate (model%line_contact(bconp%count))
      do i = 1, bconp%count
        associate (contact => model%line_contact(i))
          contact%id = nint(bconp%value(1, i))
          call resolve(deck, card_bconp, i, 2, lines, 'BLSEG', faults, contact%slave)
          call resolve(deck, card_bconp, i, 3, lines, 'BLSEG', faults, contact%master)
          if (contact%slave > 0) used(contact%slave) = .true.
          if (contact%master > 0) used(contact%master) = .true.
          if (contact%slave == 0 .or. contact%master == 0) cycle
          call check_once(deck, i, model, faults)
          if (contact%slave == contact%master) then
            call faults%add_error(deck%place(card_bconp, i, 3), deck%identity(card_bconp, i)// &
                                  ': SLAVE and MASTER are one line', 'another BLSEG')
            cycle
          end if
          associate (slave => model%line(contact%slave), master => model%line(contact%master))
            if (size(slave%element) == 0 .or. size(master%element) == 0 .or. .not. sound) cycle   ! said of line or element
            contact%search = deck%parameter_value('SEARCH', default_search*max(slave%longest(), master%longest()))
            boxes = new_side_boxes(master)
            call find_faces(model, slave, master, boxes, contact%search, faces)
          end associate
          if (size(faces%node) == 0) then
            call add_nothing_faced(deck, i, model, faces%same_way, faults)
            cycle
          end if
          call add_pairs(faces, boxes, model, contact)
          call find_border(model, faces, boxes, contact)
          call warn_of_overlap(deck, i, model, contact, faults)
          call warn_of_finer_slave(deck, i, model, faces, faults)
        end associate
      end do
    end associate
    do i = 1, size(used)
      if (.not. used(i)) call faults%add_warning(deck%place(card_blseg, i, 1), deck%identity(card_blseg, i)// &
                              ': no BCONP names it', 'a BCONP with it as SLAVE or MASTER, or no such line')
    end do
  end subroutine build_line_pairs

  !> What the nodes of one line face of another, in their order along the line.
  pure subroutine find_faces(model, slave, master, boxes, search, faces)
    type(model_type), intent(in) :: model
    type(boundary_line), intent(in) :: slave, master
    type(side_boxes), intent(in) :: boxes   !! of the master line
    real(wp), intent(in) :: search
    type(faces_type), intent(out) :: faces
    type(facing_type) :: facing
    integer, parameter :: in_turn(3) = [1, 3, 2]   ! start, middle, end
    integer :: n, s, sides, turn, which
    logical :: new

    sides = size(slave%element)
    allocate (faces%facing(4*sides), faces%node(4*sides))
    allocate (faces%row_of(3, sides), source=0)
    n = 0
    do s = 1, sides
      do turn = 1, 3
        which = in_turn(turn)
        if (slave%segment(which, s) == 0) cycle
        if (which == 1 .and. s > 1) then
          if (all(slave%normal(:, 1, s) == slave%normal(:, 2, s - 1))) then   ! looked at from the side before
            faces%row_of(1, s) = faces%row_of(2, s - 1)
            cycle
          end if
        end if
        associate (node => slave%segment(which, s))
          facing = find_nearest(master, boxes, model%x(:, node), slave%outward(s, which), search, node)
          new = which > 1 .or. s == 1
          if (which == 1 .and. s > 1) new = .not. joined(faces%row_of(2, s - 1))
          if (which == 2 .and. s == sides .and. slave%closed) new = .not. joined(faces%row_of(1, 1))
          if (which > 1 .or. s == 1) then
            if (.not. (which == 2 .and. s == sides .and. slave%closed)) faces%nodes = faces%nodes + 1
            if (facing%same_way) faces%same_way = faces%same_way + 1
          end if
          if (.not. facing%place%found) cycle
          if (new) then
            n = n + 1
            faces%facing(n) = facing
            faces%node(n) = node
            faces%row_of(which, s) = n
          else if (which == 1) then
            faces%row_of(1, s) = faces%row_of(2, s - 1)
          else
            faces%row_of(2, s) = faces%row_of(1, 1)
          end if
        end associate
      end do
    end do
    faces%facing = faces%facing(:n)
    faces%node = faces%node(:n)

  contains

    !> Does the side before, or behind, see the node face the same way? Round a corner each side has a pair of its own.
    pure logical function joined(row)
      integer, intent(in) :: row

      joined = .false.
      if (row == 0 .or. .not. facing%place%found) return
      joined = dot_product(faces%facing(row)%place%normal, facing%place%normal) > same_face
    end function joined
  end subroutine find_faces

  !> Append pairs, with their rows of N: the slave node is B, the master line's nodes are A.
  subroutine add_pairs(faces, boxes, model, contact)
    type(faces_type), intent(in) :: faces
    type(side_boxes), intent(in) :: boxes   !! of the master line
    type(model_type), intent(inout) :: model
    type(line_contact), intent(inout) :: contact
    integer, allocatable :: start(:), node(:), nodes(:), most(:), row_end(:)
    real(wp), allocatable :: weight(:), weights(:)
    integer :: i, n

    n = size(faces%node)
    associate (slave => model%line(contact%slave), master => model%line(contact%master))
      call mortar_rows(slave, master, boxes, faces%row_of, faces%facing, contact%search, &
                       model%kinematics(model%section(slave%element(1))) == axisymmetric, start, node, weight)
    end associate
    allocate (nodes(n + size(node)), weights(n + size(node)), most(n), row_end(n))
    do i = 1, n
      associate (first => start(i), last => start(i + 1) - 1)
        nodes(first + i - 1:last + i) = [faces%node(i), node(first:last)]
        weights(first + i - 1:last + i) = [1.0_wp, -weight(first:last)]
        most(i) = node(first - 1 + maxloc(weight(first:last), dim=1))
        row_end(i) = last + i
      end associate
    end do
    contact%first = model%pairs + 1
    contact%last = model%pairs + n
    contact%left_out = faces%nodes - n
    model%row_start = [model%row_start, size(model%row_node) + row_end + 1]
    model%pair_node = reshape([model%pair_node, (most(i), faces%node(i), i=1, n)], [2, contact%last])
    model%pair_id = [model%pair_id, model%node_id(faces%node)]
    model%normal = reshape([model%normal, (faces%facing(i)%place%normal, i=1, n)], [2, contact%last])
    model%initial_gap = [model%initial_gap, faces%facing%place%gap]
    model%row_node = [model%row_node, nodes]
    model%row_weight = [model%row_weight, weights]
    model%pairs = contact%last
  end subroutine add_pairs

  !> Pairs whose neighbour along the slave line is left out, though it faces the master line from not much farther away.
  subroutine find_border(model, faces, boxes, contact)
    type(model_type), intent(in) :: model
    type(faces_type), intent(in) :: faces
    type(side_boxes), intent(in) :: boxes   !! of the master line
    type(line_contact), intent(inout) :: contact
    type(facing_type) :: facing
    logical :: at_border(size(faces%node))
    integer :: ends(2), k, s
    real(wp) :: search

    at_border = .false.
    associate (slave => model%line(contact%slave), master => model%line(contact%master))
      search = wider*max(contact%search, default_search*max(slave%longest(), master%longest()))
      do s = 1, size(slave%element)
        do k = 1, 2   ! from each end of the side to its middle, or to the other end
          ends = [k, merge(3, 3 - k, slave%segment(3, s) > 0)]
          if (count(faces%row_of(ends, s) > 0) /= 1) cycle
          if (faces%row_of(ends(1), s) == 0) ends = ends([2, 1])
          facing = find_nearest(master, boxes, model%x(:, slave%segment(ends(2), s)), slave%outward(s, ends(2)), search, &
                                slave%segment(ends(2), s))
          if (facing%place%found) at_border(faces%row_of(ends(1), s)) = .true.
        end do
      end do
    end associate
    contact%border = contact%first - 1 + pack([(k, k=1, size(at_border))], at_border)
  end subroutine find_border

  !> Two contacts of the same two lines would share their forces.
  subroutine check_once(deck, i, model, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    type(diagnostics), intent(inout) :: faults
    integer :: k

    do k = 1, i - 1
      associate (now => model%line_contact(i), earlier => model%line_contact(k))
        if (.not. all([now%slave, now%master] == [earlier%slave, earlier%master]) .and. &
            .not. all([now%slave, now%master] == [earlier%master, earlier%slave])) cycle
        call faults%add_error(deck%place(card_bconp, i, 2), deck%identity(card_bconp, i)//': its lines are those of '// &
                              deck%identity(card_bconp, k)//': forces would be shared between the two', &
                              'one BCONP for two lines: contact is exact either way')
        return
      end associate
    end do
  end subroutine check_once

  subroutine add_nothing_faced(deck, i, model, same_way, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    integer, intent(in) :: same_way
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: remedy, what

    associate (contact => model%line_contact(i))
      what = deck%identity(card_bconp, i)//': no node of BLSEG '//text_of(model%line(contact%slave)%id)// &
             ' faces a side of BLSEG '//text_of(model%line(contact%master)%id)//' within '//short_real(contact%search)
      remedy = 'lines that face each other, or a larger PARAM SEARCH'
      if (same_way > 0) then
        what = what//'; '//text_of(same_way)//' of them near sides that look the same way'
        remedy = 'boundaries of two bodies that face each other'
      end if
    end associate
    call faults%add_error(deck%place(card_bconp, i, 1), what, remedy)
  end subroutine add_nothing_faced

  !> Pressures are carried by the slave line's nodes. Where these are closer than the nodes of the other line, whose sides bend
  !! at nodes alone, they show its facets. Looked at where the lines are nearest to each other.
  subroutine warn_of_finer_slave(deck, i, model, faces, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    type(faces_type), intent(in) :: faces
    type(diagnostics), intent(inout) :: faults
    real(wp) :: nearest, ratio, sides(2)
    integer :: k, row, s

    associate (slave => model%line(model%line_contact(i)%slave), master => model%line(model%line_contact(i)%master))
      nearest = minval(faces%facing%place%gap)
      sides = 0.0_wp
      do s = 1, size(slave%element)
        do k = 1, 2
          row = faces%row_of(k, s)
          if (row == 0) cycle
          associate (facing => faces%facing(row))
            if (facing%place%gap > nearest + slave%chord_length(s) .or. master%segment(3, facing%segment) > 0) cycle
            if (all(model%held(:, master%segment(:2, facing%segment)))) cycle   ! rigid: it does not bend at all
            sides = sides + [slave%chord_length(s)/merge(2, 1, slave%segment(3, s) > 0), master%chord_length(facing%segment)]
          end associate
        end do
      end do
    end associate
    if (sides(1)*finer >= sides(2)) return
    ratio = sides(2)/sides(1)
    call faults%add_warning(deck%place(card_bconp, i, 2), deck%identity(card_bconp, i)//': sides of the slave line are '// &
                            short_real(ratio)//' times shorter than those that they face: pressures will show these as facets', &
                            'SLAVE and MASTER exchanged, or lines of about the same fineness')
  end subroutine warn_of_finer_slave

  !> One warning for all overlaps: shrink fits have many.
  subroutine warn_of_overlap(deck, i, model, contact, faults)
    type(deck_type), intent(in) :: deck
    integer, intent(in) :: i
    type(model_type), intent(in) :: model
    type(line_contact), intent(in) :: contact
    type(diagnostics), intent(inout) :: faults
    character(len=:), allocatable :: others
    integer :: deepest, overlaps

    associate (gap => model%initial_gap(contact%first:contact%last))
      overlaps = count(gap < 0.0_wp)
      if (overlaps == 0) return
      deepest = contact%first - 1 + minloc(gap, dim=1)
    end associate
    others = ''
    if (overlaps > 1) others = '; '//text_of(overlaps)//' nodes overlap'
    call faults%add_warning(deck%place(card_bconp, i, 1), deck%identity(card_bconp, i)//': the initial gap at GRID '// &
                            text_of(model%pair_id(deepest))//' is '//short_real(model%initial_gap(deepest))//others, &
                            'gaps of 0.0 or more, unless a fit is meant')
  end subroutine warn_of_overlap
end module epcont_model_line_pairs
