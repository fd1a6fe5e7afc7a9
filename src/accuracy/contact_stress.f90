!> What the smooth strains say at the pairs: the pressure, and how much the surfaces there give way.
module epcont_accuracy_contact_stress
  use epcont_accuracy_patches, only: patch_table
  use epcont_base_kinds, only: wp
  use epcont_element_kinematics, only: plane_stress
  use epcont_material_material_law, only: point_state
  use epcont_material_scene_materials, only: scene_materials
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: gives_way, smooth_pressures, surface_compliance

  !> Of a side's nodes that share in a gap, those with stresses must have this part.
  real(wp), parameter :: least_weight = 0.5_wp

contains

  !> The normal stress at each pair, as a pressure: the mean of both sides', of which each has errors of its
  !! own; 0 where neither gives way [stress] [pairs].
  pure function smooth_pressures(model, table, materials, smooth) result(pressure)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(scene_materials), intent(in) :: materials
    real(wp), intent(in) :: smooth(:, :)             !! strains [4, places]
    real(wp), allocatable :: pressure(:)
    real(wp) :: side(2), weight(2)
    logical :: seen(2)
    integer :: i, k, n

    allocate (pressure(model%pairs), source=0.0_wp)
    do k = 1, model%pairs
      side = 0.0_wp
      weight = 0.0_wp
      do i = model%row_start(k), model%row_start(k + 1) - 1
        associate (node => model%row_node(i))
          if (.not. gives_way(model, table, node)) cycle
          n = merge(1, 2, i == model%row_start(k))   ! the row's first node is one side, the others share the other
          side(n) = side(n) + model%row_weight(i)* &
                    normal_pressure(model, table, materials, smooth(:, node), node, model%normal(:, k))
          weight(n) = weight(n) + model%row_weight(i)
        end associate
      end do
      seen = abs(weight) > least_weight
      if (any(seen)) pressure(k) = sum(side/merge(weight, 1.0_wp, seen), mask=seen)/count(seen)
    end do
  end function smooth_pressures

  !> Is a node one of elements that can be strained, and not held all over?
  pure logical function gives_way(model, table, node)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: node
    integer :: i

    gives_way = .false.
    if (model%held(1, model%leader(1, node)) .and. model%held(2, model%leader(2, node))) return
    do i = table%around%start(node), table%around%start(node + 1) - 1
      associate (element => table%around%group(i))
        gives_way = gives_way .or. .not. model%is_rigid(model%connectivity(:model%order(element), element))
      end associate
    end do
  end function gives_way

  !> Normal stress of a smooth strain at a node, as a pressure.
  pure real(wp) function normal_pressure(model, table, materials, strain, node, n)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    type(scene_materials), intent(in) :: materials
    real(wp), intent(in) :: strain(4), n(2)
    integer, intent(in) :: node
    type(point_state) :: state
    integer :: section

    ! The first place of a node has its own number, and that of an element around it.
    section = model%section(table%around%group(table%around%start(node)))
    call materials%section(section)%law%update(strain, point_state(), state)
    associate (s => state%stress)
      normal_pressure = -(s(1)*n(1)**2 + s(2)*n(2)**2 + 2.0_wp*s(4)*n(1)*n(2))
    end associate
  end function normal_pressure

  !> 1/E*, of both sides of a pair: (1 - nu**2)/E, 1/E of sheets, 0 of nodes that give way nowhere [1/stress].
  pure real(wp) function surface_compliance(model, table, pair) result(compliance)
    type(model_type), intent(in) :: model
    type(patch_table), intent(in) :: table
    integer, intent(in) :: pair
    integer :: i, section

    compliance = 0.0_wp
    do i = model%row_start(pair), min(model%row_start(pair) + 1, model%row_start(pair + 1) - 1)
      associate (node => model%row_node(i))
        if (.not. gives_way(model, table, node)) cycle
        section = model%section(table%around%group(table%around%start(node)))
        compliance = compliance + (1.0_wp - merge(0.0_wp, model%poisson(section)**2, model%kinematics(section) == plane_stress)) &
                                  /model%young(section)
      end associate
    end do
  end function surface_compliance
end module epcont_accuracy_contact_stress
