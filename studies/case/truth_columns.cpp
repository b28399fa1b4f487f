#include "studies/case/truth_columns.h"

#include "render/base/not_a_number.h"
#include "render/method.h"
#include "studies/case/flat_values.h"

namespace gladstone::inline cases {

void write_sources(Hdf5Writer& file, Hdf5Axes& axes, TruthGroup const& group, Rendering const& rendering) {
  GroundTruth const& truth = rendering.truth;
  std::size_t const count = truth.size();
  for (TruthColumn const& column : group.columns) {
    std::string const name = group.path + column.name;
    file.write(name, flat(column.of(truth)), {count, 2}, column.units, column.description, column.axes);
    axes.name(name, {group.sources(), column.values == &GroundTruth::flux ? group.frame : "/component"});
  }
  std::vector<std::int64_t> rays, counts;
  for (auto const& both : truth.rays) rays.insert(rays.end(), both.begin(), both.end());
  for (auto const& frame : rendering.statuses) counts.insert(counts.end(), frame.begin(), frame.end());
  file.write(group.path + "/rays", std::span<std::int64_t const>(rays), {count, 2}, "1", group.rays,
             group.source + ", " + group.frame_order);
  file.write(group.path + "/rays_planned", std::span<std::int64_t const>(truth.rays_planned), {count}, "1",
             group.rays_planned, group.source);
  file.write("/rays/status", std::span<std::int64_t const>(counts), {2, ray_status_count}, "1",
             "rays by status: alive, missed_sensor, vignetted, total_internal_reflection, lost_in_medium, missed_lens",
             group.frame_order + ", status");
  axes.name(group.path + "/rays", {group.sources(), group.frame});
  axes.name(group.path + "/rays_planned", {group.sources()});
  axes.name("/rays/status", {group.frame, "/rays/kind"});
}

void write_source_attributes(Hdf5Writer& file, TruthGroup const& group, Scene const& scene, RenderPlan const& plan) {
  bool const by_splines = scene.setup.medium.interpolation == FieldInterpolation::cubic_bspline;
  file.attribute(group.path, "interpolation", by_splines ? "cubic_bspline" : "trilinear");
  file.attribute(group.path, "conventions", group.conventions);
  file.attribute("/", "method", to_string(plan.method));
  file.attribute(group.path, "step_mm", plan.step * 1e3);
  file.attribute(group.path, "magnification", scene.imaging.magnification);
}

void read_sources(Hdf5Reader const& file, std::string const& path, TruthGroup const& group, GroundTruth& truth) {
  std::size_t const count = truth.size();
  bool const with_errors = file.attribute("version") != "1";  // version 1 did not contain them
  for (TruthColumn const& column : group.columns) {
    std::vector<Vec2d>& values = column.of(truth);
    values.assign(count, {not_a_number, not_a_number});
    if (column.values == &GroundTruth::displacement_error_px && !with_errors) continue;
    std::vector<double> const stored = file.read(group.path + column.name);
    require_length(path, group.path + column.name, stored.size(), 2 * count);
    for (std::size_t i = 0; i < count; ++i) values[i] = {stored[2 * i], stored[2 * i + 1]};
  }
  std::vector<std::int64_t> const rays = file.read_integers(group.path + "/rays");
  require_length(path, group.path + "/rays", rays.size(), 2 * count);
  for (std::size_t i = 0; i < count; ++i) truth.rays[i] = {rays[2 * i], rays[2 * i + 1]};
  if (file.has(group.path + "/rays_planned")) {
    truth.rays_planned = file.read_integers(group.path + "/rays_planned");
    require_length(path, group.path + "/rays_planned", truth.rays_planned.size(), count);
  }
}

void require_length(std::string const& path, std::string const& dataset, std::size_t there, std::size_t needed) {
  if (there == needed) return;
  throw DataError(ErrorCode::wrong_shape, path,
                  dataset + " has " + std::to_string(there) + " values, but " + std::to_string(needed) +
                      " are required; render the case again");
}

}  // namespace gladstone::inline cases
