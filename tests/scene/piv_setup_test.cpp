#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "render/focused_dots/focused_dots.h"
#include "render/scene/particle_scene.h"
#include "render/scene/particle_warnings.h"
#include "tests/scene/read_setup_text.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

/// Returns a PIV setup with additional keys in its tables.
std::string piv_text(std::string const& particles = "", std::string const& laser = "", std::string const& flow = "",
                     std::string const& more = "") {
  return "experiment = \"piv\"\n[camera]\npixels = [64, 64]\n" + more + "[particles]\n" + particles + "[laser]\n" +
         laser + "[flow]\n" + flow;
}

auto refused_piv(std::string const& text) {
  return [text] { read_setup_text(text); };
}

TEST(PivSetup, HasDefaults) {
  gladstone::Setup const setup = read_setup_text(piv_text()).setup;
  ASSERT_TRUE(setup.piv);
  EXPECT_EQ(setup.z_d, 0);
  EXPECT_EQ(setup.z_b(), setup.z_a);
  EXPECT_EQ(setup.focus_distance(), setup.z_a);
  EXPECT_EQ(setup.piv->particles.amount, 20000);
  EXPECT_EQ(*setup.piv->particles.volume, (Vec3d{40e-3, 40e-3, 3e-3}));
  EXPECT_EQ(setup.piv->particles.scattering, ParticleScattering::mie);
  EXPECT_DOUBLE_EQ(setup.piv->flow.dt, 10e-6);
  EXPECT_EQ(setup.piv->flow.flow(Vec3d{1, 2, 3}), (Vec3d{10, 0, 0}));
  EXPECT_EQ(setup.piv->laser.wavelength, 532e-9);
}

TEST(PivSetup, ReportsKeysOfOtherExperiments) {
  EXPECT_THAT(refused_piv(piv_text("", "", "", "[target]\n")), ThrowsSetupError(ErrorCode::invalid_value, "target"));
  EXPECT_THAT(refused_piv(piv_text("", "", "", "[geometry]\nz_d_mm = 250\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "geometry.z_d_mm"));
  EXPECT_THAT(refused_piv("[particles]\nnumber = 3\n"), ThrowsSetupError(ErrorCode::invalid_value, "particles"));
  EXPECT_THAT(refused_piv("[laser]\n"), ThrowsSetupError(ErrorCode::invalid_value, "laser"));
  EXPECT_THAT(refused_piv("[camera]\nexposure = \"absolute\"\n"),
              ThrowsSetupError(ErrorCode::invalid_value, "camera.exposure"));
}

TEST(PivSetup, RejectsSetupsWithoutImage) {
  EXPECT_THAT(refused_piv(piv_text("diameter_um = 0\n")),
              ThrowsSetupError(ErrorCode::out_of_range, "particles.diameter_um"));
  EXPECT_THAT(refused_piv(piv_text("diameter_um = -1.0\n")),
              ThrowsSetupError(ErrorCode::out_of_range, "particles.diameter_um"));
  EXPECT_THAT(refused_piv(piv_text("diameter_um = { kind = \"normal\", mean_um = 1, std_um = 0.5 }\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "particles.diameter_um.std_um"));
  EXPECT_THAT(refused_piv(piv_text("", "", "dt_us = 0\n")), ThrowsSetupError(ErrorCode::out_of_range, "flow.dt_us"));
  EXPECT_THAT(refused_piv(piv_text("index = [1.000277, 0]\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "particles.index"));
  EXPECT_THAT(refused_piv(piv_text("", "offset_mm = [0, 5]\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "laser.offset_mm"));
  EXPECT_THAT(refused_piv(piv_text("number = 10\nper_pixel = 0.1\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "particles.per_pixel"));
  EXPECT_THAT(refused_piv(piv_text("viscosity_pa_s = 1e-5\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "particles.viscosity_pa_s"));
  EXPECT_THAT(refused_piv(piv_text("file = \"nowhere.csv\"\n")),
              ThrowsSetupError(ErrorCode::missing_file, "particles.file"));
  EXPECT_THAT(refused_piv(piv_text("", "wavelength_nm = 633\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "laser.wavelength_nm"));
  EXPECT_THAT(refused_piv(piv_text("volume_mm = [10, 10, 2000]\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "particles.volume_mm"));
  EXPECT_THAT(refused_piv(piv_text("", "", "", "[[window]]\nglass = \"N-BK7\"\nposition_mm = [0, 0, 0.5]\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "window[0].position_mm"));
}

TEST(PivSetup, RefusesVelocitiesThatEndInsideTheVolume) {
  std::string const file = std::string(GLADSTONE_DATA_DIR) + "/../tests/fuzz/corpus/vti_field/appended_raw.vti";
  auto const flow = [&file](std::string const& keys) { return "kind = \"file\"\nfile = \"" + file + "\"\n" + keys; };
  // 4 x 3 x 2 nodes; Z = +-1 mm
  std::string const spacing = "spacing_mm = [4, 6, 2]\n",
                    volume = "volume_mm = [12, 12, 2]\nscattering = \"lambert\"\n";
  EXPECT_NO_THROW(read_setup_text(piv_text(volume, "", flow(spacing))));
  EXPECT_THAT(refused_piv(piv_text(volume, "", flow("spacing_mm = [3.9, 6, 2]\n"))),
              ThrowsSetupError(ErrorCode::invalid_value, "flow.file"));
  EXPECT_NO_THROW(
      read_setup_text(piv_text(volume, "", flow("spacing_mm = [3.9, 6, 2]\nperiodic = [true, false, false]\n"))));
  EXPECT_THAT(refused_piv(piv_text(volume, "", flow(spacing + "center_mm = [0, 0, 1]\n"))),
              ThrowsSetupError(ErrorCode::invalid_value, "flow.file"));
  EXPECT_THAT(refused_piv(piv_text("", "", "kind = \"file\"\nfile = \"nowhere.h5\"\n")),
              ThrowsSetupError(ErrorCode::missing_file, "flow.file"));
  EXPECT_THAT(refused_piv(piv_text("", "", "kind = \"file\"\n")),
              ThrowsSetupError(ErrorCode::missing_key, "flow.file"));
}

// Particles that enter from outside the velocity field, 60 m/s times 5 us on either side of 12 mm, cause a warning.
TEST(PivSetup, WarnsOfParticlesBeyondTheVelocityField) {
  std::string const file = std::string(GLADSTONE_DATA_DIR) + "/../tests/fuzz/corpus/vti_field/appended_raw.vti";
  gladstone::Setup const setup =
      read_setup_text(piv_text("volume_mm = [12, 12, 2]\nscattering = \"lambert\"\nnumber = 300\n", "",
                               "kind = \"file\"\nfile = \"" + file + "\"\nspacing_mm = [4, 6, 2]\nscale = 0.5\n"))
          .setup;
  auto const warnings = warnings_of_particles(build_scene(setup));
  EXPECT_THAT(warnings, testing::Contains(Warns("assumed at flow.file")));
}

TEST(PivSetup, ReadsMediumOfSecondPulse) {
  std::string const second =
      "[medium.second_field]\nkind = \"gaussian_plume\"\namplitude_kg_m3 = -0.4\nradius_mm = 4\n";
  gladstone::Setup const setup = read_setup_text(piv_text("", "", "", second)).setup;
  EXPECT_EQ(setup.medium.field.kind, FieldKind::none);
  ASSERT_TRUE(setup.medium.second_field);
  auto const* const plume = setup.medium.second_field->closed_form<GaussianPlume<double>>();
  ASSERT_TRUE(plume);
  EXPECT_DOUBLE_EQ(plume->radius, 4e-3);
  EXPECT_DOUBLE_EQ(setup.medium.thickness, 28e-3);  // seven radii
  EXPECT_TRUE(build_scene(setup).second_medium);
  EXPECT_THAT(refused_piv(second), ThrowsSetupError(ErrorCode::invalid_value, "medium.second_field"));
  EXPECT_THAT(refused_piv(piv_text(
                  "", "", "", "[medium.second_field]\nkind = \"sinusoid\"\namplitude_kg_m3 = 5\nwavelength_mm = 3\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "medium.second_field.amplitude_kg_m3"));
  std::string const shock = "kind = \"normal_shock\"\nmach = 2\nupstream_density_kg_m3 = 1\nshock_thickness_mm = 1\n";
  EXPECT_THAT(refused_piv(piv_text("", "", "kind = \"normal_shock\"\n", "[medium.field]\n" + shock + second)),
              ThrowsSetupError(ErrorCode::invalid_value, "medium.second_field"));
}

// An absurd number of particles is refused with the memory that it would need, before any is created.
TEST(PivSetup, CountsTheMemoryOfParticles) {
  gladstone::Setup const setup =
      read_setup_text(piv_text("number = 3e9\nvolume_mm = [10, 10, 10]\n", "", "velocity_m_s = [0, 0, 0]\n")).setup;
  MemoryRequirement const need = particle_memory(setup);
  EXPECT_STREQ(need.key, "particles.number");
  EXPECT_DOUBLE_EQ(need.bytes, 3e9 * bytes_per_particle);
  EXPECT_THAT([&] { build_scene(setup); }, ThrowsDataError(ErrorCode::memory, "particles.number"));
}

// 64 x 64 px of 10 um at M = 105 / 645 see a square of 3.93 mm of the plane Z = 0, which is inside the volume: 0.1
// particles per pixel are 409.6 particles in view, and 8 x 8 / 3.93^2 times as many in the volume. The variation of the
// square over the depth of +-1 mm in 750 mm averages out. About 3950 of the 16384 sample points are in view; the error
// of their fraction is due to the points near the corners, about ten.
TEST(PivSetup, SeedsByThePixel) {
  gladstone::Setup const setup = read_setup_text(piv_text("per_pixel = 0.1\nvolume_mm = [8, 8, 2]\n")).setup;
  double const side = 64 * 10e-3 / (105.0 / 645);
  EXPECT_NEAR(particle_count(setup) / (409.6 * 64 / (side * side)), 1, 3e-3);
  gladstone::Setup const by_volume = read_setup_text(piv_text("per_mm3 = 12.5\nvolume_mm = [8, 8, 2]\n")).setup;
  EXPECT_NEAR(particle_count(by_volume), 1600, 1e-9);
}

// The plane Z = 0 is seen from 45 degrees. Columns and rows at slopes of up to t = 32 px / (z_i / pitch) from the axis
// intersect Z = 0 at x = Z sqrt(2) u / (1 - u), measured from the camera's axis, and at heights v Z / (1 - u). The area
// of this quadrilateral is exactly Z^2 sqrt(2) 4 t^2 / (1 - t^2)^2. With the sensor in the image plane of Z = 0
// (Scheimpflug), a pixel sees cos(phi) of that, tan(phi) = M, to second order in t = 0.004.
TEST(PivSetup, SeedsByThePixelOfAPosedCamera) {
  for (bool const scheimpflug : {false, true}) {
    gladstone::Setup const setup =
        read_setup_text(piv_text("per_pixel = 0.1\nvolume_mm = [10, 8, 0.001]\n", "", "",
                                 "[camera.pose]\nposition_mm = [530.3300858899106, 0, 530.3300858899106]\n" +
                                     std::string(scheimpflug ? "[camera.sensor]\nscheimpflug = \"auto\"\n" : "")))
            .setup;
    double const M = 105.0 / 645, t = 32 * 10e-3 / (M * 750);
    double const area = 750.0 * 750 * std::sqrt(2.0) * 4 * t * t / std::pow(1 - t * t, 2) *
                        (scheimpflug ? std::cos(std::atan(M)) : 1.0);
    EXPECT_NEAR(particle_count(setup) / (409.6 * 80 / area), 1, 5e-3) << scheimpflug;
  }
}

// Particles are never rendered by the fast renderer of flat dots, even if the camera satisfies its conditions.
TEST(PivScene, IsNotOfFocusedDots) {
  gladstone::Setup const setup = read_setup_text(piv_text("number = 20\nscattering = \"lambert\"\n")).setup;
  EXPECT_TRUE(setup.has_closed_form_layout());
  EXPECT_NE(reason_against_focused_dots(setup), "");
  EXPECT_FALSE(build_focused_dots(build_scene(setup)));
}

TEST(PivScene, RejectsSheetOutsideParticles) {
  std::string const path = testing::TempDir() + "/beside.csv";
  std::ofstream(path) << "x_mm,y_mm,z_mm,diameter_um\n0,0,20,1\n1,1,-15,1\n";
  std::string const text = piv_text("file = \"" + path + "\"\n", "profile = \"top_hat\"\n");
  gladstone::Setup const setup = read_setup_text(text).setup;
  EXPECT_THAT([&] { build_scene(setup); }, ThrowsDataError(ErrorCode::invalid_value, "laser"));
}

// A sheet of 1 mm in a flow of 60 m/s along its normal: six tenths of the particles leave it in 10 us.
TEST(PivScene, WarnsOfPairsThatAreLost) {
  gladstone::Setup const lost =
      read_setup_text(piv_text("number = 500\nvolume_mm = [2, 2, 3]\nscattering = \"lambert\"\n",
                               "profile = \"top_hat\"\n", "velocity_m_s = [0, 0, 60]\n"))
          .setup;
  auto const warnings = warnings_of_particles(build_scene(lost));
  // particles are seeded over 3 mm, so that two thirds of them are dark, and cover 2 mm of the 3.9 mm view
  EXPECT_THAT(warnings,
              testing::UnorderedElementsAre(Warns("unsuitable at flow"), Warns("exposure at particles.volume_mm"),
                                            Warns("out_of_view at particles.volume_mm")));
  gladstone::Setup const aside =
      read_setup_text(piv_text("number = 50\nvolume_mm = [2, 2, 3]\ncenter_mm = [15, 0, 0]\n")).setup;
  auto const unseen = warnings_of_particles(build_scene(aside));
  ASSERT_EQ(unseen.size(), 1u);
  EXPECT_THAT(unseen[0], Warns("out_of_view at particles"));
}

// Rays start from the centre of a particle. The images of particles of 100 um are 105 / 645 of that, 1.6 px of 10 um,
// which causes a warning; those of 1 um do not. At f/11, the PSF is 2.44 x 645 / 540 x 11 x 0.532 um, 1.7 px.
TEST(PivScene, WarnsOfParticlesThatAreNoPoints) {
  auto const warned = [](std::string const& diameter) {
    std::string const keys = "number = 200\nvolume_mm = [4, 4, 2]\nscattering = \"lambert\"\ndiameter_um = ";
    return warnings_of_particles(build_scene(read_setup_text(piv_text(keys + diameter + "\n")).setup));
  };
  EXPECT_THAT(warned("1.0"), testing::IsEmpty());
  EXPECT_THAT(warned("100.0"),
              testing::ElementsAre(Warns("approximated at particles.diameter_um", testing::HasSubstr("1.6 px"))));
}

// A refractive index of 1 differs from that of air by 2.7e-4: the scattered light is less than that of a droplet by the
// square of a thousandth.
TEST(PivSetup, RejectsParticlesWithNegligibleScattering) {
  EXPECT_THAT(refused_piv(piv_text("index = [1.0, 0.0]\n")),
              ThrowsSetupError(ErrorCode::invalid_value, "particles.index"));
  EXPECT_NO_THROW(read_setup_text(piv_text("index = [1.01, 0.0]\n")));
  EXPECT_NO_THROW(read_setup_text(piv_text("index = [1.0, 0.5]\n")));
}

}  // namespace
}  // namespace gladstone
