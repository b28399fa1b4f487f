#pragma once

#include <string_view>

/// Texts that the build puts into the program (studies/CMakeLists.txt).
namespace gladstone::embedded {

extern std::string_view const report_css;
extern std::string_view const report_js;
extern std::string_view const d3_js;       ///< Mike Bostock's d3, as Debian's package node-d3 has it
extern std::string_view const d3_licence;  ///< of that package

}  // namespace gladstone::embedded
