!> Motions that some pairs do not hold: the x with A x = 0 in their rows.
!>
!> Of many bodies A is large, and its singular values would take longer than all the rest. Motions that
!> hang together through the pairs are looked at by themselves; where the Cholesky factor of A'A, banded in
!> the order in which they are met from pair to pair, says that all of them are held, there is nothing to
!> look for.
module epcont_contact_loose_motions
  use epcont_base_kinds, only: wp
  use epcont_flexibility_motion_matrix, only: motion_matrix
  use epcont_linalg_dense, only: null_space
  implicit none
  private
  public :: loose_motions

  !> Singular values that far above the tolerance, as the factor has them, are above it: its estimate of the
  !! smallest is hardly ever off by 10.
  real(wp), parameter :: clearly = 100.0_wp

  !> Lower triangle of A'A, from the first entry of each row on: row i is entry(start(i)+first(i):start(i)+i).
  type :: profile
    integer, allocatable :: first(:), start(:)
    real(wp), allocatable :: entry(:)
  end type profile

contains

  !> Orthonormal basis of the motions that these pairs do not hold.
  function loose_motions(motion, pairs, tolerance) result(loose)
    type(motion_matrix), intent(in) :: motion   !! A, largest entry of each column one [n, m]
    integer, intent(in) :: pairs(:)       !! each once
    real(wp), intent(in) :: tolerance     !! a singular value up to this is zero
    real(wp), allocatable :: loose(:, :)  !! [m, any]
    real(wp), allocatable :: own(:, :), wider(:, :)
    integer, allocatable :: motions(:), together(:)
    integer, allocatable :: start(:), entry(:)      ! of each pair, the motions that close it
    logical :: met(motion%motions())
    integer :: j, k

    call list_motions(motion, pairs, start, entry)
    allocate (loose(size(met), 0))
    met = .false.
    do j = 1, size(met)
      if (met(j)) cycle
      call meet_all(j)
      if (are_held()) cycle
      motions = pack([(k, k=1, size(met))], [(any(together == k), k=1, size(met))])
      own = null_space(motion%rows(pairs, motions), tolerance)
      allocate (wider(size(met), size(loose, 2) + size(own, 2)), source=0.0_wp)
      wider(:, :size(loose, 2)) = loose
      wider(motions, size(loose, 2) + 1:) = own
      call move_alloc(wider, loose)
    end do

  contains

    !> The motions that hang together with one, in the order in which they are met.
    subroutine meet_all(first)
      integer, intent(in) :: first
      integer :: at, i, k, last
      integer :: queue(size(met))

      queue(1) = first
      met(first) = .true.
      last = 1
      at = 1
      do while (at <= last)
        do i = motion%start(queue(at)), motion%start(queue(at) + 1) - 1
          do k = start(motion%pair(i)), start(motion%pair(i) + 1) - 1
            associate (next => entry(k))
              if (met(next)) cycle
              last = last + 1
              queue(last) = next
              met(next) = .true.
            end associate
          end do
        end do
        at = at + 1
      end do
      together = queue(:last)
    end subroutine meet_all

    !> Are all singular values of these motions clearly above the tolerance?
    logical function are_held() result(held)
      type(profile) :: square
      real(wp) :: least   ! of an eigenvalue of A'A; that has its rounding, too
      integer :: i

      square = new_profile(motion, together, start, entry)
      least = clearly**2*max(tolerance**2, epsilon(1.0_wp) &
                             *maxval([(square%entry(square%start(i) + i), i=1, size(together))]))
      call factor_profile(square, least, held)
      if (held) held = largest_inverse(square)*least < 1.0_wp
    end function are_held
  end function loose_motions

  !> The motions that close each of some pairs; none of the others.
  pure subroutine list_motions(motion, pairs, start, entry)
    type(motion_matrix), intent(in) :: motion
    integer, intent(in) :: pairs(:)
    integer, allocatable, intent(out) :: start(:), entry(:)   !! of pair k: entry(start(k):start(k + 1) - 1)
    integer :: i, j, k, next(motion%pairs)
    logical :: counts(motion%pairs)

    counts = .false.
    counts(pairs) = .true.
    allocate (start(motion%pairs + 1), source=0)
    do i = 1, size(motion%pair)
      if (counts(motion%pair(i))) start(motion%pair(i) + 1) = start(motion%pair(i) + 1) + 1
    end do
    start(1) = 1
    do k = 1, motion%pairs
      start(k + 1) = start(k) + start(k + 1)
    end do
    allocate (entry(start(motion%pairs + 1) - 1))
    next = start(:motion%pairs)
    do j = 1, motion%motions()
      do i = motion%start(j), motion%start(j + 1) - 1
        k = motion%pair(i)
        if (.not. counts(k)) cycle
        entry(next(k)) = j
        next(k) = next(k) + 1
      end do
    end do
  end subroutine list_motions

  !> A'A of some motions, in their order.
  pure type(profile) function new_profile(motion, motions, start, entry) result(square)
    type(motion_matrix), intent(in) :: motion
    integer, intent(in) :: motions(:)   !! that no others hang together with
    integer, intent(in) :: start(:), entry(:)   !! of the pairs that count
    real(wp) :: closing(motion%pairs)   ! of those by one of the motions
    integer :: i, j, k, r

    call outline_profile(motion, motions, start, entry, square)
    allocate (square%entry(square%start(size(motions) + 1)), source=0.0_wp)
    closing = 0.0_wp
    do r = 1, size(motions)
      do i = motion%start(motions(r)), motion%start(motions(r) + 1) - 1
        k = motion%pair(i)
        if (start(k + 1) > start(k)) closing(k) = motion%closing(i)
      end do
      do j = square%first(r), r
        associate (sum => square%entry(square%start(r) + j))
          do i = motion%start(motions(j)), motion%start(motions(j) + 1) - 1
            sum = sum + motion%closing(i)*closing(motion%pair(i))
          end do
        end associate
      end do
      closing(motion%pair(motion%start(motions(r)):motion%start(motions(r) + 1) - 1)) = 0.0_wp
    end do
  end function new_profile

  !> Where the rows of A'A begin.
  pure subroutine outline_profile(motion, motions, start, entry, square)
    type(motion_matrix), intent(in) :: motion
    integer, intent(in) :: motions(:), start(:), entry(:)
    type(profile), intent(out) :: square
    integer :: place(motion%motions())
    integer :: i, j, k, last, r

    place(motions) = [(j, j=1, size(motions))]
    allocate (square%first(size(motions)), square%start(size(motions) + 1))
    last = 0
    do r = 1, size(motions)
      square%first(r) = r
      do i = motion%start(motions(r)), motion%start(motions(r) + 1) - 1
        k = motion%pair(i)
        if (start(k + 1) == start(k)) cycle
        square%first(r) = min(square%first(r), minval(place(entry(start(k):start(k + 1) - 1))))
      end do
      square%start(r) = last + 1 - square%first(r)
      last = square%start(r) + r
    end do
    square%start(size(motions) + 1) = last
  end subroutine outline_profile

  !> Replace A'A by its Cholesky factor; not `sound` if a pivot is not above `least`.
  pure subroutine factor_profile(a, least, sound)
    type(profile), intent(inout) :: a
    real(wp), intent(in) :: least
    logical, intent(out) :: sound
    integer :: from, i, j

    sound = .false.
    do i = 1, size(a%first)
      associate (row => a%start(i))
        do j = a%first(i), i
          from = max(a%first(i), a%first(j))
          a%entry(row + j) = a%entry(row + j) - dot_product( &
            a%entry(row + from:row + j - 1), a%entry(a%start(j) + from:a%start(j) + j - 1))
          if (j < i) a%entry(row + j) = a%entry(row + j)/a%entry(a%start(j) + j)
        end do
        if (.not. a%entry(row + i) > least) return
        a%entry(row + i) = sqrt(a%entry(row + i))
      end associate
    end do
    sound = .true.
  end subroutine factor_profile

  !> Norm of (L L')^-1, estimated from below: right-hand sides of ones whose signs let the solution grow, and
  !! a step of inverse iteration from there.
  pure real(wp) function largest_inverse(l) result(norm)
    type(profile), intent(in) :: l
    real(wp) :: x(size(l%first))
    integer :: i, step

    do step = 1, 2
      do i = 1, size(x)
        associate (row => l%start(i), from => l%first(i))
          norm = -dot_product(l%entry(row + from:row + i - 1), x(from:i - 1))
          if (step == 1) x(i) = sign(1.0_wp, norm)
          x(i) = (x(i) + norm)/l%entry(row + i)
        end associate
      end do
      do i = size(x), 1, -1
        associate (row => l%start(i), from => l%first(i))
          x(i) = x(i)/l%entry(row + i)
          x(from:i - 1) = x(from:i - 1) - x(i)*l%entry(row + from:row + i - 1)
        end associate
      end do
      norm = norm2(x)/merge(sqrt(real(size(x), wp)), 1.0_wp, step == 1)
      x = x/norm2(x)
    end do
  end function largest_inverse
end module epcont_contact_loose_motions
