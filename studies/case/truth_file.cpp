#include "studies/case/truth_file.h"

#include <algorithm>
#include <array>

#include "render/base/not_a_number.h"
#include "render/files/hdf5_axes.h"
#include "render/method.h"
#include "studies/case/flat_values.h"
#include "studies/case/particle_case.h"

namespace gladstone {
namespace {

constexpr char const* dot_axes = "dot, component";

/// Dataset of /dots with two components per dot.
struct PairDataset {
  char const* name;
  std::vector<Vec2d> GroundTruth::*values;
  char const* units;
  char const* description;
};

constexpr std::array<PairDataset, 8> pair_datasets{{
    {"/dots/reference_px", &GroundTruth::reference_px, "px",
     "radiance-weighted centroid of the rays that pass the stop in the reference image (column, row)"},
    {"/dots/displacement_px", &GroundTruth::displacement_px, "px",
     "centroid in the measurement image (flow.tif) minus that in the reference image (u right, v down)"},
    {"/dots/displacement_error_px", &GroundTruth::displacement_error_px, "px",
     "standard error of displacement_px by component (68 % of the errors lie within it); nan: unknown"},
    {"/dots/displacement_std_px", &GroundTruth::displacement_std_px, "px",
     "weighted standard deviation of the rays on the sensor in the measurement image"},
    {"/dots/flux", &GroundTruth::flux, "fully lit px",
     "light of the dot in the reference and in the measurement image"},
    {"/dots/eq9_px", &GroundTruth::eq9_px, "px",
     "Rajendran et al. eq. 9 along the straight chief ray, with lever arm Z_D (u right, v down)"},
    {"/dots/chief_px", &GroundTruth::chief_px, "px",
     "eq. 9 with the distance of each slice from the dots as lever arm"},
    {"/dots/eq9_cone_px", &GroundTruth::eq9_cone_px, "px", "eq. 9 averaged over the dot and the aperture"},
}};

void write_field_map(Hdf5Writer& file, FieldMap const& field, Hdf5Axes& axes) {
  auto const columns = static_cast<std::size_t>(field.density.columns());
  auto const rows = static_cast<std::size_t>(field.density.rows());
  double const spacing[1] = {static_cast<double>(field.spacing_px)};
  axes.write_numbers("/field/value", 1, "axis of a single number");
  file.write("/field/spacing_px", std::span<double const>(spacing), {1}, "px",
             "spacing of the maps: node (i, j) is at pixel (i, j) spacing + (spacing - 1) / 2", "value");
  axes.name("/field/spacing_px", {"/field/value"});
  auto const write_positions = [&](std::string const& name, std::size_t count, std::string const& axis) {
    std::vector<double> px(count);
    for (std::size_t i = 0; i < count; ++i) px[i] = static_cast<double>(i) * spacing[0] + (spacing[0] - 1) / 2;
    file.write(name, std::span<double const>(px), {count}, "px", axis + " of the nodes", axis);
  };
  write_positions("/field/x_px", columns, "column");
  write_positions("/field/y_px", rows, "row");
  file.write("/field/density_kg_m3", std::span<double const>(field.density.data(), field.density.size()),
             {rows, columns}, "kg/m^3", "density averaged along the chief ray through the field", "row, column");
  axes.name("/field/density_kg_m3", {"/field/y_px", "/field/x_px"});
  file.write("/field/density_gradient_kg_m4", flat(field.density_gradient), {rows, columns, 2}, "kg/m^4",
             "d rho / d(X, Y) averaged along the chief ray, Y up", "row, column, (X, Y)");
  axes.name("/field/density_gradient_kg_m4", {"/field/y_px", "/field/x_px", "/component"});
  file.write("/field/eq9_px", flat(field.eq9_px), {rows, columns, 2}, "px", "Rajendran et al. eq. 9",
             "row, column, (u, v)");
  axes.name("/field/eq9_px", {"/field/y_px", "/field/x_px", "/component"});
}

}  // namespace

void write_truth(std::string const& path, Scene const& scene, Rendering const& rendering, FieldMap const& field,
                 TableError const* table, FileOrigin const& origin) {
  GroundTruth const& truth = rendering.truth;
  Hdf5Writer file(path, origin);
  std::size_t const count = truth.size();
  Hdf5Axes axes(file);
  axes.write_numbers("/component", 2, "u to the right, v downwards; of positions column, row; of gradients X, Y");
  axes.write_numbers("/coordinate", 3, "x, y, z");
  axes.write_numbers("/frame", 2, "reference, flow");
  axes.write_numbers("/dots/dot", count, "number of the dot");
  axes.write_numbers("/rays/kind", ray_status_count, "status of a ray");
  std::vector<double> position;
  position.reserve(3 * count);
  for (Vec3d const& p : truth.position_m) position.insert(position.end(), {p.x, p.y, p.z});
  file.write("/dots/position_m", std::span<double const>(position), {count, 3}, "m",
             "dot centres in the world frame: X right, Y up as the camera sees them, Z towards the camera",
             "dot, (x, y, z)");
  axes.name("/dots/position_m", {"/dots/dot", "/coordinate"});
  for (PairDataset const& dataset : pair_datasets) {
    file.write(dataset.name, flat(truth.*dataset.values), {count, 2}, dataset.units, dataset.description, dot_axes);
    axes.name(dataset.name, {"/dots/dot", dataset.values == &GroundTruth::flux ? "/frame" : "/component"});
  }
  std::vector<std::int64_t> rays;
  for (auto const& both : truth.rays) rays.insert(rays.end(), both.begin(), both.end());
  file.write("/dots/rays", std::span<std::int64_t const>(rays), {count, 2}, "1", "rays counted in each frame",
             "dot, frame (reference, flow)");
  file.write("/dots/rays_planned", std::span<std::int64_t const>(truth.rays_planned), {count}, "1",
             "planned number of rays of the dot in each frame", "dot");
  std::vector<std::int64_t> by_table;
  for (TruthPath const by : truth.path) by_table.push_back(by == TruthPath::table ? 1 : 0);
  file.write("/dots/by_table", std::span<std::int64_t const>(by_table), {count}, "1",
             "1: the truth is the integral of a deflection table over the light cone, corrected by the dot's rays; 0: "
             "it is the centroid of the rays",
             "dot");
  std::vector<std::int64_t> counts;
  for (auto const& frame : rendering.statuses) counts.insert(counts.end(), frame.begin(), frame.end());
  file.write("/rays/status", std::span<std::int64_t const>(counts), {2, ray_status_count}, "1",
             "rays by status: alive, missed_sensor, vignetted, total_internal_reflection, lost_in_medium, missed_lens",
             "frame (reference, flow), status");
  axes.name("/dots/rays", {"/dots/dot", "/frame"});
  axes.name("/dots/rays_planned", {"/dots/dot"});
  axes.name("/dots/by_table", {"/dots/dot"});
  axes.name("/rays/status", {"/frame", "/rays/kind"});
  write_field_map(file, field, axes);
  axes.attach();

  Setup const& setup = scene.setup;
  file.attribute("/dots", "interpolation",
                 setup.medium.interpolation == FieldInterpolation::cubic_bspline ? "cubic_bspline" : "trilinear");
  file.attribute(
      "/dots", "conventions",
      "displacement = flow minus reference; column right and row down from 0 at the first pixel's centre; dots "
      "appear displaced against grad n");
  file.attribute("/", "method", to_string(rendering.plan.method));
  if (table) {
    file.attribute("/dots", "table_truth_error_px", std::max(table->truth_px, table->truth_resolution_px));
    file.attribute("/dots", "table_image_error_levels", std::max(table->image_levels, table->image_resolution_levels));
  }
  file.attribute("/dots", "step_mm", rendering.plan.step * 1e3);
  file.attribute("/dots", "magnification", scene.imaging.magnification);
  file.close();
}

namespace {

/// @throws DataError if a dataset's length does not match the others
void require_length(std::string const& path, std::string const& dataset, std::size_t there, std::size_t needed) {
  if (there == needed) return;
  throw DataError(ErrorCode::wrong_shape, path,
                  dataset + " has " + std::to_string(there) + " values, but " + std::to_string(needed) +
                      " are required; render the case again");
}

}  // namespace

GroundTruth read_truth(std::string const& path) {
  Hdf5Reader const file(path);
  if (file.has("/particles/position_m")) return read_particle_truth(path);
  GroundTruth truth;
  std::vector<double> const position = file.read("/dots/position_m");
  truth.resize(position.size() / 3);
  require_length(path, "/dots/position_m", position.size(), 3 * truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    truth.position_m[i] = {position[3 * i], position[3 * i + 1], position[3 * i + 2]};
  }
  bool const with_errors = file.attribute("version") != "1";  // version 1 did not contain them
  for (PairDataset const& dataset : pair_datasets) {
    if (dataset.values == &GroundTruth::displacement_error_px && !with_errors) {
      truth.displacement_error_px.assign(truth.size(), {not_a_number, not_a_number});
      continue;
    }
    std::vector<double> const values = file.read(dataset.name);
    require_length(path, dataset.name, values.size(), 2 * truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) (truth.*dataset.values)[i] = {values[2 * i], values[2 * i + 1]};
  }
  std::vector<std::int64_t> const by_table =
      with_errors ? file.read_integers("/dots/by_table") : std::vector<std::int64_t>(truth.size());
  require_length(path, "/dots/by_table", by_table.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    truth.path[i] = by_table[i] == 1 ? TruthPath::table : TruthPath::rays;
  }
  std::vector<std::int64_t> const rays = file.read_integers("/dots/rays");
  require_length(path, "/dots/rays", rays.size(), 2 * truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) truth.rays[i] = {rays[2 * i], rays[2 * i + 1]};
  if (file.has("/dots/rays_planned")) {
    truth.rays_planned = file.read_integers("/dots/rays_planned");
    require_length(path, "/dots/rays_planned", truth.rays_planned.size(), truth.size());
  }
  return truth;
}

FieldMap read_field_map(std::string const& path) {
  Hdf5Reader const file(path);
  FieldMap map;
  std::vector<double> const spacing = file.read("/field/spacing_px");
  require_length(path, "/field/spacing_px", spacing.size(), 1);
  auto const shape = file.shape("/field/density_kg_m3");
  constexpr std::size_t largest = 1'000'000;  // pixels of a camera along an axis, sanity limit
  if (shape.size() != 2 || shape[0] > largest || shape[1] > largest || !(spacing[0] >= 1 && spacing[0] <= largest)) {
    throw DataError(
        ErrorCode::missing_content, path,
        "/field contains no map (spacing_px, and density_kg_m3 in rows and columns); render the case again");
  }
  map.spacing_px = static_cast<int>(spacing[0]);
  std::vector<double> const density = file.read("/field/density_kg_m3");
  std::vector<double> const gradient = file.read("/field/density_gradient_kg_m4");
  std::vector<double> const eq9 = file.read("/field/eq9_px");
  require_length(path, "/field/density_gradient_kg_m4", gradient.size(), 2 * density.size());
  require_length(path, "/field/eq9_px", eq9.size(), 2 * density.size());
  int const rows = static_cast<int>(shape[0]), columns = static_cast<int>(shape[1]);
  map.density = Image<double>(columns, rows);
  map.density_gradient = Image<Vec2d>(columns, rows);
  map.eq9_px = Image<Vec2d>(columns, rows);
  for (std::size_t i = 0; i < map.density.size(); ++i) {
    map.density.data()[i] = density[i];
    map.density_gradient.data()[i] = {gradient[2 * i], gradient[2 * i + 1]};
    map.eq9_px.data()[i] = {eq9[2 * i], eq9[2 * i + 1]};
  }
  return map;
}

}  // namespace gladstone
