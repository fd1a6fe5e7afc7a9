# cmake -DPYTHON= -DCOMPARE= -DPROGRAM= -DDECK= -DREFERENCE= -DOUTPUT= -P check.cmake: run the deck, compare its listing.
# The listing contains the program's exit status.
get_filename_component(directory "${DECK}" DIRECTORY)
get_filename_component(deck "${DECK}" NAME)
get_filename_component(listing "${REFERENCE}" NAME)
file(REMOVE_RECURSE "${OUTPUT}")
file(MAKE_DIRECTORY "${OUTPUT}")
execute_process(COMMAND "${PROGRAM}" "${deck}" -o "${OUTPUT}" WORKING_DIRECTORY "${directory}"
  RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT EXISTS "${OUTPUT}/${listing}")
  message(FATAL_ERROR "no ${listing}; status ${status}\n${said}")
endif()
execute_process(COMMAND "${PYTHON}" "${COMPARE}" "${REFERENCE}" "${OUTPUT}/${listing}" RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${listing} differs; if that is right: tools/accept --yes ${OUTPUT}/${listing}")
endif()
