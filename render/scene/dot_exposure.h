#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/image.h"
#include "render/optics/lens_setup.h"
#include "render/scene/ground_truth.h"
#include "render/scene/scene.h"
#include "render/scene/trace_pair.h"
#include "render/sensor/exposure.h"

namespace gladstone {

/// The spot that every ray leaves on the sensor; one model a launch.
struct SpotView {
  SpotModel model = SpotModel::none;
  GaussianSpot<double> gaussian;  ///< for the three Gaussian models
  AiryTable::View airy;           ///< for SpotModel::airy

  /// Pixels a ray's light reaches to each side of its own.
  int half_width() const {
    if (model == SpotModel::none) return 0;
    return model == SpotModel::airy ? airy.half_width : gaussian.half_width();
  }
};

/// The spot of a scene's lens; an Airy table is built into `airy`, which must outlive the view.
SpotView make_spot(Scene const& scene, std::optional<AiryTable>& airy);

/// An image in the making: 64-bit fixed point, added to from many threads in any order.
class LightImage {
 public:
  LightImage(int columns, int rows)
      : columns_(columns), rows_(rows), light_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  void add(int column, int row, double light) {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return;
    light_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)].fetch_add(
        to_fixed_point(light), std::memory_order_relaxed);
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
  int left_ = 0, top_ = 0;                                                   // image position of the patch's corner
  int low_column_ = 0, high_column_ = 0, low_row_ = 0, high_row_ = 0;        // touched part
  std::vector<double> light_;
  std::vector<double> column_shares_, row_shares_;
};

/// Gathers everything that one dot's rays leave behind; TracePair's Exposure on the CPU. One object a thread, one dot
/// at a time, rays in order, so that sums are the same on any number of threads.
class DotExposure {
 public:
  /// @param spot null: truth only, no images
  explicit DotExposure(SpotView const* spot) : with_image_(spot != nullptr) {
    if (spot) patches_.assign(frame_count, LightPatch(*spot));
  }

  /// Starts a dot whose chief ray ends near `origin` [px].
  void begin(Vec2d origin, LightImage* const (&images)[frame_count], double light_per_weight) {
    origin_ = origin;
    light_per_weight_ = light_per_weight;
    for (int frame = 0; frame < frame_count; ++frame) {
      images_[frame] = images[frame];
      sums_[frame] = {};
    }
  }
  void deposit(Frame frame, RayHit<double> const& hit) {
    auto const f = static_cast<std::size_t>(frame);
    if (!reaches_sensor_plane(hit.status)) return;
    sums_[f].add(hit.pixel - origin_, hit.weight);
    if (with_image_) patches_[f].deposit(hit.pixel, hit.weight, images_[f], light_per_weight_);
  }
  void record_truth(std::uint64_t, EmittedRay<double> const& emitted, RayHit<double> const& reference,
                    RayHit<double> const& flow) {
    ++statuses_[0][static_cast<std::size_t>(reference.status)];
    ++statuses_[1][static_cast<std::size_t>(flow.status)];
    if (flow.status <= RayStatus::vignetted) {
      Vec2d const bend = flow.at_lens - emitted.pupil;
      largest_bend2_ = std::max(largest_bend2_, dot(bend, bend));
    }
  }
  /// Ends the dot: its light joins the images, its truth is written.
  void finish(GroundTruth& truth, std::size_t dot);

  LightPatch const& patch(Frame frame) const { return patches_[static_cast<std::size_t>(frame)]; }
  CentroidSum<double> const& sum(Frame frame) const { return sums_[static_cast<std::size_t>(frame)]; }
  StatusCounts const& statuses() const { return statuses_; }
  /// Largest distance by which the medium moved a ray on the lens plane [m].
  double largest_bend() const { return std::sqrt(largest_bend2_); }

 private:
  bool with_image_;
  Vec2d origin_{};
  double light_per_weight_ = 0;
  LightImage* images_[frame_count] = {};
  std::vector<LightPatch> patches_;
  CentroidSum<double> sums_[frame_count];
  StatusCounts statuses_{};
  double largest_bend2_ = 0;
};

}  // namespace gladstone
