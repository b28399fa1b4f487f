#pragma once

#include <string>
#include <vector>

#include "studies/commands/description.h"

namespace gladstone::inline commands {

/// Arguments of `gladstone info lens`.
struct LensQuestion {
  std::string file;
  std::vector<std::string> glasses;  ///< glass catalogues (AGF) in addition to the built-in ones
  double wavelength_nm = 0;  ///< wavelength [nm]; 0: primary wavelength of the file or, if it has none, the d line
  std::string figure;        ///< path of the figure to draw; empty: none
};

/// Reports cardinal points, f-number, pupils and spot sizes of a lens prescription; draws its layout with rays, spot
/// diagrams, distortion, field curvature and vignetting.
Description describe_lens(LensQuestion const& question);

}  // namespace gladstone::inline commands
