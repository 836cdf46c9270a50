# Installs BUILD_DIR under WORK_DIR, then configures, builds and runs CONSUMER_DIR and EXAMPLES_DIR
# against that installation only. The example's input is a flight of FLIGHT_CONFIG, simulated by the
# installed command.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
foreach(project IN ITEMS CONSUMER EXAMPLES)
  run(${CMAKE_COMMAND} -S ${${project}_DIR} -B ${WORK_DIR}/${project} -G ${GENERATOR}
      -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
  run(${CMAKE_COMMAND} --build ${WORK_DIR}/${project})
endforeach()
run(${WORK_DIR}/CONSUMER/consumer)
run(${WORK_DIR}/prefix/bin/stillkite simulate ${FLIGHT_CONFIG} --set flight.duration_s=1
    --out ${WORK_DIR}/flight)
run(${WORK_DIR}/EXAMPLES/video_to_command ${WORK_DIR}/flight/flight.mp4)
