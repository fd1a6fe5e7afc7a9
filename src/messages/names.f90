!> Names of parts of a model: ids and coordinates.
module epcont_messages_names
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: formatted, short_real, text_of
  use epcont_element_kinematics, only: directions
  use epcont_model_arrays, only: angle
  use epcont_model_finding, only: of_node
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_plan_planned_model, only: planned_model
  implicit none
  private
  public :: centre_name, direction_of, first_grid, joined, motion_name, percent, point_name, when

contains

  !> `GRID 12`: the smallest id of some nodes. It names a body.
  pure function first_grid(model, chosen) result(name)
    type(model_type), intent(in) :: model
    logical, intent(in) :: chosen(:)        !! these nodes [nodes]
    character(len=:), allocatable :: name

    name = 'GRID '//text_of(minval(model%mesh%node_id, mask=chosen))
  end function first_grid

  !> `GRID 12 direction 2`: the SUPORT DOF that measures a rigid-body mode.
  pure function motion_name(scene, k) result(name)
    class(planned_model), intent(in) :: scene   !! model with its rigid-body modes
    integer, intent(in) :: k                    !! number of the mode
    character(len=:), allocatable :: name

    name = scene%model%name_of(of_node, scene%motions%node(k))//' direction '// &
           direction_of(scene%motions, k)
  end function motion_name

  !> `2`: direction of a SUPORT DOF; 6 for the master node of a rotating RBE2.
  pure function direction_of(motions, k) result(digit)
    type(free_motions), intent(in) :: motions
    integer, intent(in) :: k                    !! number of the mode
    character(len=1) :: digit

    digit = text_of(merge(6, motions%component(k), motions%component(k) == angle))
  end function direction_of

  !> `1.000 2.500`.
  pure function point_name(x) result(name)
    real(wp), intent(in) :: x(directions)              !! [length]
    character(len=:), allocatable :: name

    name = short_real(x(1))//' '//short_real(x(2))
  end function point_name

  !> `point_name` of the mean of an element's nodes.
  pure function centre_name(model, element) result(name)
    type(model_type), intent(in) :: model
    integer, intent(in) :: element          !! its number
    character(len=:), allocatable :: name

    name = point_name(sum(model%mesh%coordinates(element), dim=2)/model%mesh%node_count(element))
  end function centre_name

  !> `1, 2, 3, and 4 more`: numbers; those after the first `most` are only counted.
  pure function joined(numbers, separator, most) result(text)
    integer, intent(in) :: numbers(:)           !! at least one
    character(len=*), intent(in) :: separator   !! between two of them
    integer, intent(in), optional :: most       !! largest number of names; all if absent
    character(len=:), allocatable :: text
    integer :: k, named

    named = size(numbers)
    if (present(most)) named = min(named, most)
    text = text_of(numbers(1))
    do k = 2, named
      text = text//separator//text_of(numbers(k))
    end do
    if (size(numbers) > named) text = text//separator//'and '//text_of(size(numbers) - named)//' more'
  end function joined

  !> Choose one of two texts, which may differ in length.
  pure function when(holds, text, otherwise) result(chosen)
    logical, intent(in) :: holds                          !! a condition
    character(len=*), intent(in) :: text                  !! if true
    character(len=*), intent(in), optional :: otherwise   !! if false; empty if absent
    character(len=:), allocatable :: chosen

    chosen = ''
    if (holds) then
      chosen = text
    else if (present(otherwise)) then
      chosen = otherwise
    end if
  end function when

  !> A part in per cent with two digits; empty if it is 100 times the whole or more.
  pure function percent(value, of) result(text)
    real(wp), intent(in) :: value   !! the part
    real(wp), intent(in) :: of      !! the whole
    character(len=:), allocatable :: text
    real(wp) :: hundredths

    text = ''
    if (of <= 0.0_wp .or. value >= 100.0_wp*of) return
    hundredths = 100.0_wp*value/of
    text = '< 0.001'
    if (hundredths >= 0.00095_wp) &
      text = formatted('(f12.'//text_of(max(0, 1 - floor(log10(1.05_wp*hundredths))))//')', hundredths)
    if (text(len(text):) == '.') text = text(:len(text) - 1)
    text = text//' %'
  end function percent
end module epcont_messages_names
