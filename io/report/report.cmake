# Embeds the report pages, their scripts and dygraphs (MIT) into stillkite_io.
find_file(STILLKITE_DYGRAPHS_JS dygraph.min.js
          PATHS /usr/share/javascript/dygraphs /usr/local/share/javascript/dygraphs)
find_file(STILLKITE_DYGRAPHS_CSS dygraph.min.css
          PATHS /usr/share/javascript/dygraphs /usr/local/share/javascript/dygraphs)
if(NOT STILLKITE_DYGRAPHS_JS OR NOT STILLKITE_DYGRAPHS_CSS)
  message(FATAL_ERROR "dygraph.min.js and dygraph.min.css are missing: install the package "
                      "libjs-dygraphs, or set STILLKITE_DYGRAPHS_JS and STILLKITE_DYGRAPHS_CSS.")
endif()

set(report_assets ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp)
file(GLOB report_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.html
     ${CMAKE_CURRENT_LIST_DIR}/*.css ${CMAKE_CURRENT_LIST_DIR}/*.js)
add_custom_command(
  OUTPUT ${report_assets}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${report_assets} -DFOLDER=${CMAKE_CURRENT_LIST_DIR}
          -DDYGRAPHS_JS=${STILLKITE_DYGRAPHS_JS} -DDYGRAPHS_CSS=${STILLKITE_DYGRAPHS_CSS}
          -P ${CMAKE_CURRENT_LIST_DIR}/embed.cmake
  DEPENDS ${CMAKE_CURRENT_LIST_DIR}/embed.cmake ${report_files} ${STILLKITE_DYGRAPHS_JS}
          ${STILLKITE_DYGRAPHS_CSS}
  COMMENT "Embedding the report pages"
  VERBATIM)
set_source_files_properties(${report_assets} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
target_sources(stillkite_io PRIVATE
  ${report_assets} report/base64.cpp report/calibration_report.cpp report/comparison_report.cpp report/decimation.cpp
  report/hover_distribution.cpp report/hover_report.cpp report/report.cpp report/report_page.cpp
  report/report_series.cpp report/study_report.cpp)
target_link_libraries(stillkite_io PUBLIC nlohmann_json::nlohmann_json)
