#pragma once

#include <vector>

#include "render/focused_dots/dot_patch.h"
#include "render/focused_dots/square_light.h"

namespace gladstone::inline focused_dots {

struct RenderedDot : DotCone, DotFound {
  double largest_aim_distance = 0;  ///< largest distance from the axis of a pupil point that the iteration for the
                                    ///< cone's centre tried, see DotAim::farthest [m]
};

/// Single lane that compares a dot's rays with the table, tracing two rays together.
struct CheckingLane : OneLane {
  static constexpr int abreast = 2;
  int scramblings = 1;
  TableCheck sums[most_scramblings];
  StatusCounts statuses{};

  void clear() { std::fill_n(sums, most_scramblings, TableCheck{}); }
  TableCheck& check(int ray) { return sums[ray % scramblings]; }
  TableCheck const* of_scramblings() const { return sums; }
  void count(int frame, RayStatus status) {
    ++statuses[static_cast<std::size_t>(frame)][static_cast<std::size_t>(status)];
  }
};

/// Renders dots on the CPU, one at a time; each thread has its own object. Sums have a fixed order, so results do not
/// depend on the number of threads.
class DotIntegrator {
 public:
  /// @param model  must outlive the integrator
  explicit DotIntegrator(DotModel const& model);

  /// Traces the dot's rays and integrates its light cone. For a fallback dot, only its kind is valid.
  /// @throws Interrupted
  template <class Medium>
  RenderedDot const& see(Medium const& medium, Vec2d centre, double radiance) {
    seen_ = {};
    seen_.largest_aim_distance = check_dot(lane_, model_, medium, centre, seen_, seen_).farthest;
    seen_.light = model_.reference_light(centre, radiance);
    if (seen_.kind != DotKind::left) integrate();
    return seen_;
  }
  /// Renders the dot's light in both images.
  /// @pre the dot is not a fallback dot, and the model's moment images are computed
  void accumulate_light(LightImage* const (&images)[frame_count]);

  /// Light cone of the last dot.
  CorrectedCone cone() const { return make_corrected_cone(model_, seen_); }
  StatusCounts const& statuses() const { return lane_.statuses; }

 private:
  void integrate();
  /// Renders the dot's light, one point of the source after the other.
  /// @param moved  mean displacement of the light [px]
  template <int orders>
  void accumulate_light_by_points(std::size_t frame, Vec2d moved);

  DotModel const& model_;
  std::vector<DotPatch> patches_;
  RenderedDot seen_;
  CheckingLane lane_;
  std::vector<double> rims_;
  ConeIntegral whole_;             ///< integrals over the whole cone; refers to rims_
  std::vector<ConeLight> points_;  ///< nodes of the cone, for all points of the source
  std::vector<unsigned short> order_;
  SquareSums<1> squares_;
};

}  // namespace gladstone::inline focused_dots
