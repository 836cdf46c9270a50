# Over real flat ground, through a lens that is off by a tenth of a pixel, the fused path is as good
# as the flow's, to a tenth. Runs STILLKITE compare on CONFIG into OUT.
if(NOT DEFINED ENV{STILLKITE_DATA})
  message(STATUS "skipped: STILLKITE_DATA is not set")
  return()
endif()
execute_process(COMMAND ${STILLKITE} compare ${CONFIG} --estimators flow,fused --out ${OUT}
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(READ ${OUT}/comparison.json comparison)
foreach(figure position_rmse_m drift_percent tilt_rmse_rad yaw_rmse_rad)
  string(JSON flow GET "${comparison}" estimators 0 evaluation ${figure})
  string(JSON fused GET "${comparison}" estimators 1 evaluation ${figure})
  message(STATUS "${figure}: flow ${flow}, fused ${fused}")
  execute_process(COMMAND awk "BEGIN { exit ${fused} <= 1.1 * ${flow} }" RESULT_VARIABLE keeps_up)
  if(NOT keeps_up EQUAL 1)
    message(SEND_ERROR "${figure}: fused is worse")
  endif()
endforeach()
