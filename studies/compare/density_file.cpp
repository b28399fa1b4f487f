#include "studies/compare/density_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "analysis/errors/error_summary.h"
#include "render/base/not_a_number.h"
#include "render/files/hdf5_file.h"
#include "studies/case/flat_values.h"
#include "studies/case/json_text.h"
#include "studies/compare/density_table.h"

namespace gladstone::inline compare {
namespace {

std::vector<double> select_finite(std::vector<double> const& values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return finite;
}

/// Least, median and largest of the finite values; NaN without any.
struct ValueRange {
  std::size_t count = 0;
  double least = not_a_number, median = not_a_number, largest = not_a_number;
};

ValueRange find_range(std::vector<double> const& values) {
  std::vector<double> const finite = select_finite(values);
  if (finite.empty()) return {};
  auto const [least, largest] = std::minmax_element(finite.begin(), finite.end());
  return {finite.size(), *least, quantile(finite, 0.5), *largest};
}

nlohmann::ordered_json range_json(ValueRange const& range) {
  return {{"least", number_or_null(range.least)},
          {"median", number_or_null(range.median)},
          {"largest", number_or_null(range.largest)}};
}

char const* direction_name(density::AxisDirection direction) {
  return direction == density::AxisDirection::vertical ? "vertical" : "horizontal";
}

void write_attributes(Hdf5Writer& file, Reconstruction const& reconstruction) {
  file.attribute("/", "reference_density_kg_m3", reconstruction.reference_density);
  file.attribute("/", "window_overlap_x", reconstruction.overlap.x);
  file.attribute("/", "window_overlap_y", reconstruction.overlap.y);
  file.attribute("/", "white_noise_gain", reconstruction.white_noise_gain);
  file.attribute("/", "samples", static_cast<std::int64_t>(reconstruction.samples));
  file.attribute("/", "axisymmetric", std::int64_t{reconstruction.axisymmetry ? 1 : 0});
  if (!reconstruction.axisymmetry) return;
  AxisymmetryResult const& flow = *reconstruction.axisymmetry;
  file.attribute("/", "axis_direction", std::string(direction_name(flow.direction)));
  file.attribute("/", "axis_mm", 1e3 * flow.axis.position);
  file.attribute("/", "axis_sigma_mm", 1e3 * flow.axis.sigma);
  file.attribute("/", "lambda", flow.lambda);
  file.attribute("/", "asymmetry", flow.asymmetry);
  file.attribute("/", "border_gradient", flow.border_gradient);
}

}  // namespace

void write_density(std::string const& path, Reconstruction const& reconstruction) {
  FileOrigin const origin{"gladstone density", 1,     reconstruction.setup,
                          reconstruction.seed, "cpu", reconstruction.sources};
  GridTable table = make_density_table(reconstruction);
  if (!path.ends_with(".h5")) {
    add_gradient_columns(table, reconstruction.gradient);
    return write_grid_table(path, table, origin);
  }
  Hdf5Writer file(path, origin);
  Hdf5Axes axes(file);
  write_grid_datasets(file, axes, table, "row (y upwards), column (x)");
  axes.write_numbers("/component", 2, "d/dx, d/dy");
  file.write(
      "/gradient_kg_m4", flat(reconstruction.gradient),
      {table.axes[0].place_mm.size(), table.axes[1].place_mm.size(), 2}, "kg/m^4",
      reconstruction.axisymmetry ? "differences of the density" : "measured density gradient, mean over the thickness",
      "row (y upwards), column (x), component (d/dx, d/dy)");
  axes.name("/gradient_kg_m4", {"/y_mm", "/x_mm", "/component"});
  axes.attach();
  write_attributes(file, reconstruction);
  file.close();
}

nlohmann::ordered_json summarize_reconstruction(Reconstruction const& reconstruction) {
  ValueRange const density = find_range(reconstruction.density);
  nlohmann::ordered_json json{{"vectors", reconstruction.vectors},
                              {"columns", reconstruction.grid.columns},
                              {"rows", reconstruction.grid.rows},
                              {"determined", density.count},
                              {"density_kg_m3", range_json(density)},
                              {"sigma_kg_m3", range_json(find_range(reconstruction.sigma))},
                              {"sigma_random_kg_m3", range_json(find_range(reconstruction.sigma_random))},
                              {"reference_density_kg_m3", reconstruction.reference_density},
                              {"white_noise_gain", reconstruction.white_noise_gain}};
  if (reconstruction.axisymmetry) {
    AxisymmetryResult const& flow = *reconstruction.axisymmetry;
    json["axis"] = {
        {"direction", direction_name(flow.direction)},       {"position_mm", 1e3 * flow.axis.position},
        {"sigma_mm", number_or_null(1e3 * flow.axis.sigma)}, {"lambda", flow.lambda},
        {"asymmetry", number_or_null(flow.asymmetry)},       {"border_gradient", number_or_null(flow.border_gradient)}};
  }
  if (!reconstruction.truth.empty()) {
    DensityErrors const errors = compute_density_errors(reconstruction);
    json["error_kg_m3"] = {{"count", errors.count},
                           {"bias", number_or_null(errors.bias)},
                           {"rms", number_or_null(errors.rms)},
                           {"largest", number_or_null(errors.largest)},
                           {"contrast", number_or_null(errors.contrast)},
                           {"coverage", number_or_null(errors.coverage)}};
  }
  for (DensityTerm const& term : reconstruction.budget)
    json["budget_kg_m3"][term.name] = {{"bias", number_or_null(term.bias)}, {"rms", number_or_null(term.rms)}};
  return json;
}

std::string reconstruction_report(Reconstruction const& reconstruction) {
  ValueRange const density = find_range(reconstruction.density), sigma = find_range(reconstruction.sigma);
  std::string text = fmt::format("Density at {} of {} x {} nodes: {:.5g} to {:.5g} kg/m^3, median {:.5g} kg/m^3\n",
                                 density.count, reconstruction.grid.columns, reconstruction.grid.rows, density.least,
                                 density.largest, density.median);
  if (sigma.count > 0)
    text += fmt::format("  standard uncertainty: median {:.3g} kg/m^3, largest {:.3g} kg/m^3\n", sigma.median,
                        sigma.largest);
  if (reconstruction.axisymmetry) {
    AxisymmetryResult const& flow = *reconstruction.axisymmetry;
    text += fmt::format("  {} axis at {} = {:.4f} mm{}{}\n", direction_name(flow.direction),
                        flow.direction == density::AxisDirection::vertical ? "x" : "y", 1e3 * flow.axis.position,
                        std::isfinite(flow.axis.sigma) ? fmt::format(" +- {:.2g} mm", 1e3 * flow.axis.sigma) : "",
                        std::isfinite(flow.asymmetry)
                            ? fmt::format("; asymmetry of the gradient {:.1f} %", 100.0 * flow.asymmetry)
                            : ", of which one side is measured");
    if (flow.lambda > 0.0) text += fmt::format("  regularisation parameter {:.3g}\n", flow.lambda);
  }
  if (reconstruction.white_noise_gain != 1.0)
    text += fmt::format("  the deconvolution amplifies white noise by {:.2f}\n", reconstruction.white_noise_gain);
  if (!reconstruction.truth.empty()) {
    DensityErrors const errors = compute_density_errors(reconstruction);
    text += fmt::format(
        "  error against the true density: bias {:.3g}, rms {:.3g}, largest {:.3g} kg/m^3 (the true density varies by "
        "{:.3g} kg/m^3, standard deviation)\n",
        errors.bias, errors.rms, errors.largest, errors.contrast);
    if (std::isfinite(errors.coverage))
      text +=
          fmt::format("  {:.1f} % of the errors lie within one standard uncertainty (normal distribution: 68.3 %)\n",
                      100.0 * errors.coverage);
  }
  if (!reconstruction.budget.empty())
    text += fmt::format("  {:<28} {:>10} {:>10}\n", "causes of the error [kg/m^3]", "bias", "rms");
  for (DensityTerm const& term : reconstruction.budget)
    text += fmt::format("  {:<28} {:>10.3g} {:>10.3g}\n", term.name, term.bias, term.rms);
  return text;
}

}  // namespace gladstone::inline compare
