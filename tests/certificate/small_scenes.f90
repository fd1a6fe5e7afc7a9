!> Models of a few elements, written in a line, and the findings of the certificate after one of the bodies is
!> moved.
module small_scenes
  use epcont_base_kinds, only: wp
  use epcont_certificate_allowance, only: allowance_type
  use epcont_certificate_meeting, only: new_search, search_type
  use epcont_certificate_scene, only: look_through, overlaps_type
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: allowance_of, moved, seen

  character(len=*), parameter, public :: section = 'PARAM,PLANE,STRAIN|PSHELL,1,1,1.0|MAT1,1,1.0+5,,0.3|SPC1,1,12,1,2|'
  !> A unit square, and a narrower one that stands on it.
  character(len=*), parameter, public :: lower = section // &
    'GRID,1,,0.0,0.0|GRID,2,,1.0,0.0|GRID,3,,1.0,1.0|GRID,4,,0.0,1.0|CQUAD4,1,1,1,2,3,4|'
  character(len=*), parameter, public :: upper = &
    'GRID,5,,0.2,1.0|GRID,6,,0.8,1.0|GRID,7,,0.8,2.0|GRID,8,,0.2,2.0|CQUAD4,2,1,5,6,7,8|SPC1,1,12,7,8|'
  !> A square of the lower one's size on top of it, and CGAPs between the two.
  character(len=*), parameter, public :: same = &
    'GRID,5,,0.0,1.0|GRID,6,,1.0,1.0|GRID,7,,1.0,2.0|GRID,8,,0.0,2.0|CQUAD4,2,1,5,6,7,8|SPC1,1,12,7,8|'
  character(len=*), parameter, public :: up = 'CORD2R,1,,0.0,0.0,0.0,0.0,0.0,1.0,+|+,0.0,1.0,0.0|'
  character(len=*), parameter, public :: gaps = 'CGAP,21,1,4,5,,,,1|CGAP,22,1,3,6,,,,1|PGAP,1,0.0|'//up

contains

  !> The model with nodes 5 to 8 moved together, every pair in contact.
  function moved(model, by, last) result(scene)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: by(2)
    integer, intent(in), optional :: last   !! the last of those nodes, if not 8
    type(overlaps_type) :: scene
    real(wp) :: u(2, model%mesh%nodes)
    integer :: highest, i

    highest = 8
    if (present(last)) highest = last
    u = 0.0_wp
    do i = 1, model%mesh%nodes
      if (model%mesh%node_id(i) >= 5 .and. model%mesh%node_id(i) <= highest) u(:, i) = by
    end do
    scene = look_through(model, u, spread(1.0_wp, 1, model%contact%pairs))
  end function moved

  !> The displaced model without contact.
  function seen(model, u) result(scene)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: u(:, :)   !! displacements
    type(overlaps_type) :: scene

    scene = look_through(model, u, [real(wp) ::])
  end function seen

  !> Allowed penetration of the edges of a model.
  function allowance_of(model, u) result(allowance)
    type(model_type), intent(in) :: model
    real(wp), intent(in) :: u(:, :)   !! displacements
    type(allowance_type) :: allowance
    type(search_type) :: search

    search = new_search(model, u)
    allowance = search%allowance
  end function allowance_of
end module small_scenes
