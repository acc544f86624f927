# trb_embed(TARGET FUNCTION page_files FOLDER web/dist FILES index.html ...): compiles the files into TARGET, which then has
# `std::span<const EmbeddedFile> trb::page_files()` (common/base/embedded_file.hpp); names are below FOLDER. Each is there plain
# and gzipped; the same files give the same bytes.
find_program(GZIP gzip REQUIRED)

function(trb_embed TARGET)
  cmake_parse_arguments(ARG "" "FUNCTION;FOLDER" "FILES" ${ARGN})
  set(BEGIN "extern \"C\" __attribute__((visibility(\"hidden\"))) const char")
  set(SYMBOLS "")
  set(ROWS "")
  set(PATHS "")
  set(NUMBER 0)
  foreach(FILE ${ARG_FILES})
    get_filename_component(PATH ${ARG_FOLDER}/${FILE} ABSOLUTE)
    set(GZIPPED ${CMAKE_CURRENT_BINARY_DIR}/${ARG_FUNCTION}_${NUMBER}.gz)
    add_custom_command(OUTPUT ${GZIPPED} COMMAND ${GZIP} -n -9 -c ${PATH} > ${GZIPPED} DEPENDS ${PATH} VERBATIM)
    set(SYMBOL trb_${ARG_FUNCTION}_${NUMBER})
    string(APPEND SYMBOLS "asm(\".section .rodata\\n${SYMBOL}_begin: .incbin \\\"${PATH}\\\"\\n"
                          "${SYMBOL}_gzipped: .incbin \\\"${GZIPPED}\\\"\\n${SYMBOL}_end:\\n.previous\\n\");\n"
                          "${BEGIN} ${SYMBOL}_begin[], ${SYMBOL}_gzipped[], ${SYMBOL}_end[];\n")
    string(APPEND ROWS "      {\"${FILE}\", between(${SYMBOL}_begin, ${SYMBOL}_gzipped), between(${SYMBOL}_gzipped, ${SYMBOL}_end)},\n")
    list(APPEND PATHS ${PATH} ${GZIPPED})
    math(EXPR NUMBER "${NUMBER} + 1")
  endforeach()
  set(SOURCE ${CMAKE_CURRENT_BINARY_DIR}/${ARG_FUNCTION}.cpp)
  file(GENERATE OUTPUT ${SOURCE} CONTENT "// Made by cmake/embed.cmake.
#include \"common/base/embedded_file.hpp\"

${SYMBOLS}
namespace trb {
std::span<const EmbeddedFile> ${ARG_FUNCTION}();
std::span<const EmbeddedFile> ${ARG_FUNCTION}() {
  const auto between = [](const char* begin, const char* end) {
    return std::string_view(begin, static_cast<std::size_t>(end - begin));
  };
  static const EmbeddedFile files[] = {
${ROWS}  };
  return files;
}
}  // namespace trb
")
  # The compiler does not see what the assembler includes.
  set_source_files_properties(${SOURCE} PROPERTIES OBJECT_DEPENDS "${PATHS}" SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${TARGET} PRIVATE ${SOURCE})
endfunction()
