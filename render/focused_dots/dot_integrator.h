#pragma once

#include <vector>

#include "render/focused_dots/dot_patch.h"
#include "render/focused_dots/square_light.h"

namespace gladstone {

struct SeenDot : DotCone, DotFound {
  double farthest_aim = 0;  ///< as DotAim::farthest
};

/// A lane by itself that checks a dot's rays, two side by side.
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

/// Works out dots on the CPU, one at a time, one object a thread. Sums have one order: the same on any number of
/// threads.
class DotIntegrator {
 public:
  /// @param model outlives the integrator
  explicit DotIntegrator(DotModel const& model);

  /// Traces the dot's rays and integrates its cone. Of one that is left nothing counts but that. @throws Interrupted
  template <class Medium>
  SeenDot const& see(Medium const& medium, Vec2d centre, double radiance) {
    seen_ = {};
    seen_.farthest_aim = check_dot(lane_, model_, medium, centre, seen_, seen_).farthest;
    seen_.light = model_.light_of(centre, radiance);
    if (seen_.kind != DotKind::left) integrate();
    return seen_;
  }
  /// Lays down its light in both frames. @pre it is not left, and the model's images of moments are worked out
  void lay_down(LightImage* const (&images)[frame_count]);

  /// The cone of the dot that was seen last.
  CorrectedCone cone() const { return cone_of(model_, seen_); }
  StatusCounts const& statuses() const { return lane_.statuses; }

 private:
  void integrate();
  /// @param moved that the light is on average [px]
  template <int orders>
  void lay_down_points(std::size_t frame, Vec2d moved);

  DotModel const& model_;
  std::vector<DotPatch> patches_;
  SeenDot seen_;
  CheckingLane lane_;
  std::vector<double> rims_;
  ConeIntegral whole_;             ///< points into the rims
  std::vector<ConeLight> points_;  ///< of the cone, of all places
  std::vector<unsigned short> order_;
  SquareSums<1> squares_;
};

}  // namespace gladstone
