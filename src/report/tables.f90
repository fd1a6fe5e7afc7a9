!> Result tables in full precision, one value a column (CSV).
module epcont_report_tables
  use epcont_accuracy_accuracy, only: accuracy_type
  use epcont_base_error, only: error_type
  use epcont_base_kinds, only: wp
  use epcont_base_text, only: text_of
  use epcont_certificate_certificate, only: certificate_type
  use epcont_certificate_scene, only: little, overlap_place
  use epcont_model_model, only: model_type
  use epcont_plan_free_motion, only: free_motions
  use epcont_report_file, only: new_text_file, text_file
  use epcont_report_limit, only: limit_of_largest, limit_of_zone
  use epcont_report_number, only: full_number, known_number
  use epcont_report_outcome, only: outcome_type
  use epcont_report_remarks, only: remarks_type
  use epcont_result_answer, only: answer_type
  use epcont_result_stresses, only: first_largest, place_of_point
  implicit none
  private
  public :: write_summary, write_contact, write_zones, write_bodies, write_nodes, write_elements, write_history

contains

  !> key,value,unit.
  subroutine write_summary(stem, model, motions, answer, certificate, accuracy, outcome, remarks, error)
    character(len=*), intent(in) :: stem
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(certificate_type), intent(in) :: certificate
    type(accuracy_type), intent(in) :: accuracy
    type(outcome_type), intent(in) :: outcome
    type(remarks_type), intent(in) :: remarks
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file
    real(wp) :: place(2)
    integer :: k

    call new_text_file(stem//'.summary.csv', file, error)
    if (allocated(error)) return
    call file%line('key,value,unit')
    call file%line('status,'//outcome%word//',')
    call file%line('warnings,'//text_of(remarks%warnings)//',')
    call file%line('notes,'//text_of(remarks%notes)//',')
    if (outcome%has_answer) then
      if (model%pairs > 0) &
        call file%line('max_pressure,'//known_number(answer%largest_pressure())//',force/length2')
      do k = 1, motions%count
        call put('approach_'//text_of(model%node_id(motions%node(k)))//'_'//text_of(motions%component(k)), &
                 answer%contact%approach(k), 'length')
      end do
      call put('total_contact_force', sum(answer%contact%force), 'force')
      call file%line('pairs_in_contact,'//text_of(count(answer%contact%touching))//',')
      call file%line('plastic_elements,'//text_of(count(answer%plastic))//',')
      call file%line('iterations,'//text_of(size(answer%history))//',')
      call file%line('factorizations,'//text_of(answer%factorizations)//',')
      call file%line('pivots,'//text_of(sum(answer%history%pivots))//',')
      associate (e => first_largest(answer%largest_stress))
        call put('max_equivalent_stress', answer%largest_stress(e), 'force/length2')
        call file%line('max_equivalent_stress_element,'//text_of(model%element_id(e))//',')
        place = place_of_point(model, answer%largest_at(e))
        call put('max_equivalent_stress_x', place(1), 'length')
        call put('max_equivalent_stress_y', place(2), 'length')
      end associate
      call put('max_displacement', maxval(norm2(answer%displacement, dim=1)), 'length')
      call put('equilibrium_residual', certificate%equilibrium, '')
      call put('smallest_force', certificate%smallest_force, 'force')
      call put('smallest_gap', certificate%smallest_gap, 'length')
      call put('largest_force_gap_product', certificate%force_gap, 'force*length')
      call put('stress_off_curve', certificate%off_curve, '')
      call put('curve_tolerance', certificate%curve_tolerance, '')
      call put('stress_off_curve_limit', certificate%off_curve_limit, '')
      call put('energy_balance', certificate%energy, '')
      if (certificate%scene%looked_through) then
        call write_places(file, 'penetration', certificate%scene%deepest, certificate%scene%inside)
        call write_places(file, 'pressed_gap', certificate%scene%widest, certificate%scene%apart)
      end if
      call put('condition', answer%condition, '')
      call put('load_factor', answer%load_factor, '')
      k = findloc(answer%history%load_factor, answer%load_factor, dim=1, back=.true.)
      call put('iteration_error_displacement', answer%history(k)%error, '')
      call put('iteration_error_force', answer%history(k)%force_error, '')
      call write_accuracy(file, model, motions, answer, accuracy)
    end if
    call file%finish(error)

  contains

    subroutine put(key, value, unit)
      character(len=*), intent(in) :: key, unit
      real(wp), intent(in) :: value

      call file%line(key//','//full_number(value)//','//unit)
    end subroutine put
  end subroutine write_summary

  !> The largest depth, the one that is worst by what is allowed, and that; 0 where it is so little that rounding chooses the
  !! place.
  subroutine write_places(file, name, largest, worst)
    type(text_file), intent(in) :: file
    character(len=*), intent(in) :: name
    type(overlap_place), intent(in) :: largest, worst

    call put('largest_', merge(largest%depth, 0.0_wp, largest%ratio >= little))
    call put('worst_', merge(worst%depth, 0.0_wp, worst%ratio >= little))
    call put('allowed_worst_', merge(worst%allowed, 0.0_wp, worst%ratio >= little))

  contains

    subroutine put(which, value)
      character(len=*), intent(in) :: which
      real(wp), intent(in) :: value

      call file%line(which//name//','//full_number(value)//',length')
    end subroutine put
  end subroutine write_places

  !> What the figures are worth; empty where an error is not known: `max_pressure_is` unbounded, or not resolved.
  subroutine write_accuracy(file, model, motions, answer, accuracy)
    type(text_file), intent(in) :: file
    type(model_type), intent(in) :: model
    type(free_motions), intent(in) :: motions
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(in) :: accuracy
    integer :: k

    call put('mesh_error_energy_norm', accuracy%energy_norm, '')
    if (model%pairs > 0) then
      call file%line('max_pressure_is,'//limit_of_largest(answer, accuracy)//',')
      call put('mesh_error_max_pressure', accuracy%max_pressure, 'force/length2')
    end if
    do k = 1, size(accuracy%zone)
      call put('mesh_error_pressure_zone_'//text_of(k), accuracy%zone(k)%pressure, 'force/length2')
      call put('mesh_error_half_width_zone_'//text_of(k), accuracy%zone(k)%half_width, 'length')
    end do
    do k = 1, motions%count
      call put('mesh_error_approach_'//text_of(model%node_id(motions%node(k)))//'_'//text_of(motions%component(k)), &
               merge(-1.0_wp, accuracy%approach(k), accuracy%approach_unbounded(k)), 'length')
    end do
    if (model%pairs > 0) call put('mesh_error_total_contact_force', accuracy%total_force, 'force')
    if (.not. accuracy%sensitivity%known) return
    call put('contact_amplification', accuracy%sensitivity%amplification, '')
    call put('rounding_error_force', max(accuracy%sensitivity%rounding, answer%rounding_error), '')
    call file%line('weak_pairs,'//text_of(count(accuracy%weak))//',')

  contains

    subroutine put(key, value, unit)
      character(len=*), intent(in) :: key, unit
      real(wp), intent(in) :: value

      call file%line(key//','//known_number(value)//','//unit)
    end subroutine put
  end subroutine write_accuracy

  !> One row a pair.
  subroutine write_contact(stem, model, answer, error)
    character(len=*), intent(in) :: stem
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file
    integer :: k

    call new_text_file(stem//'.contact.csv', file, error)
    if (allocated(error)) return
    call file%line('pair,ga,gb,x,y,nx,ny,initial_gap,force,pressure,gap,status')
    do k = 1, model%pairs
      associate (a => model%pair_node(1, k), b => model%pair_node(2, k))
        call file%line(text_of(model%pair_id(k))//','//text_of(model%node_id(a))//','//text_of(model%node_id(b))//','// &
                       row([model%x(:, b), model%normal(:, k), model%initial_gap(k), answer%contact%force(k)])//','// &
                       known_number(answer%pressure(k))//','//full_number(answer%contact%gap(k))//','// &
                       trim(merge('touching', 'open    ', answer%contact%touching(k))))
      end associate
    end do
    call file%finish(error)
  end subroutine write_contact

  !> One row a zone.
  subroutine write_zones(stem, model, answer, accuracy, error)
    character(len=*), intent(in) :: stem
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(in) :: accuracy
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file
    integer :: z

    call new_text_file(stem//'.zones.csv', file, error)
    if (allocated(error)) return
    call file%line('zone,first_pair,last_pair,force,max_pressure,half_width_last_pair,half_width,max_pressure_is')
    associate (zones => answer%zones)
      do z = 1, size(zones)
        call file%line(text_of(z)//','//text_of(model%pair_id(zones(z)%first))//','// &
                       text_of(model%pair_id(zones(z)%last))//','// &
                       full_number(zones(z)%force)//','//known_number(zones(z)%max_pressure)//','// &
                       full_number(zones(z)%half_width_pairs)//','//known_number(zones(z)%half_width)//','// &
                       limit_of_zone(answer, accuracy, z))
      end do
    end associate
    call file%finish(error)
  end subroutine write_zones

  !> One row a body that has elements: what contact exerts on it, and how much that may be off; no x in rings.
  subroutine write_bodies(stem, model, answer, accuracy, error)
    character(len=*), intent(in) :: stem
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(accuracy_type), intent(in) :: accuracy
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file
    character(len=:), allocatable :: force_x, error_x
    integer :: i

    call new_text_file(stem//'.bodies.csv', file, error)
    if (allocated(error)) return
    call file%line('body,first_node,force_x,force_y,mesh_error_x,mesh_error_y')
    do i = 1, size(answer%bodies)
      associate (body => answer%bodies(i))
        force_x = ''
        error_x = ''
        if (.not. model%has_rings()) then
          force_x = full_number(body%resultant(1))
          error_x = known_number(accuracy%body_force(1, i))
        end if
        call file%line(text_of(body%body)//','//text_of(model%node_id(body%node))//','//force_x//','// &
                       full_number(body%resultant(2))//','//error_x//','//known_number(accuracy%body_force(2, i)))
      end associate
    end do
    call file%finish(error)
  end subroutine write_bodies

  !> One row a node.
  subroutine write_nodes(stem, model, answer, error)
    character(len=*), intent(in) :: stem
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file
    integer :: i

    call new_text_file(stem//'.nodes.csv', file, error)
    if (allocated(error)) return
    call file%line('node,x,y,ux,uy,rx,ry')
    do i = 1, model%nodes
      call file%line(text_of(model%node_id(i))//','// &
                     row([model%x(:, i), answer%displacement(:, i), answer%reaction(:, i)]))
    end do
    call file%finish(error)
  end subroutine write_nodes

  !> One row an element; x and y are its centre, max_x and max_y the integration point where the von Mises stress is largest.
  subroutine write_elements(stem, model, answer, error)
    character(len=*), intent(in) :: stem
    type(model_type), intent(in) :: model
    type(answer_type), intent(in) :: answer
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file
    integer :: e

    call new_text_file(stem//'.elements.csv', file, error)
    if (allocated(error)) return
    call file%line('element,x,y,sx,sy,sz,txy,equivalent_stress,max_equivalent_stress,max_x,max_y,equivalent_strain,'// &
                   'secant_modulus,state')
    do e = 1, model%elements
      call file%line(text_of(model%element_id(e))//','// &
                     row([sum(model%coordinates(e), dim=2)/model%order(e), answer%stress(:, e), answer%equivalent_stress(e), &
                          answer%largest_stress(e), place_of_point(model, answer%largest_at(e)), &
                          answer%equivalent_strain(e), answer%secant_modulus(e)])//','// &
                     trim(merge('plastic', 'elastic', answer%plastic(e))))
    end do
    call file%finish(error)
  end subroutine write_elements

  !> One row a solve.
  subroutine write_history(stem, answer, error)
    character(len=*), intent(in) :: stem
    type(answer_type), intent(in) :: answer
    type(error_type), allocatable, intent(out) :: error
    type(text_file) :: file
    integer :: k

    call new_text_file(stem//'.history.csv', file, error)
    if (allocated(error)) return
    call file%line('iteration,change,residual,pairs_in_contact,plastic_elements,pivots,load_factor')
    do k = 1, size(answer%history)
      associate (now => answer%history(k))
        call file%line(text_of(k)//','//row([now%change, now%residual])//','//text_of(now%touching)//','// &
                       text_of(now%yielded)//','//text_of(now%pivots)//','//full_number(now%load_factor))
      end associate
    end do
    call file%finish(error)
  end subroutine write_history

  !> Numbers with commas between them.
  pure function row(values) result(text)
    real(wp), intent(in) :: values(:)
    character(len=:), allocatable :: text
    integer :: k

    text = full_number(values(1))
    do k = 2, size(values)
      text = text//','//full_number(values(k))
    end do
  end function row
end module epcont_report_tables
