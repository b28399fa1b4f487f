#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/compare/calibrate.h"

namespace gladstone::inline compare {

/// Writes calibration.h5 (docs/file-formats.md).
void write_calibration_file(std::string const& path, Calibration const& calibration);

/// Draws the residuals of both models over the image.
/// @throws GnuplotMissing if gnuplot is not installed
void draw_calibration(std::string const& path, Calibration const& calibration);

/// Returns the calibration as a JSON object.
nlohmann::ordered_json calibration_json(Calibration const& calibration);

/// Formats the calibration as a table of parameters, standard errors and residuals.
std::string calibration_table(Calibration const& calibration);

}  // namespace gladstone::inline compare
