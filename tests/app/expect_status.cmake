# Runs COMMAND with ARGUMENTS. Fails unless it exits with STATUS, a failure writes to stderr only,
# and the output matches PATTERN.
execute_process(COMMAND ${COMMAND} ${ARGUMENTS} RESULT_VARIABLE status OUTPUT_VARIABLE out
                ERROR_VARIABLE err)
if(NOT status STREQUAL STATUS)
  message(FATAL_ERROR "exit status ${status}, expected ${STATUS}\n${out}\n${err}")
endif()
if(NOT STATUS EQUAL 0 AND (NOT out STREQUAL "" OR err STREQUAL ""))
  message(FATAL_ERROR "a failure must write to stderr only\nstdout: ${out}\nstderr: ${err}")
endif()
if(NOT "${err}${out}" MATCHES "${PATTERN}")
  message(FATAL_ERROR "expected ${PATTERN}\nstdout: ${out}\nstderr: ${err}")
endif()
