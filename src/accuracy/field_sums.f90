!> Sums over the elements of a body, for loads that are linear combinations of few fields: products of the
!> errors of the answer and of the load (signed, and absolute values), and energies of the load's error and
!> strain.
!>
!> The energy of a combination of fields is a double sum over fields, so only energies of pairs of fields are
!> found. Sums of absolute values are found for each load and element from the products of the fields.
module epcont_accuracy_field_sums
  use epcont_accuracy_element_errors, only: element_errors, most_fields
  use epcont_base_kinds, only: wp
  use epcont_element_element_kind, only: most_places
  use epcont_element_kinematics, only: components
  use epcont_linalg_dense, only: add_inner_products, add_product
  use epcont_material_elasticity, only: cross_modulus
  use epcont_material_material_law, only: material_law
  implicit none
  private
  public :: field_sums, new_field_sums

  !> Maximum number of elements that are summed at once.
  integer, parameter :: most_at_once = 64

  type :: field_sums
    real(wp), allocatable :: along(:, :)    !! products: signed sum, sum of absolute values [energy] [2,
                                            !! loads]
    real(wp), allocatable :: energy(:, :)   !! of each load's error, and of its strain [2, loads]
    logical :: finds_energies = .true.      !! false: energies are already known
    real(wp), allocatable, private :: share(:, :)          !! factor of each field in each load [fields,
                                                           !! loads]
    !> Energies of each two fields: of their errors, of their strains [fields, fields, 2]
    real(wp), allocatable, private :: together(:, :, :)
    ! Elements that are not summed yet:
    integer, private :: elements = 0                       !! their number
    integer, private :: rows(2) = 0                        !! components of errors and of strains
    real(wp), allocatable, private :: product(:, :)        !! [elements, fields]
    !> Errors and strains, their stresses times the part of the volume [rows, fields, 2]
    real(wp), allocatable, private :: strain(:, :, :), stress(:, :, :)
  contains
    procedure :: add
    procedure :: include
    procedure :: finish
    procedure, private :: sum_up
  end type field_sums

contains

  !> Start sums without elements.
  pure function new_field_sums(share, elements) result(sums)
    real(wp), intent(in) :: share(:, :)   !! factor of each field in each load [fields, loads]
    integer, intent(in) :: elements       !! number of elements that will be added
    type(field_sums) :: sums
    integer :: at_once

    sums%share = share
    at_once = min(elements, most_at_once)
    associate (fields => size(share, 1), loads => size(share, 2))
      allocate (sums%along(2, loads), sums%energy(2, loads), sums%together(fields, fields, 2), &
                sums%product(at_once, fields), source=0.0_wp)
      allocate (sums%strain(components*most_places*at_once, fields, 2))
      allocate (sums%stress, mold=sums%strain)
    end associate
  end function new_field_sums

  !> Add an element.
  subroutine add(self, errors, law)
    class(field_sums), intent(inout) :: self
    type(element_errors), intent(in) :: errors   !! of its fields
    type(material_law), intent(in) :: law       !! of its section
    real(wp) :: cross, part(most_places)
    integer :: f

    if (self%finds_energies .and. errors%fields > 0) then
      cross = cross_modulus(law%bulk, law%shear, law%sheet)
      part = errors%part
      call put(1, errors%places, errors%error, self%strain(1, 1, 1), self%stress(1, 1, 1))
      if (errors%own_places == 1) part(1) = sum(part(:errors%places))
      call put(2, errors%own_places, errors%own, self%strain(1, 1, 2), self%stress(1, 1, 2))
    end if
    self%elements = self%elements + 1
    do f = 1, errors%fields
      self%product(self%elements, f) = errors%energy(f)
    end do
    if (self%elements == size(self%product, 1)) call self%sum_up()

  contains

    !> Append the strains of all fields at some points, and their stresses.
    subroutine put(i, places, found, strain, stress)
      integer, intent(in) :: i        !! 1: errors, 2: strains
      integer, intent(in) :: places   !! number of points
      real(wp), intent(in) :: found(components, 0:most_fields, places)   !! the answer first
      real(wp), dimension(size(self%strain, 1), errors%fields), intent(inout) :: strain, stress
      real(wp) :: volumetric, double, e(components)
      integer :: f, k, row

      do f = 1, errors%fields
        row = self%rows(i)
        do k = 1, places
          e = found(:, f, k)
          volumetric = part(k)*cross*(e(1) + e(2) + e(3))
          double = 2.0_wp*part(k)*law%shear
          strain(row + 1:row + components, f) = e
          stress(row + 1, f) = volumetric + double*e(1)
          stress(row + 2, f) = volumetric + double*e(2)
          stress(row + 3, f) = volumetric + double*e(3)
          stress(row + 4, f) = 0.5_wp*double*e(4)
          row = row + components
        end do
      end do
      self%rows(i) = self%rows(i) + components*places
    end subroutine put
  end subroutine add

  !> Add the sums of other elements for the same loads.
  pure subroutine include(self, others)
    class(field_sums), intent(inout) :: self
    type(field_sums), intent(inout) :: others   !! their pending elements are summed up

    call others%sum_up()
    self%along = self%along + others%along
    self%together = self%together + others%together
  end subroutine include

  !> Sum up the pending elements.
  pure subroutine sum_up(self)
    class(field_sums), intent(inout) :: self
    real(wp) :: of_load(size(self%product, 1), size(self%share, 2))
    integer :: i

    if (self%elements == 0) return
    self%product(self%elements + 1:, :) = 0.0_wp
    of_load = 0.0_wp
    call add_product(1.0_wp, self%product, self%share, of_load)
    self%along(1, :) = self%along(1, :) + sum(of_load, dim=1)
    self%along(2, :) = self%along(2, :) + sum(abs(of_load), dim=1)
    do i = 1, 2
      call add_inner_products(self%rows(i), self%strain(:, :, i), self%stress(:, :, i), &
                              self%together(:, :, i))
    end do
    self%elements = 0
    self%rows = 0
  end subroutine sum_up

  !> Sum up the last elements, and find the energies of the loads.
  pure subroutine finish(self)
    class(field_sums), intent(inout) :: self
    real(wp) :: part(size(self%share, 1), size(self%share, 2))
    integer :: i

    call self%sum_up()
    do i = 1, 2
      part = 0.0_wp
      call add_product(1.0_wp, self%together(:, :, i), self%share, part)
      self%energy(i, :) = sum(self%share*part, dim=1)
    end do
  end subroutine finish
end module epcont_accuracy_field_sums
