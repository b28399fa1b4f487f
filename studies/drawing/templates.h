#pragma once

#include <string_view>

/// Templates of figures (*.gp), embedded in the executable by the build (CMakeLists.txt).
namespace gladstone::embedded {

extern std::string_view const figure_look;     ///< settings of all figures
extern std::string_view const figure_map;      ///< additional settings of figures of Figure::Kind::map
extern std::string_view const figure_drawing;  ///< additional settings of figures of Figure::Kind::drawing

}  // namespace gladstone::embedded
