#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/case/result_rows.h"
#include "studies/compare/reconstruct.h"

namespace gladstone::inline compare {

/// Writes density.h5 (filetype "gladstone density"): /x_mm [nx], /y_mm [ny], fields [ny, nx] of density, uncertainty,
/// region and reference, /gradient_kg_m4 [ny, nx, 2], and for a rendered case truth and error; rows upwards. Tables in
/// docs/file-formats.md.
/// Another ending than .h5 selects one of the formats of write_grid_table(), with the same quantities.
/// @throws OutputError; DataError if a source has changed since it was read
void write_density(std::string const& path, Reconstruction const& reconstruction);

/// Returns the quantities of a reconstruction: range and errors of the density, and causes of the errors.
std::vector<ResultRow> reconstruction_rows(Reconstruction const& reconstruction);

/// Summarizes a reconstruction as JSON, the output of --json (docs/file-formats.md).
nlohmann::ordered_json summarize_reconstruction(Reconstruction const& reconstruction);

/// Formats the summary as text.
std::string reconstruction_report(Reconstruction const& reconstruction);

}  // namespace gladstone::inline compare
