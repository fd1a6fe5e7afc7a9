!> A, the closing of the gaps by unit rigid motions, column by column without zeros: a motion moves one body,
!> and of many bodies each has few pairs.
module epcont_flexibility_motion_matrix
  use epcont_base_incidence, only: incidence, new_incidence
  use epcont_base_kinds, only: wp
  implicit none
  private
  public :: motion_matrix, dense_motions, new_motion_matrix

  !> A motion closes gaps by this part of how far it takes the body, or it is measured as if it did: of two
  !! that close the same gaps that along the flat is the one which is none.
  real(wp), parameter :: least_lever = 1.0e-4_wp

  !> Motion j closes the gaps of the pairs pair(start(j):start(j+1)-1).
  type :: motion_matrix
    integer :: pairs = 0                    !! of the problem
    integer, allocatable :: start(:)        !! [motions + 1]
    integer, allocatable :: pair(:)         !! ascending in each motion [entries]
    real(wp), allocatable :: closing(:)     !! [entries]
    !> How far each takes nodes of its pairs, at most; not allocated: not known [motions]
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

  !> A from its entries; those that are zero are left out.
  pure type(motion_matrix) function new_motion_matrix(pairs, motions, pair, motion, closing) result(new)
    integer, intent(in) :: pairs, motions           !! rows and columns
    integer, intent(in) :: pair(:), motion(:)       !! row and column of each entry; rows ascend [entries]
    real(wp), intent(in) :: closing(:)              !! each once [entries]
    type(incidence) :: entries   ! of each motion

    new%pairs = pairs
    entries = new_incidence(reshape(merge(motion, 0, closing /= 0.0_wp), [1, size(motion)]), motions)
    new%start = entries%start
    new%pair = pair(entries%group)
    new%closing = closing(entries%group)
  end function new_motion_matrix

  !> The same from a matrix with all of its zeros.
  pure type(motion_matrix) function dense_motions(matrix) result(new)
    real(wp), intent(in) :: matrix(:, :)   !! A [pairs, motions]
    integer :: j, k

    associate (n => size(matrix, 1), m => size(matrix, 2))
      new = new_motion_matrix(n, m, [((k, j=1, m), k=1, n)], [((j, j=1, m), k=1, n)], &
                              pack(transpose(matrix), .true.))
    end associate
  end function dense_motions

  !> How many there are.
  pure integer function motions(self)
    class(motion_matrix), intent(in) :: self

    motions = size(self%start) - 1
  end function motions

  !> Largest entry of each motion, without its sign, or its least lever, where that is more; 0 of none
  !! [motions].
  pure function sizes(self)
    class(motion_matrix), intent(in) :: self
    real(wp) :: sizes(size(self%start) - 1)
    integer :: j

    sizes = [(maxval([abs(self%closing(self%start(j):self%start(j + 1) - 1)), 0.0_wp]), j=1, size(sizes))]
    if (.not. allocated(self%travel)) return
    where (sizes > 0.0_wp) sizes = max(sizes, least_lever*self%travel)
  end function sizes

  !> The same, and one for a motion that closes no gap [motions].
  pure function units(self)
    class(motion_matrix), intent(in) :: self
    real(wp) :: units(size(self%start) - 1)

    units = self%sizes()
    where (units <= 0.0_wp) units = 1.0_wp
  end function units

  !> The same in units of each motion.
  pure type(motion_matrix) function over(self, unit) result(new)
    class(motion_matrix), intent(in) :: self
    real(wp), intent(in) :: unit(:)        !! that each column is measured in [motions]
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

  !> A q, the closing of the gaps by motions; or |A| |q|, what it is the sum of.
  pure function times(self, approach, magnitudes) result(closing)
    class(motion_matrix), intent(in) :: self
    real(wp), intent(in) :: approach(:)    !! q [motions]
    logical, intent(in), optional :: magnitudes   !! true: of A and q
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

  !> A Q, the closing of some pairs' gaps by each of several motions [pairs, any].
  pure function of_each(self, approach, pairs) result(closing)
    class(motion_matrix), intent(in) :: self
    real(wp), intent(in) :: approach(:, :)   !! Q [motions, any]
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

  !> A'R, what forces carry along each motion [motions].
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

  !> Closing of some pairs' gaps, zeros and all, by all motions or some [pairs, motions].
  pure function rows(self, pairs, motions) result(closing)
    class(motion_matrix), intent(in) :: self
    integer, intent(in) :: pairs(:)              !! each once
    integer, intent(in), optional :: motions(:)
    real(wp), allocatable :: closing(:, :)
    integer, allocatable :: chosen(:)
    integer :: i, j, k
    integer :: row(self%pairs)   ! of each pair; 0: none

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

  !> All of it [pairs, motions].
  pure function dense(self)
    class(motion_matrix), intent(in) :: self
    real(wp), allocatable :: dense(:, :)
    integer :: k

    dense = self%rows([(k, k=1, self%pairs)])
  end function dense

  !> A', the motions that close each pair, ascending: pairs and motions have changed places.
  pure type(motion_matrix) function turned(self)
    class(motion_matrix), intent(in) :: self
    integer :: i, j

    turned = new_motion_matrix(self%motions(), self%pairs, &
                               [((j, i=self%start(j), self%start(j + 1) - 1), j=1, self%motions())], &
                               self%pair, self%closing)
  end function turned

  !> Drop what closes a gap by up to a part of the motion's travel.
  pure subroutine drop(self, part)
    class(motion_matrix), intent(inout) :: self   !! of known travels
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

  !> With some of the motions only.
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
