#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/interrupt.h"
#include "render/focused_dots/dot_light.h"
#include "render/focused_dots/trace_pair.h"
#include "render/scene/ground_truth.h"
#include "render/scene/light_image.h"
#include "render/scene/scene.h"
#include "render/scene/truth_error.h"

namespace gladstone {

/// A square piece of a frame in which one dot's rays are gathered in double before they join the image.
class LightPatch {
 public:
  /// @param images of the squares of displacement that it is to hold, or none
  LightPatch(SpotView const& spot, MomentImages const& images);

  /// Adds one ray's spot of weight `weight` at p [px]; a spot beyond the patch first sends the patch to the image.
  void deposit(Vec2d p, double weight, LightImage* image, double light_per_weight);
  /// A Gaussian spot along one axis: its shares of the pixels from `first` on, and their derivatives by its place.
  struct Series {
    int first = 0;               ///< pixel [px]
    std::vector<double> shares;  ///< [order + 1][width] of taylor_shares()
  };
  /// Series of a spot at p [px]. @return false beyond any image
  bool make_series(double p, Series& series) const;
  /// Adds Gaussian spots whose displacements from where the series stand have these moments.
  void deposit(Series const& column, Series const& row, double weight, DisplacementMoments const& moments,
               LightImage* image, double light_per_weight);
  /// Adds the light of one of the sensor's squares of displacement.
  void deposit(Vec2<int> square, double weight, MomentField const& field, LightImage* image, double light_per_weight);
  /// Adds what has been gathered to the image (if any) and clears the patch.
  void flush(LightImage* image, double light_per_weight);

  /// Calls visit(column, row, gathered weight) for every pixel touched since the last flush.
  template <class Visit>
  void for_each_touched(Visit&& visit) const {
    for (int row = low_row_; row < high_row_; ++row) {
      for (int column = low_column_; column < high_column_; ++column) {
        visit(column + left_, row + top_, light_[static_cast<std::size_t>(row * side_ + column)]);
      }
    }
  }

 private:
  SpotView spot_;
  MomentImages images_;
  int half_;
  int side_;
  int left_ = 0, top_ = 0;                                             // image position of the patch's corner
  int low_column_ = 0, high_column_ = 0, low_row_ = 0, high_row_ = 0;  // touched part
  std::vector<double> light_;
  std::vector<double> column_shares_, row_shares_;  ///< for shares()
  std::vector<double> of_square_;                   ///< light of a square of displacement

  /// Makes room for a spot and marks it as touched. @return the place of its first pixel
  double* reach(Footprint const& spot, LightImage* image, double light_per_weight);
};

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
  /// Completes truth and patches without sending them anywhere.
  void finish_light();

  LightPatch const& patch(Frame frame) const { return patches_[static_cast<std::size_t>(frame)]; }
  StatusCounts const& statuses() const { return statuses_; }
  /// Largest distance by which the medium moved a ray on the lens plane [m].
  double largest_bend() const { return std::sqrt(largest_bend2_); }

 private:
  void deposit(Frame frame, Deposit const& light);
  /// What the cone of a dot comes to at every place of the source; its points are in cone_points_.
  struct ConeIntegral {
    CorrectedCone cone;
    DisplacementMoments whole[PlaceRule::most_places];
    double without_medium[PlaceRule::most_places] = {};
    bool narrow = true;  ///< at all places
  };
  /// Of a dot that the table covers; empty: its rays have to do.
  std::optional<ConeIntegral> integrate_cone(TruthErrors const& errors);
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
  std::vector<LightPatch> patches_;
  RaySums of_scramblings_[most_scramblings];
  std::uint64_t recorded_ = 0;  ///< rays so far
  bool tabled_ = false;         ///< whether the deflection table covers the dot's rays
  TableCheck check_;            ///< of all rays
  DotTruth truth_;
  std::vector<ConeLight> cone_points_;      ///< of all places
  std::vector<DisplacementMoments> parts_;  ///< by square of displacement and place
  LightPatch::Series column_, row_;         ///< of one point of the source
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
  if (ray < rays) pair({dot, ray}, exposure);
}

}  // namespace gladstone
