# Real flat ground, calibration error of 0.1 px: the fused errors are at most 25 % above the flow's,
# and the covariance is consistent. Runs STILLKITE compare on CONFIG into OUT.
if("$ENV{STILLKITE_DATA}" STREQUAL "")
  message(STATUS "skipped: STILLKITE_DATA is not set")
  return()
endif()

function(expect_at_most name value limit)
  message(STATUS "${name}: ${value}, at most ${limit}")
  execute_process(COMMAND awk "BEGIN { exit ${value} <= ${limit} }" RESULT_VARIABLE holds)
  if(NOT holds EQUAL 1)
    message(SEND_ERROR "${name} is too large")
  endif()
endfunction()

execute_process(COMMAND ${STILLKITE} compare ${CONFIG} --estimators flow,fused --out ${OUT}
                COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
file(READ ${OUT}/comparison.json comparison)
foreach(figure position_rmse_m tilt_rmse_rad yaw_rmse_rad)
  string(JSON flow GET "${comparison}" estimators 0 evaluation ${figure})
  string(JSON fused GET "${comparison}" estimators 1 evaluation ${figure})
  expect_at_most(${figure} ${fused} "1.5 * ${flow}")
endforeach()
foreach(quantity position attitude velocity)
  string(JSON nees GET "${comparison}" estimators 1 evaluation nees ${quantity} mean)
  expect_at_most("NEES of the ${quantity} (3 if consistent)" ${nees} 12)
endforeach()
