#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/image.h"
#include "render/base/interrupt.h"
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
  /// Disc as above; a spot that is wider than a twentieth of the disc is integrated to 1e-5 of the peak, a Table 1 dot
  /// to 4e-7. Square: Gauss-Legendre in both directions. A point: itself.
  /// @param half_size_px of the source's image; the finer the spot beside it, the more points
  static SourceCubature make(SourceShape shape, double half_size_px, double spot_px);
};

SourceCubature make_cubature(Scene const& scene, DotPattern const& sources, SpotView const& spot);

/// What is known of a dot's light before its rays are traced.
struct DotPlan {
  Vec2d origin{};              ///< image of the dot's centre without medium [px]
  double expected_weight = 0;  ///< sum of the weights of all rays that pass the stop, expected
  bool control = false;        ///< see DotExposure
};

/// @param spot null: no images
DotPlan plan_dot(Scene const& scene, SpotView const* spot, SceneView<double> const& view, std::uint64_t dot);

/// What one ray tells about where the flow sends a dot's light.
struct RayRecord {
  Vec2d place;         ///< on the source, in units of its half size
  Vec2d pupil;         ///< where it meets the lens plane in the reference frame [m]
  Vec2d displacement;  ///< flow hit minus the geometric image of its place [px]
  Vec2d bend;          ///< where it meets the lens plane in the flow frame, minus that [m]
  double weight;       ///< radiance cos^4
  double flow_weight;  ///< the same times what passes the stop in the flow frame
};

/// A smooth model of a dot's light in the flow: displacement as a polynomial of the place on the source (cubic) and of
/// the pupil point (quadratic), arrival on the lens plane as a linear function of both. Where the rays are few, or the
/// source is a point, the model is simpler.
class FlowFit {
 public:
  /// Least squares over a dot's rays.
  /// @param extended false: the source is a point
  void fit(std::vector<RayRecord> const& rays, double stop_radius, bool extended);

  Vec2d displacement(Vec2d place, Vec2d pupil) const;
  /// Where a ray is expected to arrive on the lens plane, and the pupil point of a ray that arrives there [m].
  Vec2d arrival(Vec2d pupil, Vec2d place) const;
  Vec2d pupil_of(Vec2d arrival, Vec2d place) const;
  /// Pupil area that arrives on a unit of the stop's area.
  double area_ratio() const;
  /// How far the pupil's rim moves the displacement [px].
  double pupil_spread() const;

 private:
  static constexpr int displacement_terms = 19;
  static constexpr int bend_terms = 5;  ///< 1, pupil x, y, place x, y
  std::size_t rays_ = 0;
  bool extended_ = false;
  double stop_radius_ = 1;
  int terms_ = 0;
  Vec2d displacement_[displacement_terms];
  Vec2d bend_[bend_terms];

  static int basis(Vec2d place, Vec2d pupil, std::size_t rays, bool extended, double* value);
  /// d arrival / d pupil: [[a, b], [c, d]] and its determinant.
  struct Jacobian {
    double a, b, c, d;
    double determinant() const { return a * d - b * c; }
  };
  Jacobian arrival_by_pupil() const;
};

/// Gathers everything that one dot's rays leave behind; TracePair's Exposure on the CPU. One object a thread, one dot
/// at a time, rays in order, so that sums are the same on any number of threads.
///
/// Images use a control variate where the reference frame is known in closed form (a thin lens focused on the target
/// maps every ray of a source's point on one image point, so the reference image is the source's disc convolved with
/// the spot, integrated by cubature): the flow image is the same disc moved by a smooth fit to the rays' displacements,
/// integrated likewise, plus for every ray the spot where it lands minus the spot where the fit puts it. Whatever the
/// fit, the sum converges to the image that the rays alone would give; the better the fit, the less it scatters.
class DotExposure {
 public:
  /// @param spot null: truth only, no images
  /// @param scene,cubature outlive the exposure
  DotExposure(Scene const& scene, DotPattern const& sources, SpotView const* spot, SourceCubature const& cubature);

  /// Starts a dot. @param plan says where its light is expected
  void begin(DotPlan const& plan, LightImage* const (&images)[frame_count], double light_per_weight);

  /// What TracePair leaves behind for one ray.
  void record(EmittedRay<double> const& emitted, RayHit<double> const& reference, RayHit<double> const& flow);

  /// Ends the dot: its light joins the images, its truth is written.
  void finish(GroundTruth& truth, std::size_t dot);
  /// Completes the patches without sending them anywhere.
  void finish_light() {
    if (with_image_ && plan_.control) deposit_controlled();
  }

  LightPatch const& patch(Frame frame) const { return patches_[static_cast<std::size_t>(frame)]; }
  CentroidSum<double> const& sum(Frame frame) const { return sums_[static_cast<std::size_t>(frame)]; }
  StatusCounts const& statuses() const { return statuses_; }
  /// Largest distance by which the medium moved a ray on the lens plane [m].
  double largest_bend() const { return std::sqrt(largest_bend2_); }

 private:
  void deposit(Frame frame, Vec2d p, double weight);

  void deposit_controlled();

  Scene const& scene_;
  SourceCubature const& cubature_;
  bool with_image_;
  DotPlan plan_;
  ApertureStop<double> stop_;  ///< meaningless for chief rays
  double stop_radius_;         ///< [m]; 1 without a stop
  double half_size_px_ = 0;    ///< of the source's image
  double light_per_weight_ = 0;
  std::vector<RayRecord> rays_;  ///< of the dot, where images are controlled
  LightImage* images_[frame_count] = {};
  std::vector<LightPatch> patches_;
  CentroidSum<double> sums_[frame_count];
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
