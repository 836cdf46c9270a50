# stillkite_module(NAME SOURCES ... LINK ... [LINK_PRIVATE ...])
# One folder, one library: target stillkite_NAME, alias stillkite::NAME.
function(stillkite_module NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;LINK_PRIVATE" ${ARGN})
  add_library(stillkite_${NAME} STATIC ${ARG_SOURCES})
  add_library(stillkite::${NAME} ALIAS stillkite_${NAME})
  set_target_properties(stillkite_${NAME} PROPERTIES EXPORT_NAME ${NAME}
                                                     POSITION_INDEPENDENT_CODE ON)
  target_compile_features(stillkite_${NAME} PUBLIC cxx_std_20)
  target_include_directories(stillkite_${NAME} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/stillkite>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(stillkite_${NAME} PUBLIC ${ARG_LINK} PRIVATE ${ARG_LINK_PRIVATE})
  stillkite_compile_options(stillkite_${NAME})
  target_precompile_headers(stillkite_${NAME} REUSE_FROM stillkite_precompiled)
endfunction()

# Warnings and sanitizers, the same for every target of the project. A designated initialiser may
# leave out members on purpose: their defaults live in the struct.
function(stillkite_compile_options TARGET)
  target_compile_options(${TARGET} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                           -Wno-sign-conversion -Wno-missing-field-initializers)
  if(STILLKITE_SANITIZE)
    # the address sanitizer finds invalid pointers; checking them again at each of Eigen's accesses
    # costs half of the compile time
    target_compile_options(${TARGET} PUBLIC -fsanitize=address,undefined -fno-sanitize-recover=all
                                            -fno-sanitize=null,alignment,object-size
                                            -fno-omit-frame-pointer)
    target_link_options(${TARGET} PUBLIC -fsanitize=address,undefined)
  endif()
  if(STILLKITE_FUZZ)  # coverage for libFuzzer; its main function only in the fuzz targets
    target_compile_options(${TARGET} PUBLIC -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# stillkite_test(NAME SOURCES ... LINK ... [SLOW filter ...]): one GoogleTest program, its cases found
# by ctest. Cases that match a filter of SLOW (Suite.Test, * allowed) are long statistical or
# closed-loop tests; they get the label `slow`, which sanitizer runs exclude.
function(stillkite_test NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;SLOW" ${ARGN})
  add_executable(${NAME} ${ARG_SOURCES})
  target_link_libraries(${NAME} PRIVATE ${ARG_LINK} GTest::gtest GTest::gtest_main)
  stillkite_compile_options(${NAME})
  target_precompile_headers(${NAME} REUSE_FROM stillkite_precompiled_tests)
  list(JOIN ARG_SLOW ":" slow)
  if(STILLKITE_SANITIZE)
    stillkite_add_whole_test(${NAME} "-${slow}")
    if(slow)
      stillkite_add_whole_test(${NAME}_slow "${slow}" LABELS slow)
    endif()
  elseif(slow)
    gtest_discover_tests(${NAME} TEST_FILTER "-${slow}" TEST_LIST ${NAME}_FAST
                         DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
    gtest_discover_tests(${NAME} TEST_FILTER "${slow}" TEST_LIST ${NAME}_SLOW
                         DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300 LABELS slow)
  else()
    gtest_discover_tests(${NAME} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
  endif()
endfunction()

# The cases of a program in one process: under sanitizers a start takes half a second.
function(stillkite_add_whole_test NAME FILTER)
  string(REGEX REPLACE "_slow$" "" program ${NAME})
  add_test(NAME ${NAME} COMMAND ${program} --gtest_brief=1 --gtest_filter=${FILTER})
  set_tests_properties(${NAME} PROPERTIES
    TIMEOUT 3600 ${ARGN}
    ENVIRONMENT LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/cmake/leak_suppressions.txt:print_suppressions=0)
endfunction()
