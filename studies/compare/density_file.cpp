#include "studies/compare/density_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "analysis/errors/error_summary.h"
#include "render/files/hdf5_file.h"
#include "studies/case/flat_values.h"
#include "studies/case/result_rows.h"
#include "studies/compare/density_table.h"

namespace gladstone::inline compare {
namespace {

std::vector<double> select_finite(std::vector<double> const& values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return finite;
}

ResultRow density_row(std::string key, std::string label, double value) {
  return plain_row(std::move(key), std::move(label), value, "kg/m^3");
}

/// Returns the least, median and largest of the finite values; NaN without any.
std::vector<ResultRow> range_rows(std::string const& label, std::vector<double> const& values) {
  std::vector<double> const finite = select_finite(values);
  return {density_row("least", label + ", least", quantile(finite, 0.0)),
          density_row("median", label + ", median", quantile(finite, 0.5)),
          density_row("largest", label + ", largest", quantile(finite, 1.0))};
}

std::vector<ResultRow> axis_rows(AxisymmetryResult const& flow) {
  char const* const note = std::isfinite(flow.asymmetry) ? "" : "one side of the axis is measured";
  return {plain_row("position_mm", "position of the axis", 1e3 * flow.axis.position, "mm"),
          plain_row("sigma_mm", "position of the axis, standard uncertainty", 1e3 * flow.axis.sigma, "mm"),
          plain_row("lambda", "regularisation parameter", flow.lambda),
          plain_row("asymmetry", "asymmetry of the gradient", flow.asymmetry, "", note),
          plain_row("border_gradient", "gradient at the border over that of all radii", flow.border_gradient)};
}

std::vector<ResultRow> density_error_rows(DensityErrors const& errors) {
  return {count_row("count", "nodes with a true density", errors.count),
          density_row("bias", "error, bias", errors.bias),
          density_row("rms", "error, rms", errors.rms),
          density_row("largest", "error, largest", errors.largest),
          density_row("contrast", "standard deviation of the true density", errors.contrast),
          plain_row("coverage", "fraction of the errors within one sigma", errors.coverage, "",
                    "normal distribution: 0.683")};
}

/// Returns the quantities other than the causes of the error.
std::vector<ResultRow> density_rows(Reconstruction const& reconstruction) {
  std::vector<ResultRow> rows{
      count_row("columns", "columns", reconstruction.grid.columns), count_row("rows", "rows", reconstruction.grid.rows),
      count_row("determined", "nodes with a density", select_finite(reconstruction.density).size())};
  append_rows(rows, range_rows("density", reconstruction.density), "density_kg_m3");
  append_rows(rows, range_rows("standard uncertainty", reconstruction.sigma), "sigma_kg_m3");
  append_rows(rows, range_rows("standard uncertainty due to the vectors", reconstruction.sigma_random),
              "sigma_random_kg_m3");
  rows.push_back(density_row("reference_density_kg_m3", "reference density", reconstruction.reference_density));
  rows.push_back(plain_row("white_noise_gain", "amplification of white noise by the deconvolution",
                           reconstruction.white_noise_gain));
  if (reconstruction.axisymmetry) append_rows(rows, axis_rows(*reconstruction.axisymmetry), "axis");
  if (!reconstruction.truth.empty())
    append_rows(rows, density_error_rows(compute_density_errors(reconstruction)), "error_kg_m3");
  return rows;
}

/// Returns the causes of the error.
std::vector<ResultGroup> cause_groups(Reconstruction const& reconstruction) {
  std::vector<ResultGroup> groups;
  for (DensityTerm const& term : reconstruction.budget)
    groups.push_back({term.name, {density_row("bias", "bias", term.bias), density_row("rms", "rms", term.rms)}});
  return groups;
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

std::vector<ResultRow> reconstruction_rows(Reconstruction const& reconstruction) {
  std::vector<ResultRow> rows = density_rows(reconstruction);
  for (ResultGroup const& group : cause_groups(reconstruction))
    append_rows(rows, group.rows, "budget_kg_m3." + group.name);
  return rows;
}

nlohmann::ordered_json summarize_reconstruction(Reconstruction const& reconstruction) {
  nlohmann::ordered_json json{{"vectors", reconstruction.vectors}};
  json.update(rows_json(reconstruction_rows(reconstruction)));
  if (reconstruction.axisymmetry) json["axis"]["direction"] = direction_name(reconstruction.axisymmetry->direction);
  return json;
}

std::string reconstruction_report(Reconstruction const& reconstruction) {
  std::string text = "Density";
  if (reconstruction.axisymmetry)
    text += fmt::format(", symmetric about a {} axis", direction_name(reconstruction.axisymmetry->direction));
  text += '\n' + rows_text(density_rows(reconstruction));
  if (!reconstruction.budget.empty()) text += groups_text("cause", cause_groups(reconstruction), 3);
  return text;
}

}  // namespace gladstone::inline compare
