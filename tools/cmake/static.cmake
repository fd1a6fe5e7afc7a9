# Link OpenBLAS and the Fortran runtime statically: loading shared ones takes two milliseconds, a small deck three.
# libquadmath, which the runtime calls, stays shared: its licence (LGPL) has conditions for static linking.
# Other BLAS and LAPACK libraries are linked as CMake found them. Sets linear_algebra, for target_link_libraries; targets with the property
# LINKED_SHARED are linked with shared libraries.
set(EPCONT_STATIC AUTO CACHE STRING "OpenBLAS and the runtime of Fortran linked statically: AUTO (where they can be), ON or OFF")
set_property(CACHE EPCONT_STATIC PROPERTY STRINGS AUTO ON OFF)
set(linear_algebra LAPACK::LAPACK BLAS::BLAS)
set(is_static FALSE)
if(NOT EPCONT_STATIC STREQUAL "OFF" AND CMAKE_Fortran_COMPILER_ID STREQUAL "GNU" AND
   LAPACK_LIBRARIES MATCHES "^([^;]*/libopenblas[^/;]*\\.so)")
  # The archive of the OpenBLAS that was found: beside the target of Debian's alternatives. It may need pthreads or OpenMP.
  get_filename_component(shared "${CMAKE_MATCH_1}" REALPATH)
  get_filename_component(folder "${shared}" DIRECTORY)
  find_library(GOMP_ARCHIVE libgomp.a HINTS ${CMAKE_Fortran_IMPLICIT_LINK_DIRECTORIES})
  mark_as_advanced(GOMP_ARCHIVE)
  set(archives "${folder}/libopenblas.a" $<$<BOOL:${GOMP_ARCHIVE}>:${GOMP_ARCHIVE}> pthread ${CMAKE_DL_LIBS})
  set(options -static-libgfortran -static-libgcc -Wl,--as-needed)
  foreach(name openblas_set_num_threads openblas_get_parallel)   # symbols that src/system/threads.f90 looks up in the program's own table
    list(APPEND options "-Wl,--undefined=${name},--export-dynamic-symbol=${name}")
  endforeach()

  include(CheckFortranSourceCompiles)
  set(CMAKE_REQUIRED_LIBRARIES ${archives})
  set(CMAKE_REQUIRED_LINK_OPTIONS ${options})
  check_fortran_source_compiles("
    program try
      implicit none
      external :: dpotrf, dgemm
      call dgemm
      call dpotrf
      print *, 1.0
    end program" STATIC_LINKS SRC_EXT f90)
  unset(CMAKE_REQUIRED_LIBRARIES)
  unset(CMAKE_REQUIRED_LINK_OPTIONS)
  if(STATIC_LINKS)
    set(is_static TRUE)
    add_library(linked_statically INTERFACE)
    target_link_libraries(linked_statically INTERFACE ${archives})
    # prepare_start of src/app/process.f90 runs before OpenBLAS, which starts before the main program.
    target_link_options(linked_statically INTERFACE ${options} -Wl,--undefined=epcont_prepare_start,-init=epcont_prepare_start)
    set(linear_algebra $<IF:$<BOOL:$<TARGET_PROPERTY:LINKED_SHARED>>,LAPACK::LAPACK,linked_statically>)
    message(STATUS "Linked statically: ${folder}/libopenblas.a, libgfortran, libgcc")
  endif()
endif()
if(EPCONT_STATIC STREQUAL "ON" AND NOT is_static)
  message(FATAL_ERROR "EPCONT_STATIC is ON, but there is no OpenBLAS with its libopenblas.a, or no gfortran with its libgfortran.a")
endif()
