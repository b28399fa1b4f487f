#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/image.h"
#include "render/base/interrupt.h"
#include "render/scene/dot_light.h"
#include "render/scene/ground_truth.h"
#include "render/scene/scene.h"
#include "render/scene/trace_pair.h"
#include "render/sensor/exposure.h"

namespace gladstone {

/// The spot of a scene's lens; an Airy table is built into `airy`, which must outlive the view.
SpotView make_spot(Scene const& scene, std::optional<AiryTable>& airy);

/// An image in the making: 64-bit fixed point, added to from many threads in any order.
class LightImage {
 public:
  LightImage(int columns, int rows)
      : columns_(columns), rows_(rows), light_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  void add(int column, int row, double light) {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return;
    light_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)]
        .fetch_add(to_fixed_point(light), std::memory_order_relaxed);
  }
  Image<double> to_light() const {
    Image<double> image(columns_, rows_);
    for (std::size_t i = 0; i < light_.size(); ++i) {
      image.data()[i] = static_cast<double>(light_[i].load(std::memory_order_relaxed)) / fixed_point_one;
    }
    return image;
  }

 private:
  int columns_;
  int rows_;
  std::vector<std::atomic<std::int64_t>> light_;
};

/// A square piece of a frame in which one dot's rays are gathered in double before they join the image.
class LightPatch {
 public:
  explicit LightPatch(SpotView const& spot);

  /// Adds one ray's spot of weight `weight` at p [px]; a spot beyond the patch first sends the patch to the image.
  void deposit(Vec2d p, double weight, LightImage* image, double light_per_weight);
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
  int half_;
  int side_;
  int left_ = 0, top_ = 0;                                             // image position of the patch's corner
  int low_column_ = 0, high_column_ = 0, low_row_ = 0, high_row_ = 0;  // touched part
  std::vector<double> light_;
  std::vector<double> column_shares_, row_shares_;
};

/// Points of a unit disc (or square) with weights that integrate what a spot makes of a source to far below a grey
/// level.
struct SourceCubature {
  std::vector<Vec2d> points;    ///< offsets in units of the source's half size
  std::vector<double> weights;  ///< sum 1

  /// Uniform over the unit disc: Gauss-Legendre in r^2 times equal angles, turned by half a step from ring to ring.
  /// @param innermost,outermost points on a ring of radius zero and one; between them in proportion
  static SourceCubature disc(int radial, int innermost, int outermost);
  /// Seven points, exact up to degree 5 over the unit disc (Radon 1948; Stroud 1971, S2: 5-1).
  static SourceCubature radon();
  /// Disc as above; a spot that is wider than a twentieth of the disc is integrated to 1e-5 of the peak, a Table 1 dot
  /// to 4e-7. Square: Gauss-Legendre in both directions. A point: itself.
  /// @param half_size_px of the source's image; the finer the spot beside it, the more points
  static SourceCubature make(SourceShape shape, double half_size_px, double spot_px);
};

/// A scene's light model with the rules that it integrates by; the spot's Airy table is the caller's.
struct OwnedLightModel {
  LightModel model;
  SourceCubature source;
  SourceCubature pupil[pupil_rules];

  /// @param spot null: no images
  OwnedLightModel(Scene const& scene, DotPattern const& sources, SpotView const* spot);
  OwnedLightModel(OwnedLightModel const&) = delete;  // the model points into the rules
  OwnedLightModel& operator=(OwnedLightModel const&) = delete;
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
  /// Completes the patches without sending them anywhere.
  void finish_light() {
    if (with_images_ && model_.controlled) deposit_controlled();
  }

  LightPatch const& patch(Frame frame) const { return patches_[static_cast<std::size_t>(frame)]; }
  CentroidSum<double> const& sum(Frame frame) const { return sums_[static_cast<std::size_t>(frame)]; }
  StatusCounts const& statuses() const { return statuses_; }
  /// Largest distance by which the medium moved a ray on the lens plane [m].
  double largest_bend() const { return std::sqrt(largest_bend2_); }

 private:
  void deposit(Frame frame, Deposit const& light);
  FlowFit fit_flow() const;
  void deposit_controlled();

  LightModel const& model_;
  bool with_images_;
  Vec2d centre_{};
  DotPlan plan_;
  double light_per_weight_ = 0;
  std::vector<RayRecord<double>> rays_;  ///< of the dot, where images are controlled
  LightImage* images_[frame_count] = {};
  std::vector<LightPatch> patches_;
  CentroidSum<double> sums_[frame_count];
  bool moved_ = false;  ///< whether the flow did anything to any of its rays
  StatusCounts statuses_{};
  double largest_bend2_ = 0;
};

/// Ctrl-C is looked for this often within a dot, whose rays may take seconds.
inline constexpr std::uint64_t rays_between_polls = 128;

/// Traces the first `rays` rays of a dot in order, two side by side. @throws Interrupted
template <class Medium>
void trace_dot(TracePair<double, Medium> const& pair, std::uint64_t dot, std::uint64_t rays, DotExposure& exposure) {
  std::uint64_t ray = 0;
  for (; ray + 2 <= rays; ray += 2) {
    if (ray % rays_between_polls == 0) throw_if_interrupted();
    pair.template together<2>({dot, ray}, exposure);
  }
  if (ray < rays) pair({dot, ray}, exposure);
}

}  // namespace gladstone
