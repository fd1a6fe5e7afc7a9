!> List of the values of a run, which grows.
module epcont_report_figure_list
  use epcont_base_kinds, only: wp
  use epcont_messages_names, only: percent, when
  use epcont_messages_outcome, only: reason_of
  use epcont_report_columns, only: estimate, full_number, known, listed_number, number, rounding
  implicit none
  private
  public :: figure_list, figure_type

  integer, parameter :: room_at_first = 64   !! number of values

  type :: figure_type
    character(len=40) :: key = ''      !! in the file
    character(len=26) :: value = ''
    character(len=13) :: unit = ''
    character(len=44) :: name = ''     !! in the listing; empty if it is not listed
    character(len=64) :: listed = ''   !! its value there
    character(len=80) :: note = ''     !! text after the value
  end type figure_type

  !> Values, in order.
  type :: figure_list
    type(figure_type), allocatable :: figure(:)   !! with free space
    integer :: count = 0
  contains
    procedure :: put, put_relative, list_as, put_word, put_error
    procedure, private :: append
  end type figure_list

contains

  !> Add a number; its kind defines its digits in the listing.
  subroutine put(self, key, unit, kind, value, name, note)
    class(figure_list), intent(inout) :: self
    character(len=*), intent(in) :: key, unit
    integer, intent(in) :: kind
    real(wp), intent(in) :: value
    character(len=*), intent(in), optional :: name, note   !! in the listing
    type(figure_type) :: figure

    figure = figure_type(key, full_number(kind, value), unit)
    if (present(name)) figure%name = name
    if (present(note)) figure%note = note
    figure%listed = listed_number(kind, value, 0.0_wp)
    call self%append(figure)
  end subroutine put

  !> Add a number that the listing has relative to another one.
  subroutine put_relative(self, key, unit, value, name, relative)
    class(figure_list), intent(inout) :: self
    character(len=*), intent(in) :: key, unit
    real(wp), intent(in) :: value
    character(len=*), intent(in) :: name   !! in the listing
    real(wp), intent(in) :: relative       !! its value there, which may be rounding

    call self%put(key, unit, number, value, name)
    call self%list_as(listed_number(rounding, relative, 0.0_wp))
  end subroutine put_relative

  !> Replace the text of the last number in the listing.
  subroutine list_as(self, listed)
    class(figure_list), intent(inout) :: self
    character(len=*), intent(in) :: listed

    self%figure(self%count)%listed = listed
  end subroutine list_as

  !> Add a word.
  subroutine put_word(self, key, word, name)
    class(figure_list), intent(inout) :: self
    character(len=*), intent(in) :: key, word
    character(len=*), intent(in) :: name   !! in the listing; empty if it is not listed

    call self%append(figure_type(key, word, '', name, word))
  end subroutine put_word

  !> Append a value. Space doubles, since many bodies have many values.
  subroutine append(self, figure)
    class(figure_list), intent(inout) :: self
    type(figure_type), intent(in) :: figure
    type(figure_type), allocatable :: more(:)

    if (.not. allocated(self%figure)) allocate (self%figure(room_at_first))
    if (self%count == size(self%figure)) then
      allocate (more(2*self%count))
      more(:self%count) = self%figure
      call move_alloc(more, self%figure)
    end if
    self%count = self%count + 1
    self%figure(self%count) = figure
  end subroutine append

  !> Add an error by the mesh or the increments; the listing shows it if it is known, otherwise the reason.
  subroutine put_error(self, key, unit, name, error, value, limit)
    class(figure_list), intent(inout) :: self
    character(len=*), intent(in) :: key, unit, name
    real(wp), intent(in) :: error, value
    character(len=*), intent(in) :: limit             !! of the value: `bounded`, `singular` ...
    character(len=:), allocatable :: reason

    reason = reason_of(limit)
    call self%put(key, unit, known, error, when(reason /= '' .or. error >= 0.0_wp, name), &
                  when(reason == '', '   '//percent(error, value)))
    call self%list_as(when(reason == '', listed_number(estimate, error, value), reason))
  end subroutine put_error
end module epcont_report_figure_list
