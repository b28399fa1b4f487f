#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "studies/case/result_rows.h"
#include "studies/compare/stereo.h"

namespace gladstone::inline compare {

/// Computes the errors of u, v and w over the valid nodes with a finite error.
/// @param error, sigma  displacement minus truth, and standard uncertainty [m]
std::array<ComponentErrors, 3> compute_component_errors(std::span<Vec3d const> error, std::span<Vec3d const> sigma,
                                                        std::span<VectorStatus const> status);

/// Returns the error measures of u, v and w.
/// @param pixel_size  on the sheet [m]
std::vector<ResultGroup> error_groups(std::array<ComponentErrors, 3> const& errors, double pixel_size);

/// Errors of a file of gladstone stereo against the truth that it contains.
struct StereoScores {
  std::string path;
  double pixel_size = 0.0;  ///< mean size of a pixel on the plane [m]
  std::array<ComponentErrors, 3> errors;
  std::size_t valid = 0, rejected = 0;  ///< number of nodes whose residual is within, and beyond its limit
  /// number of valid, and of rejected nodes with an error above gross_error_px in a component
  std::size_t gross = 0, gross_rejected = 0;
};

/// Scores a file of gladstone stereo.
/// @throws DataError if it contains no truth, or is incomplete
StereoScores score_stereo_file(std::string const& path);

/// Formats scores as JSON, the output of gladstone compare --json for three components (docs/file-formats.md).
nlohmann::ordered_json summarize_scores(StereoScores const& scores);

/// Formats scores as text.
std::string scores_report(StereoScores const& scores);

}  // namespace gladstone::inline compare
