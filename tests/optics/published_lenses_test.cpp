#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>

#include "render/base/units.h"
#include "render/optics/apparent_pupil.h"
#include "render/optics/lens.h"
#include "render/optics/paraxial.h"

namespace gladstone {
namespace {

Prescription shipped(std::string const& name) {
  return read_prescription(std::string(GLADSTONE_DATA_DIR "/lenses/") + name);
}

Lens build(Prescription prescription, double wavelength = spectral_line::d) {
  return build_lens(std::move(prescription), GlassCatalogue::shipped(), wavelength);
}

/// Returns surfaces [first, last) of a lens as a separate lens, whose stop is the first of them.
Prescription part(Prescription const& whole, std::size_t first, std::size_t last) {
  Prescription result = whole;
  auto const begin = whole.surfaces.begin();
  result.surfaces.assign(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last));
  for (PrescribedSurface& surface : result.surfaces) surface.stop = false;
  result.surfaces.front().stop = true;
  result.aperture = {PrescribedAperture::Kind::entrance_pupil, unit::millimetre};
  return result;
}

/// Returns the uncertainty of a quantity due to the printed digits: patents print lengths to 0.001 and indices to
/// 0.00001, each exact to half a digit; the resulting changes are added up.
/// @param scale  ratio of the shipped lens to the printed one [1]
template <class Quantity>
double left_open(Prescription const& printed, double scale, Quantity const& quantity) {
  double const as_printed = quantity(printed), half_length = 0.0005 * scale * unit::millimetre;
  double sum = 0;
  auto const add = [&](std::size_t i, auto const& change) {
    Prescription changed = printed;
    change(changed.surfaces[i]);
    sum += std::abs(quantity(changed) - as_printed);
  };
  for (std::size_t i = 0; i < printed.surfaces.size(); ++i) {
    if (printed.surfaces[i].curvature != 0) {
      add(i, [&](PrescribedSurface& s) { s.curvature = 1 / (1 / s.curvature + half_length); });
    }
    if (i + 1 < printed.surfaces.size()) add(i, [&](PrescribedSurface& s) { s.thickness += half_length; });
    if (std::holds_alternative<PrescribedMedium::Described>(printed.surfaces[i].after.is)) {
      add(i, [](PrescribedSurface& s) { std::get<PrescribedMedium::Described>(s.after.is).nd += 0.000005; });
    }
  }
  return sum;
}

/// Compares a quantity with its published value, within the uncertainty of the printed digits of both.
template <class Quantity>
void expect_published(Prescription const& lens, double scale, Quantity const& quantity, double published,
                      double half_a_digit) {
  double const tolerance = left_open(lens, scale, quantity) + half_a_digit;
  EXPECT_NEAR(quantity(lens), published, tolerance);
}

double focal_length(Prescription const& lens) { return paraxial_lens(build(lens)).effective_focal_length; }
double back_focus(Prescription const& lens) { return paraxial_lens(build(lens)).back_focal_length; }

/// Returns the distance from the first to the last surface [m].
double vertex_length(Prescription const& lens) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i) sum += lens.surfaces[i].thickness;
  return sum;
}

constexpr double mm = unit::millimetre;

// JP H9-105860, Example 1: the shipped doublet, followed after 107 mm by the patent's rear component, is the published
// lens: f = 390.004, Bf = 174.594, front and rear focal lengths of 0.541 and -0.520 f, length to the image 0.762 f. The
// beam at f/8.13 is limited by the doublet.
TEST(PublishedLenses, AchromatIsTheFrontOfThePublishedTelephoto) {
  Prescription const doublet = shipped("achromat.toml");
  Prescription whole = doublet;
  whole.surfaces.back().thickness = 107 * mm;
  auto const add = [&](double radius, double thickness, PrescribedMedium after) {
    PrescribedSurface surface;
    surface.curvature = 1 / (radius * mm);
    surface.thickness = thickness * mm;
    surface.after = std::move(after);
    whole.surfaces.push_back(surface);
  };
  add(191.786, 3, {PrescribedMedium::Described{1.62004, 36.27}});
  add(-247.184, 2, {PrescribedMedium::Described{1.51680, 64.10}});
  add(59.608, 0, {});
  expect_published(whole, 1, focal_length, 390.004 * mm, 0.0005 * mm);
  expect_published(whole, 1, back_focus, 174.594 * mm, 0.0005 * mm);
  expect_published(
      whole, 1, [](auto const& p) { return (vertex_length(p) + back_focus(p)) / focal_length(p); }, 0.762, 0.0005);
  expect_published(
      whole, 1, [](auto const& p) { return focal_length(part(p, 0, 3)) / focal_length(p); }, 0.541, 0.0005);
  expect_published(
      whole, 1, [](auto const& p) { return focal_length(part(p, 3, 6)) / focal_length(p); }, -0.520, 0.0005);
  ParaxialLens const paraxial = paraxial_lens(build(doublet));
  EXPECT_NEAR(paraxial.entrance.diameter, 390.004 / 8.13 * mm, 0.005 / 8.13 * 390.004 / 8.13 * mm);
  EXPECT_NEAR(paraxial.f_number, 0.541 * 8.13, 0.0005 * 8.13 + 0.541 * 0.005);
}

// The foci of a single lens of the doublet's crown glass for F and C are f / V apart, 3.7 mm; the flint lens
// compensates nine tenths of that, and the spherical aberration as well: on the axis, rays of all heights meet within
// two radii of the Airy disc.
TEST(PublishedLenses, AchromatBringsColoursAndZonesTogether) {
  Prescription const doublet = shipped("achromat.toml");
  double const f = focal_length(doublet);
  double const blue = paraxial_lens(build(doublet, spectral_line::F)).back_focal_length;
  double const red = paraxial_lens(build(doublet, spectral_line::C)).back_focal_length;
  EXPECT_LT(std::abs(blue - red), 0.1 * f / 57.03);
  Lens const lens = build(doublet);
  double const focus = paraxial_lens(lens).back_focal_length;
  double const airy = 1.22 * spectral_line::d * paraxial_lens(lens).f_number;  // 3.2 um
  for (double const height : {5.0, 10.0, 15.0, 20.0, 23.9}) {
    Ray<double> ray{{0, height * mm, -0.1}, {0, 0, 1}};
    RayAccount<double> account;
    ASSERT_EQ(lens.view().carry(ray, account), RayStatus::alive);
    double const way = (lens.poses.back().origin.z + focus - ray.position.z) / ray.direction.z;
    EXPECT_LT(std::abs(ray.position.y + way * ray.direction.y), 2 * airy) << height;
  }
}

// US 4,099,850, Example 5: f = 100.0, back focus 137.350, aperture ratio 1:3.5, and a front pair of |f12| between 1.5
// and 1.75 f; the shipped lens is scaled by 0.28.
TEST(PublishedLenses, WideAngleHasThePublishedFoci) {
  constexpr double scale = 0.28;
  Prescription const lens = shipped("wide_angle.toml");
  expect_published(lens, scale, focal_length, 100.0 * scale * mm, 0.05 * scale * mm);
  expect_published(lens, scale, back_focus, 137.350 * scale * mm, 0.0005 * scale * mm);
  EXPECT_NEAR(paraxial_lens(build(lens)).f_number, 3.5, 1e-12);
  double const pair = -focal_length(part(lens, 0, 4)) / focal_length(lens);
  EXPECT_GT(pair, 1.5);
  EXPECT_LT(pair, 1.75);
}

// The field is 74.2 degrees: the chief ray of the corner passes all edges and is imaged within 3 % of f tan(37.1
// degrees).
TEST(PublishedLenses, WideAngleReachesItsCorner) {
  Lens const lens = build(shipped("wide_angle.toml"));
  double const angle = 37.1 * unit::degree;
  RayOrigin const corner = RayOrigin::direction({0, std::sin(angle), std::cos(angle)});
  auto const disc = find_apparent_pupil(lens, corner);
  ASSERT_TRUE(disc);
  Ray<double> ray = corner.ray_through(disc->centre);
  RayAccount<double> account;
  ASSERT_EQ(lens.view().carry(ray, account), RayStatus::alive);
  ParaxialLens const paraxial = paraxial_lens(lens);
  double const way = (lens.poses.back().origin.z + paraxial.back_focal_length - ray.position.z) / ray.direction.z;
  double const height = ray.position.y + way * ray.direction.y;
  EXPECT_NEAR(height / (paraxial.effective_focal_length * std::tan(angle)), 1, 0.03);
}

// US 4,338,001, Embodiment 2: focal lengths of the forward and the rearward group 80.383 and -118.959, with principal
// points 57.046 apart, hence f = 100, and a telephoto ratio of 0.957; the shipped lens is scaled by 1.8. Its stop
// differs from that of the patent.
TEST(PublishedLenses, TelecentricLensIsThePublishedTelephoto) {
  constexpr double scale = 1.8, published_f = 80.383 * -118.959 / (80.383 - 118.959 - 57.046);
  Prescription const lens = part(shipped("telecentric.toml"), 0, 10);
  auto const front = [](auto const& p) { return part(p, 0, 6); };
  auto const rear = [](auto const& p) { return part(p, 6, 10); };
  double const half = 0.0005 * scale * mm;
  expect_published(
      lens, scale, [&](auto const& p) { return focal_length(front(p)); }, 80.383 * scale * mm, half);
  expect_published(
      lens, scale, [&](auto const& p) { return focal_length(rear(p)); }, -118.959 * scale * mm, half);
  expect_published(
      lens, scale,
      [&](auto const& p) {
        return p.surfaces[5].thickness - paraxial_lens(build(front(p))).rear_principal_plane +
               paraxial_lens(build(rear(p))).front_principal_plane;
      },
      57.046 * scale * mm, half);
  EXPECT_NEAR(published_f, 100, 0.005);
  expect_published(lens, scale, focal_length, 100 * scale * mm, 0.005 * scale * mm);
  expect_published(
      lens, scale, [](auto const& p) { return (vertex_length(p) + back_focus(p)) / focal_length(p); }, 0.957, 0.0005);
}

/// Returns the chief ray of a point at a height above the axis, `distance` in front of the first vertex.
Ray<double> chief_ray(Lens const& lens, double height, double distance) {
  RayOrigin const origin = RayOrigin::point({0, height, -distance});
  auto const disc = find_apparent_pupil(lens, origin);
  EXPECT_TRUE(disc);
  return origin.ray_through(disc->centre);
}

// Chief rays from the field, 44 mm wide, are parallel to the axis within 0.005 degrees: the residual is the spherical
// aberration of the published lens, which images parallel light onto the stop.
TEST(PublishedLenses, TelecentricLensTakesChiefRaysParallelToTheAxis) {
  Lens const lens = build(shipped("telecentric.toml"));
  EXPECT_TRUE(std::isinf(paraxial_lens(lens).entrance.position));
  for (double const height : {2.0, 6.0, 10.0, 14.0, 18.0, 22.0}) {
    Ray<double> ray = chief_ray(lens, height * mm, lens.prescription.object_distance);
    EXPECT_LT(std::abs(std::atan2(ray.direction.y, ray.direction.z)), 0.005 * unit::degree) << height;
    RayAccount<double> account;
    EXPECT_EQ(lens.view().carry(ray, account), RayStatus::alive) << height;
  }
}

// Hence the image of an object keeps its size when the object moves: if it is 0.3 m nearer or farther, its image
// changes by less than 1 / 1000, whereas a perspective camera at the first vertex would show it a third larger or a
// fifth smaller.
TEST(PublishedLenses, ImageSizeOfATelecentricLensIsIndependentOfDistance) {
  Lens const lens = build(shipped("telecentric.toml"));
  double const distance = lens.prescription.object_distance;
  auto const image = [&](double way) {
    Ray<double> ray = chief_ray(lens, 20 * mm, distance + way);
    RayAccount<double> account;
    EXPECT_EQ(lens.view().carry(ray, account), RayStatus::alive);
    return ray.position.y + 36.006 * mm * ray.direction.y / ray.direction.z;
  };
  double const here = image(0);
  EXPECT_NEAR(here, -0.2 * 20 * mm, 0.02 * 0.2 * 20 * mm);
  for (double const way : {-0.3, 0.3}) EXPECT_NEAR(image(way) / here, 1, 1e-3) << way;
}

// US 2,532,751, Example 1: F = 1.000 at f/2. Lengths and indices are printed to 0.001, so the uncertainty includes the
// effect of half a thousandth in each index, in addition to the lengths and the digits of F. The sample lens of the
// same form has the same glass thicknesses to 0.1 mm, but other airspaces and curvatures.
TEST(PublishedLenses, DoubleGaussHasThePatentsFocalLength) {
  Prescription const lens = shipped("double_gauss_patent.toml");
  double const as_printed = focal_length(lens);
  double indices = 0;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    if (!std::holds_alternative<PrescribedMedium::Described>(lens.surfaces[i].after.is)) continue;
    Prescription changed = lens;
    std::get<PrescribedMedium::Described>(changed.surfaces[i].after.is).nd += 0.0005;
    indices += std::abs(focal_length(changed) - as_printed);
  }
  expect_published(lens, 100, focal_length, 100 * mm, indices + 0.05 * mm);
  EXPECT_LT(indices + left_open(lens, 100, focal_length), 1.5 * mm);
  EXPECT_NEAR(paraxial_lens(build(lens)).f_number, 2, 1e-12);
  Prescription const sample = shipped("double_gauss.toml");
  ASSERT_EQ(sample.surfaces.size(), lens.surfaces.size());
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    EXPECT_EQ(sample.surfaces[i].after.is_air(), lens.surfaces[i].after.is_air()) << i;
    if (lens.surfaces[i].after.is_air()) continue;
    EXPECT_NEAR(sample.surfaces[i].thickness, lens.surfaces[i].thickness, 0.11 * mm) << i;
  }
}

}  // namespace
}  // namespace gladstone
