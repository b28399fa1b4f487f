#include "analysis/correlation/optical_flow/optical_flow_correlator.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "analysis/correlation/standard_correlator.h"

namespace gladstone::inline correlation {
namespace {

/// Returns a warning listing the settings that differ from their defaults but have no effect on optical flow.
std::optional<Warning> unheeded(CorrelationSettings const& settings) {
  CorrelationSettings const usual;
  std::vector<char const*> keys;
  auto const note = [&](char const* key, bool as_usual) {
    if (!as_usual) keys.push_back(key);
  };
  note("subpixel", settings.subpixel == usual.subpixel);
  note("weighting", settings.weighting == usual.weighting);
  note("deformation", settings.deformation == usual.deformation);
  note("final_passes", settings.final_passes == usual.final_passes);
  note("steep_passes", settings.steep_passes == usual.steep_passes);
  note("median_threshold", settings.median_threshold == usual.median_threshold);
  note("median_epsilon_px", settings.median_epsilon_px == usual.median_epsilon_px);
  note("displacement_threshold", settings.displacement_threshold == usual.displacement_threshold);
  note("trusted_peak_ratio", settings.trusted_peak_ratio == usual.trusted_peak_ratio);
  note("least_peak_ratio", settings.least_peak_ratio == usual.least_peak_ratio);
  note("least_correlation", settings.least_correlation == usual.least_correlation);
  note("replace", settings.replace == usual.replace);
  if (keys.empty()) return {};
  return Warning{WarningCode::ignored, "correlate.method",
                 fmt::format("\"{}\" ignores correlate.{} (optical flow has no correlation peaks, and its vectors are "
                             "not validated); remove these settings",
                             settings.method, fmt::join(keys, ", correlate."))};
}

class OpticalFlowCorrelator final : public Correlator {
 public:
  OpticalFlowCorrelator(CorrelationSettings const& settings, EstimateFlow estimate)
      : settings_(settings), estimate_(estimate) {}

  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    check_image_sizes(settings_, reference.columns(), reference.rows(), flow.columns(), flow.rows());
    ImagePair const pair = make_image_pair(reference, flow);
    InterrogationGrid const grid = final_grid(settings_, pair.columns, pair.rows);
    bool const any_contrast = pair.contrast > 0.0f;
    DenseFlow dense(pair.columns, pair.rows);
    auto const grey = [&](auto const& values) {
      return GreyImage{pair.columns, pair.rows, {values.begin(), values.end()}};
    };
    if (any_contrast) dense = estimate_(grey(pair.reference), grey(pair.flow));
    double const limit = CorrelationSchedule(settings_).limit_px(), nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<MeasuredVector> vectors(grid.size());
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      Vec2d const value = dense.at(grid.centre(i));
      MeasuredVector& vector = vectors[i];
      vector = {value, value, nan, nan, VectorStatus::valid, VectorReason::measured, FailedTest::none, Ambiguity::none};
      auto const reject_vector = [&](VectorStatus status, VectorReason reason) {
        vector.displacement = vector.raw = {nan, nan};
        vector.status = status;
        vector.reason = reason;
      };
      if (valid_pixel_fraction(pair, grid, i) < min_valid_weight_fraction)
        reject_vector(VectorStatus::masked, VectorReason::masked);
      else if (!has_signal(pair, pair.reference, grid, i) || !has_signal(pair, pair.flow, grid, i))
        reject_vector(VectorStatus::invalid, VectorReason::no_signal);
      else if (!is_within(value, limit))
        reject_vector(VectorStatus::invalid, VectorReason::beyond_limit);
    }
    DisplacementField field = displacement_field(grid, vectors);
    if (auto const warning = unheeded(settings_)) field.warnings.push_back(*warning);
    return field;
  }

 private:
  static Vec2<int> first_pixel(InterrogationGrid const& grid, std::size_t vector) {
    Vec2d const centre = grid.centre(vector);
    double const half = 0.5 * (grid.window_px - 1);
    return {static_cast<int>(std::lround(centre.x - half)), static_cast<int>(std::lround(centre.y - half))};
  }

  /// Returns whether a window of one frame has contrast, by the criterion of plane_scale().
  static bool has_signal(ImagePair const& pair, UninitializedVector<float> const& frame, InterrogationGrid const& grid,
                         std::size_t vector) {
    auto const [x, y] = first_pixel(grid, vector);
    double sum = 0.0, squares = 0.0;
    for (int j = y; j < y + grid.window_px; ++j)
      for (int i = x; i < x + grid.window_px; ++i) {
        double const level = frame[static_cast<std::size_t>(j) * pair.columns + i];
        sum += level;
        squares += level * level;
      }
    double const pixels = static_cast<double>(grid.window_px) * grid.window_px, mean = sum / pixels;
    return squares / pixels - mean * mean > std::pow(smallest_contrast * pair.contrast, 2);
  }

  /// Returns the fraction of the pixels of a nominal window that are known in both frames.
  static double valid_pixel_fraction(ImagePair const& pair, InterrogationGrid const& grid, std::size_t vector) {
    if (pair.available.empty()) return 1.0;
    auto const [x, y] = first_pixel(grid, vector);
    double known = 0.0;
    for (int j = y; j < y + grid.window_px; ++j)
      for (int i = x; i < x + grid.window_px; ++i)
        known += pair.available[static_cast<std::size_t>(j) * pair.columns + i];
    return known / (static_cast<double>(grid.window_px) * grid.window_px);
  }

  CorrelationSettings settings_;
  EstimateFlow estimate_;
};

}  // namespace

std::unique_ptr<Correlator> make_optical_flow_correlator(CorrelationSettings const& settings, EstimateFlow estimate) {
  return std::make_unique<OpticalFlowCorrelator>(settings, estimate);
}

}  // namespace gladstone::inline correlation
