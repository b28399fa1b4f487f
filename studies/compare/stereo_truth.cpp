#include "studies/compare/stereo_truth.h"

#include <algorithm>
#include <cmath>

#include "analysis/correlation/standard_correlator.h"
#include "analysis/errors/window_truth.h"

namespace gladstone::inline compare {

Vec2d find_plane_scale(std::array<PinholeCamera const*, 2> const& cameras, stereo::ObjectPlane const& plane) {
  constexpr double step = 1e-4;  // step of the finite differences [m]
  Vec2d scale{};                 // mean of both cameras: the sum of half the scale of each
  for (PinholeCamera const* camera : cameras) {
    Vec2d const middle = camera->project(plane.point({}));
    Vec2d const along_x = camera->project(plane.point({step, 0})) - middle;
    Vec2d const along_y = camera->project(plane.point({0, step})) - middle;
    scale += Vec2d{length(along_x), length(along_y)} / (2.0 * step);
  }
  return scale;
}

std::vector<Vec3d> compute_stereo_truth(std::array<GroundTruth const*, 2> const& dots, Vec2d scale,
                                        stereo::NodeGrid const& grid, CorrelationSettings const& settings) {
  auto const scaled = [&](Vec2d at) { return Vec2d{scale.x * at.x, scale.y * at.y}; };
  GroundTruth const& first = *dots[0];
  std::vector<Vec2d> middle, in_plane, across, nodes;
  std::vector<double> light;
  for (std::size_t i = 0; i < first.size(); ++i) {
    Vec3d const from = first.position_m[i], to = first.particles.second_m[i], moved = to - from;
    middle.push_back(scaled({0.5 * (from.x + to.x), 0.5 * (from.y + to.y)}));
    in_plane.push_back({moved.x, moved.y});
    across.push_back({moved.z, 0.0});
    double const in_a = dots[0]->flux[i].x * dots[0]->flux[i].y, in_b = dots[1]->flux[i].x * dots[1]->flux[i].y;
    light.push_back(std::pow(std::max(0.0, in_a * in_b), 0.25));
  }
  for (std::size_t node = 0; node < grid.size(); ++node) nodes.push_back(scaled(grid.position(node)));
  WindowWeight const weight = correlation_window(window_weighting(settings), settings.window_px.back());
  // The positions are already those at mid-time.
  WindowTruth const uv = window_truth(middle, in_plane, light, nodes, weight, TruthAt::reference);
  WindowTruth const w = window_truth(middle, across, light, nodes, weight, TruthAt::reference);
  std::vector<Vec3d> truth;
  for (std::size_t node = 0; node < grid.size(); ++node)
    truth.push_back({uv.displacement_px[node].x, uv.displacement_px[node].y, w.displacement_px[node].x});
  return truth;
}

}  // namespace gladstone::inline compare
