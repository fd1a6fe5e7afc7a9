# Large systems: MUMPS without MPI (Debian: libmumps-seq-dev). The program does without it, by its band.
set(EPCONT_MUMPS AUTO CACHE STRING "Sparse solver MUMPS: AUTO (where there is one), ON or OFF")
set_property(CACHE EPCONT_MUMPS PROPERTY STRINGS AUTO ON OFF)
set(has_mumps FALSE)
if(NOT EPCONT_MUMPS STREQUAL "OFF")
  find_path(MUMPS_INCLUDE_DIR dmumps_struc.h)
  find_library(MUMPS_LIBRARY dmumps_seq)
  if(MUMPS_INCLUDE_DIR AND MUMPS_LIBRARY)
    include(CheckFortranSourceCompiles)
    # A flag of its own: CMake drops -I/usr/include, where gfortran does not look.
    set(CMAKE_REQUIRED_FLAGS "-I${MUMPS_INCLUDE_DIR}")
    set(CMAKE_REQUIRED_LIBRARIES ${MUMPS_LIBRARY} LAPACK::LAPACK BLAS::BLAS)
    check_fortran_source_compiles("
      program try
        implicit none
        include 'dmumps_struc.h'
        type(dmumps_struc) :: id
        call dmumps(id)
      end program" MUMPS_LINKS SRC_EXT f90)
    unset(CMAKE_REQUIRED_FLAGS)
    unset(CMAKE_REQUIRED_LIBRARIES)
    if(MUMPS_LINKS)
      set(has_mumps TRUE)
    endif()
  endif()
  if(EPCONT_MUMPS STREQUAL "ON" AND NOT has_mumps)
    message(FATAL_ERROR "EPCONT_MUMPS is ON, but there is no dmumps_struc.h and libdmumps_seq for this compiler")
  endif()
endif()
if(has_mumps)
  message(STATUS "MUMPS: ${MUMPS_LIBRARY}")
else()
  message(STATUS "MUMPS: none")
endif()
