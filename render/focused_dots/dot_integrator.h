#pragma once

#include <algorithm>
#include <vector>

#include "render/base/interrupt.h"
#include "render/focused_dots/dot_model.h"
#include "render/focused_dots/dot_patch.h"

namespace gladstone {

/// What is known of a dot once its rays are traced and its cone is integrated.
struct SeenDot {
  DotAim aim;
  DotKind kind = DotKind::left;
  int rays = 0;  ///< traced
  Vec2d centre{};
  double light = 0;  ///< in the reference frame [fully lit px]
  TableCheck check;
  CheckErrors errors;
  DotTruth truth;
  DisplacementMoments whole[PlaceRule::most_places];  ///< of the cone, at every place of the source
  double without_medium[PlaceRule::most_places] = {};
  Extent extent;  ///< of displacements from the cone's origin
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
    seen_.centre = centre;
    seen_.light = model_.light_of(centre, radiance);
    seen_.truth.origin = model_.to_pixel(centre);
    seen_.aim = aim_dot(model_, centre);
    seen_.kind = seen_.aim.kind;
    if (seen_.kind == DotKind::narrow) trace(medium);
    if (seen_.kind != DotKind::left) integrate();
    return seen_;
  }
  /// Lays down its light in both frames. @pre it is not left, and the model's images of moments are worked out
  void lay_down(LightImage* const (&images)[frame_count]);

  /// The cone of the dot that was seen last.
  CorrectedCone cone() const;
  StatusCounts const& statuses() const { return statuses_; }

 private:
  template <class Medium>
  void trace(Medium const& medium) {
    std::fill_n(of_scramblings_, most_scramblings, TableCheck{});
    for (int enough = model_.fewest_rays; seen_.kind != DotKind::left;
         enough = std::min(2 * enough, model_.most_rays)) {
      for (; seen_.rays < enough; seen_.rays += 2) {
        throw_if_interrupted();  // each of them may take a million steps
        int const next = std::min(seen_.rays + 1, enough - 1);
        SentRay const sent[2] = {send_ray(model_, seen_.centre, seen_.aim.pupil, seen_.rays),
                                 send_ray(model_, seen_.centre, seen_.aim.pupil, next)};
        Deflection found[2];
        deflect(model_.bench, medium, {sent[0].from, sent[1].from}, {sent[0].pupil, sent[1].pupil}, found);
        enter(seen_.rays, sent[0], found[0]);
        if (next > seen_.rays) enter(next, sent[1], found[1]);
      }
      seen_.rays = enough;
      if (settle()) return;
    }
  }
  void enter(int ray, SentRay const& sent, Deflection const& found);
  /// Sums up. @return whether these rays are enough
  bool settle();
  void integrate();
  void deposit_source(Frame frame, LightImage* image);
  void deposit_narrow(LightImage* image);
  void deposit_wide(LightImage* image);

  DotModel const& model_;
  std::vector<DotPatch> patches_;
  SeenDot seen_;
  TableCheck of_scramblings_[most_scramblings];
  std::vector<ConeLight> points_;           ///< of the cone, of all places
  std::vector<double> rims_;                ///< of all places' directions; empty: they have none
  std::vector<DisplacementMoments> parts_;  ///< by square of displacement and place
  DotPatch::Series column_, row_;           ///< of one point of the source
  StatusCounts statuses_{};
};

}  // namespace gladstone
