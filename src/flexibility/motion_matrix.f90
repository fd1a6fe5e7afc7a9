!> Matrix A of gap closures by unit rigid-body displacements, stored by columns without zeros: a mode moves
!> one body, and each of many bodies has few pairs.
module epcont_flexibility_motion_matrix
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: motion_matrix, dense_motions, new_motion_matrix

  !> Smallest closure of a mode divided by its largest displacement, for scaling. If two modes close the same
  !! gaps, the one along the flat surface is treated as closing no gap.
  real(wp), parameter :: least_lever = 1.0e-4_wp

  !> Mode j closes the gaps of the pairs pair(start(j):start(j+1)-1).
  type :: motion_matrix
    integer :: pairs = 0                    !! number of pairs of the problem
    integer, allocatable :: start(:)        !! [modes + 1]
    integer, allocatable :: pair(:)         !! ascending in each mode [entries]
    real(wp), allocatable :: closing(:)     !! [entries]
    !> Largest displacement of the nodes of its pairs in each mode; not allocated if unknown [modes]
    real(wp), allocatable :: travel(:)
  contains
    procedure :: motions
    procedure :: sizes
    procedure :: units
    procedure :: over
    procedure :: times
    procedure :: of_each
    procedure :: carried
    procedure :: rows
    procedure :: dense
    procedure :: only
    procedure :: turned
    procedure :: drop
  end type motion_matrix

contains

  !> Make A from its entries; zeros are left out.
  pure type(motion_matrix) function new_motion_matrix(pairs, motions, pair, motion, closing) result(new)
    integer, intent(in) :: pairs, motions           !! rows and columns
    integer, intent(in) :: pair(:), motion(:)       !! row and column of each entry; rows ascend [entries]
    real(wp), intent(in) :: closing(:)              !! each entry once [entries]
    type(incidence) :: entries   ! entries of each mode

    new%pairs = pairs
    entries = new_incidence(reshape(merge(motion, 0, closing /= 0.0_wp), [1, size(motion)]), motions)
    new%start = entries%start
    new%pair = pair(entries%group)
    new%closing = closing(entries%group)
  end function new_motion_matrix

  !> Make A from a matrix with all its zeros.
  pure type(motion_matrix) function dense_motions(matrix) result(new)
    real(wp), intent(in) :: matrix(:, :)   !! A [pairs, modes]
    integer :: j, k

    associate (n => size(matrix, 1), m => size(matrix, 2))
      new = new_motion_matrix(n, m, [((k, j=1, m), k=1, n)], [((j, j=1, m), k=1, n)], &
                              pack(transpose(matrix), .true.))
    end associate
  end function dense_motions

  !> Number of modes.
  pure integer function motions(self)
    class(motion_matrix), intent(in) :: self

    motions = size(self%start) - 1
  end function motions

  !> Magnitude of the largest entry of each mode, but at least `least_lever` times its largest displacement; 0
  !! if the mode closes no gap [modes].
  pure function sizes(self)
    class(motion_matrix), intent(in) :: self
    real(wp) :: sizes(size(self%start) - 1)
    integer :: j

    sizes = [(maxval([abs(self%closing(self%start(j):self%start(j + 1) - 1)), 0.0_wp]), j=1, size(sizes))]
    if (.not. allocated(self%travel)) return
    where (sizes > 0.0_wp) sizes = max(sizes, least_lever*self%travel)
  end function sizes

  !> Units of the modes: `sizes`, or 1 for a mode that closes no gap [modes].
  pure function units(self)
    class(motion_matrix), intent(in) :: self
    real(wp) :: units(size(self%start) - 1)

    units = self%sizes()
    where (units <= 0.0_wp) units = 1.0_wp
  end function units

  !> Divide each column by its unit.
  pure type(motion_matrix) function over(self, unit) result(new)
    class(motion_matrix), intent(in) :: self
    real(wp), intent(in) :: unit(:)        !! unit of each column [modes]
    integer :: j

    new%pairs = self%pairs
    new%start = self%start
    new%pair = self%pair
    new%closing = self%closing
    do j = 1, size(unit)
      associate (own => new%closing(new%start(j):new%start(j + 1) - 1))
        own = own/unit(j)
      end associate
    end do
  end function over

  !> A q, the gap closures by rigid-body displacements; or |A| |q|, the sums of the magnitudes of their terms.
  pure function times(self, approach, magnitudes) result(closing)
    class(motion_matrix), intent(in) :: self
    real(wp), intent(in) :: approach(:)    !! q [modes]
    logical, intent(in), optional :: magnitudes   !! true: of the entries of A and q
    real(wp) :: closing(self%pairs)
    real(wp) :: by
    integer :: i, j
    logical :: absolute

    absolute = .false.
    if (present(magnitudes)) absolute = magnitudes
    closing = 0.0_wp
    do j = 1, size(approach)
      by = approach(j)
      if (absolute) by = abs(by)
      if (by == 0.0_wp) cycle
      do i = self%start(j), self%start(j + 1) - 1
        if (absolute) then
          closing(self%pair(i)) = closing(self%pair(i)) + by*abs(self%closing(i))
        else
          closing(self%pair(i)) = closing(self%pair(i)) + by*self%closing(i)
        end if
      end do
    end do
  end function times

  !> A Q, the closures of some gaps by several rigid-body displacements [pairs, any].
  pure function of_each(self, approach, pairs) result(closing)
    class(motion_matrix), intent(in) :: self
    real(wp), intent(in) :: approach(:, :)   !! Q [modes, any]
    integer, intent(in) :: pairs(:)
    real(wp), allocatable :: closing(:, :)
    real(wp) :: all_pairs(self%pairs)
    integer :: k

    allocate (closing(size(pairs), size(approach, 2)))
    do k = 1, size(approach, 2)
      all_pairs = self%times(approach(:, k))
      closing(:, k) = all_pairs(pairs)
    end do
  end function of_each

  !> A'R, the loads that contact forces balance along each mode [modes].
  pure function carried(self, force) result(load)
    class(motion_matrix), intent(in) :: self
    real(wp), intent(in) :: force(:)   !! R [pairs]
    real(wp) :: load(size(self%start) - 1)
    integer :: i, j

    do j = 1, size(load)
      load(j) = 0.0_wp
      do i = self%start(j), self%start(j + 1) - 1
        load(j) = load(j) + self%closing(i)*force(self%pair(i))
      end do
    end do
  end function carried

  !> Closures of some gaps by all modes or some, with zeros [pairs, modes].
  pure function rows(self, pairs, motions) result(closing)
    class(motion_matrix), intent(in) :: self
    integer, intent(in) :: pairs(:)              !! each once
    integer, intent(in), optional :: motions(:)
    real(wp), allocatable :: closing(:, :)
    integer, allocatable :: chosen(:)
    integer :: i, j, k
    integer :: row(self%pairs)   ! row of each pair; 0 if it is not requested

    if (present(motions)) then
      chosen = motions
    else
      chosen = [(j, j=1, size(self%start) - 1)]
    end if
    row = 0
    row(pairs) = [(k, k=1, size(pairs))]
    allocate (closing(size(pairs), size(chosen)), source=0.0_wp)
    do j = 1, size(chosen)
      do i = self%start(chosen(j)), self%start(chosen(j) + 1) - 1
        if (row(self%pair(i)) > 0) closing(row(self%pair(i)), j) = self%closing(i)
      end do
    end do
  end function rows

  !> The matrix with its zeros [pairs, modes].
  pure function dense(self)
    class(motion_matrix), intent(in) :: self
    real(wp), allocatable :: dense(:, :)
    integer :: k

    dense = self%rows([(k, k=1, self%pairs)])
  end function dense

  !> A', the modes that close each pair, ascending: pairs and modes are exchanged.
  pure type(motion_matrix) function turned(self)
    class(motion_matrix), intent(in) :: self
    integer :: i, j

    turned = new_motion_matrix(self%motions(), self%pairs, &
                               [((j, i=self%start(j), self%start(j + 1) - 1), j=1, self%motions())], &
                               self%pair, self%closing)
  end function turned

  !> Drop closures of at most this part of the mode's largest displacement.
  pure subroutine drop(self, part)
    class(motion_matrix), intent(inout) :: self   !! with known largest displacements
    real(wp), intent(in) :: part
    integer :: i, j, last, start

    last = 0
    start = 1
    do j = 1, self%motions()
      do i = start, self%start(j + 1) - 1
        if (abs(self%closing(i)) <= part*self%travel(j)) cycle
        last = last + 1
        self%pair(last) = self%pair(i)
        self%closing(last) = self%closing(i)
      end do
      start = self%start(j + 1)
      self%start(j + 1) = last + 1
    end do
    self%pair = self%pair(:last)
    self%closing = self%closing(:last)
  end subroutine drop

  !> The columns of some modes.
  pure type(motion_matrix) function only(self, kept) result(fewer)
    class(motion_matrix), intent(in) :: self
    integer, intent(in) :: kept(:)   !! motions
    integer, allocatable :: entry(:)
    integer :: i, j, last

    fewer%pairs = self%pairs
    allocate (fewer%start(size(kept) + 1), entry(size(self%pair)))
    last = 0
    fewer%start(1) = 1
    do j = 1, size(kept)
      do i = self%start(kept(j)), self%start(kept(j) + 1) - 1
        last = last + 1
        entry(last) = i
      end do
      fewer%start(j + 1) = last + 1
    end do
    fewer%pair = self%pair(entry(:last))
    fewer%closing = self%closing(entry(:last))
  end function only
end module epcont_flexibility_motion_matrix
