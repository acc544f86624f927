# fuzz_NAME: the target with its seeds and plain mutations, in every build; libfuzz_NAME: under libFuzzer, with clang's
# `fuzz` preset alone. See scripts/fuzz.
option(TRB_LIBFUZZER "build the fuzz targets for libFuzzer; needs clang" OFF)

if(NOT TRB_BUILD_TESTS)
  function(trb_fuzz)
  endfunction()
  return()
endif()

trb_library(trb_fuzz_require SOURCES tests/fuzz/require.cpp)
trb_library(trb_fuzz_replay SOURCES tests/fuzz/replay.cpp)

# trb_fuzz(NAME FILE fuzz/name.cpp SOURCES more.cpp ... LIBS x y INPUTS n): FILE, or NAME.cpp, is the target; n of 20000 if one
# takes long.
function(trb_fuzz NAME)
  cmake_parse_arguments(ARG "" "INPUTS;FILE" "SOURCES;LIBS" ${ARGN})
  if(NOT ARG_INPUTS)
    set(ARG_INPUTS 20000)
  endif()
  if(NOT ARG_FILE)
    set(ARG_FILE ${NAME}.cpp)
  endif()
  set(SOURCES ${ARG_FILE} ${ARG_SOURCES})
  trb_program(fuzz_${NAME} SOURCES ${SOURCES} LIBS trb_fuzz_replay trb_fuzz_require ${ARG_LIBS})
  add_test(NAME fuzz_${NAME} COMMAND fuzz_${NAME} --inputs ${ARG_INPUTS})
  set_tests_properties(fuzz_${NAME} PROPERTIES LABELS fuzz TIMEOUT 900)
  if(TRB_LIBFUZZER)
    trb_program(libfuzz_${NAME} SOURCES ${SOURCES} ${CMAKE_SOURCE_DIR}/tests/fuzz/libfuzzer.cpp LIBS trb_fuzz_require ${ARG_LIBS})
    target_link_options(libfuzz_${NAME} PRIVATE -fsanitize=fuzzer)
  endif()
endfunction()
