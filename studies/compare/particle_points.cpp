#include "studies/compare/particle_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/base/median.h"
#include "render/base/parallel.h"
#include "render/light/flow_path.h"

namespace gladstone::inline compare {
namespace {

constexpr std::uint64_t rough_rays = 128;
constexpr int correction_rounds = 2;
constexpr int projection_rounds = 4;  // each iteration squares the residual, or divides it by the flow's strain
constexpr double out_of_sight = std::numeric_limits<double>::quiet_NaN();

/// Points of an image projected onto the laser sheet, corrected iteratively.
class SheetPoints {
 public:
  SheetPoints(Scene const& scene, std::vector<Vec2d> const& places_px)
      : scene_(scene), plane_(scene.sheet_plane()), wanted_(places_px), seen_(places_px.size()) {
    parallel_for(places_px.size(), [&](std::size_t i) { seen_[i] = scene.camera.unproject(places_px[i], plane_); });
    for (auto const& seen : seen_) place_.push_back(seen ? seen->place : Vec2d{});
    PivSetup const& piv = *scene.setup.piv;
    diameter_ = upper_median(scene.particles.diameter);
    velocity_ = {piv.flow.flow, piv.particles.response_time(diameter_), 0.01 * piv.flow.dt};
  }

  /// Returns virtual particles at the present positions, with equal light at both pulses.
  Particles particles() const {
    Particles virtual_ones;
    virtual_ones.resize(place_.size());
    double const half = scene_.setup.piv->flow.dt / 2;
    parallel_for(place_.size(), [&](std::size_t i) {
      Vec3d const middle = plane_.point_to_outer({place_[i].x, place_[i].y, 0});
      virtual_ones.place[0][i] = moved(velocity_, middle, -half, scene_.particles.path.steps);
      virtual_ones.place[1][i] = moved(velocity_, middle, half, scene_.particles.path.steps);
      virtual_ones.diameter[i] = diameter_;
      for (auto& photons : virtual_ones.photons) photons[i] = seen_[i] ? 1.0 : 0.0;
    });
    return virtual_ones;
  }

  /// Shifts the particles so that their images move from the traced to the required positions.
  void correct(std::vector<Vec2d> const& reference, std::vector<Vec2d> const& displacement, TruthAt at) {
    for (std::size_t i = 0; i < place_.size(); ++i) {
      Vec2d const shift = at == TruthAt::mid_position ? 0.5 * displacement[i] : Vec2d{};
      Vec2d const miss = wanted_[i] - (reference[i] + shift);
      if (!seen_[i] || !std::isfinite(miss.x) || !std::isfinite(miss.y)) continue;
      Vec2d const a = seen_[i]->by_x, b = seen_[i]->by_y;
      double const area = a.x * b.y - a.y * b.x;
      place_[i] += Vec2d{(miss.x * b.y - miss.y * b.x) / area, (a.x * miss.y - a.y * miss.x) / area};
    }
  }

  std::vector<Vec2d> flow_px() const {
    std::vector<Vec2d> moves;
    double const dt = scene_.setup.piv->flow.dt;
    for (auto const& seen : seen_) {
      if (!seen) {
        moves.push_back({out_of_sight, out_of_sight});
        continue;
      }
      Vec3d const middle = plane_.point_to_outer({seen->place.x, seen->place.y, 0});
      Vec3d const way = plane_.direction_to_local(dt * velocity_.flow(middle));
      moves.push_back(seen->moved({way.x, way.y}));
    }
    return moves;
  }

 private:
  Scene const& scene_;
  Pose<double> plane_;
  std::vector<Vec2d> const& wanted_;
  std::vector<std::optional<ImagedPoint>> seen_;
  std::vector<Vec2d> place_;  // positions at mid-time, on the plane [m]
  double diameter_ = 0;
  ParticleVelocity velocity_;
};

bool without_medium(Scene const& scene) {
  return std::holds_alternative<NoMedium<double>>(scene.medium.view) && !scene.second_medium;
}

/// Selects the image positions to be matched: with or without the medium.
enum class SeenThrough { medium, ambient };

/// Traces the particles whose images coincide with the points.
GroundTruth trace_points(Scene const& scene, RenderPlan const& plan, Renderer& renderer, SheetPoints here, TruthAt at,
                         SeenThrough through) {
  auto const trace = [&](RenderPlan const& with_rays) {
    return renderer.render_particles(scene, with_rays, here.particles(), ParticleLight::equal, RenderImages::no).truth;
  };
  bool const ambient = through == SeenThrough::ambient;
  RenderPlan rough = plan;
  rough.rays = std::min(plan.rays, rough_rays);
  for (int round = 0; round < correction_rounds; ++round) {
    GroundTruth const truth = trace(rough);
    here.correct(ambient ? truth.particles.reference_ambient_px : truth.reference_px,
                 ambient ? truth.particles.displacement_ambient_px : truth.displacement_px, at);
  }
  return trace(plan);
}

/// Computes the displacements of the particles whose pinhole projections coincide with the points. With an ideal lens
/// and no medium, they equal the centroids of traced rays, in a thousandth of the time.
std::vector<Vec2d> project_points(Scene const& scene, SheetPoints here, TruthAt at) {
  auto const project = [&](std::vector<Vec2d>& first, std::vector<Vec2d>& moved) {
    Particles const particles = here.particles();
    first.assign(particles.size(), {out_of_sight, out_of_sight});
    moved = first;
    parallel_for(particles.size(), [&](std::size_t i) {
      if (!(particles.photons[0][i] > 0)) return;
      auto const a = scene.camera.project(particles.place[0][i]), b = scene.camera.project(particles.place[1][i]);
      if (!a || !b) return;
      first[i] = *a;
      moved[i] = *b - *a;
    });
  };
  std::vector<Vec2d> first, moved;
  for (int round = 0; round < projection_rounds; ++round) {
    project(first, moved);
    here.correct(first, moved, at);
  }
  project(first, moved);
  return moved;
}

}  // namespace

ParticlePoints particle_points(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                               std::vector<Vec2d> const& places_px, TruthAt at) {
  SheetPoints const start(scene, places_px);
  ParticlePoints points;
  points.flow_px = start.flow_px();
  points.seen = trace_points(scene, plan, renderer, start, at, SeenThrough::medium);
  points.ambient_px =
      without_medium(scene)
          ? points.seen.displacement_px
          : trace_points(scene, plan, renderer, start, at, SeenThrough::ambient).particles.displacement_ambient_px;
  return points;
}

bool has_projected_displacements(Scene const& scene) {
  return without_medium(scene) && scene.setup.has_closed_form_layout();
}

GroundTruth particle_displacements(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                                   std::vector<Vec2d> const& places_px, TruthAt at) {
  SheetPoints start(scene, places_px);
  if (!has_projected_displacements(scene))
    return trace_points(scene, plan, renderer, std::move(start), at, SeenThrough::medium);
  GroundTruth truth;
  truth.displacement_px = project_points(scene, std::move(start), at);
  return truth;
}

}  // namespace gladstone::inline compare
