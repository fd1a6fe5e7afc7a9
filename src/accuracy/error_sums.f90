!> Error estimates of approaches and of sums of contact forces: products of strain errors, and additions for
!> node-to-edge contact, gap oscillation and narrow zones.
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

  !> Estimate the errors of approaches, then those of sums of forces.
  pure function sum_errors(loads, surface, answer, errors, field, energy_norm) result(off)
    type(contact_loads), intent(in) :: loads       !! adjoint loads
    type(surface_line), intent(in) :: surface      !! of the pairs
    type(answer_type), intent(in) :: answer        !! of the last solve
    type(zone_error), intent(in) :: errors(:)      !! of its zones
    type(error_fields), intent(in) :: field        !! strain errors
    real(wp), intent(in) :: energy_norm            !! error of the answer in the energy norm
    real(wp) :: off(size(loads%unit))
    !> Overclosure between nodes and at ends of zones, that a unit force at each pair turns into an error
    !! [length] [pairs]
    real(wp), dimension(size(answer%contact%force)) :: near, at_ends
    real(wp), dimension(size(off)) :: near_sum, end_sum   !! sums of these under each adjoint load
    real(wp) :: at_end
    integer :: j, z

    near = 0.0_wp
    at_ends = 0.0_wp
    do z = 1, size(errors)
      associate (zone => errors(z), pairs => answer%zones(z)%pairs)
        at_end = answer%zones(z)%max_pressure*zone%half_length*surface%compliance(zone%peak)
        ! Between the nodes of flat faces there is no overclosure: if an edge or a tip causes the pressure,
        ! this term is skipped.
        if (.not. zone%unbounded) &
          near(pairs) = near(pairs) + zone%weights%between*(at_end*zone%resolution**2)
        at_ends(pairs) = at_ends(pairs) + zone%weights%end*(at_end*zone%end_resolution**2) &
                         + wave_height*zone%wave_height + zone%too_near
      end associate
    end do
    ! For a tilt of either sign, the ends count with absolute values.
    near_sum = matmul(near, loads%force(:size(near), :))
    end_sum = matmul(at_ends, abs(loads%force(:size(near), :)))
    off = 0.0_wp
    do j = 1, size(off)
      if (loads%unit(j) > 0.0_wp) off(j) = error_along(near_sum(j), end_sum(j))
    end do

  contains

    !> Estimate the error of an approach or of a sum of forces. It is the signed product of the errors of the
    !! model and of an adjoint field, with the overclosure between nodes added.
    pure real(wp) function error_along(near, at_ends) result(error)
      real(wp), intent(in) :: near, at_ends  !! overclosure between nodes, and at ends of zones
      real(wp) :: short, vague

      vague = merge(1.0_wp, unresolved, all(errors%resolved))
      short = max(abs(field%along(1, j) - near), uncancelled*field%along(2, j))
      ! For forces shared by pairs or bodies, parts do not cancel.
      if (j > max(1, size(loads%motion))) short = of_shares*(field%along(2, j) + abs(near))
      ! The estimate measures the missing energy by the computed energy: the error is divided by the computed
      ! part. Of several element types the largest weight is used.
      error = vague*(at_ends + &
                     maxval(errors%weights%product)*short/max(least_energy, 1.0_wp - energy_norm**2))
    end function error_along
  end function sum_errors

  !> Estimate the change of sums of forces if the forces of narrow zones are shifted [force] [sums].
  pure function shift_errors(shared, shifted) result(off)
    real(wp), intent(in) :: shared(:, :)           !! forces under an adjoint load along each mode [motions,
                                                   !! sums]
    real(wp), intent(in) :: shifted(:, :)          !! loads along the modes, of each zone [motions, zones]
    real(wp) :: off(size(shared, 2))
    integer :: j

    do j = 1, size(off)
      off(j) = sum(abs(matmul(shared(:, j), shifted)))
    end do
  end function shift_errors

  !> Add the error of gap oscillation: if displacements are prescribed, oscillations that contact does not
  !! flatten add force. The error grows with their height; it is zero if they are flattened, or if loads alone
  !! determine the sum [force].
  pure real(wp) function with_waves(off, k, share, answer, errors) result(force)
    real(wp), intent(in) :: off(:)   !! errors, without oscillation
    integer, intent(in) :: k         !! number of the sum
    real(wp), intent(in) :: share(:, :)         !! factor of each row in each sum [rows, sums]
    type(answer_type), intent(in) :: answer     !! of the last solve
    type(zone_error), intent(in) :: errors(:)   !! of its zones
    integer :: z

    force = 0.0_wp
    if (off(k) <= least_difference*sum(answer%contact%force)) return   ! rounding
    do z = 1, size(errors)
      force = force + min(1.0_wp, errors(z)%waviness**3)* &
                      sum(abs(share(answer%zones(z)%pairs, k))* &
                          answer%contact%force(answer%zones(z)%pairs))
    end do
    force = off(k) + force
  end function with_waves
end module epcont_accuracy_error_sums
