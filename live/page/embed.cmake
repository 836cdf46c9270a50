# Writes OUTPUT, the definitions of page_assets.hpp. Called by page.cmake at build time.
file(WRITE ${OUTPUT}
     "// Written by embed.cmake.\n#include \"live/page/page_assets.hpp\"\n\n"
     "namespace stillkite::page_assets {\n\n")

function(embed NAME)
  set(all "")
  foreach(file IN LISTS ARGN)
    file(READ ${FOLDER}/${file} text)
    string(APPEND all "${text}")
  endforeach()
  file(APPEND ${OUTPUT} "const std::string_view ${NAME} = R\"embedded(${all})embedded\";\n\n")
endfunction()

embed(kHtml page.html)
embed(kStyle page.css)
embed(kScript server.js displacement.js charts.js page.js)
file(APPEND ${OUTPUT} "}  // namespace stillkite::page_assets\n")
