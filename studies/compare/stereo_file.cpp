#include "studies/compare/stereo_file.h"

#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>

#include "analysis/errors/error_summary.h"
#include "analysis/stereo/residual_validation.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "render/files/hdf5_axes.h"
#include "render/files/hdf5_file.h"
#include "studies/case/result_rows.h"
#include "studies/compare/stereo_scores.h"

namespace gladstone::inline compare {
namespace {

using StereoNode = std::optional<stereo::StereoVector>;
constexpr std::array<char const*, 3> component_names{"u", "v", "w"};

/// Writes datasets with the nodes of the grid as first axes.
class NodeWriter {
 public:
  NodeWriter(Hdf5Writer& file, stereo::StereoField const& field) : file_(file), axes_(file), field_(field) {
    axes_.write_numbers("/component", 3, "u, v, w along X, Y, Z");
    axes_.write_numbers("/covariance_entry", 6, "uu, vv, ww, uv, uw, vw");
    axes_.write_numbers("/image_component", 4, "u of camera A, v of camera A, u of camera B, v of camera B");
  }

  /// @param width  number of values of each node; 1: no third axis
  /// @param value  returns the value of a determined node; the others are NaN
  void write(char const* dataset, std::size_t width, char const* units, char const* description,
             std::string const& third_axis,
             std::function<double(stereo::StereoVector const&, std::size_t)> const& value) {
    std::vector<double> values;
    values.reserve(width * field_.nodes.size());
    for (StereoNode const& node : field_.nodes)
      for (std::size_t k = 0; k < width; ++k) values.push_back(node ? value(*node, k) : not_a_number);
    write_values(dataset, values, width, units, description, third_axis);
  }

  void write_values(char const* dataset, std::vector<double> const& values, std::size_t width, char const* units,
                    char const* description, std::string const& third_axis) {
    std::vector<std::size_t> shape{static_cast<std::size_t>(field_.grid.rows),
                                   static_cast<std::size_t>(field_.grid.columns)};
    if (width > 1) shape.push_back(width);
    std::string const axes = "row (y upwards), column (x)";
    file_.write(dataset, std::span<double const>(values), shape, units, description,
                width > 1 ? axes + ", " + third_axis : axes);
    std::vector<std::string> names{"/y_mm", "/x_mm"};
    if (width > 1)
      names.emplace_back(width == 3 ? "/component" : width == 4 ? "/image_component" : "/covariance_entry");
    axes_.name(dataset, names);
  }

  void write_status() {
    std::vector<std::int64_t> status;
    for (StereoNode const& node : field_.nodes)
      status.push_back(static_cast<std::int64_t>(node ? node->status : VectorStatus::invalid));
    file_.write("/status", std::span<std::int64_t const>(status),
                {static_cast<std::size_t>(field_.grid.rows), static_cast<std::size_t>(field_.grid.columns)}, "1",
                "0 valid, 3 invalid: not determined (displacement NaN), or the residual exceeds its limit",
                "row (y upwards), column (x)");
    axes_.name("/status", {"/y_mm", "/x_mm"});
  }

  void attach_axes() { axes_.attach(); }

 private:
  Hdf5Writer& file_;
  Hdf5Axes axes_;
  stereo::StereoField const& field_;
};

constexpr char const* component_axis = "component (u, v, w)";

double pick_component(Vec3d const& vector, std::size_t k) { return vector[static_cast<int>(k)]; }

void write_node_positions(Hdf5Writer& file, stereo::NodeGrid const& grid) {
  std::vector<double> x_mm, y_mm;
  for (int i = 0; i < grid.columns; ++i) x_mm.push_back((grid.first.x + i * grid.spacing) / unit::mm);
  for (int j = 0; j < grid.rows; ++j) y_mm.push_back((grid.first.y + j * grid.spacing) / unit::mm);
  file.write("/x_mm", std::span<double const>(x_mm), {x_mm.size()}, "mm", "X of the nodes in the world frame",
             "column");
  file.write("/y_mm", std::span<double const>(y_mm), {y_mm.size()}, "mm", "Y of the nodes in the world frame", "row");
}

void write_stereo_truth(NodeWriter& nodes, StereoMeasurement const& measurement) {
  std::vector<double> truth, error;
  for (std::size_t i = 0; i < measurement.truth.size(); ++i) {
    StereoNode const& node = measurement.field.nodes[i];
    for (std::size_t k = 0; k < 3; ++k) {
      double const value = pick_component(measurement.truth[i], k);
      truth.push_back(value / unit::mm);
      error.push_back(node ? (pick_component(node->displacement, k) - value) / unit::mm : not_a_number);
    }
  }
  nodes.write_values("/truth_mm", truth, 3, "mm", "true displacement, mean over the particles in the window",
                     component_axis);
  nodes.write_values("/error_mm", error, 3, "mm", "displacement minus true displacement", component_axis);
}

/// @pre the measurement has an alignment
std::vector<ResultRow> alignment_rows(StereoMeasurement const& measurement) {
  stereo::SheetAlignment const& alignment = *measurement.alignment;
  stereo::FittedPlane const& fit = alignment.fit;
  char const* const note = measurement.is_aligned()    ? ""
                           : alignment.has_converged() ? "not significant: the given sheet is used"
                                                       : "not converged: the given sheet is used";
  return {plain_row("z_mm", "laser sheet, Z at X = Y = 0", fit.plane.height / unit::mm, "mm", note),
          plain_row("z_sigma_mm", "standard uncertainty of Z", fit.height_sigma / unit::mm, "mm"),
          plain_row("slope.0", "laser sheet, dZ/dX", fit.plane.slope.x),
          plain_row("slope.1", "laser sheet, dZ/dY", fit.plane.slope.y),
          plain_row("slope_sigma.0", "standard uncertainty of dZ/dX", fit.slope_sigma.x),
          plain_row("slope_sigma.1", "standard uncertainty of dZ/dY", fit.slope_sigma.y),
          plain_row("disparity_px", "disparity for the given sheet", alignment.disparity_px.front(), "px"),
          plain_row("disparity_sigma_px", "standard uncertainty of the disparity", alignment.disparity_sigma_px, "px"),
          plain_row("residual_px", "disparity after the correction", alignment.disparity_px.back(), "px"),
          plain_row("scatter_px", "scatter of the disparities", alignment.scatter_px, "px"),
          count_row("iterations", "iterations of the sheet", alignment.disparity_px.size()),
          count_row("vectors", "disparities of the last fit", fit.points),
          count_row("outliers", "outliers of the last fit", fit.outliers)};
}

std::vector<ResultRow> given_sheet_rows(stereo::SheetAlignment const& sheet) {
  return {plain_row("disparity_px", "disparity for the given sheet", sheet.disparity_px.front(), "px"),
          plain_row("disparity_sigma_px", "standard uncertainty of the disparity", sheet.disparity_sigma_px, "px"),
          plain_row("scatter_px", "scatter of the disparities", sheet.scatter_px, "px")};
}

void write_stereo_attributes(Hdf5Writer& file, StereoMeasurement const& measurement) {
  file.attribute("/", "sheet_z_mm", measurement.field.plane.height / unit::mm);
  file.attribute("/", "sheet_slope_x", measurement.field.plane.slope.x);
  file.attribute("/", "sheet_slope_y", measurement.field.plane.slope.y);
  file.attribute("/", "pixel_size_mm", measurement.pixel_size / unit::mm);
  file.attribute("/", "view_angle_deg", measurement.view_angle / unit::degree);
  file.attribute("/", "window_a_px", measurement.window_px[0]);
  file.attribute("/", "window_b_px", measurement.window_px[1]);
  auto const& sheet = measurement.alignment ? measurement.alignment : measurement.given_sheet;
  if (!sheet) return;
  file.attribute("/", "disparity_px", sheet->disparity_px.front());
  file.attribute("/", "disparity_sigma_px", sheet->disparity_sigma_px);
  if (!measurement.is_aligned()) return;
  file.attribute("/", "residual_disparity_px", sheet->disparity_px.back());
  file.attribute("/", "sheet_z_sigma_mm", sheet->fit.height_sigma / unit::mm);
  file.attribute("/", "sheet_slope_x_sigma", sheet->fit.slope_sigma.x);
  file.attribute("/", "sheet_slope_y_sigma", sheet->fit.slope_sigma.y);
}

/// Statistics of one component over the valid nodes [m].
struct ComponentStatistics {
  std::size_t count = 0;
  double mean = not_a_number, deviation = not_a_number;
  double sigma = not_a_number;  ///< median standard uncertainty; NaN: vectors without uncertainty
};

bool is_valid(StereoNode const& node) { return node && node->status == VectorStatus::valid; }

ComponentStatistics find_component_statistics(stereo::StereoField const& field, std::size_t k) {
  ComponentStatistics statistics;
  double sum = 0.0, squares = 0.0;
  std::vector<double> sigma;
  for (StereoNode const& node : field.nodes) {
    if (!is_valid(node)) continue;
    ++statistics.count;
    sum += pick_component(node->displacement, k);
    if (double const one = pick_component(node->sigma(), k); std::isfinite(one)) sigma.push_back(one);
  }
  if (statistics.count == 0) return statistics;
  auto const count = static_cast<double>(statistics.count);
  statistics.mean = sum / count;
  for (StereoNode const& node : field.nodes)
    if (is_valid(node)) squares += std::pow(pick_component(node->displacement, k) - statistics.mean, 2);
  statistics.deviation = std::sqrt(squares / count);
  if (!sigma.empty()) statistics.sigma = quantile(sigma, 0.5);
  return statistics;
}

/// Returns the statistics of u, v and w.
std::vector<ResultGroup> component_groups(stereo::StereoField const& field) {
  std::vector<ResultGroup> groups;
  for (std::size_t k = 0; k < 3; ++k) {
    ComponentStatistics const one = find_component_statistics(field, k);
    groups.push_back({component_names[k],
                      {{.key = "mean_mm", .label = "mean", .value = one.mean / unit::mm, .unit = "mm"},
                       {.key = "deviation_mm", .label = "deviation", .value = one.deviation / unit::mm, .unit = "mm"},
                       {.key = "sigma_mm", .label = "sigma", .value = one.sigma / unit::mm, .unit = "mm"}}});
  }
  return groups;
}

double find_median_residual(stereo::StereoField const& field) {
  std::vector<double> residuals;
  for (StereoNode const& node : field.nodes)
    if (node) residuals.push_back(node->residual_px);
  return quantile(residuals, 0.5);
}

/// Returns the quantities other than those of a component.
std::vector<ResultRow> measurement_rows(StereoMeasurement const& measurement) {
  stereo::StereoField const& field = measurement.field;
  std::vector<ResultRow> rows{
      count_row("columns", "columns", field.grid.columns),
      count_row("rows", "rows", field.grid.rows),
      count_row("determined", "nodes with a valid displacement", find_component_statistics(field, 0).count),
      count_row("rejected", "nodes with a large residual", stereo::count_rejected(field)),
      plain_row("spacing_mm", "spacing", field.grid.spacing / unit::mm, "mm"),
      plain_row("pixel_size_mm", "size of a pixel on the sheet", measurement.pixel_size / unit::mm, "mm"),
      plain_row("view_angle_deg", "angle between the views", measurement.view_angle / unit::degree, "deg"),
      plain_row("residual_px", "residual of the four equations, median", find_median_residual(field), "px"),
      plain_row("residual_ratio", "residual over its standard uncertainty, rms", compute_residual_ratio(field))};
  if (measurement.alignment) append_rows(rows, alignment_rows(measurement), "sheet");
  if (measurement.given_sheet) append_rows(rows, given_sheet_rows(*measurement.given_sheet), "given_sheet");
  return rows;
}

/// Returns the errors of u, v and w; none without the true displacement.
std::vector<ResultGroup> truth_groups(StereoMeasurement const& measurement) {
  if (measurement.truth.empty()) return {};
  return error_groups(compute_stereo_errors(measurement), measurement.pixel_size);
}

}  // namespace

void write_stereo(std::string const& path, StereoMeasurement const& measurement) {
  Hdf5Writer file(path, {"gladstone stereo", 1, measurement.setup, measurement.seed, "cpu", measurement.sources});
  using stereo::StereoVector;
  NodeWriter nodes(file, measurement.field);
  write_node_positions(file, measurement.field.grid);
  nodes.write("/displacement_mm", 3, "mm",
              "displacement from frame A to frame B along X, Y, Z of the world; NaN: not determined", component_axis,
              [](StereoVector const& v, std::size_t k) { return pick_component(v.displacement, k) / unit::mm; });
  nodes.write("/sigma_mm", 3, "mm", "standard uncertainty: vectors and calibrations; NaN: vectors without uncertainty",
              component_axis,
              [](StereoVector const& v, std::size_t k) { return pick_component(v.sigma(), k) / unit::mm; });
  nodes.write("/sigma_calibration_mm", 3, "mm", "the part of the uncertainty that is due to the calibrations",
              component_axis,
              [](StereoVector const& v, std::size_t k) { return std::sqrt(v.from_calibration[k]) / unit::mm; });
  nodes.write("/covariance_mm2", 6, "mm^2", "covariance of the displacement", "uu, vv, ww, uv, uw, vw",
              [](StereoVector const& v, std::size_t k) { return v.covariance[k] / (unit::mm * unit::mm); });
  nodes.write("/residual_px", 1, "px", "root of the sum of squares of the residuals of the four equations", "",
              [](StereoVector const& v, std::size_t) { return v.residual_px; });
  nodes.write("/residual_ratio", 1, "1", "residual divided by its standard uncertainty; NaN: vectors without it", "",
              [](StereoVector const& v, std::size_t) { return v.residual_ratio; });
  nodes.write("/image_displacement_px", 4, "px", "vectors of both cameras, interpolated at the node",
              "u of camera A, v of camera A, u of camera B, v of camera B", [](StereoVector const& v, std::size_t k) {
                return std::array{v.image_a_px.x, v.image_a_px.y, v.image_b_px.x, v.image_b_px.y}[k];
              });
  nodes.write_status();
  if (!measurement.truth.empty()) write_stereo_truth(nodes, measurement);
  write_stereo_attributes(file, measurement);
  nodes.attach_axes();
  file.close();
}

std::vector<ResultRow> stereo_rows(StereoMeasurement const& measurement) {
  std::vector<ResultRow> rows = measurement_rows(measurement);
  for (ResultGroup const& group : component_groups(measurement.field)) append_rows(rows, group.rows, group.name);
  for (ResultGroup const& group : truth_groups(measurement)) append_rows(rows, group.rows, "error." + group.name);
  return rows;
}

nlohmann::ordered_json summarize_stereo(StereoMeasurement const& measurement) {
  nlohmann::ordered_json json{{"vectors", measurement.vectors}, {"calibrations", measurement.calibrations}};
  json.update(rows_json(stereo_rows(measurement)));
  if (measurement.alignment) json["sheet"]["used"] = measurement.is_aligned();
  return json;
}

std::string stereo_report(StereoMeasurement const& measurement) {
  std::string const text = "Displacement in three components\n" + rows_text(measurement_rows(measurement)) +
                           groups_text("component", component_groups(measurement.field));
  if (measurement.truth.empty()) return text;
  return text + groups_text("error", truth_groups(measurement)) +
         "  (coverage: fraction of the errors within one sigma, normal distribution: 0.683)\n";
}

}  // namespace gladstone::inline compare
