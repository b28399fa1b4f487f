# embed_text(target name file): embeds a text file into a target as gladstone::embedded::NAME, a std::string_view
# (declared in embedded_text.h or templates.h of its room). CMake reads the file when it runs, and runs again when the
# file changes.
function(embed_text target name file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} hexadecimal HEX)
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${hexadecimal}")
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT [[
#include <string_view>

namespace gladstone::embedded {
extern std::string_view const @name@;
namespace {
constexpr char bytes[] = {@bytes@};
}
std::string_view const @name@{bytes, sizeof bytes};
}  // namespace gladstone::embedded
]] @ONLY)
  target_sources(${target} PRIVATE ${source})
endfunction()
