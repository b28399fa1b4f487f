#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// Independent implementation of a density plane: periodic cubic B-spline, read and filtered without render/medium.
class PeriodicPlane {
 public:
  explicit PeriodicPlane(FieldSetup const& field) {
    Hdf5Reader const reader(field.file);
    auto const shape = reader.shape("Density_0001");  // z, y, x, component
    rows_ = static_cast<int>(shape[1]), columns_ = static_cast<int>(shape[2]);
    coefficients_ = reader.read("Density_0001");
    for (double& value : coefficients_) value *= field.scale.value_or(1);
    spacing_ = field.spacing->x;
    for (int row = 0; row < rows_; ++row) filter(row * columns_, 1, columns_);
    for (int column = 0; column < columns_; ++column) filter(column, columns_, rows_);
  }
  /// grad rho at (x, y) [kg/m^4]; the grid's centre is on the axis.
  Vec2d gradient(double x, double y) const {
    double const u = x / spacing_ + 0.5 * (columns_ - 1), v = y / spacing_ + 0.5 * (rows_ - 1);
    double const i = std::floor(u), j = std::floor(v);
    auto const wx = basis(u - i), wy = basis(v - j), dx = slope(u - i), dy = slope(v - j);
    Vec2d sum{};
    for (int b = 0; b < 4; ++b) {
      double const* const line =
          &coefficients_[static_cast<std::size_t>(wrap(static_cast<int>(j) - 1 + b, rows_) * columns_)];
      for (int a = 0; a < 4; ++a) {
        double const c = line[wrap(static_cast<int>(i) - 1 + a, columns_)];
        sum += c * Vec2d{dx[std::size_t(a)] * wy[std::size_t(b)], wx[std::size_t(a)] * dy[std::size_t(b)]};
      }
    }
    return sum / spacing_;
  }

 private:
  static int wrap(int i, int n) { return ((i % n) + n) % n; }
  static std::array<double, 4> basis(double t) {
    double const s = 1 - t;
    return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
  }
  static std::array<double, 4> slope(double t) {
    double const s = 1 - t;
    return {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2};
  }
  /// Solves the periodic system (c[i-1] + 4 c[i] + c[i+1])/6 = f[i]: c = sqrt(3) sum z^|k| f[i+k], z = sqrt(3) - 2
  /// (Unser 1993).
  void filter(int start, int stride, int n) {
    std::vector<double> f(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) f[std::size_t(i)] = coefficients_[std::size_t(start + i * stride)];
    for (int i = 0; i < n; ++i) {
      double sum = f[std::size_t(i)], power = 1;
      for (int k = 1; k < 28; ++k) {
        power *= std::sqrt(3.0) - 2;
        sum += power * (f[std::size_t(wrap(i - k, n))] + f[std::size_t(wrap(i + k, n))]);
      }
      coefficients_[std::size_t(start + i * stride)] = std::sqrt(3.0) * sum;
    }
  }

  int columns_ = 0, rows_ = 0;
  double spacing_ = 0;
  std::vector<double> coefficients_;
};

/// Displacement of one dot by straight rays [px]: clipped at the stop in each frame, clipped to the rays common to
/// both, and unclipped.
struct StraightTruth {
  Vec2d clipped, common, unclipped;
};

/// Computes the displacement of one dot by rays through slices of the field, each of which deflects the ray by K grad
/// rho dz/n0 at its intersection with the undeflected ray. The dot and the enlarged pupil are sampled by the additive
/// recurrence of the four-dimensional golden ratio.
StraightTruth straight_truth(PeriodicPlane const& plane, PlannedScene const& scene, Vec2d centre, int rays) {
  double const phi = 1.1673039782614187;  // real root of x^5 = x + 1
  double const step[4] = {1 / phi, std::pow(phi, -2), std::pow(phi, -3), std::pow(phi, -4)};
  double const stop = scene.imaging.entrance_pupil / 2, wide = stop + scene.plan.pupil_margin, z_b = scene.setup.z_b();
  constexpr int slices = 12;
  double const dz = scene.setup.medium.thickness / slices;
  Vec2d clipped[2]{}, common[2]{}, unclipped{};
  double in_stop[2]{}, in_both = 0;
  for (int k = 1; k <= rays; ++k) {
    double u[4], whole;
    for (int d = 0; d < 4; ++d) u[d] = std::modf(0.5 + k * step[d], &whole);
    double const disc = scene.dots.half_size * std::sqrt(u[0]), reach = wide * std::sqrt(u[2]);
    Vec2d const start = centre + disc * Vec2d{std::cos(2 * pi * u[1]), std::sin(2 * pi * u[1])};
    Vec2d const pupil = reach * Vec2d{std::cos(2 * pi * u[3]), std::sin(2 * pi * u[3])};
    Vec2d const tangent = (pupil - start) / z_b;
    Vec2d apparent{}, bent{};
    for (int slice = 0; slice < slices; ++slice) {
      double const s = scene.setup.z_d - scene.setup.medium.thickness / 2 + (slice + 0.5) * dz;
      Vec2d const turn = scene.setup.medium.gladstone_dale * dz / scene.setup.ambient_index() *
                         plane.gradient(start.x + tangent.x * s, start.y + tangent.y * s);
      apparent += -s * turn;
      bent += (z_b - s) * turn;
    }
    double const weight = std::pow(1 + dot(tangent, tangent), -2);
    bool const reference = length(pupil) <= stop, flow = length(pupil + bent) <= stop;
    Vec2d const from_centre = start - centre;
    if (reference) clipped[0] += weight * from_centre, unclipped += weight * apparent, in_stop[0] += weight;
    if (flow) clipped[1] += weight * (from_centre + apparent), in_stop[1] += weight;
    if (reference && flow) common[0] += weight * apparent, in_both += weight;
  }
  double const scale = scene.imaging.magnification / scene.setup.camera.pixel_pitch;
  auto const to_px = [scale](Vec2d on_target) { return Vec2d{scale * on_target.x, -scale * on_target.y}; };
  return {to_px(clipped[1] / in_stop[1] - clipped[0] / in_stop[0]), to_px(common[0] / in_both),
          to_px(unclipped / in_stop[0])};
}

/// Returns positions spread over the view by the recurrence of the plastic number.
std::vector<Vec2d> spread_places(int count) {
  std::vector<Vec2d> places;
  double whole;
  for (int i = 1; i <= count; ++i) {
    places.push_back(
        {512 * std::modf(i * 0.7548776662466927, &whole) - 0.5, 512 * std::modf(i * 0.5698402909980532, &whole) - 0.5});
  }
  return places;
}

struct RmsRatio {
  double difference = 0, signal = 0;
  void add(Vec2d a, Vec2d b) { difference += dot(a - b, a - b), signal += dot(b, b); }
  double value() const { return std::sqrt(difference / signal); }
};

PlannedScene dns_scene(std::string const& instant, int dots, double dot_px, std::uint64_t rays) {
  auto setup = table1_setup(512);
  setup.target.dot_diameter_px = dot_px;
  setup.medium.field = dns_plane(instant);
  return scene_with_dots(setup, spread_places(dots), rays);
}

/// Returns the rms difference between the renderer's truth and straight rays over the rms truth, for 20 dots. Each of
/// the four scramblings of their rays has 2^13 points.
double straight_ray_error(std::string const& instant, double dot_px) {
  PlannedScene scene = dns_scene(instant, 20, dot_px, 1 << 15);
  GroundTruth const truth = RaysRenderer()
                                .render(scene, scene.plan, scene.dots, RenderImages::no, RenderTheory::no)
                                .truth;  // by ray tracing alone
  PeriodicPlane const plane(scene.setup.medium.field);
  RmsRatio ratio;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    ratio.add(truth.displacement_px[i], straight_truth(plane, scene, scene.dots.centre[i], 20000).clipped);
  }
  return ratio.value();
}

// Rays through the late plane are deflected by 2e-5 rad rms and depart from the straight line by 1e-7 m = 0.2 % of a
// cell; the sampling error of 2^14 points of the cone is 0.2 % of the displacement of 0.07 px. Rays at the stop's edge
// that pass in one frame only are g = 1e-2 of the bundle and have the dot's radius: for dots of 3 px, this adds sqrt(g
// N) 0.75 px/N = 6e-4 px in both sums.
TEST(StopLimitedTruth, AgreesWithStraightRaysOnTheLatePlane) {
  EXPECT_LT(straight_ray_error("late", 0), 0.004);
  EXPECT_LT(straight_ray_error("late", 3), 0.03);
}

// On the early plane, rays are deflected by 1.8e-4 rad rms (1.6e-3 at most) and depart from the straight line by 1e-6
// m, 1.5 % of a cell: 1 % of the gradient where it changes over a front's width of a few cells.
TEST(StopLimitedTruth, AgreesWithStraightRaysOnTheEarlierPlane) {
  EXPECT_LT(straight_ray_error("kepeak", 0), 0.015);
  EXPECT_LT(straight_ray_error("kepeak", 3), 0.02);
}

// The truth without clipping, from rays over the undeflected pupil, has an error of about 25 % rms on the early plane
// and 2 % on the late one; clipping to rays common to both frames has errors of 16 % and 2 % (rms of the vector
// difference over rms of the displacement, over the view; the tolerances are wide, since 300 points sample only a few
// independent fronts).
TEST(StopLimitedTruth, CannotBeHadWithoutClippingInEachFrame) {
  struct Case {
    char const* instant;
    double unclipped, common;
  };
  for (Case const& one : {Case{"kepeak", 0.25, 0.16}, Case{"late", 0.02, 0.02}}) {
    PlannedScene scene = dns_scene(one.instant, 300, 0, 1);
    PeriodicPlane const plane(scene.setup.medium.field);
    RmsRatio unclipped, common;
    for (Vec2d const centre : scene.dots.centre) {
      StraightTruth const truth = straight_truth(plane, scene, centre, 3000);
      unclipped.add(truth.unclipped, truth.clipped);
      common.add(truth.common, truth.clipped);
    }
    EXPECT_NEAR(unclipped.value() / one.unclipped, 1, 0.4) << one.instant;
    EXPECT_NEAR(common.value() / one.common, 1, 0.4) << one.instant;
  }
}

}  // namespace
}  // namespace gladstone
