!> Parts of a model that two load histories must share if one continues the other.
module epcont_model_marks
  use epcont_base_archive, only: checksum
  use epcont_base_kinds, only: wp
  use epcont_model_arrays, only: body_load
  use epcont_model_model, only: model_type
  implicit none
  private
  public :: marks_of

  !> Their names on cards.
  character(len=*), parameter, public :: part_name(5) = [character(len=38) :: 'GRIDs', 'elements', &
    'properties or materials', 'supports, SUPORT, RBE2, MPC or springs', 'GRAV or RFORCE']

contains

  !> Compute a checksum of each part of a model.
  pure function marks_of(model) result(mark)
    type(model_type), intent(in) :: model
    real(wp) :: mark(size(part_name))
    type(body_load), allocatable :: mass_loads(:)
    integer :: k

    mark(1) = checksum([model%mesh%x])
    mark(2) = checksum([real(wp) :: model%mesh%kind, model%mesh%section, model%mesh%connectivity])
    associate (s => model%sections)
      mark(3) = checksum([real(wp) :: s%young, s%poisson, s%kinematics, s%thickness, s%density, &
                          s%expansion, s%reference_temperature])
      do k = 1, size(s%curve)
        if (allocated(s%curve(k)%strain)) mark(3) = checksum([mark(3), real(k, wp), s%curve(k)%strain, &
          s%curve(k)%stress, s%curve(k)%kinematic, s%curve(k)%endless])
      end do
    end associate
    associate (c => model%constraints)
      mark(4) = checksum([real(wp) :: merge(1, 0, c%held), merge(1, 0, c%reference), c%leader, c%sum_of, &
                          (c%sum(k)%component, c%sum(k)%node, c%sum(k)%coefficient, k=1, size(c%sum)), &
                          c%platen%leader, merge(1, 0, c%platen%held), c%spring%stiffness, &
                          (c%spring(k)%component, c%spring(k)%node, k=1, size(c%spring))])
    end associate
    mass_loads = model%loads%body_load
    mass_loads%factor = 0.0_wp
    mark(5) = checksum(transfer(mass_loads, [0.0_wp]))
  end function marks_of
end module epcont_model_marks
