# The programs that ctest runs.
if(NOT TRB_BUILD_TESTS)
  function(trb_test)
  endfunction()
  function(trb_python_test)
  endfunction()
  return()
endif()

# doctest's main, and where the tests find the repository: compiled once, for it takes seconds and names absolute paths.
add_library(trb_test_main STATIC tests/support/doctest_main.cpp)
target_compile_definitions(trb_test_main PRIVATE TRB_SOURCE_DIR="${CMAKE_SOURCE_DIR}" TRB_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
target_link_libraries(trb_test_main PUBLIC doctest::doctest)
# A node's folder, for whoever reads one.
trb_library(trb_node_folder SOURCES tests/support/node_folder.cpp LIBS trb_drivers)

# Of two tests with one name ctest would run one under the other's label.
function(trb_take_test_name NAME)
  get_property(TAKEN GLOBAL PROPERTY TRB_TEST_NAMES)
  if(NAME IN_LIST TAKEN)
    message(FATAL_ERROR "there are two tests ${NAME}: give one another name")
  endif()
  set_property(GLOBAL APPEND PROPERTY TRB_TEST_NAMES ${NAME})
endfunction()

# A doctest program that ctest runs: trb_test(NAME LABEL unit SOURCES a_test.cpp ... LIBS x y APART). APART: its files share
# names, and are compiled one by one in every preset.
function(trb_test NAME)
  cmake_parse_arguments(ARG "APART" "LABEL;TIMEOUT;UNDER" "SOURCES;LIBS;DEFINITIONS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  trb_take_test_name(${NAME})
  add_executable(${NAME} ${ARG_SOURCES})
  if(NAME IN_LIST TRB_PLAYED)
    trb_precompile(${NAME})  # of an inline function the linker takes the first file's code, for all
  else()
    target_compile_options(${NAME} PRIVATE ${TRB_TEST_OPTIONS})
    if(TRB_PRECOMPILED)
      target_precompile_headers(${NAME} REUSE_FROM trb_precompiled_tests)
    endif()
  endif()
  set_target_properties(${NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(ARG_APART)
    set_target_properties(${NAME} PROPERTIES UNITY_BUILD OFF)
  endif()
  target_link_libraries(${NAME} PRIVATE ${ARG_LIBS} trb_test_main)
  target_compile_definitions(${NAME} PRIVATE ${ARG_DEFINITIONS})
  add_test(NAME ${NAME} COMMAND ${ARG_UNDER} $<TARGET_FILE:${NAME}>)
  set_tests_properties(${NAME} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
  if(ARG_LABEL MATCHES "unit|contract")
    add_dependencies(unit_tests ${NAME})
  endif()
  if(NOT ARG_LABEL STREQUAL unit)
    add_dependencies(system_tests ${NAME})
  endif()
endfunction()

# A Python program that ctest runs, with Debian's interpreter, whose packages it may use: trb_python_test(NAME LABEL e2e
# TIMEOUT 240 COMMAND a_test.py ... ENVIRONMENT A=b ... ALONE). What cannot be tried here leaves with 77: tests/support/skips.py.
function(trb_python_test NAME)
  cmake_parse_arguments(ARG "ALONE" "LABEL;TIMEOUT" "COMMAND;ENVIRONMENT" ${ARGN})
  trb_take_test_name(${NAME})
  add_test(NAME ${NAME} COMMAND /usr/bin/python3 ${ARG_COMMAND})
  set_tests_properties(${NAME} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT} SKIP_RETURN_CODE 77
                       RUN_SERIAL ${ARG_ALONE} ENVIRONMENT "${ARG_ENVIRONMENT};PYTHONDONTWRITEBYTECODE=1")
endfunction()
