#include "studies/compare/stereo_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "analysis/errors/error_summary.h"
#include "analysis/vectors/three_components.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline compare {
namespace {

constexpr std::array<char const*, 3> scored_components{"u", "v", "w"};

bool is_gross(Vec3d const& error, double pixel_size) {
  return std::max({std::abs(error.x), std::abs(error.y), std::abs(error.z)}) > gross_error_px * pixel_size;
}

}  // namespace

std::array<ComponentErrors, 3> compute_component_errors(std::span<Vec3d const> error, std::span<Vec3d const> sigma,
                                                        std::span<VectorStatus const> status) {
  std::array<ComponentErrors, 3> errors;
  for (int axis = 0; axis < 3; ++axis) {
    ComponentErrors& component = errors[static_cast<std::size_t>(axis)];
    double sum = 0.0, squares = 0.0, within = 0.0, with_sigma = 0.0;
    for (std::size_t node = 0; node < error.size(); ++node) {
      double const one = error[node][axis], own = sigma[node][axis];
      if (status[node] != VectorStatus::valid || !std::isfinite(one)) continue;
      ++component.count;
      sum += one;
      squares += one * one;
      with_sigma += std::isfinite(own) ? 1.0 : 0.0;
      within += std::abs(one) <= own ? 1.0 : 0.0;
    }
    auto const count = static_cast<double>(component.count);
    component.bias = component.count > 0 ? sum / count : not_a_number;
    component.rms = component.count > 0 ? std::sqrt(squares / count) : not_a_number;
    component.coverage = with_sigma > 0 ? within / with_sigma : not_a_number;
  }
  return errors;
}

std::vector<ResultGroup> error_groups(std::array<ComponentErrors, 3> const& errors, double pixel_size) {
  std::vector<ResultGroup> groups;
  for (std::size_t k = 0; k < 3; ++k) {
    ComponentErrors const& one = errors[k];
    groups.push_back({scored_components[k],
                      {{.key = "count", .label = "count", .value = static_cast<double>(one.count)},
                       {.key = "bias_px", .label = "bias", .value = one.bias / pixel_size, .unit = "px"},
                       {.key = "rms_px", .label = "rms", .value = one.rms / pixel_size, .unit = "px"},
                       {.key = "rms_mm", .label = "rms", .value = one.rms / unit::mm, .unit = "mm"},
                       {.key = "coverage", .label = "coverage", .value = one.coverage}}});
  }
  return groups;
}

StereoScores score_stereo_file(std::string const& path) {
  ThreeComponentField const field = read_three_components(path);
  Hdf5Reader const file(path);
  if (!file.has("/error_mm"))
    throw DataError(ErrorCode::missing_content, path,
                    "contains no true displacement; give gladstone stereo two cameras of one rendered case");
  std::vector<double> const values = file.read("/error_mm");
  if (values.size() != 3 * field.size())
    throw DataError(ErrorCode::wrong_shape, path, "/error_mm does not have the shape of the grid");
  StereoScores scores;
  scores.path = path;
  scores.pixel_size = std::strtod(file.attribute("pixel_size_mm").c_str(), nullptr) * unit::mm;
  std::vector<Vec3d> error, sigma;
  for (std::size_t node = 0; node < field.size(); ++node) {
    error.push_back(unit::mm * Vec3d{values[3 * node], values[3 * node + 1], values[3 * node + 2]});
    sigma.push_back(unit::mm * field.sigma_mm[node]);
    bool const valid = field.status[node] == VectorStatus::valid;
    if (!valid && !std::isfinite(field.displacement_mm[node].x)) continue;  // not determined
    bool const gross = is_gross(error[node], scores.pixel_size);
    scores.valid += valid ? 1 : 0;
    scores.rejected += valid ? 0 : 1;
    scores.gross += valid && gross ? 1 : 0;
    scores.gross_rejected += !valid && gross ? 1 : 0;
  }
  scores.errors = compute_component_errors(error, sigma, field.status);
  return scores;
}

nlohmann::ordered_json summarize_scores(StereoScores const& scores) {
  nlohmann::ordered_json json{{"file", scores.path},   {"pixel_size_mm", scores.pixel_size / unit::mm},
                              {"valid", scores.valid}, {"rejected", scores.rejected},
                              {"gross", scores.gross}, {"gross_rejected", scores.gross_rejected}};
  for (ResultGroup const& group : error_groups(scores.errors, scores.pixel_size))
    json["error"][group.name] = rows_json(group.rows);
  return json;
}

std::string scores_report(StereoScores const& scores) {
  std::string text = fmt::format(
      "Three components of {}: {} vectors valid, {} rejected; errors above {:g} px: {} of the valid, {} of "
      "the rejected\n",
      scores.path, scores.valid, scores.rejected, gross_error_px, scores.gross, scores.gross_rejected);
  text += groups_text("error", error_groups(scores.errors, scores.pixel_size));
  return text + fmt::format(
                    "  (px of {:.4g} mm on the sheet; truth: mean of the particles in the window, over the thickness "
                    "of the sheet; coverage: fraction of the errors within one sigma, normal distribution: 0.683)\n",
                    scores.pixel_size / unit::mm);
}

}  // namespace gladstone::inline compare
