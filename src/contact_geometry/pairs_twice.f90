!> Pairs at one place: they are refused, since of two of them each bears a part of the force, and the pressure
!> is that of a part.
module epcont_contact_geometry_pairs_twice
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: rounded_off
  use epcont_model_finding, only: and_more, findings, of_couple, of_pair
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: refuse_pairs_twice

  !> Normals of two CGAPs are one within 2.5 degrees: in a groove, whose walls stand at a larger angle, each
  !! has its force.
  real(wp), parameter :: parallel = 0.999_wp
  !> The normal of a CGAP is that of a line, which bends from node to node, within 45 degrees.
  real(wp), parameter :: one_face = sqrt(0.5_wp)
  character(len=*), parameter :: shared = ': forces would be shared between the two'

contains

  !> Of pairs given one by one (CGAP) at the place of another of these, and at the place of one of lines.
  pure subroutine refuse_pairs_twice(model, found)
    type(model_type), intent(in) :: model   !! the scene
    type(findings), intent(inout) :: found   !! what is wrong with it is added
    type(incidence) :: around, lines   !! CGAPs at each node; pairs of lines in which a node stands on sides
    integer, dimension(model%single_pairs()) :: cgap, line   ! like each pair; 0: none
    integer :: cgaps, k

    cgaps = model%single_pairs()
    if (cgaps == 0) return
    around = new_incidence(model%pair_node(:, :cgaps), model%nodes)
    lines = new_incidence(reshape(model%row_node(model%row_start(cgaps + 1:model%pairs)), &
                                  [1, model%pairs - cgaps]), model%nodes)
    do k = 1, cgaps
      cgap(k) = cgap_like(model, around, k)
      line(k) = line_pair_like(model, lines, cgaps, k)
    end do
    k = findloc(cgap > 0, .true., dim=1)
    if (k > 0) call found%add_error(of_pair, k, 1, ': joins the nodes of '// &
                                    model%name_of(of_pair, cgap(k))// &
      ' along the same normal, with the same gap'//shared//like_this(count(cgap > 0)), &
      'one CGAP for two nodes and a normal')
    k = findloc(line > 0, .true., dim=1)
    if (k > 0) call found%add_error(of_pair, k, 1, ': joins nodes that '// &
                                    model%name_of(of_couple, couple_of(model, line(k)))// &
      ' joins along the same normal'//shared//like_this(count(line > 0)), 'either CGAPs or a BCONP')
  end subroutine refuse_pairs_twice

  !> How many more CGAPs there are than the one that is named.
  pure function like_this(count) result(text)
    integer, intent(in) :: count
    character(len=:), allocatable :: text

    text = and_more(count, '; so it is with ', trim(merge(' more CGAPs', ' more CGAP ', count > 2)))
  end function like_this

  !> The first couple of the contact that a pair is of.
  pure integer function couple_of(model, pair) result(couple)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair

    couple = model%line_contact(findloc(model%line_contact%last >= pair, .true., dim=1))%couple(1)
  end function couple_of

  !> The first CGAP before pair k that is between its nodes, along its normal, with its gap; 0: none.
  pure integer function cgap_like(model, around, k) result(other)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: around
    integer, intent(in) :: k
    real(wp) :: apart
    integer :: i, node, way

    associate (a => model%pair_node(1, k), b => model%pair_node(2, k))
      ! At a node of the ground there may be thousands.
      node = merge(a, b, around%start(a + 1) - around%start(a) < around%start(b + 1) - around%start(b))
      do i = around%start(node), around%start(node + 1) - 1
        other = around%group(i)
        if (other == k) exit
        way = 0
        if (all(model%pair_node(:, other) == [a, b])) way = 1
        if (all(model%pair_node(:, other) == [b, a])) way = -1
        if (way*dot_product(model%normal(:, other), model%normal(:, k)) < parallel) cycle
        apart = norm2(model%x(:, b) - model%x(:, a)) + abs(model%initial_gap(k))
        if (abs(model%initial_gap(other) - model%initial_gap(k)) <= rounded_off*apart) return
      end do
    end associate
    other = 0
  end function cgap_like

  !> The first pair of lines that joins the nodes of CGAP k along its normal; 0: none.
  pure integer function line_pair_like(model, lines, cgaps, k) result(pair)
    type(model_type), intent(in) :: model
    type(incidence), intent(in) :: lines
    integer, intent(in) :: cgaps, k
    integer :: i, which

    do which = 1, 2
      associate (node => model%pair_node(which, k), other => model%pair_node(3 - which, k))
        do i = lines%start(node), lines%start(node + 1) - 1
          pair = cgaps + lines%group(i)
          if (all(model%row_node(model%row_start(pair) + 1:model%row_start(pair + 1) - 1) /= other)) cycle
          if (dot_product(model%normal(:, pair), model%normal(:, k))*merge(1, -1, which == 2) >= one_face) &
            return
        end do
      end associate
    end do
    pair = 0
  end function line_pair_like
end module epcont_contact_geometry_pairs_twice
