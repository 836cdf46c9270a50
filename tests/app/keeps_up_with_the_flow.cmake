# Over real flat ground, through a lens that is off by a tenth of a pixel, the fused path is no
# worse than the flow's. Runs STILLKITE compare on CONFIG into OUT.
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
  if(fused GREATER flow)
    message(SEND_ERROR "${figure}: fused is worse")
  endif()
endforeach()
