#pragma once

#include <string>
#include <vector>

#include "studies/commands/command.h"

namespace gladstone {

/// What `gladstone info lens` is asked.
struct LensQuestion {
  std::string file;
  std::vector<std::string> glasses;  ///< catalogues (AGF) beside the shipped ones
  double wavelength_nm = 0;          ///< 0: the file's primary wavelength, else the d line
  std::string figure;                ///< picture to draw; empty: none
};

/// Cardinal points, f-number, pupils and spot sizes of a lens prescription; draws its layout with rays, its spots,
/// distortion, field curvature and vignetting.
int describe_lens(LensQuestion const& question, GlobalOptions const& options);

}  // namespace gladstone
