!> Effects of unit pair forces and of unit rigid-body displacements on the gaps.
module epcont_flexibility_flexibility
  use epcont_assembly_stiffness, only: body_stiffness
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: cancelled, solved_to
  use epcont_element_kinematics, only: directions
  use epcont_flexibility_motion_matrix, only: motion_matrix, new_motion_matrix
  use epcont_linalg_assembled, only: sparse_rows
  use epcont_linalg_dense, only: null_space
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_numbering, only: numbering_type
  use epcont_plan_sums, only: put_pair
  implicit none
  private
  public :: body_flexibility, find_flexibility, gap_opening, pair_forces, see_motions, terms_of_openings

  !> Contribution of one body to F, for the pairs whose gaps depend on its deformation.
  type :: body_flexibility
    integer, allocatable :: pair(:)         !! ascending
    !> Lower triangle [length/force] [its pairs, its pairs]
    real(wp), allocatable :: matrix(:, :)
  end type body_flexibility

contains

  !> Compute the contribution of one body to F = N K^-1 N'.
  pure subroutine find_flexibility(model, numbering, b, pairs, stiffness, part)
    type(model_type), intent(in) :: model
    type(numbering_type), intent(in) :: numbering   !! equation numbers
    integer, intent(in) :: b                       !! the body
    integer, intent(in) :: pairs(:)                !! pairs with nodes in it
    type(body_stiffness), intent(in) :: stiffness  !! factored
    type(body_flexibility), intent(out) :: part   !! without pairs if the body has no free DOFs in gaps
    type(sparse_rows) :: rows   ! of N
    integer :: j, k

    allocate (part%pair(size(pairs)), rows%start(size(pairs) + 1), source=1)
    allocate (rows%equation(0), rows%weight(0))
    k = 1
    do j = 1, size(pairs)
      call put_pair(model, pairs(j), b, numbering%equation, numbering%body(b)%tied, k, rows)
      part%pair(k) = pairs(j)
      if (rows%start(k + 1) > rows%start(k)) k = k + 1
    end do
    part%pair = part%pair(:k - 1)
    if (k == 1) return
    rows = sparse_rows(rows%start(:k), rows%equation(:rows%start(k) - 1), rows%weight(:rows%start(k) - 1))
    call stiffness%matrix%find_compliance(rows, part%matrix)
  end subroutine find_flexibility

  !> Gap changes due to displacements: N u [length] [pairs].
  pure function gap_opening(model, displacement) result(opening)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)  !! [directions, nodes]
    real(wp) :: opening(model%contact%rows())
    integer :: k

    do k = 1, model%contact%rows()
      opening(k) = model%contact%opening(k, displacement(:, &
                                                         model%contact%row_node(model%contact%row_start(k): &
          model%contact%row_start(k + 1) - 1)))
    end do
  end function gap_opening

  !> Sums of the magnitudes of the terms in these gap changes, along x or y, whichever is larger [length]
  !! [pairs].
  pure function terms_of_openings(model, displacement) result(terms)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: displacement(:, :)  !! [directions, nodes]
    real(wp) :: terms(model%contact%rows())
    integer :: i, k

    terms = 0.0_wp
    do k = 1, model%contact%rows()
      do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
        terms(k) = terms(k) + abs(model%contact%row_weight(i))*maxval(abs(displacement(:, &
          model%contact%row_node(i))))
      end do
    end do
  end function terms_of_openings

  !> Nodal forces of the pairs, or of all rows: N' R [force] [directions, nodes].
  pure function pair_forces(model, force) result(nodal)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: force(:)  !! [pairs, or rows]
    real(wp) :: nodal(directions, model%mesh%nodes)
    integer :: i, k, node

    nodal = 0.0_wp
    do k = 1, size(force)
      do i = model%contact%row_start(k), model%contact%row_start(k + 1) - 1
        node = model%contact%row_node(i)
        nodal(:, node) = nodal(:, node) + force(k)*model%contact%row_weight(i)*model%contact%normal(:, k)
      end do
    end do
  end function pair_forces

  !> Compute A = -N Phi, the gap closures by unit rigid-body displacements, and P = Phi' f, the loads along
  !! these modes. Rounding is removed from A if a pair moves as a whole or tangentially; otherwise large
  !! contact forces would drive the body. It is removed from P if loads cancel or act across the mode;
  !! otherwise rounding would decide whether a body is unconstrained. Loads on fixed DOFs are left out,
  !! because their supports carry them.
  subroutine see_motions(model, motions, closing, resultant)
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions   !! unconstrained modes
    type(motion_matrix), intent(out) :: closing   !! A
    real(wp), allocatable, intent(out) :: resultant(:)    !! P [motions]
    type(motion_matrix) :: of_pair   ! rows of A
    real(wp) :: all_loads(motions%count), load(directions), moved(directions)
    integer :: b, c, i, m

    call close_gaps()
    allocate (resultant(motions%count), source=0.0_wp)
    all_loads = 0.0_wp
    do i = 1, model%mesh%nodes
      load = [(merge(0.0_wp, model%loads%load(c, i), &
                     model%constraints%held(c, model%constraints%leader(c, i))), c=1, directions)]
      if (all(load == 0.0_wp)) cycle
      do m = motions%first(model%mesh%body(i)), motions%first(model%mesh%body(i) + 1) - 1
        moved = motions%displacement(model, i, m)
        resultant(m) = resultant(m) + dot_product(moved, load)
        all_loads(m) = all_loads(m) + norm2(moved)*norm2(load)
      end do
    end do
    where (abs(resultant) <= cancelled*all_loads) resultant = 0.0_wp
    of_pair = closing%turned()
    do b = 1, model%mesh%bodies
      if (motions%first(b + 1) > motions%first(b) + 1) &
        call clear_slides(motions%first(b), motions%first(b + 1) - 1)
    end do
    call closing%drop(solved_to)

  contains

    !> Remove rounding of modes that close no gap. They are seldom along one axis: on a flat surface inclined
    !! by 1E-8, this mode is x minus 1E-8 y. Closures and loads of both modes then agree except for rounding,
    !! which would restrain and load the combination. So its closures and load are subtracted from all modes
    !! of the body.
    subroutine clear_slides(first, last)
      integer, intent(in) :: first, last             !! modes of one body
      real(wp), allocatable :: noise(:), own(:, :), slide(:, :)
      real(wp) :: drive
      integer :: before, e, j, m

      before = closing%start(first) - 1
      own = rows_of_entries(first, last)
      slide = null_space(own, solved_to*norm2(own))
      do j = 1, size(slide, 2)
        noise = matmul(own, slide(:, j))
        drive = dot_product(resultant(first:last)/closing%travel(first:last), slide(:, j))
        if (abs(drive) > solved_to*norm2(all_loads(first:last)/closing%travel(first:last))) drive = 0.0_wp
        do m = first, last
          do e = closing%start(m), closing%start(m + 1) - 1
            closing%closing(e) = closing%closing(e) - &
                                 noise(e - before)*slide(m - first + 1, j)*closing%travel(m)
          end do
          resultant(m) = resultant(m) - drive*slide(m - first + 1, j)*closing%travel(m)
        end do
      end do
    end subroutine clear_slides

    !> Rows of A for each entry of these modes, divided by their largest displacements.
    pure function rows_of_entries(first, last) result(row)
      integer, intent(in) :: first, last
      real(wp), allocatable :: row(:, :)   !! [entries, these modes]
      integer :: before, e, i

      before = closing%start(first) - 1
      allocate (row(closing%start(last + 1) - 1 - before, last - first + 1), source=0.0_wp)
      do e = 1, size(row, 1)
        associate (pair => closing%pair(before + e))
          do i = of_pair%start(pair), of_pair%start(pair + 1) - 1
            associate (m => of_pair%pair(i))
              if (m >= first .and. m <= last) row(e, m - first + 1) = of_pair%closing(i)/closing%travel(m)
            end associate
          end do
        end associate
      end do
    end function rows_of_entries

    !> Compute the closure of each pair by the modes of the bodies that have its nodes.
    subroutine close_gaps()
      real(wp) :: moved(directions, maxval([0, &
        model%contact%row_start(2:) - model%contact%row_start(:model%contact%rows())]))
      integer, allocatable :: pair(:), motion(:)   ! row and column of each entry of A
      real(wp), allocatable :: by(:)
      real(wp) :: travel(motions%count)
      integer :: entries, i, j, k, m, n

      travel = 0.0_wp
      n = sum(motions%first(model%mesh%body(model%contact%row_node) + 1) - &
              motions%first(model%mesh%body(model%contact%row_node)))
      allocate (pair(n), motion(n), by(n))
      entries = 0
      do k = 1, model%contact%rows()
        associate (node => model%contact%row_node(model%contact%row_start(k):model%contact%row_start(k + &
          1) - 1), &
                   weight => model%contact%row_weight(model%contact%row_start(k):model%contact%row_start(k + &
                     1) - 1))
          n = size(node)
          do i = 1, n
            if (any(model%mesh%body(node(:i - 1)) == model%mesh%body(node(i)))) cycle
            do m = motions%first(model%mesh%body(node(i))), motions%first(model%mesh%body(node(i)) + 1) - 1
              do j = 1, n
                moved(:, j) = motions%displacement(model, node(j), m)
              end do
              entries = entries + 1
              pair(entries) = k
              motion(entries) = m
              by(entries) = -model%contact%opening(k, moved(:, :n))
              travel(m) = max(travel(m), maxval(norm2(moved(:, :n), dim=1)))
            end do
          end do
        end associate
      end do
      closing = new_motion_matrix(model%contact%rows(), motions%count, pair(:entries), motion(:entries), &
                                  by(:entries))
      closing%travel = merge(travel, 1.0_wp, travel > 0.0_wp)
    end subroutine close_gaps
  end subroutine see_motions
end module epcont_flexibility_flexibility
