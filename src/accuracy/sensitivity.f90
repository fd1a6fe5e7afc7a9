!> What an error of the flexibility and of the gaps does to the contact forces.
!>
!> On the pairs in contact the forces are R = -M g + ..., with M = F^-1 - F^-1 A (A'F^-1 A)^-1 A'F^-1. Errors
!> dF and dg move them by M (dF R + dg), at most |M| (|dF| |R| + |dg|): a bound that no change of units alters
!> (Skeel 1979). Its largest entry is the 1-norm of D M with D = diag(|dF| |R| + |dg|): summed up where pairs
!> are few, else estimated from a few products (Hager 1984; Higham 1988).
module epcont_accuracy_sensitivity
  use epcont_accuracy_unit_loads, only: forces_under
  use epcont_base_kinds, only: wp
  use epcont_contact_basis, only: contact_basis
  use epcont_contact_scaling, only: scaled_problem
  implicit none
  private
  public :: contact_sensitivity, find_sensitivity

  !> Pairs up to which all of M is made: the estimate may stop at one of two nearly equal rows, as rounding
  !! has it.
  integer, parameter :: few_pairs = 200
  integer, parameter :: most_products = 5

  type :: contact_sensitivity
    logical :: known = .false.
    !> Relative error of the forces / relative error of the flexibility, at most
    real(wp) :: amplification = 0.0_wp
    real(wp) :: rounding = 0.0_wp        !! what rounding may leave in a force, of the largest
  end type contact_sensitivity

contains

  !> What errors of the stiffness and of the gaps do to the forces.
  pure function find_sensitivity(problem, basis, force, travel, condition) result(found)
    type(scaled_problem), intent(in) :: problem   !! of the contact
    type(contact_basis), intent(in) :: basis      !! of the pairs in contact
    real(wp), intent(in) :: force(:)     !! [force] [pairs]
    real(wp), intent(in) :: travel(:)    !! what the gap of each pair is the sum of, added up [length] [pairs]
    real(wp), intent(in) :: condition    !! of the stiffness
    type(contact_sensitivity) :: found
    real(wp), allocatable :: opening(:), rounding(:)

    if (.not. basis%sound .or. size(basis%pairs) == 0) return
    found%known = .true.
    associate (pairs => basis%pairs)
      opening = matmul(abs(problem%flexibility(pairs, pairs)), abs(force(pairs)))/problem%force_unit
      rounding = epsilon(1.0_wp)*(condition*opening + travel(pairs)/problem%gap_unit)
      found%amplification = largest_change(basis, opening)*problem%force_unit/maxval(force)
      found%rounding = min(1.0_wp, largest_change(basis, rounding)*problem%force_unit/maxval(force))
    end associate
  end function find_sensitivity

  !> 1-norm of D M.
  pure real(wp) function largest_change(basis, d) result(norm)
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: d(:)
    real(wp) :: x(size(d)), y(size(d)), turned(size(d))
    integer :: k, product

    norm = 0.0_wp
    if (size(d) <= few_pairs) then
      do k = 1, size(d)
        x = 0.0_wp
        x(k) = 1.0_wp
        norm = max(norm, sum(abs(d*change(x))))
      end do
      return
    end if
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
    ! Where all pairs are alike that stays at the start: forces of alternating sign are looked at, too.
    x = [(merge(1.0_wp, -1.0_wp, mod(k, 2) == 0)*(1.0_wp + (k - 1.0_wp)/(size(d) - 1.0_wp)), k=1, size(d))]
    norm = max(norm, sum(abs(d*change(x)))/(1.5_wp*size(d)))

  contains

    !> M g, but for its sign.
    pure function change(gap)
      real(wp), intent(in) :: gap(:)
      real(wp) :: change(size(gap))

      change = reshape(forces_under(basis, reshape(gap, [size(gap), 1])), [size(gap)])
    end function change
  end function largest_change
end module epcont_accuracy_sensitivity
