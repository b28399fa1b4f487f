#include "studies/case/truth_file.h"

#include <algorithm>
#include <array>

#include "render/files/hdf5_axes.h"
#include "studies/case/flat_values.h"
#include "studies/case/particle_case.h"
#include "studies/case/truth_columns.h"

namespace gladstone::inline cases {
namespace {

constexpr std::array<TruthColumn, 8> dot_columns{{
    {"/reference_px", &GroundTruth::reference_px, "px",
     "radiance-weighted centroid of the rays that pass the stop in the reference image (column, row)"},
    {"/displacement_px", &GroundTruth::displacement_px, "px",
     "centroid in the measurement image (flow.tif) minus that in the reference image (u right, v down)"},
    {"/displacement_error_px", &GroundTruth::displacement_error_px, "px",
     "standard error of displacement_px by component (68 % of the errors lie within it); nan: unknown"},
    {"/displacement_std_px", &GroundTruth::displacement_std_px, "px",
     "weighted standard deviation of the rays on the sensor in the measurement image"},
    {"/flux", &GroundTruth::flux, "fully lit px", "light of the dot in the reference and in the measurement image"},
    {"/eq9_px", &GroundTruth::eq9_px, "px",
     "Rajendran et al. eq. 9 along the straight chief ray, with lever arm Z_D (u right, v down)"},
    {"/chief_px", &GroundTruth::chief_px, "px", "eq. 9 with the distance of each slice from the dots as lever arm"},
    {"/eq9_cone_px", &GroundTruth::eq9_cone_px, "px", "eq. 9 averaged over the dot and the aperture"},
}};

TruthGroup const& dots_group() {
  static TruthGroup const group{"/dots",
                                "dot",
                                "/frame",
                                "frame (reference, flow)",
                                "rays counted in each frame",
                                "planned number of rays of the dot in each frame",
                                "displacement = flow minus reference; column right and row down from 0 at the first "
                                "pixel's centre; dots appear displaced against grad n",
                                dot_columns};
  return group;
}

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
  write_sources(file, axes, dots_group(), rendering);
  std::vector<std::int64_t> by_table;
  for (TruthPath const by : truth.path) by_table.push_back(by == TruthPath::table ? 1 : 0);
  file.write("/dots/by_table", std::span<std::int64_t const>(by_table), {count}, "1",
             "1: the truth is the integral of a deflection table over the light cone, corrected by the dot's rays; 0: "
             "it is the centroid of the rays",
             "dot");
  axes.name("/dots/by_table", {"/dots/dot"});
  write_field_map(file, field, axes);
  axes.attach();
  write_source_attributes(file, dots_group(), scene, rendering.plan);
  if (table) {
    file.attribute("/dots", "table_truth_error_px", std::max(table->truth_px, table->truth_resolution_px));
    file.attribute("/dots", "table_image_error_levels", std::max(table->image_levels, table->image_resolution_levels));
  }
  file.close();
}

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
  read_sources(file, path, dots_group(), truth);
  std::vector<std::int64_t> const by_table =  // version 1 did not contain it
      file.attribute("version") == "1" ? std::vector<std::int64_t>(truth.size()) : file.read_integers("/dots/by_table");
  require_length(path, "/dots/by_table", by_table.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    truth.path[i] = by_table[i] == 1 ? TruthPath::table : TruthPath::rays;
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

}  // namespace gladstone::inline cases
