// Optical elements besides the lens: plates and wedge prisms ahead of and behind the lens, and their tables in a setup.
#include <cmath>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "tests/scene/read_setup_text.h"
#include "tests/scene/real_lens_setups.h"

namespace gladstone {
namespace {

using ::testing::HasSubstr;

WedgePrism prism_of(double angle, double thickness) {
  WedgePrism prism;
  prism.index = 1.5168;
  prism.thickness = thickness;
  prism.wedge = {0, angle};
  return prism;
}

/// Traces a ray along z through an element at the origin. @param x  its distance from the middle [m]
RayStatus pass_along_z(OpticalElement const& element, double x, Ray<double>& ray) {
  ray = {{x, 0, -0.1}, {0, 0, 1}};
  RayStatus status = RayStatus::alive;
  element.add_surfaces(Pose<double>{}, false, [&](CameraElement<double> const& surface, char const*) {
    RayAccount<double> account;
    if (status == RayStatus::alive) status = pass_element(surface, ray, account);
  });
  return status;
}

// Snell's law at the inclined face of a prism: asin(n sin a) - a, towards the thick side. For a thin prism this is (n -
// 1) a + n (n^2 - 1) a^3 / 6 + O(a^5).
TEST(WedgePrism, DeflectsTowardsItsThickSide) {
  constexpr double n = 1.5168;
  Ray<double> ray;
  for (double const angle : {1e-3, 0.05, 0.3}) {
    ASSERT_EQ(pass_along_z(prism_of(angle, 10e-3), 0, ray), RayStatus::alive);
    double const deflection = std::asin(-ray.direction.x);  // turned by `angle` about y, it is thick at negative x
    EXPECT_NEAR(deflection, std::asin(n * std::sin(angle)) - angle, 1e-15);
    EXPECT_EQ(ray.direction.y, 0);
  }
  ASSERT_EQ(pass_along_z(prism_of(1e-3, 10e-3), 0, ray), RayStatus::alive);
  EXPECT_NEAR(std::asin(-ray.direction.x), (n - 1) * 1e-3, 1.1 * n * (n * n - 1) / 6 * 1e-9);
}

// The faces of a prism with 10 mm at the centre and an angle of 0.3 intersect at a distance of 10 mm / tan(0.3) = 32.3
// mm from the centre.
TEST(WedgePrism, EndsWhereItsThicknessIsZero) {
  Ray<double> ray;
  double const edge = 10e-3 / std::tan(0.3);
  EXPECT_EQ(pass_along_z(prism_of(0.3, 10e-3), 0.999 * edge, ray), RayStatus::alive);
  EXPECT_EQ(pass_along_z(prism_of(0.3, 10e-3), 1.001 * edge, ray), RayStatus::vignetted);
  EXPECT_EQ(pass_along_z(prism_of(0, 10e-3), 1.001 * edge, ray), RayStatus::alive) << "a plate has no edge";
}

// A thin prism at a distance b from the dots makes them appear displaced by b (n - 1) a towards its thin edge. Relative
// errors: thickness over b, 0.1 mm / 850 mm; squares of the angles, 3e-6.
TEST(WedgePrism, AheadOfTheLensDisplacesTheImage) {
  auto const setup = table1_setup(512);
  double const angle = 0.1 * unit::degree, b = 0.85, scale = 105.0 / 895.0 / setup.camera.pixel_pitch;
  for (ElementSide const side : {ElementSide::camera, ElementSide::target}) {
    WedgePrism prism = prism_of(angle, 0.1e-3);
    prism.side = side;
    prism.position = {0, 0, b - setup.z_d};
    auto through = setup;
    through.elements = {prism};
    EXPECT_TRUE(through.has_oblique_view());
    Vec2d const seen = *build_camera(through).project({0, 0, -setup.z_d});
    EXPECT_NEAR((seen.x - 255.5) / (scale * b * 0.5168 * angle), 1, 2e-4);
    EXPECT_NEAR(seen.y, 255.5, 1e-6);
  }
}

gladstone::Setup with_plate_behind_lens(double f_number, double tilt) {
  auto setup = table1_setup(512);
  setup.lens.f_number = f_number;
  OpticalWindow plate;
  plate.side = ElementSide::sensor;
  plate.index = 1.5168;
  plate.thickness = 10e-3;
  plate.position = {0, 0, 0.05};
  plate.tilt = {0, tilt};
  setup.elements = {plate};
  return setup;
}

// A plane plate behind the lens moves the image away by t (1 - 1/n) and leaves its size unchanged. At f/64, its
// spherical aberration moves the best focus by t (n^2 - 1) u^2 / (2 n^3), 1e-5 of t with u = 1/143, and the image of a
// point 2.2 mm off the axis by that times its slope, 1e-7 m * 2.2e-3.
TEST(PlateBehindTheLens, MovesTheImageAway) {
  auto const setup = with_plate_behind_lens(64, 0);
  auto bare = setup;
  bare.elements.clear();
  Camera const camera = build_camera(setup), other = build_camera(bare);
  EXPECT_NEAR(camera.sensor.pose.origin.z - other.sensor.pose.origin.z, 10e-3 * (1 - 1 / 1.5168), 1e-7);
  EXPECT_NEAR(setup.imaging().magnification, bare.imaging().magnification, 1e-15);
  Vec3d const point{1e-3, 2e-3, -setup.z_d};
  EXPECT_NEAR(length(*camera.project(point) - *other.project(point)), 0, 1e-4);
  EXPECT_NEAR(length(camera.ideal_project(point) - *other.project(point)), 0, 1e-4);
}

// Behind a double Gauss at f/8, the best focus is between that of paraxial rays and that of the rays of the largest
// slope u, which the plate's spherical aberration moves by t (n^2 - 1) u^2 / (2 n^3).
TEST(PlateBehindTheLens, MovesTheImageOfAPrescriptionAway) {
  auto const bare = double_gauss_setup(64, 8);
  auto setup = bare;
  setup.elements = with_plate_behind_lens(8, 0).elements;
  Camera const camera = build_camera(setup), other = build_camera(bare);
  double const n = 1.5168, moved = camera.sensor.pose.origin.z - other.sensor.pose.origin.z;
  double const u = other.paraxial.image_slope(1 + other.paraxial.front);
  EXPECT_GT(moved, 10e-3 * (1 - 1 / n));
  EXPECT_LT(moved, 10e-3 * ((1 - 1 / n) + (n * n - 1) * u * u / (2 * n * n * n)));
  ASSERT_EQ(camera.names.back(), "window 1, second face");
  Pose<double> const face = camera.elements.back().visit([](auto const& held) { return held.pose; });
  EXPECT_NEAR(face.origin.z - lens_exit(setup).origin.z, 55e-3, 1e-12);
}

// A tilted plate displaces a ray by t sin(a) (1 - cos(a) / sqrt(n^2 - sin(a)^2)). The chief ray of the axis point
// passes along the axis, so that its image is displaced by as much.
TEST(PlateBehindTheLens, DisplacesTheImageIfTilted) {
  auto const setup = with_plate_behind_lens(11, 30 * unit::degree);
  double const s = 0.5, c = std::sqrt(0.75), shift = 10e-3 * s * (1 - c / std::sqrt(1.5168 * 1.5168 - s * s));
  Vec2d const seen = *build_camera(setup).project({0, 0, -setup.z_d});
  EXPECT_NEAR(std::abs(seen.x - 255.5), shift / setup.camera.pixel_pitch, 1e-6);
  EXPECT_NEAR(seen.y, 255.5, 1e-6);
}

// The lens is placed such that the image of the dots is on a fixed sensor, with the plate between them.
TEST(PlateBehindTheLens, MovesWithTheLensThatASensorPlaces) {
  gladstone::Setup const setup = read_setup_text(
                                     "[geometry]\nz_sensor_mm = 870.0\nz_d_mm = 250.0\n[[element]]\nkind = \"window\"\n"
                                     "side = \"sensor\"\nposition_mm = [0, 0, 40]\n")
                                     .setup;
  Camera const camera = build_camera(setup);
  EXPECT_NEAR(camera.sensor.pose.origin.z, 0.87, 1e-9);
  Pose<double> const plate = camera.elements.back().visit([](auto const& held) { return held.pose; });
  EXPECT_NEAR(plate.origin.z - setup.z_a, 45e-3, 1e-12);
}

TEST(ElementTables, MeanTheSameAsTheTablesOfOneKind) {
  auto const read = [](std::string const& text) { return read_setup_text(text).setup; };
  gladstone::Setup const window = read("[[window]]\nposition_mm = [0, 0, 100]\ntilt_deg = [5, 0]\n"),
                         element =
                             read("[[element]]\nkind = \"window\"\nposition_mm = [0, 0, 100]\ntilt_deg = [5, 0]\n");
  ASSERT_EQ(element.elements.size(), 1u);
  Vec3d const point{1e-3, 2e-3, -0.25};
  EXPECT_EQ(*build_camera(window).project(point), *build_camera(element).project(point));
  std::string const keys = "pitch_um = 65\nfocal_length_um = 280\n";
  gladstone::Setup const lenslets = read("[camera.lenslets]\n" + keys),
                         array = read("[[element]]\nkind = \"lenslets\"\n" + keys);
  ASSERT_TRUE(array.element<LensletSetup>());
  EXPECT_EQ(array.element<LensletSetup>()->pitch, lenslets.element<LensletSetup>()->pitch);
  EXPECT_TRUE(array.divides_light());
  EXPECT_EQ(array.spot_scale_px(), lenslets.spot_scale_px());
}

TEST(ElementTables, NameTheirElementsInTheOrderOfTheLight) {
  gladstone::Setup const setup =
      read_setup_text(
          "[[element]]\nkind = \"wedge\"\nposition_mm = [0, 0, 100]\n[[window]]\nside = \"target\"\n"
          "position_mm = [0, 0, -100]\n[[element]]\nkind = \"window\"\nside = \"sensor\"\nposition_mm = [0, 0, 30]\n"
          "[[element]]\nkind = \"lenslets\"\npitch_um = 65\nfocal_length_um = 280\n")
          .setup;
  std::vector<std::string> const expected{"window 1, first face",
                                          "window 1, second face",
                                          "wedge 1, first face",
                                          "wedge 1, second face",
                                          "stop",
                                          "thin lens",
                                          "window 2, first face",
                                          "window 2, second face",
                                          "lenslets"};
  Camera const camera = build_camera(setup);
  EXPECT_EQ(camera.names, expected);
  EXPECT_EQ(camera.before_medium, 2);
  EXPECT_EQ(camera.before_lens, 4);
}

TEST(ElementTables, MistakesAreReportedAtTheirKeys) {
  auto const refuses = [](std::string const& keys, ErrorCode code, std::string const& where) {
    EXPECT_THAT([&] { read_setup_text("[[element]]\n" + keys); }, refused(code, where)) << keys;
  };
  refuses("position_mm = [0, 0, 100]\n", ErrorCode::missing_key, "1:");
  refuses("kind = \"mirror\"\n", ErrorCode::unknown_choice, "2:1");
  refuses("kind = \"wedge\"\n", ErrorCode::missing_key, "1:");
  refuses("kind = \"wedge\"\nwedge_deg = [0, 50]\nposition_mm = [0, 0, 100]\n", ErrorCode::out_of_range, "3:1");
  refuses("kind = \"wedge\"\nglass = \"none\"\nposition_mm = [0, 0, 100]\n", ErrorCode::unknown_choice, "3:1");
  refuses("kind = \"window\"\nposition_mm = [0, 0, 800]\nside = \"camera\"\n", ErrorCode::invalid_value, "4:1");
  // behind the image, which is 117 mm behind the lens, and in the lens
  refuses("kind = \"window\"\nside = \"sensor\"\nposition_mm = [0, 0, 118]\n", ErrorCode::invalid_value, "4:1");
  refuses("kind = \"window\"\nside = \"sensor\"\nposition_mm = [0, 0, 4]\n", ErrorCode::invalid_value, "4:1");
}

}  // namespace
}  // namespace gladstone
