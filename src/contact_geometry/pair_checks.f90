!> Pairs that cannot do what pairs are for: found before solving, and warned of.
module epcont_contact_geometry_pair_checks
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: short_real, text_of
  use epcont_base_tolerances, only: least_difference, no_effect
  use epcont_geometry_plane, only: cross_product
  use epcont_model_finding, only: and_more, findings, of_couple, of_element, of_node, of_pair
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: check_pairs

  !> A normal within 60 degrees of a boundary's own goes its way.
  real(wp), parameter :: same_way = 0.5_wp

contains

  !> Warn of pairs that point the wrong way, that do not lie opposite each other, that can neither open nor
  !! close, and of six-node sides with half of them.
  pure subroutine check_pairs(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    integer :: c

    if (model%pairs == 0) return
    call warn_of_wrong_ways(model, found)
    call warn_of_sideways(model, found)
    call warn_of_held(model, 1, model%single_pairs(), 0, found)
    do c = 1, size(model%line_contact)
      associate (contact => model%line_contact(c))
        call warn_of_held(model, contact%first, contact%last, contact%couple(1), found)
      end associate
    end do
    call warn_of_half_sides(model, found)
  end subroutine check_pairs

  !> Normals that go into the body of node A, or out of that of node B; but not where the other node says that
  !! they are right.
  pure subroutine warn_of_wrong_ways(model, found)
    type(model_type), intent(in) :: model
    type(findings), intent(inout) :: found
    real(wp), allocatable :: outward(:, :)
    real(wp) :: along_a, along_b   ! the normal, along those of the two boundaries
    integer :: k

    outward = boundary_normals(model)
    do k = 1, model%single_pairs()
      along_a = dot_product(outward(:, model%pair_node(1, k)), model%normal(:, k))
      along_b = dot_product(outward(:, model%pair_node(2, k)), model%normal(:, k))
      if (along_a >= same_way .or. along_b <= -same_way) cycle
      if (along_a <= -same_way .or. along_b >= same_way) &
        call found%add_warning(of_pair, k, 1, &
                             ': its normal points the wrong way: into the body of GA, or out of that of GB', &
                               'GA and GB exchanged, or the x-axis of CID turned round')
    end do
  end subroutine warn_of_wrong_ways

  !> One warning for all CGAPs whose two nodes, both of bodies, lie farther apart across the normal than a
  !! side there is long.
  pure subroutine warn_of_sideways(model, found)
    type(model_type), intent(in) :: model
    type(findings), intent(inout) :: found
    real(wp) :: side(model%nodes), sideways(model%single_pairs())
    integer :: far, i

    side = 0.0_wp
    do i = 1, model%body_outline%sides
      associate (node => model%body_outline%node(:, i))
        associate (ends => node(:merge(3, 2, node(3) > 0)))
          side(ends) = max(side(ends), norm2(model%x(:, node(2)) - model%x(:, node(1))))
        end associate
      end associate
    end do
    do i = 1, size(sideways)
      associate (a => model%pair_node(1, i), b => model%pair_node(2, i))
        sideways(i) = abs(cross_product(model%x(:, b) - model%x(:, a), model%normal(:, i)))
        if (min(side(a), side(b)) == 0.0_wp .or. sideways(i) <= max(side(a), side(b))) sideways(i) = 0.0_wp
      end associate
    end do
    if (all(sideways == 0.0_wp)) return
    far = maxloc(sideways, dim=1)
    call found%add_warning(of_pair, far, 4, ': GA and GB lie '//short_real(sideways(far))// &
                           ' apart along the contact, more than a side there ('// &
                           short_real(maxval(side(model%pair_node(:, far))))//')'// &
                           and_more(count(sideways > 0.0_wp), '; so do ', ' more'), &
                           'nodes that lie opposite each other, or BLSEG lines with a BCONP between them')
  end subroutine warn_of_sideways

  !> A six-node side presses by its middle, with two thirds of the force, and its ends: where some of these
  !! have no pair, the side passes through what the others touch. A middle alone may be a point of support;
  !! two beside each other are none.
  pure subroutine warn_of_half_sides(model, found)
    type(model_type), intent(in) :: model
    type(findings), intent(inout) :: found
    type(incidence) :: around         ! CGAPs at each node
    logical, allocatable :: on_line(:)
    integer :: c, first, half, s

    if (model%single_pairs() == 0 .or. all(model%body_outline%node(3, :) == 0)) return
    around = new_incidence(model%pair_node(:, :model%single_pairs()), model%nodes)
    allocate (on_line(0:model%nodes), source=.false.)
    do c = 1, size(model%line_contact)
      on_line([model%line_contact(c)%slave%segment, model%line_contact(c)%master%segment]) = .true.
    end do
    half = 0
    associate (outline => model%body_outline)
      do s = outline%sides, 1, -1
        if (outline%node(3, s) == 0) cycle
        if (on_line(outline%node(3, s)) .or. model%is_rigid(outline%node(:, s))) cycle
        if (.not. is_half(model, around, s)) cycle
        half = half + 1
        first = s
      end do
    end associate
    if (half > 0) call add_half_side(model, around, first, half, found)
  end subroutine warn_of_half_sides

  !> Has a six-node side pairs at its ends alone, or, beside another such side, at its middle alone?
  pure logical function is_half(model, around, side)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around   !! pairs at each node
    integer, intent(in) :: side
    logical :: at(3), beside(3)

    associate (outline => model%body_outline)
      at = has_pair(model, around, outline%node(:, side))
      beside = has_pair(model, around, outline%node(:, outline%before(side))) .or. &
               has_pair(model, around, outline%node(:, outline%after(side)))
    end associate
    is_half = merge(beside(3) .and. .not. any(at(:2)), all(at(:2)), at(3))
  end function is_half

  pure subroutine add_half_side(model, around, side, half, found)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: side, half         !! the first of them, and how many there are
    type(findings), intent(inout) :: found
    character(len=:), allocatable :: what
    logical :: at(3)

    associate (node => model%body_outline%node(:, side))
      at = has_pair(model, around, node)
      if (at(3)) then
        what = ' at its middle, '//model%name_of(of_node, node(3))//', and none at its ends'
      else
        what = ' at both ends and none at its middle, '//model%name_of(of_node, node(3))
      end if
      call found%add_warning(of_pair, around%group(around%start(node(merge(3, 1, at(3))))), 1, &
                             ': a side of '// &
                             model%name_of(of_element, model%body_outline%element(side))//' has CGAPs'// &
                             what// &
                             ': it will pass through what it touches, and the pressures are wrong'// &
                             and_more(half, '; so it is with ', ' more'), &
                             'CGAPs at all three nodes of the sides, or BLSEG and BCONP')
    end associate
  end subroutine add_half_side

  !> Have the nodes of a side a CGAP that presses on it?
  pure function has_pair(model, around, node)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: node(3)
    logical :: has_pair(3)
    real(wp) :: along(2), across(2)
    integer :: i, k

    has_pair = .false.
    if (node(3) == 0) return
    along = model%x(:, node(2)) - model%x(:, node(1))
    across = [along(2), -along(1)]/norm2(along)
    do k = 1, 3
      do i = around%start(node(k)), around%start(node(k) + 1) - 1
        has_pair(k) = abs(dot_product(across, model%normal(:, around%group(i)))) >= same_way
        if (has_pair(k)) exit
      end do
    end do
  end function has_pair

  !> Outward normals of the boundary at all nodes; zero inside bodies, and where there is none.
  pure function boundary_normals(model) result(normal)
    type(model_type), intent(in) :: model
    real(wp), allocatable :: normal(:, :)   !! [2, nodes]
    real(wp) :: length(model%nodes), chord(2)
    integer :: k, s

    allocate (normal(2, model%nodes), source=0.0_wp)
    length = 0.0_wp
    do s = 1, model%body_outline%sides
      associate (node => model%body_outline%node(:, s))
        chord = model%x(:, node(2)) - model%x(:, node(1))
        do k = 1, merge(3, 2, node(3) > 0)
          normal(:, node(k)) = normal(:, node(k)) + [chord(2), -chord(1)]
          length(node(k)) = length(node(k)) + norm2(chord)
        end do
      end associate
    end do
    do k = 1, model%nodes
      if (norm2(normal(:, k)) <= no_effect*length(k)) normal(:, k) = 0.0_wp
      normal(:, k) = normal(:, k)/max(norm2(normal(:, k)), tiny(1.0_wp))
    end do
  end function boundary_normals

  !> One warning for all pairs of a range whose nodes are held along the normal. A held overlap is no warning:
  !! the run will end with it.
  pure subroutine warn_of_held(model, first, last, couple, found)
    type(model_type), intent(in) :: model
    integer, intent(in) :: first, last       !! the range
    integer, intent(in) :: couple            !! of lines that the pairs are of; 0: given one by one
    type(findings), intent(inout) :: found
    integer, allocatable :: held(:)
    character(len=:), allocatable :: which
    integer :: k

    held = pack([(k, k=first, last)], [(is_held(model, k), k=first, last)])
    if (size(held) == 0) return
    which = and_more(size(held), ', and ', ' more')
    if (couple > 0) which = ': GRID '//text_of(model%pair_id(held(1)))//which
    call found%add_warning(merge(of_couple, of_pair, couple > 0), merge(couple, held(1), couple > 0), 1, &
                           which// &
                           ': can neither open nor close: the nodes on both sides are held along '// &
                           'the normal', &
                           'a free node on one side, or no pair')
  end subroutine warn_of_held

  !> Are all nodes of a pair held along its normal, and do they not overlap?
  pure logical function is_held(model, pair)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    real(wp) :: gap
    integer :: c, i

    gap = model%initial_gap(pair)
    is_held = .false.
    do i = model%row_start(pair), model%row_start(pair + 1) - 1
      do c = 1, 2
        if (abs(model%normal(c, pair)) <= least_difference) cycle
        associate (leader => model%leader(c, model%row_node(i)))
          if (.not. model%held(c, leader)) return
          gap = gap + model%row_weight(i)*model%normal(c, pair)*model%prescribed(c, leader)
        end associate
      end do
    end do
    is_held = gap >= 0.0_wp
  end function is_held
end module epcont_contact_geometry_pair_checks
