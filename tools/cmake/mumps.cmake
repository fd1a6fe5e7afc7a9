# Large systems: MUMPS without MPI (Debian: libmumps-seq-dev). The program does without it, by its band. It is not linked, but
# loaded when a deck asks for it, by the name that the library gives itself, which no other version has.
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
    # A name is what only a shared library has.
    execute_process(COMMAND "${CMAKE_OBJDUMP}" -p "${MUMPS_LIBRARY}" OUTPUT_VARIABLE headers ERROR_QUIET)
    if(MUMPS_LINKS AND headers MATCHES "SONAME +([^\n]+)")
      set(has_mumps TRUE)
      set(mumps_name "${CMAKE_MATCH_1}")
      file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/mumps/library_name.inc" CONTENT
        "character(len=*), parameter :: library_name = '@mumps_name@'\n" @ONLY)
      set(mumps_flags "-I${MUMPS_INCLUDE_DIR}" "-I${PROJECT_BINARY_DIR}/mumps")
      # Where it is looked for besides the system's folders.
      get_filename_component(folder "${MUMPS_LIBRARY}" DIRECTORY)
      if(NOT folder IN_LIST CMAKE_Fortran_IMPLICIT_LINK_DIRECTORIES)
        list(APPEND CMAKE_BUILD_RPATH "${folder}")
      endif()
    endif()
  endif()
  if(EPCONT_MUMPS STREQUAL "ON" AND NOT has_mumps)
    message(FATAL_ERROR "EPCONT_MUMPS is ON, but there is no dmumps_struc.h and shared libdmumps_seq for this compiler")
  endif()
endif()
if(has_mumps)
  message(STATUS "MUMPS: ${mumps_name}, loaded on demand")
else()
  message(STATUS "MUMPS: none")
endif()
