!> Sensitivity of a contact solution from the flexibility: forces under unit loads, with the pairs in contact
!> kept closed, and changes of the contact forces by errors of the flexibility and of the gaps.
!>
!> On the pairs in contact, R = -M g + ..., with M = F^-1 - F^-1 A (A'F^-1 A)^-1 A'F^-1. Errors dF
!> and dg change R by M (dF R + dg), at most |M| (|dF| |R| + |dg|): a bound that does not depend on units
!> (Skeel 1979). Its largest entry is the 1-norm of D M with D = diag(|dF| |R| + |dg|): computed if there are
!> few pairs, else estimated from a few products (Hager 1984; Higham 1988).
module epcont_linear_simplex_response
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference, solved_to
  use epcont_contact_basis, only: contact_basis, respond
  use epcont_contact_scaling, only: gaps_by_forces, scaled_problem
  use epcont_linear_contact_rule, only: contact_loads, contact_sensitivity
  implicit none
  private
  public :: find_sensitivity, load_pairs

  !> Number of pairs up to which all of M is computed: of two nearly equal rows, rounding may choose the one
  !! at which the estimate stops.
  integer, parameter :: few_pairs = 200
  integer, parameter :: most_products = 5

contains

  !> Contact forces under unit loads along modes, and of gaps that shrink by the weight of each pair: zero
  !> if modes close the gaps. By reciprocity, a unit load along a mode changes a sum of forces by the
  !> approach that closing the gaps causes.
  pure subroutine load_pairs(problem, basis, loads)
    type(scaled_problem), intent(in) :: problem   !! of the contact
    type(contact_basis), intent(in) :: basis      !! of the pairs in contact
    type(contact_loads), intent(inout) :: loads   !! with modes and weights
    real(wp), allocatable :: opening(:, :), load(:, :), carried(:, :), approach(:, :)
    integer :: j, motions

    motions = size(loads%motion)
    associate (all_loads => motions + size(loads%share, 2), unit => problem%motion_size)
      allocate (loads%force(size(problem%gap), all_loads), loads%shared(size(unit), size(loads%share, 2)), &
                source=0.0_wp)
      loads%sound = basis%sound
      if (.not. loads%sound) return
      allocate (opening(size(basis%pairs), all_loads), load(basis%motions, all_loads), source=0.0_wp)
      do j = 1, motions
        where (basis%kept == loads%motion(j)) load(:, j) = 1.0_wp/unit(loads%motion(j))
      end do
      opening(:, motions + 1:) = -loads%share(basis%pairs, :)/problem%gap_unit
      call respond(basis, opening, load, carried, approach)
      where (abs(carried(:, :motions)) <= least_difference/maxval(unit)) carried(:, :motions) = 0.0_wp
      loads%force(basis%pairs, :motions) = carried(:, :motions)
      do j = motions + 1, all_loads
        if (maxval(abs(carried(:, j))) > solved_to*maxval(abs(opening(:, j)))) &
          loads%force(basis%pairs, j) = carried(:, j)*problem%force_unit
        loads%shared(basis%kept, j - motions) = -approach(:, j)*problem%gap_unit/unit(basis%kept)
      end do
    end associate
  end subroutine load_pairs

  !> Forces that keep the pairs in contact closed against given openings, without other loads
  !! [pairs in contact, any].
  pure function forces_under(basis, opening) result(carried)
    type(contact_basis), intent(in) :: basis                 !! sound
    real(wp), contiguous, intent(in) :: opening(:, :)        !! in scaled units [pairs in contact, any]
    real(wp), allocatable :: carried(:, :), approach(:, :)
    real(wp) :: load(basis%motions, size(opening, 2))

    load = 0.0_wp
    call respond(basis, opening, load, carried, approach)
  end function forces_under

  !> Compute the sensitivity of the forces to errors of the stiffness and of the gaps.
  pure function find_sensitivity(problem, basis, force, travel, condition) result(found)
    type(scaled_problem), intent(in) :: problem   !! of the contact
    type(contact_basis), intent(in) :: basis      !! of the pairs in contact
    real(wp), intent(in) :: force(:)     !! [force] [pairs]
    real(wp), intent(in) :: travel(:)    !! sum of magnitudes of the terms of each gap [length] [pairs]
    real(wp), intent(in) :: condition    !! of the stiffness
    type(contact_sensitivity) :: found
    real(wp), allocatable :: opening(:), pressed(:), rounding(:)
    real(wp) :: change(2)                !! of forces

    if (.not. basis%sound .or. size(basis%pairs) == 0) return
    found%known = .true.
    allocate (pressed(size(force)), source=0.0_wp)
    pressed(basis%pairs) = force(basis%pairs)/problem%force_unit
    opening = gaps_by_forces(problem, pressed, magnitudes=.true.)
    opening = opening(basis%pairs)
    rounding = epsilon(1.0_wp)*(condition*opening + travel(basis%pairs)/problem%gap_unit)
    change = largest_changes(basis, reshape([opening, rounding], [size(opening), 2])) &
             *problem%force_unit/maxval(force)
    found%amplification = change(1)
    found%rounding = min(1.0_wp, change(2))
  end function find_sensitivity

  !> 1-norm of D M for each D.
  pure function largest_changes(basis, d) result(norm)
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: d(:, :)   !! diagonals [pairs in contact, any]
    real(wp) :: norm(size(d, 2))
    real(wp), allocatable :: opening(:, :)
    integer :: k

    if (size(d, 1) > few_pairs) then
      norm = [(largest_change(basis, d(:, k)), k=1, size(d, 2))]
    else
      allocate (opening(size(d, 1), size(d, 1)), source=0.0_wp)
      do k = 1, size(d, 1)
        opening(k, k) = 1.0_wp
      end do
      norm = maxval(matmul(transpose(d), abs(forces_under(basis, opening))), dim=2)
    end if
  end function largest_changes

  !> Estimate the 1-norm of D M.
  pure real(wp) function largest_change(basis, d) result(norm)
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: d(:)
    real(wp) :: x(size(d)), y(size(d)), turned(size(d))
    integer :: k, product

    norm = 0.0_wp
    x = 1.0_wp/size(d)
    do product = 1, most_products
      y = d*change(x)
      if (sum(abs(y)) <= norm) exit
      norm = sum(abs(y))
      turned = change(d*sign(1.0_wp, y))
      k = maxloc(abs(turned), dim=1)
      if (abs(turned(k)) <= dot_product(turned, x)) exit
      x = 0.0_wp
      x(k) = 1.0_wp
    end do
    ! If all pairs are alike, the estimate stays at its start: also try forces of alternating sign.
    x = [(merge(1.0_wp, -1.0_wp, mod(k, 2) == 0)*(1.0_wp + (k - 1.0_wp)/(size(d) - 1.0_wp)), k=1, size(d))]
    norm = max(norm, sum(abs(d*change(x)))/(1.5_wp*size(d)))

  contains

    !> M g, up to its sign.
    pure function change(gap)
      real(wp), intent(in) :: gap(:)
      real(wp) :: change(size(gap))

      change = reshape(forces_under(basis, reshape(gap, [size(gap), 1])), [size(gap)])
    end function change
  end function largest_change
end module epcont_linear_simplex_response
