#pragma once

#include <string_view>

/// Texts embedded in the executable by the build (CMakeLists.txt).
namespace gladstone::embedded {

extern std::string_view const report_css;
extern std::string_view const report_js;
extern std::string_view const figure_js;   ///< studies/drawing/figure.js
extern std::string_view const d3_js;       ///< Mike Bostock's d3, from Debian's package node-d3
extern std::string_view const d3_licence;  ///< licence of d3, from the same package

}  // namespace gladstone::embedded
