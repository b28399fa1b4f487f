#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/case/result_rows.h"
#include "studies/compare/stereo.h"

namespace gladstone::inline compare {

/// Writes a file of three components (filetype "gladstone stereo"): /x_mm [nx], /y_mm [ny], /displacement_mm
/// [ny, nx, 3] with its uncertainty, the residuals, and for rendered cases truth and error; rows upwards, NaN where not
/// determined. Tables in docs/file-formats.md.
/// @throws OutputError; DataError if a source has changed since it was read
void write_stereo(std::string const& path, StereoMeasurement const& measurement);

/// Returns the quantities of a measurement: those of the field and the laser sheet, then those of each component.
std::vector<ResultRow> stereo_rows(StereoMeasurement const& measurement);

/// Summarizes a measurement as JSON, the output of --json (docs/file-formats.md).
nlohmann::ordered_json summarize_stereo(StereoMeasurement const& measurement);

/// Formats the summary as text.
std::string stereo_report(StereoMeasurement const& measurement);

}  // namespace gladstone::inline compare
