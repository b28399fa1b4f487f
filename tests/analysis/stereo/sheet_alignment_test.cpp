#include "analysis/stereo/sheet_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/analysis/stereo/inclined_camera.h"

namespace gladstone::inline stereo {
namespace {

/// The inclined camera with an image of 256 x 256 px.
PinholeCamera small_camera(double degrees) {
  PinholeCamera camera = inclined_camera(degrees);
  camera.value[2] = camera.value[3] = 127.5;
  return camera;
}

// 100 points of a plane with 5 um of noise, and 15 at other places.
TEST(ObjectPlanes, AreFittedWithoutOutliers) {
  ObjectPlane const plane{4e-4, {0.02, -0.01}};
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Vec3d> points;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      points.push_back(plane.point({2e-3 * i, 3e-3 * j}) + Vec3d{0, 0, 5e-6 * normal(random)});
  for (int i = 0; i < 15; ++i) points.push_back({1e-3 * i, 2e-3 * i, 2e-3});
  auto const fit = fit_object_plane(points);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->plane.height, plane.height, 5e-6);
  EXPECT_NEAR(fit->plane.slope.x, plane.slope.x, 5e-4);
  EXPECT_NEAR(fit->plane.slope.y, plane.slope.y, 5e-4);
  EXPECT_GE(fit->outliers, 15u);
  EXPECT_LE(fit->outliers, 20u);
  EXPECT_NEAR(fit->scatter, 5e-6, 1.5e-6);
}

// Errors of points with the correlation of windows that overlap by half, (1, 0.5, 0, ...) along each axis: moving
// averages of two independent values. The squares of 200 errors over their sigma have a mean of 1; its standard
// deviation is sqrt(2 / 200) = 0.1, and the uncertainty of the scatter adds 5 %.
TEST(ObjectPlanes, HaveTheUncertaintyOfOverlappingWindows) {
  constexpr int side = 12, repeats = 200;
  double const redundancy = find_redundancy(side, 0.5);
  EXPECT_NEAR(redundancy, 2.0 - 1.0 / side, 1e-12);
  EXPECT_NEAR(find_redundancy(side, 0.0), 1.0, 1e-12);
  ObjectPlane const plane{4e-4, {0.02, -0.01}};
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 5e-6);
  Vec3d squares{};
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<double> noise((side + 1) * (side + 1));
    for (double& value : noise) value = normal(random);
    std::vector<Vec3d> points;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        auto const at = [&](int column, int row) { return noise[static_cast<std::size_t>(row * (side + 1) + column)]; };
        double const error = 0.5 * (at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1));
        points.push_back(plane.point({1e-3 * i - 4e-3, 1e-3 * j - 5e-3}) + Vec3d{0, 0, error});
      }
    auto const fit = fit_object_plane(points, redundancy * redundancy);
    ASSERT_TRUE(fit);
    Vec3d const ratio{(fit->plane.height - plane.height) / fit->height_sigma,
                      (fit->plane.slope.x - plane.slope.x) / fit->slope_sigma.x,
                      (fit->plane.slope.y - plane.slope.y) / fit->slope_sigma.y};
    for (int axis = 0; axis < 3; ++axis) squares[axis] += ratio[axis] * ratio[axis] / repeats;
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(squares[axis], 1.0, 0.3) << axis;
}

TEST(ObjectPlanes, NeedPointsThatSpanThem) {
  EXPECT_FALSE(fit_object_plane({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << "no redundancy";
  EXPECT_FALSE(fit_object_plane({{0, 0, 0}, {1, 1, 0}, {2, 2, 1}, {3, 3, 0}, {4, 4, 0}})) << "on one line";
}

TEST(Triangulation, FindsThePointThatBothCamerasSee) {
  PinholeCamera const a = small_camera(-40), b = small_camera(25);
  ObjectPlane const plane{-2e-4, {0.01, 0.02}};
  for (Vec3d const point : {Vec3d{3e-3, -2e-3, 1e-3}, Vec3d{-8e-3, 5e-3, -2e-3}}) {
    auto const in_a = intersect_plane(a, a.project(point), plane), in_b = intersect_plane(b, b.project(point), plane);
    ASSERT_TRUE(in_a && in_b);
    EXPECT_LT(length(triangulate(a, *in_a, b, *in_b, plane) - point), 1e-9);
  }
}

TEST(PixelSizes, AreThoseOfAnInclinedPlane) {
  EXPECT_NEAR(find_pixel_size(small_camera(0), {}), 1e-4, 1e-9);
  // stretched along X by 1 / cos 60; the finite difference of 0.1 mm adds 0.1 mm tan 60 / 650 mm
  EXPECT_NEAR(find_pixel_size(small_camera(60), {}), 1e-4 / std::sqrt(0.5), 1e-7);
}

// A linear image is interpolated exactly; the top row shows the largest y.
TEST(DewarpedImages, ShowThePlane) {
  PinholeCamera const camera = small_camera(40);
  ObjectPlane const plane{3e-4, {0.01, 0}};
  auto const grey = [](Vec2d at) { return 100 + 2 * at.x - 0.5 * at.y; };
  Image<double> image(256, 256);
  for (int row = 0; row < 256; ++row)
    for (int column = 0; column < 256; ++column) image(column, row) = grey({1.0 * column, 1.0 * row});
  NodeGrid const grid = NodeGrid::between({-5e-3, -4e-3}, {5e-3, 6e-3}, 1e-4);
  ASSERT_EQ(grid.size(), 101u * 101u);
  Image<double> const dewarped = dewarp_image(image, camera, plane, grid);
  for (std::size_t node = 0; node < grid.size(); node += 517) {
    int const column = static_cast<int>(node % 101), row = 100 - static_cast<int>(node / 101);
    EXPECT_NEAR(dewarped(column, row), grey(camera.project(plane.point(grid.position(node)))), 1e-8);
  }
  Image<double> const outside = dewarp_image(image, camera, plane, NodeGrid::between({0.1, 0}, {0.11, 1e-3}, 1e-4));
  EXPECT_TRUE(std::isnan(outside(0, 0)));
}

/// Images of particles as Gaussians of 0.9 px standard deviation.
Image<double> image_of(std::vector<Vec3d> const& particles, PinholeCamera const& camera) {
  Image<double> image(256, 256, 10.0);
  for (Vec3d const& particle : particles) {
    Vec2d const at = camera.project(particle);
    int const column = static_cast<int>(std::lround(at.x)), row = static_cast<int>(std::lround(at.y));
    for (int y = row - 4; y <= row + 4; ++y)
      for (int x = column - 4; x <= column + 4; ++x) {
        if (x < 0 || y < 0 || x >= 256 || y >= 256) continue;
        image(x, y) += 1000 * std::exp(-(std::pow(x - at.x, 2) + std::pow(y - at.y, 2)) / (2 * 0.81));
      }
  }
  return image;
}

// A thin sheet 0.5 mm off the plane and inclined by one degree about both axes: the disparity on the axis is 0.5 mm
// times 2 tan 40 over the size of a pixel, 0.1 mm / sqrt(cos 40), or 7.3 px. The residual is below 0.05 px, which is 3
// um along Z.
TEST(SheetAlignment, FindsAMisalignedSheet) {
  PinholeCamera const left = small_camera(-40), right = small_camera(40);
  double const slope = std::tan(std::numbers::pi / 180);
  ObjectPlane const sheet{5e-4, {slope, -slope}};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> along_x(-0.022, 0.022), along_y(-0.017, 0.017);
  std::vector<SimultaneousImages> images;
  for (int time = 0; time < 2; ++time) {
    std::vector<Vec3d> particles;
    for (int i = 0; i < 4500; ++i) {
      double const x = along_x(random), y = along_y(random);
      particles.push_back(sheet.point({x, y}));
    }
    images.push_back({image_of(particles, left), image_of(particles, right)});
  }
  CorrelationSettings settings;
  settings.window_px = {64, 32, 32};
  settings.overlap = 0.5;
  SheetAlignment const found = align_sheet({&left, &right}, images, {}, settings);
  EXPECT_NEAR(found.disparity_px.front(), 7.5, 0.5);
  EXPECT_LT(found.disparity_px.back(), 0.05);
  EXPECT_NEAR(found.fit.plane.height, sheet.height, 3e-6);
  EXPECT_NEAR(found.fit.plane.slope.x, sheet.slope.x, 5e-4);
  EXPECT_NEAR(found.fit.plane.slope.y, sheet.slope.y, 5e-4);
  EXPECT_LT(found.scatter_px, 0.1);
  EXPECT_TRUE(found.has_converged() && found.is_significant());
  // The uncertainty is small, and explains the errors.
  EXPECT_LT(found.fit.height_sigma, 2e-6);
  EXPECT_LT(std::abs(found.fit.plane.height - sheet.height), 4 * found.fit.height_sigma);
  EXPECT_LT(std::abs(found.fit.plane.slope.x - sheet.slope.x), 4 * found.fit.slope_sigma.x);
  EXPECT_LT(std::abs(found.fit.plane.slope.y - sheet.slope.y), 4 * found.fit.slope_sigma.y);
  // One iteration measures the disparity of the assumed plane, here of the true one and of the one 0.5 mm off.
  EXPECT_FALSE(align_sheet({&left, &right}, images, sheet, settings, 1).is_significant());
  SheetAlignment const assumed = align_sheet({&left, &right}, images, {}, settings, 1);
  EXPECT_EQ(assumed.disparity_px.size(), 1u);
  EXPECT_EQ(assumed.disparity_px.front(), found.disparity_px.front());
  EXPECT_TRUE(assumed.is_significant());
}

}  // namespace
}  // namespace gladstone::inline stereo
