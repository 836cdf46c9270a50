# Writes OUTPUT, the definitions of assets.hpp. Called by report.cmake at build time.
file(WRITE ${OUTPUT}
     "// Written by embed.cmake.\n#include \"io/report/assets.hpp\"\n\n"
     "namespace stillkite::report_assets {\n\n")

function(embed NAME)
  foreach(path IN LISTS ARGN)
    file(READ ${path} text)
    string(APPEND all "${text}")
  endforeach()
  file(APPEND ${OUTPUT} "const std::string_view ${NAME} = R\"embedded(${all})embedded\";\n\n")
endfunction()

set(common data.js tables.js plots.js plane.js)
function(embed_script NAME)
  list(TRANSFORM ARGN PREPEND ${FOLDER}/)
  embed(${NAME} ${ARGN})
endfunction()

embed(kPage ${FOLDER}/page.html)
embed(kReportMain ${FOLDER}/report.html)
embed(kReportStyle ${FOLDER}/report.css)
embed_script(kReportScript ${common} flight.js headline.js charts.js path.js verdicts.js page.js)
embed(kHoverMain ${FOLDER}/hover.html)
embed(kHoverStyle ${FOLDER}/report.css ${FOLDER}/hover.css)
embed_script(kHoverScript ${common} trials.js table_one.js displacement.js histogram.js heat_map.js
             decisions.js replay_views.js replay.js sortable_table.js trial_table.js hover_page.js)
embed(kComparisonMain ${FOLDER}/comparison.html)
embed(kComparisonStyle ${FOLDER}/report.css ${FOLDER}/comparison.css)
embed_script(kComparisonScript ${common} compared.js comparison_table.js charts.js path.js verdicts.js
             comparison_page.js)
embed(kStudyMain ${FOLDER}/study.html)
embed(kStudyStyle ${FOLDER}/report.css ${FOLDER}/study.css)
embed_script(kStudyScript data.js tables.js sortable_table.js study_figures.js study_page.js)
embed(kCalibrationMain ${FOLDER}/calibration.html)
embed(kCalibrationStyle ${FOLDER}/report.css ${FOLDER}/calibration.css)
embed_script(kCalibrationScript data.js tables.js calibration_page.js)
embed(kDygraphs ${DYGRAPHS_JS})
embed(kDygraphsStyle ${DYGRAPHS_CSS})
file(APPEND ${OUTPUT} "}  // namespace stillkite::report_assets\n")
