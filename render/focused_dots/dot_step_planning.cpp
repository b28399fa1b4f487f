#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/focused_dots/dot_planning.h"
#include "render/focused_dots/trace_pair.h"

namespace gladstone {
namespace {

/// A ray that a dot is probed by.
struct ProbeRay {
  Vec2d beside;  ///< where it starts, from the dot's centre [m]
  Vec2d pupil;   ///< where it runs to [m]
};

template <class Medium>
Probe probe_dots(FocusedDots const& bench, Medium const& medium, std::vector<std::size_t> const& dots,
                 std::vector<ProbeRay> const& rays, double step) {
  Scene const& scene = bench.scene();
  SceneView<double> view = bench.open_view();  // bending matters here, not clipping
  view.tracing.step = step;
  Probe probe;
  probe.displacement_px.resize(dots.size());
  probe.bend.resize(dots.size());
  parallel_chunks(dots.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec2d const centre = scene.dots.centre[dots[i]];
      Vec2d sum{};
      int seen = 0;
      for (auto const& [beside, pupil] : rays) {
        throw_if_interrupted();
        Vec3d const start{centre.x + beside.x, centre.y + beside.y, view.sources.plane_z};
        Ray<double> const straight{
            start, normalized(Vec3d{pupil.x - start.x, pupil.y - start.y, view.bundle.lens_z - start.z})};
        RayHit<double> const flow = follow(view, medium, straight, 1.0);
        if (!reaches_sensor_plane(flow.status)) continue;
        RayHit<double> const reference = through_camera(view, straight, 1.0);
        sum += flow.pixel - reference.pixel;
        probe.bend[i] = std::max(probe.bend[i], length(flow.at_lens - pupil));
        ++seen;
      }
      probe.displacement_px[i] = seen > 0 ? sum / static_cast<double>(seen) : Vec2d{};
    }
  });
  return probe;
}

/// Probes the dots of a scene at one step after the other.
class StepProbe {
 public:
  /// Chooses the dots to be probed: those whose chief rays change most when this step is halved. About those whose
  /// chief rays are bent most the bend is looked for on a lattice that fills the gaps to their neighbours, which may be
  /// wider than what bends rays most.
  StepProbe(FocusedDots const& bench, double step) : bench_(bench), dots_(bench.scene().dots.centre.size()), cone_{{}} {
    Scene const& scene = bench.scene();
    double const rim = scene.imaging.entrance_pupil / 2;
    if (!scene.chief_rays_only()) cone_ = {{}, {{}, {rim, 0}}, {{}, {0, rim}}, {{}, {-rim, 0}}, {{}, {0, -rim}}};
    std::iota(dots_.begin(), dots_.end(), std::size_t{0});
    if (dots_.size() <= probed_dots) return;
    Probe const coarse = probe(dots_, {{}}, step), fine = probe(dots_, {{}}, step / 2);
    largest_bend_ = probe(largest_of(coarse.bend), about_dot(), step).largest_bend();
    dots_ = largest_of(changes(coarse, fine));
  }

  StepProbes probes() const {
    return {dots_, largest_bend_, [this](double step) { return probe(dots_, cone_, step); }};
  }

 private:
  Probe probe(std::vector<std::size_t> const& dots, std::vector<ProbeRay> const& rays, double step) const {
    return std::visit([&](auto const& medium) { return probe_dots(bench_, medium, dots, rays, step); },
                      bench_.scene().medium.view);
  }
  /// Chief rays from a lattice about a dot, as wide as dots are apart on average.
  std::vector<ProbeRay> about_dot() const {
    constexpr int side = 5;
    std::vector<Vec2d> const& centre = bench_.scene().dots.centre;
    Vec2d low = centre[0], high = low;
    for (Vec2d const c : centre) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y)};
    }
    double const spacing = std::sqrt((high.x - low.x) * (high.y - low.y) / static_cast<double>(dots_.size()));
    std::vector<ProbeRay> rays;
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        rays.push_back({spacing / side * Vec2d{column - 0.5 * (side - 1), row - 0.5 * (side - 1)}, {}});
      }
    }
    return rays;
  }

  FocusedDots bench_;
  std::vector<std::size_t> dots_;
  std::vector<ProbeRay> cone_;  ///< by which these are probed
  double largest_bend_ = 0;
};

}  // namespace

StepPlan plan_step(FocusedDots const& dots) {
  return choose_step(dots.scene(), [&](double step, auto const& search) {
    StepProbe const probe(dots, step);
    search(probe.probes());
  });
}

}  // namespace gladstone
