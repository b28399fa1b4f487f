#include "studies/compare/reconstruct_case.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "render/base/error.h"
#include "render/files/input_file.h"
#include "render/files/stop_point.h"
#include "studies/case/case_kind.h"
#include "studies/case/truth_file.h"
#include "studies/case/warning_log.h"
#include "studies/compare/compared_files.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/density_budget.h"
#include "studies/compare/density_truth.h"

namespace gladstone::inline compare {
namespace {

namespace fs = std::filesystem;

/// Files of a reconstruction.
struct ReconstructedFiles {
  std::string setup, vectors;
  std::string truth;  ///< path of the truth; empty: images of an experiment
  SourceFiles sources;
};

/// Locates the vectors of measured images and the setup of the experiment.
/// @param place    setup, or a folder that contains one
/// @param vectors  path; empty: those of the folder
ReconstructedFiles find_measured_files(std::string const& place, std::string const& vectors) {
  ReconstructedFiles files;
  std::error_code error;
  bool const is_folder = fs::is_directory(place, error);
  files.setup = is_folder ? in_case(place, case_file::setup) : place;
  if (!is_folder) require_input_file(place, "a case folder or a setup");
  if (!is_folder && vectors.empty())
    throw DataError(ErrorCode::wrong_format, place,
                    "is a setup, which contains no vectors; give their file with --vectors");
  files.vectors = vectors.empty() ? in_case(place, case_file::vectors) : vectors;
  if (!fs::exists(files.vectors, error))
    throw DataError(ErrorCode::missing_file, files.vectors,
                    vectors.empty() ? "does not exist; create it with gladstone correlate, or give "
                                      "another file with --vectors"
                                    : "does not exist; check --vectors");
  require_input_file(files.vectors, "a file of vectors");
  files.sources.add("", files.setup, SourceFiles::Holds::bytes);
  files.sources.add("vectors", files.vectors);
  return files;
}

ReconstructedFiles find_files(std::string const& place, std::string const& vectors) {
  std::error_code error;
  ReconstructedFiles files;
  if (fs::is_directory(place, error)) require_case(place);
  if (fs::exists(fs::path(place) / case_file::truth, error)) {
    ComparedFiles compared = compared_files(place, vectors);
    files = {compared.setup, compared.vectors, compared.truth, std::move(compared.sources)};
  } else {
    files = find_measured_files(place, vectors);
  }
  files.sources.on_change("run gladstone reconstruct again");
  return files;
}

/// Returns the true density at the nodes of a reconstruction.
std::vector<double> compute_truth(Reconstruction const& result, DisplacementField const& field, CaseSetup const& loaded,
                                  std::string const& truth) {
  if (result.axisymmetry) return sample_middle_plane(loaded.setup.medium, result.grid);
  std::vector<Vec2d> position_px;
  for (int row = 0; row < result.grid.rows; ++row)  // rows of the grid upwards, of the vectors downwards
    for (int column = 0; column < result.grid.columns; ++column)
      position_px.push_back(field.position_px[result.grid.index(column, result.grid.rows - 1 - row)]);
  return interpolate_density(read_field_map(truth), position_px);
}

}  // namespace

Reconstruction reconstruct_case(std::string const& place, ReconstructOptions const& options, Backend const& device,
                                CaseSetup const* setup, Comparison const* comparison) {
  ReconstructedFiles files = find_files(place, options.vectors);
  CaseSetup const loaded = setup ? setup->copy() : load_case_setup(files.setup, {});
  require_experiment(loaded.setup, bos_experiment, files.setup,
                     "is not a BOS setup (density follows from the displacement of a background); use a setup with "
                     "experiment = \"bos\"");
  std::optional<GroundTruth> dots;
  if (!files.truth.empty()) dots = read_truth(files.truth);
  CompareOptions reading;
  reading.conventions = options.conventions;
  MeasuredVectors const vectors = load_vectors(files.vectors, loaded, dots ? &*dots : nullptr, reading);
  if (!vectors.report.empty()) spdlog::info("{}: {}", files.vectors, vectors.report);
  stop_point("reconstructing");

  double const window_px = vectors.settings.window_px.back();
  Reconstruction result = reconstruct_density(vectors.field, loaded.setup, window_px, options);
  if (dots) result.truth = compute_truth(result, vectors.field, loaded, files.truth);
  if (options.budget && dots) {
    CompareOptions comparing = reading;
    comparing.vectors = options.vectors;
    comparing.reuse = true;
    std::optional<Comparison> computed;
    if (!comparison) comparison = &computed.emplace(compare_case(place, device, comparing, &loaded));
    result.budget = compute_density_budget(*comparison, result, loaded.setup, window_px, options);
  } else if (options.budget) {
    throw DataError(ErrorCode::missing_file, place,
                    "has no truth.h5, without which the causes of the error are unknown; remove --budget, or "
                    "render the case");
  }
  bool const is_assumed = files.truth.empty() && loaded.setup.medium.automatic_thickness && !result.axisymmetry;
  if (is_assumed)
    result.warnings.push_back({WarningCode::assumed, "medium.thickness_mm",
                               fmt::format("is not given in {}, so that {:.4g} mm is assumed (the density is "
                                           "proportional to its inverse); set it to the depth of the flow",
                                           files.setup, 1e3 * loaded.setup.medium.thickness)});
  bool const has_sigma = std::any_of(result.sigma_random.begin(), result.sigma_random.end(),
                                     [](double sigma) { return std::isfinite(sigma); });
  if (vectors.foreign && !options.overlap && has_sigma)
    spdlog::info(
        "windows of {} px, from [correlate] of the setup, are assumed for the correlation of the vectors' "
        "errors; give --overlap if the vectors were measured with other windows",
        window_px);
  result.setup = loaded.document.resolved();
  result.seed = loaded.setup.render.seed;
  result.vectors = files.vectors;
  result.sources = std::move(files.sources);
  log_warnings(result.warnings);
  return result;
}

}  // namespace gladstone::inline compare
