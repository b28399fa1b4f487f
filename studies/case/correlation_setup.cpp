#include "studies/case/correlation_setup.h"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/correlator.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/uncertainty/uncertainty.h"

namespace gladstone::inline cases {
namespace {

TrackingTable read_tracking_table(SetupTable table) {
  TrackingTable tracking;
  tracking.diameter_px = table.number_or_auto("diameter_px", Range::positive(64.0));
  tracking.polarity = table.word("polarity", tracking.polarity, {"auto", "bright", "dark"});
  tracking.shape = table.word("shape", tracking.shape, {"round", "elliptic"});
  tracking.search_radius_px = table.number_or_auto("search_radius_px", Range::positive(512.0));
  tracking.displacement_bound_px =
      table.number_or_word("displacement_bound_px", {{}, "none"}, {"none", "off"}, Range::positive(512.0)).number;
  tracking.output = table.word("output", tracking.output, {"grid", "scattered"});
  return tracking;
}

}  // namespace

CorrelationSettings read_correlation_settings(SetupTable table, PreparedSet set) {
  CorrelationSettings settings;
  std::vector<long long> const fallback(settings.window_px.begin(), settings.window_px.end());
  std::vector<long long> const windows = table.integers("window_px", fallback, 1, 10, 4, 512);
  settings.window_px.assign(windows.begin(), windows.end());
  if (std::any_of(windows.begin(), windows.end(), [](long long w) { return w % 2 != 0; }))
    table.problem("window_px",
                  "an odd window size (the weights extend over twice the window and must begin at a whole pixel); use "
                  "even sizes");
  if (!std::is_sorted(windows.rbegin(), windows.rend()))
    table.problem("window_px",
                  "a window larger than that of the previous pass (each pass refines the previous one); order them "
                  "from large to small");
  settings.overlap = table.number("overlap", settings.overlap, Range::at_least(0.0, 0.95));
  settings.method = table.word("method", settings.method, correlation_methods());
  settings.subpixel = table.word("subpixel", settings.subpixel, subpixel_fits());
  settings.weighting = table.word("weighting", settings.weighting, {"gaussian", "uniform"});
  settings.deformation = table.word("deformation", settings.deformation, {"cubic", "quintic", "sinc"});
  settings.final_passes = static_cast<int>(table.integer("final_passes", settings.final_passes, 1, 5));
  settings.steep_passes = static_cast<int>(table.integer("steep_passes", settings.steep_passes, 0, 20));
  settings.max_displacement_px =
      table.number_or_word("max_displacement_px", {{}, "none"}, {"none", "off"}, Range::positive(512.0)).number;
  settings.median_threshold =
      table.number_or_word("median_threshold", {settings.median_threshold, {}}, {"off"}, Range::positive()).number;
  settings.median_epsilon_px = table.number("median_epsilon_px", settings.median_epsilon_px, Range::positive());
  settings.displacement_threshold =
      table.number_or_word("displacement_threshold", {settings.displacement_threshold, {}}, {"off"}, Range::positive())
          .number;
  settings.trusted_peak_ratio = table
                                    .number_or_word("trusted_peak_ratio", {settings.trusted_peak_ratio, {}},
                                                    {"none", "off"}, Range::at_least(1.0))
                                    .number;
  std::vector<std::string> estimators = uncertainty_methods();
  estimators.insert(estimators.begin(), {"auto", "none"});
  settings.uncertainty = table.word("uncertainty", "auto", estimators);
  settings.least_peak_ratio =
      table.number_or_word("least_peak_ratio", {{}, "off"}, {"off"}, Range::at_least(1.0)).number;
  settings.least_correlation =
      table.number_or_word("least_correlation", {{}, "off"}, {"off"}, Range::at_least(0.0, 1.0)).number;
  settings.replace = table.boolean("replace", settings.replace);
  bool const tracks_dots = correlation_method(settings.method).tracks_dots;
  if (tracks_dots && settings.estimates_uncertainty())
    table.problem("uncertainty",
                  fmt::format("conflicts with method = \"{}\" (which estimates the uncertainty from the fit of each "
                              "dot); use \"auto\"",
                              settings.method));
  if (tracks_dots || table.has("tracking")) settings.tracking = read_tracking_table(table.table("tracking"));
  settings.preparation = read_frame_preparation(table, set);
  return settings;
}

}  // namespace gladstone::inline cases
