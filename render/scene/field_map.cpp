#include "render/scene/field_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/scene/theory.h"

namespace gladstone::inline scene {

FieldMap FieldMap::ambient(Setup const& setup, int spacing_px) {
  int const columns = std::max(1, setup.camera.columns / spacing_px);
  int const rows = std::max(1, setup.camera.rows / spacing_px);
  return {spacing_px, Image<double>(columns, rows, setup.medium.ambient_density), Image<Vec2d>(columns, rows),
          Image<Vec2d>(columns, rows)};
}

namespace {

/// Inverse of the thin lens' projection, x = M X / p: returns the point of the target seen by a pixel [m].
Vec2d unproject_on_axis(Scene const& scene, Vec2d pixel) {
  double const scale = scene.setup.camera.pixel_pitch / scene.imaging.magnification;
  Vec2d const middle = scene.camera.sensor.axis_pixel();
  return {(pixel.x - middle.x) * scale, (middle.y - pixel.y) * scale};
}

}  // namespace

FieldMap map_field(Scene const& scene, double longest_step, int spacing_px) {
  FieldMap map = FieldMap::ambient(scene.setup, spacing_px);
  MediumSetup const& setup = scene.setup.medium;
  double const step = std::min(longest_step, scene.medium.coarsest_step);
  std::visit(
      [&](auto const& medium) {
        parallel_for(static_cast<std::size_t>(map.density.rows()), [&](std::size_t line) {
          int const row = static_cast<int>(line);
          for (int column = 0; column < map.density.columns(); ++column) {
            throw_if_interrupted();
            Vec2d const at = unproject_on_axis(scene, map.position_px(column, row));
            Vec3d const start{at.x, at.y, -scene.setup.z_d};
            Ray<double> const chief{start, normalized(Vec3d{-at.x, -at.y, scene.setup.z_b()})};
            GradientIntegral<double> const along = integrate_gradient(medium, chief, step);
            double const mean = along.depth > 0 ? 1 / (setup.gladstone_dale * along.depth) : 0;
            map.density(column, row) = along.depth > 0 ? along.refractivity * mean : setup.ambient_density;
            map.density_gradient(column, row) = along.plain * mean;
            map.eq9_px(column, row) = theory_displacement(along.plain, scene.setup.z_d, scene.imaging.magnification,
                                                          scene.setup.ambient_index(), scene.setup.camera.pixel_pitch);
          }
        });
      },
      scene.medium.view);
  return map;
}

StrainMap compute_strain(Image<Vec2d> const& displacement, int spacing_px) {
  StrainMap map;
  map.spacing_px = spacing_px;
  int const columns = displacement.columns(), rows = displacement.rows();
  map.caustic = Image<double>(columns, rows);
  map.strain = Image<double>(columns, rows);
  std::size_t crossed = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      int const left = std::max(0, column - 1), right = std::min(columns - 1, column + 1);
      int const up = std::max(0, row - 1), down = std::min(rows - 1, row + 1);
      Vec2d const along_x =
          (displacement(right, row) - displacement(left, row)) / double((right - left) * map.spacing_px);
      Vec2d const along_y =
          (displacement(column, down) - displacement(column, up)) / double((down - up) * map.spacing_px);
      double const middle = 0.5 * (along_x.x + along_y.y);
      double const radius = std::hypot(0.5 * (along_x.x - along_y.y), 0.5 * (along_x.y + along_y.x));
      map.caustic(column, row) = middle + radius;
      map.strain(column, row) = std::max(std::abs(middle + radius), std::abs(middle - radius));
      if (middle + radius >= 1) ++crossed;
      map.largest_px = std::max(map.largest_px, length(displacement(column, row)));
    }
  }
  map.caustic_fraction = static_cast<double>(crossed) / static_cast<double>(displacement.size());
  return map;
}

namespace {

/// Lattice node within a disc centred on node (0, 0), and its fraction of the disc's area.
struct DiscNode {
  int column, row;
  double share;
};

/// Returns the nodes of a disc; nodes at its edge have partial weight. The weights sum to 1.
/// @param radius  radius in units of the lattice spacing
std::vector<DiscNode> disc_nodes(double radius) {
  std::vector<DiscNode> nodes;
  int const reach = static_cast<int>(std::ceil(radius));
  double sum = 0;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      double const share = std::clamp(radius + 0.5 - std::hypot(column, row), 0.0, 1.0);
      if (share == 0) continue;
      nodes.push_back({column, row, share});
      sum += share;
    }
  }
  for (DiscNode& node : nodes) node.share /= sum;
  return nodes;
}

}  // namespace

StrainMap map_strain(Scene const& scene) {
  CameraSetup const& camera = scene.setup.camera;
  // The cone average smooths structures between the points of a coarse lattice; chief rays resolve all structures.
  bool const chief = scene.chief_rays_only();
  int const larger = std::max(camera.columns, camera.rows);
  int const spacing_px = chief ? std::max(1, larger / 512) : std::max(4, larger / 128);
  int const columns = std::max(3, camera.columns / spacing_px), rows = std::max(3, camera.rows / spacing_px);

  // Radius of the target region whose chief rays cross the medium's mid-plane within a dot's light cone.
  Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
  double const plane_z = -scene.setup.z_d, middle = 0.5 * (box.low.z + box.high.z);
  double const lever = (middle - plane_z) / (scene.setup.z_a - middle);
  double const px = scene.imaging.magnification / camera.pixel_pitch;
  double const radius_px = chief ? 0 : lever * scene.imaging.entrance_pupil / 2 * px;
  double const finest_px = (1 + lever) * scene.medium.finest * px;

  // Refine the lattice for the chief rays so that it resolves the cone or the field.
  double const resolved_px = std::max(radius_px / 3, finest_px);
  int const finer =
      chief || !(resolved_px > 0) ? 1 : std::clamp(static_cast<int>(std::ceil(spacing_px / resolved_px)), 1, 8);
  std::vector<DiscNode> const disc = disc_nodes(radius_px * finer / spacing_px);
  int const reach = -disc.front().row, margin = (reach + finer - 1) / finer;
  auto const residue = [finer](int i) { return ((i % finer) + finer) % finer; };
  std::vector<char> needed(static_cast<std::size_t>(finer * finer), 0);
  for (DiscNode const& node : disc)
    needed[static_cast<std::size_t>(residue(node.row) * finer + residue(node.column))] = 1;

  Image<Vec2d> along_chief((columns + 2 * margin) * finer, (rows + 2 * margin) * finer);
  double const fine_px = static_cast<double>(spacing_px) / finer;
  std::visit(
      [&](auto const& medium) {
        parallel_for(static_cast<std::size_t>(along_chief.rows()), [&](std::size_t line) {
          int const row = static_cast<int>(line);
          for (int column = 0; column < along_chief.columns(); ++column) {
            if (!needed[static_cast<std::size_t>(residue(row) * finer + residue(column))]) continue;
            throw_if_interrupted();
            Vec2d const at = unproject_on_axis(scene, {fine_px * (column - margin * finer) + 0.5 * spacing_px,
                                                       fine_px * (row - margin * finer) + 0.5 * spacing_px});
            Vec3d const start{at.x, at.y, plane_z};
            Ray<double> const ray{start, normalized(Vec3d{-at.x, -at.y, scene.setup.z_a - start.z})};
            along_chief(column, row) = integrate_gradient(medium, ray, scene.medium.coarsest_step).lever_weighted;
          }
        });
      },
      scene.medium.view);

  Image<Vec2d> displacement(columns, rows);
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t line) {
    int const row = static_cast<int>(line);
    for (int column = 0; column < columns; ++column) {
      Vec2d sum{};
      for (DiscNode const& node : disc) {
        sum += node.share * along_chief((column + margin) * finer + node.column, (row + margin) * finer + node.row);
      }
      displacement(column, row) =
          theory_displacement(sum, 1.0, scene.imaging.magnification, scene.setup.ambient_index(), camera.pixel_pitch);
    }
  });
  return compute_strain(displacement, spacing_px);
}

}  // namespace gladstone::inline scene
