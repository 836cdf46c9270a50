# Headers that nearly every source parses, compiled once (docs/adr/0004-several-sources-at-once.md). The preset
# `dev` compiles without them: a source includes all that it uses.
function(stillkite_add_precompiled NAME)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")
  add_library(${NAME} OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(${NAME} PRIVATE Eigen3::Eigen opencv_core)
  target_precompile_headers(${NAME} PRIVATE
    <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <map>
    <memory> <numeric> <optional> <random> <span> <sstream> <string> <string_view> <utility>
    <variant> <vector> <Eigen/Dense> <opencv2/core.hpp> ${ARGN})
  stillkite_compile_options(${NAME})
endfunction()

stillkite_add_precompiled(stillkite_precompiled)
set_target_properties(stillkite_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
