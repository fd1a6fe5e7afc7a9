!> Forces at the pairs in contact under unit loads along motions, by levels (`contact/flexibility_matrix`): a
!> load enters on the level of its motion, and is passed on to both sides. What is far away feels resultants
!> only: loads that arrive alike go on as one column, and of many bodies each level has few:
!>
!>     level 1     a     bcd
!>                 |     / \
!>     level 2     a    b   cd
!>                  \   |   | \
!>     level 3       \  |   c   d
!>                     ab
!>
!> What is a sum over pairs or bodies is found for the columns, and added up along the way of each load.
module epcont_accuracy_passed_loads
  use epcont_base_kinds, only: wp
  use epcont_base_sorting, only: sorted_order
  use epcont_base_tolerances, only: least_difference, no_effect
  use epcont_contact_basis, only: contact_basis
  use epcont_linalg_saddle, only: substitute, substitute_back
  implicit none
  private
  public :: passed_loads, dense_loads, pass_on_loads

  !> First the columns that come from the level before, then those that enter, those from the next level, and
  !> loads whose forces were known.
  type :: passed_level
    integer, allocatable :: pair(:)        !! in contact [own]
    !> At these under each column [force]; while that is solved for, motions and the next level's rows follow
    !! [own, columns]
    real(wp), allocatable :: force(:, :)
    integer, allocatable :: next(:)        !! what each column is on the next level; 0: nothing [columns]
    integer, allocatable :: back(:)        !! on the level before; 0: nothing, or it comes from there
    integer, allocatable :: from(:)        !! the level before: -1; 0: it enters; the next level: 1
  end type passed_level

  type :: passed_loads
    integer :: loads = 0                   !! how many
    type(passed_level), allocatable :: level(:)
    integer, allocatable :: first(:)       !! first column of each level, and one behind the last [levels + 1]
    integer, allocatable :: entry(:, :)    !! level and column where each load enters; 0: nowhere [2, loads]
    integer, allocatable :: level_of(:)    !! of each pair in contact; 0: of others [pairs]
    integer, allocatable :: place(:)       !! of these on their level [pairs]
    !> Largest force under a load on its way, the least of all that a column is of; 0: nothing is asked of
    !! them [force] [columns]
    real(wp), allocatable :: unit(:)
    !> Of joined bodies, where all are on one level: under each load [length] [directions, loads, nodes]
    real(wp), allocatable :: displacement(:, :, :)
  contains
    procedure :: way
    procedure :: add_up
    procedure :: weighed
    procedure :: ask_for
    procedure :: find_at
  end type passed_loads

contains

  !> Loads whose forces are known, all on one level.
  pure subroutine dense_loads(force, passed)
    real(wp), intent(in) :: force(:, :)          !! under each [force] [pairs, loads]
    type(passed_loads), intent(out) :: passed    !! the same
    integer :: k

    allocate (passed%level(1))
    associate (level => passed%level(1))
      level%pair = [(k, k=1, size(force, 1))]
      allocate (level%force(size(force, 1), 0), level%next(0), level%back(0), level%from(0))
    end associate
    allocate (passed%entry(2, size(force, 2)))
    call complete(passed, force)
  end subroutine dense_loads

  !> Unit loads along motions, and behind them others whose forces are known.
  subroutine pass_on_loads(basis, motions, motion_size, known, passed)
    type(contact_basis), intent(in) :: basis     !! a sound one
    integer, intent(in) :: motions               !! all: those that are not kept make no forces
    real(wp), intent(in) :: motion_size(:)       !! unit of each that is kept [kept motions]
    real(wp), intent(in) :: known(:, :)          !! forces under the others [force] [pairs, other loads]
    type(passed_loads), intent(out) :: passed    !! all of them
    real(wp) :: least                            ! what is nothing
    integer :: l

    allocate (passed%level(size(basis%level)))
    do l = 1, size(passed%level)
      passed%level(l)%pair = basis%level(l)%pair
    end do
    allocate (passed%entry(2, motions + size(known, 2)), source=0)
    least = least_difference/maxval([motion_size, tiny(1.0_wp)])
    call pass_forward(basis, motion_size, least, passed%level, passed%entry)
    call pass_back(basis, least, passed%level)
    call complete(passed, known)
  end subroutine pass_on_loads

  !> First half of the solutions, from level to level.
  subroutine pass_forward(basis, motion_size, least, level, entry)
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: motion_size(:), least
    type(passed_level), intent(inout) :: level(:)
    integer, intent(inout) :: entry(:, :)
    integer, allocatable :: chosen(:)   ! columns that the level before passes on
    integer :: i, k, l, rows(size(level) + 1)

    rows = [(size(basis%level(l)%pair) + size(basis%level(l)%motion), l=1, size(level)), 0]
    allocate (chosen(0))
    do l = 1, size(level)
      k = size(chosen)
      associate (factor => basis%level(l)%factor, motion => basis%level(l)%motion)
        allocate (level(l)%force(rows(l) + rows(l + 1), k + size(motion)), source=0.0_wp)
        level(l)%from = [spread(-1, 1, k), 0*motion]
        associate (x => level(l)%force, before => max(l - 1, 1))
          if (l > 1) x(:rows(l), :k) = level(before)%force(rows(before) + 1:, chosen)
          do i = 1, size(motion)
            x(size(basis%level(l)%pair) + i, k + i) = -1.0_wp/motion_size(motion(i))
            entry(:, basis%kept(motion(i))) = [l, k + i]
          end do
          call substitute(size(factor, 1), factor, rows(l), rows(l + 1), size(x, 2), size(x, 1), x)
          call join(x(rows(l) + 1:, :), least, level(l)%next, chosen)
        end associate
      end associate
    end do
  end subroutine pass_forward

  !> Of columns those that are alike become one.
  pure subroutine join(x, least, joined, chosen)
    real(wp), intent(in) :: x(:, :)                   !! [rows, columns]
    real(wp), intent(in) :: least                     !! up to which a column is nothing
    integer, allocatable, intent(out) :: joined(:)    !! which of the chosen each is; 0: none [columns]
    integer, allocatable, intent(out) :: chosen(:)    !! columns that are unlike
    real(wp) :: largest(size(x, 2))
    integer :: key(size(x, 2))
    integer :: c, i, k, last

    do c = 1, size(key)   ! those that are alike have like keys
      largest(c) = maxval([abs(x(:, c)), 0.0_wp])
      key(c) = 0
      if (largest(c) > least) key(c) = nint(sum([(x(i, c)/i, i=1, size(x, 1))])/(no_effect*largest(c)))
    end do
    allocate (joined(size(key)), chosen(size(key)), source=0)
    last = 0
    associate (order => sorted_order(key))
      do k = 1, size(order)
        c = order(k)
        if (largest(c) <= least) cycle
        joined(c) = last
        if (last > 0) then
          if (all(abs(x(:, c) - x(:, chosen(last))) <= least_difference*largest(c))) cycle
        end if
        last = last + 1
        joined(c) = last
        chosen(last) = c
      end do
    end associate
    chosen = chosen(:last)
  end subroutine join

  !> Second half, back from the last level.
  subroutine pass_back(basis, least, level)
    type(contact_basis), intent(in) :: basis
    real(wp), intent(in) :: least
    type(passed_level), intent(inout) :: level(:)
    integer, allocatable :: chosen(:), joined(:)
    integer :: c, l, own, pairs, passed

    do l = size(level), 1, -1
      pairs = size(level(l)%pair)
      own = pairs + size(basis%level(l)%motion)
      passed = size(level(l)%next)
      if (l < size(level)) call put_later(own, level(l + 1), level(l))
      associate (factor => basis%level(l)%factor, x => level(l)%force)
        call substitute_back(size(factor, 1), factor, [pairs, own - pairs], size(x, 1) - own, size(x, 2), &
                             size(x, 1), x)
      end associate
      allocate (level(l)%back(count(level(l)%from < 0)), source=0)
      if (l == size(level)) cycle
      call join(level(l)%force(:pairs, passed + 1:), least, joined, chosen)
      level(l)%force = level(l)%force(:, [(c, c=1, passed), passed + chosen])
      level(l)%next = [level(l)%next, 0*chosen]
      level(l)%from = [level(l)%from, 0*chosen + 1]
      level(l + 1)%back = [level(l + 1)%back, merge(passed + joined, 0, joined > 0)]
    end do
    level(1)%back = 0*level(1)%next
  end subroutine pass_back

  !> Put what the next level's rows are below the own ones, and behind the columns that go there all that do
  !! not come from here.
  pure subroutine put_later(own, later, level)
    integer, intent(in) :: own                  !! rows
    type(passed_level), intent(in) :: later     !! the next level, solved
    type(passed_level), intent(inout) :: level
    real(wp), allocatable :: x(:, :)
    integer :: c, came, passed

    passed = size(level%next)
    came = size(later%back)
    associate (below => size(level%force, 1) - own)
      allocate (x(own + below, passed + size(later%next) - came), source=0.0_wp)
      x(:own, :passed) = level%force(:own, :)
      do c = 1, passed
        if (level%next(c) > 0) x(own + 1:, c) = later%force(:below, level%next(c))
      end do
      x(own + 1:, passed + 1:) = later%force(:below, came + 1:)
    end associate
    call move_alloc(x, level%force)
  end subroutine put_later

  !> Put loads whose forces are known behind the others, pairs into order, and number the columns.
  pure subroutine complete(passed, known)
    type(passed_loads), intent(inout) :: passed
    real(wp), intent(in) :: known(:, :)      !! [pairs, other loads]
    integer :: j, k, l, later, others

    others = size(known, 2)
    passed%loads = size(passed%entry, 2)
    passed%entry(1, passed%loads - others + 1:) = 1
    passed%entry(2, passed%loads - others + 1:) = [(size(passed%level(1)%next) + j, j=1, others)]
    allocate (passed%level_of(size(known, 1)), passed%place(size(known, 1)), source=0)
    allocate (passed%first(size(passed%level) + 1))
    passed%first(1) = 1
    do l = 1, size(passed%level)
      later = 0
      if (l < size(passed%level)) later = size(passed%level(l + 1)%next)
      associate (level => passed%level(l), order => sorted_order(passed%level(l)%pair))
        level%pair = level%pair(order)
        level%force = reshape([level%force(order, :), known(level%pair, :)], &
                              [size(order), size(level%next) + others])
        level%next = [level%next, (merge(later + j, 0, l < size(passed%level)), j=1, others)]
        level%back = [level%back, spread(0, 1, others)]
        level%from = [level%from, spread(merge(-1, 0, l > 1), 1, others)]
        passed%level_of(level%pair) = l
        passed%place(level%pair) = [(k, k=1, size(order))]
        passed%first(l + 1) = passed%first(l) + size(level%next)
      end associate
    end do
    allocate (passed%unit(passed%first(size(passed%level) + 1) - 1), source=0.0_wp)
  end subroutine complete

  !> The columns that a load is part of, on all levels that feel it [any].
  pure function way(self, load) result(columns)
    class(passed_loads), intent(in) :: self
    integer, intent(in) :: load   !! which
    integer, allocatable :: columns(:)
    integer :: c, found(size(self%level)), l, n

    n = 0
    l = self%entry(1, load)
    c = self%entry(2, load)
    do while (c > 0)
      n = n + 1
      found(n) = self%first(l) - 1 + c
      c = self%level(l)%next(c)
      l = l + 1
    end do
    l = self%entry(1, load)
    c = self%entry(2, load)
    if (l > 0) c = self%level(l)%back(c)
    do while (c > 0)
      l = l - 1
      n = n + 1
      found(n) = self%first(l) - 1 + c
      c = self%level(l)%back(c)
    end do
    columns = found(:n)
  end function way

  !> Sums for each load: of the parts of all columns on its way [any, loads].
  pure function add_up(self, part) result(total)
    class(passed_loads), intent(in) :: self
    real(wp), intent(in) :: part(:, :)   !! of each column [any, columns]
    real(wp) :: total(size(part, 1), self%loads)
    integer :: j, k

    total = 0.0_wp
    do j = 1, self%loads
      associate (columns => self%way(j))
        do k = 1, size(columns)
          total(:, j) = total(:, j) + part(:, columns(k))
        end do
      end associate
    end do
  end function add_up

  !> Sums of forces, each times a weight of its pair, under each load; of magnitudes of forces, if wanted
  !! [loads].
  pure function weighed(self, weight, magnitudes) result(total)
    class(passed_loads), intent(in) :: self
    real(wp), intent(in) :: weight(:)               !! [pairs]
    logical, intent(in), optional :: magnitudes
    real(wp) :: total(self%loads), part(1, size(self%unit))
    integer :: c, l
    logical :: absolute

    absolute = .false.
    if (present(magnitudes)) absolute = magnitudes
    do l = 1, size(self%level)
      associate (level => self%level(l))
        do c = 1, size(level%next)
          part(1, self%first(l) - 1 + c) = &
            dot_product(weight(level%pair), merge(abs(level%force(:, c)), level%force(:, c), absolute))
        end do
      end associate
    end do
    total = reshape(self%add_up(part), [self%loads])
  end function weighed

  !> Say which loads are asked for, by the unit of their columns.
  pure subroutine ask_for(self, asked)
    class(passed_loads), intent(inout) :: self
    logical, intent(in) :: asked(:)   !! [loads]
    real(wp) :: largest(size(self%unit))
    real(wp) :: most   ! under a load
    integer :: c, j, k, l

    do l = 1, size(self%level)
      do c = 1, size(self%level(l)%next)
        largest(self%first(l) - 1 + c) = maxval([abs(self%level(l)%force(:, c)), 0.0_wp])
      end do
    end do
    self%unit = 0.0_wp
    do j = 1, self%loads
      if (.not. asked(j)) cycle
      associate (columns => self%way(j))
        most = maxval([largest(columns), 0.0_wp])
        do k = 1, size(columns)
          associate (unit => self%unit(columns(k)))
            unit = min(merge(unit, most, unit > 0.0_wp), most)
          end associate
        end do
      end associate
    end do
  end subroutine ask_for

  !> What arrives at pairs of one body, which are on one level, or on two that follow each other.
  subroutine find_at(self, pair, column, force)
    class(passed_loads), intent(in) :: self
    integer, intent(in) :: pair(:)                       !! in contact
    integer, allocatable, intent(out) :: column(:)       !! those that are asked for and felt there [any]
    real(wp), allocatable, intent(out) :: force(:, :)    !! under each [force] [columns, pairs]
    real(wp), allocatable :: found(:, :)
    integer :: c, l, last, n

    l = minval([self%level_of(pair), size(self%level)])
    last = maxval([self%level_of(pair), l])
    associate (columns => self%first(last + 1) - self%first(l))
      allocate (column(columns), found(size(pair), columns))
    end associate
    n = 0
    do c = 1, size(self%level(l)%next)
      if (last > l .and. self%level(l)%from(c) > 0) cycle   ! the next level has it
      call look_at(self%first(l) - 1 + c, c, self%level(l)%next(c))
    end do
    if (last > l) then
      do c = 1, size(self%level(last)%next)
        if (self%level(last)%from(c) < 0) cycle
        call look_at(self%first(last) - 1 + c, self%level(last)%back(c), c)
      end do
    end if
    column = column(:n)
    force = transpose(found(:, :n))

  contains

    !> Take a column, if there is anything in it.
    subroutine look_at(number, own, later)
      integer, intent(in) :: number, own, later   !! in all, on each of the levels; 0: not there
      integer :: k

      if (self%unit(number) <= 0.0_wp) return
      found(:, n + 1) = 0.0_wp
      do k = 1, size(pair)
        if (self%level_of(pair(k)) == l .and. own > 0) then
          found(k, n + 1) = self%level(l)%force(self%place(pair(k)), own)
        else if (self%level_of(pair(k)) > l .and. later > 0) then
          found(k, n + 1) = self%level(last)%force(self%place(pair(k)), later)
        end if
      end do
      if (all(found(:, n + 1) == 0.0_wp)) return
      n = n + 1
      column(n) = number
    end subroutine look_at
  end subroutine find_at
end module epcont_accuracy_passed_loads
