#include "render/scene/field_map.h"

#include <algorithm>
#include <cmath>

#include "render/base/parallel.h"
#include "render/scene/theory.h"

namespace gladstone {

FieldMap map_field(Scene const& scene, int spacing_px) {
  CameraSetup const& camera = scene.setup.camera;
  FieldMap map;
  map.spacing_px = spacing_px;
  int const columns = std::max(1, camera.columns / spacing_px), rows = std::max(1, camera.rows / spacing_px);
  map.density = Image<double>(columns, rows);
  map.density_gradient = Image<Vec2d>(columns, rows);
  map.eq9_px = Image<Vec2d>(columns, rows);
  MediumSetup const& setup = scene.setup.medium;
  double const step = std::min(scene.step, scene.medium.coarsest_step);
  std::visit(
      [&](auto const& medium) {
        parallel_for(static_cast<std::size_t>(rows), [&](std::size_t line) {
          int const row = static_cast<int>(line);
          for (int column = 0; column < columns; ++column) {
            Vec2d const at = scene.to_target(map.position_px(column, row));
            Vec3d const start{at.x, at.y, -scene.setup.z_d};
            Ray<double> const chief{start, normalized(Vec3d{-at.x, -at.y, scene.setup.z_b()})};
            GradientIntegral<double> const along = integrate_gradient(medium, chief, step);
            double const mean = along.depth > 0 ? 1 / (setup.gladstone_dale * along.depth) : 0;
            map.density(column, row) = along.depth > 0 ? along.refractivity * mean : setup.ambient_density;
            map.density_gradient(column, row) = along.plain * mean;
            map.eq9_px(column, row) = theory_displacement(along.plain, scene.setup.z_d, scene.imaging.magnification,
                                                          scene.setup.ambient_index(), camera.pixel_pitch);
          }
        });
      },
      scene.medium.view);
  return map;
}

StrainMap strain_of(Image<Vec2d> const& displacement, int spacing_px) {
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
    }
  }
  map.caustic_fraction = static_cast<double>(crossed) / static_cast<double>(displacement.size());
  return map;
}

StrainMap map_strain(Scene const& scene) {
  CameraSetup const& camera = scene.setup.camera;
  // the cone smooths what lies between the points of a coarse lattice; chief rays see everything, but need one ray a
  // point
  bool const chief = scene.chief_rays_only();
  int const larger = std::max(camera.columns, camera.rows);
  int const spacing_px = chief ? std::max(1, larger / 512) : std::max(4, larger / 128);
  int const columns = std::max(3, camera.columns / spacing_px), rows = std::max(3, camera.rows / spacing_px);
  Image<Vec2d> displacement(columns, rows);
  std::uint64_t const rays = chief ? 1 : 64;
  DotPattern points;
  points.centre.resize(displacement.size());
  for (std::size_t i = 0; i < points.centre.size(); ++i) {
    int const column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    points.centre[i] = scene.to_target({spacing_px * (column + 0.5), spacing_px * (row + 0.5)});
  }
  SceneView<double> view = scene.view(points);
  view.bundle.pupil_radius = scene.imaging.entrance_pupil / 2;
  double const step = std::min(scene.step, scene.medium.coarsest_step);
  std::visit(
      [&](auto const& medium) {
        parallel_chunks(points.centre.size(), 32, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            Vec2d sum{};
            // every point takes the pupil points of the first, so that differences between points carry no scatter
            SourcesView<double> point = view.sources;
            point.centre += i;
            for (std::uint64_t ray = 0; ray < rays; ++ray) {
              EmittedRay<double> const emitted = emit(point, view.bundle, 0, ray);
              sum += integrate_gradient(medium, emitted.ray, step).levered / static_cast<double>(rays);
            }
            displacement.data()[i] = theory_displacement(sum, 1.0, scene.imaging.magnification,
                                                         scene.setup.ambient_index(), camera.pixel_pitch);
          }
        });
      },
      scene.medium.view);

  return strain_of(displacement, spacing_px);
}

}  // namespace gladstone
