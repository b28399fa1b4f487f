#pragma once

#include <string_view>

/// Texts embedded in the executable by the build (CMakeLists.txt).
namespace gladstone::embedded {

extern std::string_view const setup_keys;  ///< docs/reference/setup.md
/// Templates of `gladstone init`, from studies/commands/templates.
extern std::string_view const template_bos, template_piv, template_stereo, template_calibration, template_study,
    template_design;

}  // namespace gladstone::embedded
