#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/interrupt.h"
#include "render/focused_dots/dot_light.h"
#include "render/focused_dots/dot_patch.h"
#include "render/focused_dots/trace_pair.h"
#include "render/scene/ground_truth.h"

namespace gladstone {

/// Gathers everything that one dot's rays leave behind; TracePair's Exposure on the CPU. One object a thread, one dot
/// at a time, rays in order, so that sums are the same on any number of threads.
class DotExposure {
 public:
  /// @param model outlives the exposure @param with_images false: truth only
  DotExposure(LightModel const& model, bool with_images);

  /// Starts a dot. @param centre of the source [m] @param images null: its light is not sent anywhere
  void begin(Vec2d centre, double radiance, LightImage* const (&images)[frame_count], double light_per_weight);

  /// What TracePair leaves behind for one ray.
  void record(EmittedRay<double> const& emitted, RayHit<double> const& reference, RayHit<double> const& flow);

  /// Ends the dot: its light joins the images, its truth is written.
  void finish(GroundTruth& truth, std::size_t dot);

  StatusCounts const& statuses() const { return statuses_; }
  /// Largest distance by which the medium moved a ray on the lens plane [m].
  double largest_bend() const { return std::sqrt(largest_bend2_); }

 private:
  /// Completes truth and patches without sending them anywhere.
  void finish_light();
  void deposit(Frame frame, Deposit const& light);
  /// What the cone of a dot comes to at every place of the source; its points are in cone_points_.
  struct ConeIntegral {
    CorrectedCone cone;
    DisplacementMoments whole[PlaceRule::most_places];
    double without_medium[PlaceRule::most_places] = {};
    bool narrow = true;  ///< at all places
  };
  /// Of a dot that the table covers; empty: its rays have to do.
  std::optional<ConeIntegral> integrate_cone(DotErrors const& errors);
  /// Lays down the light in the flow square by square. @return false: there are too many, and nothing was done
  bool deposit_wide(ConeIntegral const& integral);
  /// Lays down the light in the flow by the moments about one displacement.
  void deposit_narrow(ConeIntegral const& integral);
  /// Lays down the source's disc as the reference frame shows it.
  void deposit_source(Frame frame);
  FlowFit fit_flow() const;
  /// Lays down the light in the flow by a fit and what the rays leave of it.
  void deposit_rays();

  LightModel const& model_;
  bool with_images_;
  Vec2d centre_{};
  DotPlan plan_;
  double light_per_weight_ = 0;
  std::vector<RayRecord<double>> rays_;  ///< of the dot, where images are controlled
  LightImage* images_[frame_count] = {};
  std::vector<DotPatch> patches_;
  DotSums of_scramblings_[most_scramblings];
  std::uint64_t recorded_ = 0;  ///< rays so far
  bool tabled_ = false;         ///< whether the deflection table covers the dot's rays
  TableCheck check_;            ///< of all rays
  DotTruth truth_;
  std::vector<ConeLight> cone_points_;      ///< of all places
  std::vector<DisplacementMoments> parts_;  ///< by square of displacement and place
  DotPatch::Series column_, row_;           ///< of one point of the source
  bool moved_ = false;                      ///< whether the flow did anything to any of its rays
  StatusCounts statuses_{};
  double largest_bend2_ = 0;
};

/// Traces the first `rays` rays of a dot in order, two side by side. @throws Interrupted
template <class Medium>
void trace_dot(TracePair<double, Medium> const& pair, std::uint64_t dot, std::uint64_t rays, DotExposure& exposure) {
  std::uint64_t ray = 0;
  for (; ray + 2 <= rays; ray += 2) {
    throw_if_interrupted();  // each of them may take a million steps
    pair.template together<2>({dot, ray}, exposure);
  }
  if (ray < rays) pair.template together<1>({dot, ray}, exposure);
}

}  // namespace gladstone
