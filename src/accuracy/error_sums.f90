!> Error estimates of approaches and of sums of contact forces: products of the strain errors, and additions
!> for contact at nodes alone, gap oscillation and narrow zones.
module epcont_accuracy_error_sums
  use epcont_linear_contact_rule, only: contact_loads
  use epcont_accuracy_error_fields, only: error_fields
  use epcont_accuracy_surface_line, only: surface_line
  use epcont_accuracy_weights, only: least_energy, of_shares, uncancelled, unresolved, wave_height
  use epcont_accuracy_zone_error, only: zone_error
  use epcont_base_kinds, only: wp
  use epcont_base_tolerances, only: least_difference
  use epcont_result_answer, only: answer_type
  implicit none
  private
  public :: shift_errors, sum_errors, with_waves

contains

  !> Errors of approaches, then of sums of forces.
  pure function sum_errors(loads, surface, answer, errors, field, energy_norm) result(off)
    type(contact_loads), intent(in) :: loads       !! unit loads
    type(surface_line), intent(in) :: surface      !! of the pairs
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(zone_error), intent(in) :: errors(:)      !! of its zones
    type(error_fields), intent(in) :: field        !! errors of strains
    real(wp), intent(in) :: energy_norm            !! of these
    real(wp) :: off(size(loads%unit))
    !> What a force at each pair adds of what contact at nodes alone lets the bodies come too near, and of
    !! what its ends leave open [length] [pairs]
    real(wp), dimension(size(answer%contact%force)) :: near, at_ends
    real(wp), dimension(size(off)) :: near_sum, end_sum   !! of these, under each load
    real(wp) :: at_end
    integer :: j, z

    near = 0.0_wp
    at_ends = 0.0_wp
    do z = 1, size(errors)
      associate (zone => errors(z), pairs => answer%zones(z)%pairs)
        at_end = answer%zones(z)%max_pressure*zone%half_length*surface%compliance(zone%peak)
        ! Between the nodes of flat faces there is no gap: where an edge or a tip makes the pressure, it
        ! says nothing of one.
        if (.not. zone%unbounded) &
          near(pairs) = near(pairs) + zone%weights%between*(at_end*zone%resolution**2)
        at_ends(pairs) = at_ends(pairs) + zone%weights%end*(at_end*zone%end_resolution**2) &
                         + wave_height*zone%wave_height + zone%too_near
      end associate
    end do
    ! Of a tilt of either sign the ends count, not the sum.
    near_sum = matmul(near, loads%force)
    end_sum = matmul(at_ends, abs(loads%force))
    off = 0.0_wp
    do j = 1, size(off)
      if (loads%unit(j) > 0.0_wp) off(j) = error_along(near_sum(j), end_sum(j))
    end do

  contains

    !> Error of an approach, or of a sum of contact forces: the product of the errors of the scene and of its
    !! answer to a unit load along the motion, or to closing gaps, signed, with what contact at nodes alone
    !! lets the bodies come too near.
    pure real(wp) function error_along(near, at_ends) result(error)
      real(wp), intent(in) :: near, at_ends  !! what contact at nodes alone, and its ends, add
      real(wp) :: short, vague

      vague = merge(1.0_wp, unresolved, all(errors%resolved))
      short = max(abs(field%along(1, j) - near), uncancelled*field%along(2, j))
      ! Of what pairs or bodies share no part cancels another.
      if (j > max(1, size(loads%motion))) short = of_shares*(field%along(2, j) + abs(near))
      ! What a mesh misses is measured by what it has: each error is larger by as much as the energy of its
      ! field is too small. Of unlike elements that bear the largest weight counts.
      error = vague*(at_ends + maxval(errors%weights%product)*short/ &
        max(least_energy, 1.0_wp - energy_norm**2)/max(least_energy, 1.0_wp - field%missing(j)))
    end function error_along
  end function sum_errors

  !> What forces of narrow zones change of sums of forces where they are aside [force] [sums].
  pure function shift_errors(shared, shifted) result(off)
    real(wp), intent(in) :: shared(:, :)           !! by a unit load along each motion [motions, sums]
    real(wp), intent(in) :: shifted(:, :)          !! loads along these, of each zone [motions, zones]
    real(wp) :: off(size(shared, 2))
    integer :: j

    do j = 1, size(off)
      off(j) = sum(abs(matmul(shared(:, j), shifted)))
    end do
  end function shift_errors

  !> Where motions are given, waves of the gap that are not pressed flat bear more than what is meant: the
  !! higher they are the more, and none of it where they are flat; nothing where loads alone make the sum
  !! [force].
  pure real(wp) function with_waves(off, k, share, answer, errors) result(force)
    real(wp), intent(in) :: off(:)   !! errors, without waves
    integer, intent(in) :: k         !! which sum
    real(wp), intent(in) :: share(:, :)         !! of each pair in each sum [pairs, sums]
    type(answer_type), intent(in) :: answer     !! of the last solve
    type(zone_error), intent(in) :: errors(:)   !! of its zones
    integer :: z

    force = 0.0_wp
    if (off(k) <= least_difference*sum(answer%contact%force)) return   ! that is rounding
    do z = 1, size(errors)
      force = force + min(1.0_wp, errors(z)%waviness**3)* &
                      sum(abs(share(answer%zones(z)%pairs, k))* &
                          answer%contact%force(answer%zones(z)%pairs))
    end do
    force = off(k) + force
  end function with_waves
end module epcont_accuracy_error_sums
