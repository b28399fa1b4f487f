#include "analysis/stereo/reconstruct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "analysis/stereo/interpolated_field.h"
#include "tests/analysis/stereo/inclined_camera.h"

namespace gladstone::inline stereo {
namespace {

using Motion = std::function<Vec3d(Vec3d)>;

/// Exact vectors of a camera on (2 n + 1)^2 nodes about its principal point.
DisplacementField image_motion(PinholeCamera const& camera, Motion const& motion, int n = 15, double spacing_px = 16) {
  DisplacementField field;
  field.columns = field.rows = 2 * n + 1;
  for (int j = -n; j <= n; ++j) {
    for (int i = -n; i <= n; ++i) {
      Vec2d const pixel{256 + spacing_px * i, 256 + spacing_px * j};
      Vec3d const at = ObjectPlane{}.point(intersect_plane(camera, pixel, {}).value());
      Vec3d const moved = motion(at);
      field.position_px.push_back(pixel);
      field.displacement_px.push_back(camera.project(at + 0.5 * moved) - camera.project(at - 0.5 * moved));
    }
  }
  return field;
}

/// Returns the vector at the node x = y = 0.
StereoVector vector_at_origin(StereoField const& field) {
  for (std::size_t i = 0; i < field.grid.size(); ++i)
    if (length(field.grid.position(i)) < 1e-9) return field.nodes[i].value();
  ADD_FAILURE() << "no node at the origin";
  return {};
}

TEST(SightLine, InvertsTheProjectionOfADistortingCamera) {
  PinholeCamera camera = inclined_camera(20);
  camera.value[0] = camera.value[1] = 1500;
  camera.value[4] = -0.12;
  camera.value[5] = 0.06;
  camera.value[6] = 1e-3;
  camera.value[7] = -5e-4;
  for (Vec2d const pixel : {Vec2d{0, 0}, Vec2d{256, 256}, Vec2d{900, 30}, Vec2d{-200, 700}}) {
    auto const line = find_sight_line(camera, pixel);
    ASSERT_TRUE(line);
    EXPECT_NEAR(length(line->direction), 1.0, 1e-12);
    for (double const along : {0.1, 0.7}) {
      Vec2d const image = camera.project(line->origin + along * line->direction);
      EXPECT_NEAR(image.x, pixel.x, 1e-6);
      EXPECT_NEAR(image.y, pixel.y, 1e-6);
    }
    ObjectPlane const plane{0.01, {0.1, -0.05}};
    auto const at = intersect_plane(camera, pixel, plane);
    ASSERT_TRUE(at);
    EXPECT_NEAR(length(camera.project(plane.point(*at)) - pixel), 0.0, 1e-6);
  }
}

TEST(SightLine, AnglesBetweenViewsAddUp) {
  EXPECT_NEAR(find_view_angle(inclined_camera(-30), inclined_camera(45), {}), 75 * std::numbers::pi / 180, 1e-9);
}

// Motions of one pixel along each axis are recovered exactly, except for the interpolation between vectors: bilinear at
// the border, of the order of (h / z)^2 = 6e-6 of 0.5 mm for distances h of 1.6 mm and z = 650 mm.
TEST(StereoReconstruction, RecoversUniformMotionAlongEveryAxis) {
  for (double const degrees : {30.0, 45.0}) {
    PinholeCamera const left = inclined_camera(-degrees), right = inclined_camera(degrees);
    for (Vec3d const motion : {Vec3d{1e-4, 0, 0}, Vec3d{0, 1e-4, 0}, Vec3d{0, 0, 1e-4}, Vec3d{3e-4, -2e-4, 4e-4}}) {
      auto const uniform = [&](Vec3d) { return motion; };
      StereoField const field = reconstruct({left, {}}, image_motion(left, uniform), {right, {}},
                                            image_motion(right, uniform), {}, {.spacing = 2e-3});
      ASSERT_GT(field.nodes.size(), 400u);
      std::size_t determined = 0;
      for (auto const& node : field.nodes) {
        if (!node) continue;
        ++determined;
        EXPECT_LT(length(node->displacement - motion), 1e-8) << degrees;
        EXPECT_LT(node->residual_px, 1e-3);
        EXPECT_TRUE(std::isnan(node->covariance[0])) << "vectors without uncertainty";
      }
      EXPECT_GT(determined, field.nodes.size() / 2);
    }
  }
}

// Vectors of dewarped images: intersections of the lines of sight of P + D/2 and P - D/2 with the plane, in its pixels.
TEST(StereoReconstruction, AcceptsVectorsOfDewarpedImages) {
  PinholeCamera const left = inclined_camera(-45), right = inclined_camera(45);
  Vec3d const motion{1e-4, -2e-4, 1.5e-4};
  Dewarping const dewarping{{2e-4, {0.01, 0}}, NodeGrid::between({-0.02, -0.02}, {0.02, 0.02}, 1e-4)};
  auto const seen = [&](PinholeCamera const& camera) {
    DisplacementField field = image_motion(
        camera, [](Vec3d) { return Vec3d{}; }, 10);
    for (std::size_t i = 0; i < field.size(); ++i) {
      field.position_px[i] = field.position_px[i] - Vec2d{56, 56};  // about the middle of 401 x 401 px
      Vec3d const at = dewarping.plane.point(dewarping.grid.position_of_pixel(field.position_px[i]));
      auto const image = [&](Vec3d point) {
        return dewarping.grid.pixel(intersect_plane(camera, camera.project(point), dewarping.plane).value());
      };
      field.displacement_px[i] = image(at + 0.5 * motion) - image(at - 0.5 * motion);
    }
    return field;
  };
  StereoSettings settings;
  settings.dewarping = dewarping;
  StereoField const field = reconstruct({left, {}}, seen(left), {right, {}}, seen(right), dewarping.plane, settings);
  EXPECT_NEAR(field.grid.spacing, 1.6e-3, 1e-9) << "the distance of 16 dewarped pixels";
  EXPECT_LT(length(vector_at_origin(field).displacement - motion), 1e-8);
  EXPECT_GT(field.nodes.size(), 300u);
}

// Cameras at different angles, and a plane that is inclined: the displacement refers to the axes of the world.
TEST(StereoReconstruction, AcceptsAnyPlaneAndAngles) {
  PinholeCamera const a = inclined_camera(-50), b = inclined_camera(10);
  ObjectPlane const plane{1e-3, {0.02, -0.03}};
  Vec3d const motion{1e-4, 2e-4, -1e-4};
  auto const seen = [&](PinholeCamera const& camera) {
    DisplacementField field = image_motion(camera, [&](Vec3d) { return motion; });
    for (std::size_t i = 0; i < field.size(); ++i) {
      Vec3d const at = plane.point(intersect_plane(camera, field.position_px[i], plane).value());
      field.displacement_px[i] = camera.project(at + 0.5 * motion) - camera.project(at - 0.5 * motion);
    }
    return field;
  };
  StereoField const field = reconstruct({a, {}}, seen(a), {b, {}}, seen(b), plane);
  EXPECT_LT(length(vector_at_origin(field).displacement - motion), 2e-9);
}

// Cameras at -a and +a measure m (u cos a -+ w sin a) and m v, with the magnification m on the axis. Errors sigma of
// both give sigma / (sqrt 2 m cos a), sigma / (sqrt 2 m), sigma / (sqrt 2 m sin a).
TEST(StereoReconstruction, UncertaintyFollowsFromTheAngle) {
  double const degrees = 35, a = degrees * std::numbers::pi / 180, sigma = 0.05;
  PinholeCamera const left = inclined_camera(-degrees), right = inclined_camera(degrees);
  auto const seen = [&](PinholeCamera const& camera) {
    DisplacementField field = image_motion(camera, [](Vec3d) { return Vec3d{}; });
    field.sigma_px.assign(field.size(), {sigma, sigma});
    return field;
  };
  StereoVector const vector =
      vector_at_origin(reconstruct({left, {}}, seen(left), {right, {}}, seen(right), {}, {.spacing = 2e-3}));
  double const unit = sigma / (std::numbers::sqrt2 * scale);
  EXPECT_NEAR(vector.sigma().x, unit / std::cos(a), 1e-4 * unit);
  EXPECT_NEAR(vector.sigma().y, unit, 1e-4 * unit);
  EXPECT_NEAR(vector.sigma().z, unit / std::sin(a), 1e-4 * unit);
  for (std::size_t k = 3; k < 6; ++k) EXPECT_NEAR(vector.covariance[k], 0.0, 1e-4 * unit * unit);
}

// v is measured twice. A difference d between the two measurements leaves the residuals d/2 and -d/2, whose root of the
// sum of squares is d / sqrt 2. Independent errors sigma of both give it a standard deviation of sigma.
TEST(StereoReconstruction, ResidualIsTheDisagreementOfBothCameras) {
  PinholeCamera const left = inclined_camera(-45), right = inclined_camera(45);
  DisplacementField a = image_motion(left, [](Vec3d) { return Vec3d{}; }), b = a;
  for (Vec2d& d : a.displacement_px) d.y += 0.3;
  a.sigma_px.assign(a.size(), {0.1, 0.1});
  b.sigma_px = a.sigma_px;
  StereoVector const vector = vector_at_origin(reconstruct({left, {}}, a, {right, {}}, b, {}, {.spacing = 2e-3}));
  EXPECT_NEAR(vector.residual_px, 0.3 / std::numbers::sqrt2, 1e-6);
  EXPECT_NEAR(vector.residual_ratio, 3 / std::numbers::sqrt2, 1e-5);
  EXPECT_NEAR(vector.displacement.y, -0.15 / scale, 1e-9);  // row downwards, Y upwards
}

// Independent normal errors of every vector: 68.3 % of the errors of each component are within its uncertainty, between
// the vectors, too. Of about 3000 nodes a quarter are independent, which determines the fraction to 1.7 %.
TEST(StereoReconstruction, UncertaintyCoversTheErrorsOfNoisyVectors) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1);
  for (double const degrees : {30.0, 45.0}) {
    PinholeCamera const left = inclined_camera(-degrees), right = inclined_camera(degrees);
    Vec3d const motion{2e-4, -1e-4, 1.5e-4};
    auto const seen = [&](PinholeCamera const& camera) {
      DisplacementField field = image_motion(camera, [&](Vec3d) { return motion; });
      for (Vec2d& d : field.displacement_px) {
        Vec2d const sigma{0.03 + 0.04 * std::abs(d.x) / 10, 0.06};
        field.sigma_px.push_back(sigma);
        d += Vec2d{sigma.x * normal(random), sigma.y * normal(random)};
      }
      return field;
    };
    Vec3d within{};
    double count = 0, squares = 0;
    for (int trial = 0; trial < 6; ++trial) {
      DisplacementField const a = seen(left), b = seen(right);
      StereoField const field = reconstruct({left, {}}, a, {right, {}}, b, {}, {.spacing = 1.7e-3});
      for (auto const& node : field.nodes) {
        if (!node) continue;
        Vec3d const error = node->displacement - motion, sigma = node->sigma();
        for (int k = 0; k < 3; ++k) within[k] += std::abs(error[k]) <= sigma[k] ? 1 : 0;
        squares += node->residual_ratio * node->residual_ratio;
        count += 1;
      }
    }
    ASSERT_GT(count, 2000);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GT(within[k] / count, 0.62) << degrees << ' ' << k;
      EXPECT_LT(within[k] / count, 0.74) << degrees << ' ' << k;
    }
    EXPECT_NEAR(squares / count, 1.0, 0.15);  // chi-squared with one degree of freedom
  }
}

// Errors of a calibration: the motion is measured with the true camera and reconstructed with cameras whose parameters
// scatter. The rms error over 200 cameras is the propagated uncertainty to within 1 / sqrt(400) = 5 %.
TEST(StereoReconstruction, PropagatesTheCovarianceOfTheCalibration) {
  PinholeCamera const left = inclined_camera(-40), right = inclined_camera(40);
  auto const shear = [](Vec3d at) { return Vec3d{2e-4 * (1 + at.x / 0.02), 1e-4, 1e-4 * (1 - at.x / 0.02)}; };
  DisplacementField const a = image_motion(left, shear, 4, 64), b = image_motion(right, shear, 4, 64);
  // fx, fy, cx, cy [px], distortion, rvec [rad], tvec [m]
  std::array<double, PinholeCamera::count> const error{5, 5, 0.6, 0.5, 0, 0, 0, 0, 1e-4, 1e-4, 1e-4, 3e-5, 3e-5, 2e-4};
  std::vector<double> covariance(PinholeCamera::count * PinholeCamera::count);
  for (std::size_t i = 0; i < error.size(); ++i) covariance[i * (PinholeCamera::count + 1)] = error[i] * error[i];
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  Vec3d squares{};
  constexpr int cameras = 200;
  Covariance predicted{};
  for (int k = 0; k < cameras; ++k) {
    CalibratedCamera calibrated{right, covariance};
    for (std::size_t i = 0; i < error.size(); ++i) calibrated.camera.value[i] += error[i] * normal(random);
    StereoVector const vector = vector_at_origin(reconstruct({left, {}}, a, calibrated, b, {}, {.spacing = 0.01}));
    Vec3d const off = vector.displacement - shear({});
    squares += {off.x * off.x, off.y * off.y, off.z * off.z};
    predicted = vector.from_calibration;
  }
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::sqrt(squares[axis] / cameras / predicted[static_cast<std::size_t>(axis)]), 1.0, 0.17) << axis;
}

TEST(StereoReconstruction, HasNoVectorNextToMissingOnes) {
  PinholeCamera const left = inclined_camera(-30), right = inclined_camera(30);
  auto const still = [](Vec3d) { return Vec3d{}; };
  DisplacementField a = image_motion(left, still);
  a.status.assign(a.size(), VectorStatus::valid);
  a.status[a.size() / 2] = VectorStatus::invalid;  // at the principal point, the image of the origin
  StereoField const field = reconstruct({left, {}}, a, {right, {}}, image_motion(right, still), {}, {.spacing = 4e-3});
  std::size_t missing = 0;
  for (std::size_t i = 0; i < field.grid.size(); ++i) {
    bool const near = length(field.grid.position(i)) < 1e-9;
    if (near) {
      EXPECT_FALSE(field.nodes[i]);
    }
    if (length(field.grid.position(i)) < 9e-3 && !field.nodes[i]) ++missing;
  }
  EXPECT_EQ(missing, 1u) << "bilinear interpolation next to the gap";
}

// Nodes about the origin at the mean distance of the vectors: 1.6 mm along Y and 1.6 mm / cos 45 along X.
TEST(StereoReconstruction, ChoosesTheMeanDistanceOfTheVectors) {
  PinholeCamera const left = inclined_camera(-45), right = inclined_camera(45);
  DisplacementField const still = image_motion(left, [](Vec3d) { return Vec3d{}; });
  NodeGrid const grid = find_common_grid({left, {}}, still, {right, {}}, still, {}, 0);
  EXPECT_NEAR(grid.spacing, 1.6e-3 / std::sqrt(std::cos(std::numbers::pi / 4)), 2e-5);
  EXPECT_NEAR(std::remainder(grid.first.x, grid.spacing), 0, 1e-12);
  // views that do not overlap
  PinholeCamera away = right;
  away.value[11] += 0.2;
  EXPECT_EQ(find_common_grid({left, {}}, still, {away, {}}, still, {}, 0).size(), 0u);
}

/// A field of 8 x 8 vectors 10 px apart.
DisplacementField small_field(std::function<Vec2d(Vec2d)> const& displacement) {
  DisplacementField field;
  field.columns = field.rows = 8;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      field.position_px.push_back({10.0 * i + 5, 10.0 * j + 5});
      field.displacement_px.push_back(displacement(field.position_px.back()));
    }
  return field;
}

// Cubic convolution reproduces quadratic polynomials.
TEST(InterpolatedVectors, AreExactForQuadraticFields) {
  auto const quadratic = [](Vec2d p) { return Vec2d{1 + 0.1 * p.x - 0.01 * p.x * p.y, 0.002 * p.y * p.y + p.x}; };
  DisplacementField const field = small_field(quadratic);
  InterpolatedField const interpolated(field, 0);
  for (Vec2d const at : {Vec2d{31, 42.5}, Vec2d{25, 25}, Vec2d{22.2, 59.9}}) {
    auto const found = interpolated.displacement(at);
    ASSERT_TRUE(found);
    EXPECT_LT(length(*found - quadratic(at)), 1e-11);
  }
  EXPECT_TRUE(interpolated.displacement({5, 75}));
  EXPECT_FALSE(interpolated.displacement({4.9, 30}));
  EXPECT_FALSE(interpolated.displacement({30, 75.1}));
}

// Halfway between nodes the weights of an axis are (-1, 9, 9, -1) / 16: independent errors are reduced by the root of
// 164 / 256 per axis, fully correlated ones are not.
TEST(InterpolatedVectors, HaveTheUncertaintyOfCorrelatedNeighbours) {
  DisplacementField field = small_field([](Vec2d) { return Vec2d{}; });
  field.sigma_px.assign(field.size(), {0.1, 0.2});
  auto const sigma = [&](double window_px, Vec2d at) {
    return InterpolatedField(field, window_px).vector(at)->sigma_px;
  };
  double const axis = std::sqrt(164.0 / 256);
  EXPECT_NEAR(sigma(0, {35, 35}).x, 0.1, 1e-12);
  EXPECT_NEAR(sigma(0, {40, 35}).x, 0.1 * axis, 1e-12);
  EXPECT_NEAR(sigma(0, {40, 40}).y, 0.2 * axis * axis, 1e-12);
  EXPECT_NEAR(sigma(1e9, {40, 40}).y, 0.2, 1e-6);
}

TEST(InterpolatedVectors, NeedARegularGrid) {
  DisplacementField field = small_field([](Vec2d) { return Vec2d{}; });
  EXPECT_TRUE(is_regular_grid(field));
  field.position_px[13].x += 0.5;
  EXPECT_FALSE(is_regular_grid(field));
  field.columns = field.rows = 0;
  EXPECT_FALSE(is_regular_grid(field));
  EXPECT_FALSE(is_regular_grid({}));
}

}  // namespace
}  // namespace gladstone::inline stereo
