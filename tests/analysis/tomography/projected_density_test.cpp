#include "analysis/tomography/projected_density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/density/projected_gradient.h"

namespace gladstone::inline tomography {
namespace {

// A camera on the Z axis: pupil at Z = Z_A, dots at Z = -Z_D, the middle of the medium at the origin.
constexpr double z_a = 0.75, z_d = 0.25, pitch = 10e-6, magnification = 0.1, index = 1.0003, dale = 2.26e-4;
constexpr int across = 41;
constexpr double step_px = 8.0;

struct PinholeView {
  DisplacementField field;
  ViewOptics optics;
};

PinholeView make_view() {
  PinholeView view;
  view.optics.gladstone_dale = dale;
  view.optics.ambient_index = index;
  double const dot_per_px = pitch / magnification;
  view.field.columns = view.field.rows = across;
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < across; ++i) {
      Vec2d const px{step_px * (i - across / 2), step_px * (j - across / 2)};
      VectorSight sight;
      sight.line.origin = {px.x * dot_per_px, -px.y * dot_per_px, -z_d};
      Vec3d const to_pupil = Vec3d{0.0, 0.0, z_a} - sight.line.origin;
      sight.line.pupil_distance = length(to_pupil);
      sight.line.direction = normalized(to_pupil);
      sight.line.scale = z_a / z_d;
      sight.by_column = {dot_per_px, 0.0, 0.0};
      sight.by_row = {0.0, -dot_per_px, 0.0};
      view.field.position_px.push_back(px);
      view.field.displacement_px.push_back({});
      view.optics.sights.push_back(sight);
    }
  return view;
}

/// Gaussian blob of the density.
struct Blob {
  Vec3d centre;
  double amplitude = -0.5, radius = 4e-3;

  double density(Vec3d p) const {
    Vec3d const r = p - centre;
    return amplitude * std::exp(-dot(r, r) / (radius * radius));
  }
  Vec3d gradient(Vec3d p) const { return (-2.0 / (radius * radius) * density(p)) * (p - centre); }
};

/// Integrates f(s) along the part of a sight line that contains the blob, by the midpoint rule, which converges
/// exponentially for a Gaussian.
template <class F>
auto integrate_through(Blob const& blob, SightLine const& line, F const& f) {
  double const middle = dot(blob.centre - line.origin, line.direction), half = 7.0 * blob.radius;
  constexpr int count = 80;
  double const ds = 2.0 * half / count;
  auto sum = 0.0 * f(middle);
  for (int i = 0; i < count; ++i) sum = sum + ds * f(middle - half + (i + 0.5) * ds);
  return sum;
}

/// Displacement of the dots: D = -(K / n0) integral of s (grad rho - d (d . grad rho)) ds, projected along d onto the
/// plane of the dots.
void displace(PinholeView& view, Blob const& blob) {
  for (std::size_t i = 0; i < view.field.size(); ++i) {
    SightLine const& line = view.optics.sights[i]->line;
    Vec3d const d = line.direction;
    Vec3d const across_line = integrate_through(blob, line, [&](double s) {
      Vec3d const g = blob.gradient(line.origin + s * d);
      return s * (g - dot(g, d) * d);
    });
    Vec3d const shift = -(dale / index) * (across_line - (across_line.z / d.z) * d);
    view.field.displacement_px[i] = (magnification / pitch) * Vec2d{shift.x, -shift.y};
  }
}

// On the axis the gradient is that of Eq. 9 times the size of a pixel in the mid-plane, exactly; elsewhere the two
// differ by the square of the obliquity.
TEST(ProjectedDensity, GradientIsThatOfTheSmallAngleTheory) {
  PinholeView view = make_view();
  for (std::size_t i = 0; i < view.field.size(); ++i) view.field.displacement_px[i] = {0.3, -0.7};
  density::ProjectionOptics const optics{magnification, z_a, z_d, pitch, dale, index, {}};
  density::GradientMap const pixel = compute_pixel_gradient(view.field, view.optics);
  density::GradientMap const plane = density::compute_projected_gradient(view.field, optics).map;
  double const pixel_size = pitch / optics.medium_magnification();
  for (std::size_t i = 0; i < pixel.gradient.size(); ++i) {
    std::size_t const vector = (across - 1 - i / across) * across + i % across;
    double const sine2 = 1.0 - std::pow(view.optics.sights[vector]->line.direction.z, 2);
    Vec2d const expected = pixel_size * plane.gradient[i];
    double const tolerance = (1e-12 + 2.0 * sine2) * length(expected);
    EXPECT_NEAR(pixel.gradient[i].x, expected.x, tolerance);
    EXPECT_NEAR(pixel.gradient[i].y, expected.y, tolerance);
  }
}

// A blob 15 mm in front of the mid-plane displaces the dots by its greater distance from them: by (Z_D + 15 mm) / (Z_A
// - 15 mm) Z_A / Z_D = 1.08 times as much as the unweighted line integral says. The weighted integral agrees. The
// neglected terms are of the order of obliquity times size over distance, 0.016 x 4 / 250 = 0.03 %; the integration by
// the four-point rule errs by (h / R)^4 / 6 with the spacing h = 0.6 mm in the medium, 0.01 %.
TEST(ProjectedDensity, LineIntegralHasTheWeightOfTheDepth) {
  Blob const blob{{1e-3, -2e-3, 15e-3}};
  PinholeView view = make_view();
  displace(view, blob);
  density::GradientMap const gradient = compute_pixel_gradient(view.field, view.optics);
  auto const reference = density::make_side_reference(gradient.grid, density::GridSide::left, 0.0);
  ProjectedView const projected = integrate_view(gradient, view.optics, reference);
  double largest = 0.0, squares = 0.0, norm = 0.0, unweighted = 0.0;
  for (std::size_t i = 0; i < projected.lines.size(); ++i) {
    SightLine const& line = projected.lines[i];
    double const exact = integrate_through(
        blob, line, [&](double s) { return line.weight(s) * blob.density(line.origin + s * line.direction); });
    double const plain =
        integrate_through(blob, line, [&](double s) { return blob.density(line.origin + s * line.direction); });
    largest = std::max(largest, std::abs(exact));
    squares += std::pow(projected.value[i] - exact, 2);
    unweighted += std::pow(projected.value[i] - plain, 2);
    norm += exact * exact;
  }
  EXPECT_GT(largest, 3e-3);
  EXPECT_LT(std::sqrt(squares / norm), 0.002);
  EXPECT_NEAR(std::sqrt(unweighted / norm), 1.0 - 1.0 / 1.0816, 0.003);
}

TEST(ProjectedDensity, VectorsWithoutSightAreHoles) {
  PinholeView view = make_view();
  view.optics.sights[7].reset();
  density::GradientMap const gradient = compute_pixel_gradient(view.field, view.optics);
  EXPECT_EQ(gradient.valid[gradient.grid.index(7, across - 1)], 0);
  auto const reference = density::make_side_reference(gradient.grid, density::GridSide::left, 0.0);
  ProjectedView const projected = integrate_view(gradient, view.optics, reference);
  EXPECT_TRUE(std::isnan(projected.value[7]));
  EXPECT_EQ(projected.value[8], 0.0);  // without displacement
}

}  // namespace
}  // namespace gladstone::inline tomography
