# HTTP server of the operator's page, its files embedded into stillkite_live.
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)

set(page_assets ${CMAKE_CURRENT_BINARY_DIR}/page_assets.cpp)
file(GLOB page_files CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/*.html
     ${CMAKE_CURRENT_LIST_DIR}/*.css ${CMAKE_CURRENT_LIST_DIR}/*.js)
add_custom_command(
  OUTPUT ${page_assets}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${page_assets} -DFOLDER=${CMAKE_CURRENT_LIST_DIR}
          -P ${CMAKE_CURRENT_LIST_DIR}/embed.cmake
  DEPENDS ${CMAKE_CURRENT_LIST_DIR}/embed.cmake ${page_files}
  COMMENT "Embedding the operator's page"
  VERBATIM)
set_source_files_properties(${page_assets} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
target_sources(stillkite_live PRIVATE
  ${page_assets} page/control_lease.cpp page/page_access.cpp page/page_address.cpp
  page/page_connection.cpp page/page_server.cpp page/request_rate.cpp)
target_link_libraries(stillkite_live PRIVATE PkgConfig::HTTPLIB)
