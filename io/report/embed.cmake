# Writes OUTPUT, the definitions of assets.hpp. Run by report.cmake at build time.
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

embed(kPage ${FOLDER}/report.html)
embed(kStyle ${FOLDER}/report.css)
embed(kScript ${FOLDER}/data.js ${FOLDER}/tables.js ${FOLDER}/charts.js ${FOLDER}/path.js
      ${FOLDER}/verdicts.js ${FOLDER}/page.js)
embed(kDygraphs ${DYGRAPHS_JS})
embed(kDygraphsStyle ${DYGRAPHS_CSS})
file(APPEND ${OUTPUT} "}  // namespace stillkite::report_assets\n")
