!> Contact problems of many bodies: each gives way at its own pairs, and closes these where it moves.
module many_bodies
  use epcont_base_kinds, only: wp
  use epcont_contact_flexibility_matrix, only: new_flexibility
  use epcont_contact_problem, only: contact_problem
  use epcont_flexibility_motion_matrix, only: dense_motions
  use random_problem, only: generator
  implicit none
  private
  public :: bodies_of, scene_of, shapes, stack_of

  !> A row of bodies; one that ends where it begins; rows upon each other; two rows that have nothing to do with each other.
  character(6), parameter :: shapes(4) = [character(6) :: 'row', 'ring', 'pile', 'apart']

contains

  !> Bodies of each pair: `each` pairs between those that touch; 0: the ground.
  function bodies_of(shape, bodies, each) result(body)
    character(*), intent(in) :: shape
    integer, intent(in) :: bodies, each
    integer, allocatable :: body(:, :)
    integer, allocatable :: one(:), other(:)
    integer :: b, wide

    one = [integer ::]
    other = [integer ::]
    wide = max(1, nint(sqrt(real(bodies))))
    do b = 1, bodies
      select case (shape)
      case ('pile')   ! upon the one below and beside the one before
        one = [one, b, b]
        other = [other, max(b - wide, 0), merge(0, b - 1, mod(b, wide) == 1 .or. wide == 1)]
      case ('apart')
        one = [one, b]
        other = [other, merge(0, b - 1, b == 1 .or. b == bodies/2)]
      case default
        one = [one, b]
        other = [other, b - 1]
      end select
    end do
    if (shape == 'ring') other(1) = bodies
    body = reshape([spread(one, 1, each), spread(other, 1, each)], [each*size(one), 2])
    body = transpose(body)
  end function bodies_of

  !> Pairs between bodies of random flexibility, each free along one motion; some bodies rigid, and some pairs twice there.
  !> Some R >= 0 carries the load.
  function scene_of(random, body, bodies, awkward) result(problem)
    type(generator), intent(inout) :: random
    integer, intent(in) :: body(:, :), bodies
    logical, intent(in) :: awkward   !! with rigid bodies and pairs that depend on each other
    type(contact_problem) :: problem
    real(wp), allocatable :: force(:), motion(:, :), root(:, :)
    integer, allocatable :: own(:)
    integer :: b, i, k, n

    n = size(body, 2)
    problem%flexibility = new_flexibility(body, bodies)
    allocate (motion(n, bodies), problem%load_gap(n), source=0.0_wp)
    do b = 1, bodies
      own = pack([(k, k=1, n)], [(any(body(:, k) == b), k=1, n)])
      do i = 1, size(own)
        motion(own(i), b) = merge(1.0_wp, -1.0_wp, body(1, own(i)) == b)*(0.5_wp + random%uniform())
      end do
      if (awkward .and. random%chance(0.2_wp)) cycle
      allocate (root(size(own), size(own)))
      do k = 1, size(own)
        root(:, k) = [(2*random%uniform() - 1, i=1, size(own))]
        if (awkward .and. k > 1 .and. random%chance(0.05_wp)) root(:, k) = root(:, k - 1)
      end do
      call problem%flexibility%add(own, matmul(transpose(root), root))
      deallocate (root)
    end do
    call problem%flexibility%complete()
    problem%initial_gap = [(merge(0.0_wp, 0.3_wp*random%uniform(), random%chance(0.5_wp)), k=1, n)]
    force = [(random%uniform(), k=1, n)]
    problem%motion = dense_motions(motion)
    problem%resultant = problem%motion%carried(force)
  end function scene_of

  !> The same of bodies that shift and turn, each as soft near a force as it is, some a million times stiffer than others.
  function stack_of(random, body, bodies) result(problem)
    type(generator), intent(inout) :: random
    integer, intent(in) :: body(:, :), bodies
    type(contact_problem) :: problem
    real(wp) :: motion(size(body, 2), 2*bodies), place(size(body, 2)), softness
    real(wp), allocatable :: near(:, :)
    integer, allocatable :: own(:)
    integer :: b, i, k, n

    n = size(body, 2)
    problem%flexibility = new_flexibility(body, bodies)
    place = [(2*random%uniform() - 1, k=1, n)]
    motion = 0.0_wp
    do b = 1, bodies
      own = pack([(k, k=1, n)], [(any(body(:, k) == b), k=1, n)])
      motion(own, 2*b - 1) = merge(1.0_wp, -1.0_wp, body(1, own) == b)
      motion(own, 2*b) = place(own)*motion(own, 2*b - 1)
      softness = 10.0_wp**(6*random%uniform() - 3)
      allocate (near(size(own), size(own)), source=0.0_wp)
      do k = 1, size(own)
        do i = 1, size(own)
          if (all(body(:, own(i)) == body(:, own(k)))) &
            near(i, k) = softness*exp(-4*(place(own(i)) - place(own(k)))**2)
        end do
        near(k, k) = 1.01_wp*near(k, k)
      end do
      call problem%flexibility%add(own, near)
      deallocate (near)
    end do
    call problem%flexibility%complete()
    problem%initial_gap = [(merge(0.0_wp, 0.3_wp*random%uniform(), random%chance(0.5_wp)), k=1, n)]
    allocate (problem%load_gap(n), source=0.0_wp)
    problem%motion = dense_motions(motion)
  end function stack_of
end module many_bodies
