#include <cmath>

#include "render/base/vec.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// White spheres in a sheet, seen by a camera with noise.
constexpr char const* piv_setup = R"(schema = 1
experiment = "piv"

[camera]
pixels = [96, 96]
pixel_pitch_um = 10.0
bit_depth = 12

[camera.noise]
full_well_e = 10000
quantum_efficiency = 0.5

[lens]
focal_length_mm = 105.0
f_number = 16.0

[geometry]
z_a_mm = 750.0

[particles]
per_pixel = 0.03
volume_mm = [9.0, 9.0, 1.5]
scattering = "lambert"

[laser]
thickness_mm = 1.0
pulse_energy_mj = 50.0

[flow]
kind = "rotation"
rate_rad_s = 3000.0
dt_us = 10.0

[correlate]
window_px = [32, 32]

[render]
rays_per_dot = 8
)";

class SilentPhysics : public ProgramFixture {
 protected:
  nlohmann::json summary_of(std::string const& setup, std::vector<std::string> const& assignments = {}) const {
    write("setup.toml", setup);
    std::vector<std::string> arguments{"render", "setup.toml", "-o", "case", "--quiet"};
    for (std::string const& one : assignments) arguments.insert(arguments.end(), {"--set", one});
    return json_of(arguments);
  }
  std::vector<std::string> warnings_of(std::vector<std::string> const& assignments = {}) const {
    return warnings_in(summary_of(piv_setup, assignments));
  }
};

// A photon releases quantum_efficiency electrons, never more. With sufficient light the exposure fills 90 % of the
// well.
TEST_F(SilentPhysics, AutoExposureIsLimitedByPhotons) {
  auto const bright = summary_of(piv_setup, {"laser.pulse_energy_mj=5000"});
  EXPECT_LT(bright["particles"]["electrons_per_photon"].get<double>(), 0.5);
  EXPECT_THAT(warnings_in(bright), Not(Contains("exposure at camera.exposure")));
  auto const dim = summary_of(piv_setup, {"laser.pulse_energy_mj=0.05"});
  EXPECT_NEAR(dim["particles"]["electrons_per_photon"].get<double>(), 0.5, 1e-9);
  EXPECT_THAT(warnings_in(dim), Contains("exposure at camera.exposure"));
  EXPECT_NEAR(dim["exposure"].get<double>(), 0.5 * dim["particles"]["photons"]["most"].get<double>(),
              0.01 * dim["exposure"].get<double>());
  // without noise electrons are only a scale of grey levels
  auto const ideal = summary_of(with(piv_setup, "[camera.noise]\nfull_well_e = 10000\nquantum_efficiency = 0.5\n", ""),
                                {"laser.pulse_energy_mj=0.05"});
  EXPECT_GT(ideal["particles"]["electrons_per_photon"].get<double>(), 0.6);
}

// 43.5 photons release 22 electrons in all pixels of the brightest particle. Its brightest pixel has at most those, and
// less than 22 / sqrt(22 + 3^2) = 3.9 times its noise; a hundred thousand times the light has more than ten times its
// noise.
TEST_F(SilentPhysics, WarnsOfAbsoluteExposuresThatAreLostInNoise) {
  std::string const absolute = "camera.exposure=\"absolute\"";
  EXPECT_THAT(warnings_of({"laser.pulse_energy_mj=0.05", absolute}), Contains("exposure at camera.exposure"));
  EXPECT_THAT(summary_of(piv_setup, {"laser.pulse_energy_mj=5000", absolute})["warnings"].dump(),
              Not(HasSubstr("times its noise")));
}

TEST_F(SilentPhysics, WarnsOfParticlesThatSendNoPhoton) {
  EXPECT_THAT(warnings_of({"laser.pulse_energy_mj=1e-6"}), Contains("exposure at particles"));
  auto const tiny = summary_of(piv_setup, {"particles.diameter_um=1e-7"});
  EXPECT_THAT(warnings_in(tiny), Contains("exposure at particles"));
  EXPECT_THAT(tiny["warnings"].dump(), AllOf(ContainsWhole("1e-07 m "), ContainsWhole("0.1 um")));
}

// The view is 96 * 10 um / 0.1628 = 5.9 mm wide, and the light of the sheet ends at 1.5 times its thickness. A rotation
// by 3e-8 rad displaces points 48 px from its axis by 1.4e-6 px.
TEST_F(SilentPhysics, WarnsOfVolumesSheetsAndTimesThatDoNotFit) {
  std::string const small = "out_of_view at particles.volume_mm", dark = "exposure at particles.volume_mm",
                    slow = "unsuitable at flow.dt_us";
  auto const fine = warnings_of({"laser.pulse_energy_mj=5000"});
  for (std::string const& warning : {small, dark, slow}) EXPECT_THAT(fine, Not(Contains(warning)));
  EXPECT_THAT(warnings_of({"particles.volume_mm=[4, 9, 1.5]"}), Contains(small));
  EXPECT_THAT(warnings_of({"particles.volume_mm=[9, 9, 12]"}), Contains(dark));
  EXPECT_THAT(warnings_of({"flow.dt_us=1e-5"}), Contains(slow));
}

TEST_F(SilentPhysics, ReportsFormulaRendering) {
  auto const summary = summary_of(with(piv_setup, "\"lambert\"", "\"gaussian\""));
  EXPECT_EQ(summary["method"], "formula");
  EXPECT_EQ(summary["estimator"]["dots_by_rays"], 0);
  EXPECT_EQ(summary["estimator"]["dots_by_formula"], summary["dots"]);
  EXPECT_THAT(summary["estimator"]["no_table_since"].get<std::string>(), HasSubstr("formula"));
  EXPECT_TRUE(summary["rays_per_dot"].is_null());
}

// A setup rejected because of a wrong unit: the message names the unit, too.
TEST_F(SilentPhysics, AsksForTheUnitOfImplausibleNumbers) {
  write("setup.toml", automatic_setup());
  auto const json_with = [this](std::vector<std::string> arguments, std::string const& assignment) {
    arguments.insert(arguments.end(), {"--set", assignment, "--json"});
    return nlohmann::json::parse(gladstone(arguments).out);
  };
  std::vector<std::string> const rendering{"render", "setup.toml", "-o", "case"};
  auto const short_wave = json_with(rendering, "medium.wavelength_nm=0.532");
  EXPECT_EQ(short_wave["exit_code"], 2);
  EXPECT_THAT(short_wave["warnings"].dump(), AllOf(ContainsWhole("0.532 um"), ContainsWhole("532 nm")));
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,0,0,0,1\n");
  auto const is_implausible = Contains(testing::StartsWith("implausible at "));
  for (std::vector<std::string> const& command :
       {rendering, {"design", "setup.toml"}, {"trace", "setup.toml", "--rays", "rays.csv", "-o", "out.csv"}})
    EXPECT_THAT(warnings_in(json_with(command, "lens.focal_length_mm=0.105")), is_implausible) << command.front();
  EXPECT_THAT(warnings_in(json_with(rendering, "medium.gladstone_dale=2.26e-4")), Not(is_implausible));
}

// 192 dots with 32 rays are 6144 rays, a hundredth of those for a deflection table and the measurement of its error.
TEST_F(SilentPhysics, AutoTakesRaysForFewDotsWhereATableIsLong) {
  std::string const shock =
      with(with(automatic_setup(), "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
                "kind = \"normal_shock\"\nmach = 1.2\nupstream_density_kg_m3 = 1.225\n"
                "shock_thickness_mm = 0.5\ntilt_deg = 0.0\nposition_mm = 0.0"),
           "dots_per_32px_window = 10.0", "dots_per_32px_window = 12.0");
  EXPECT_EQ(summary_of(shock, {"medium.ambient_density_kg_m3=1.225", "medium.thickness_mm=10"})["method"], "rays");
  EXPECT_EQ(summary_of(automatic_setup())["method"], "focused_dots");
}

// A solid body rotates by t = 0.03 rad between the pulses. Pixels relative to the axis, Y down: a point P of frame A
// moves by (cos t - 1) P + sin t (Y, -X); one whose images have P as their midpoint by 2 tan(t/2) (Y, -X). Paths are
// integrated to 1e-5 px.
TEST_F(SilentPhysics, ADatasetHoldsTheExactDisplacementOfEveryPixel) {
  write("setup.toml", piv_setup);
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"flow.rate_rad_s\" = [3000.0]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  succeed({"sweep", "run", "run", "--quiet", "--keep-images"});
  succeed({"sweep", "collect", "run", "--no-figures", "--quiet", "--dataset", "set.h5"});
  Hdf5Reader const set(in("set.h5").string());
  double const t = 0.03;
  for (std::string const name : {"/displacement_px", "/displacement_mid_px"}) {
    bool const mid = name == "/displacement_mid_px";
    ASSERT_EQ(set.shape(name), (std::vector<std::size_t>{1, 96, 96, 2}));
    EXPECT_EQ(std::stod(set.attribute_of(name, "spacing_px")), 1);
    EXPECT_THAT(set.attribute_of(name, "place"), HasSubstr(mid ? "mid-time" : "frame A"));
    std::vector<double> const map = set.read(name);
    double worst = 0;
    for (std::size_t i = 0; i < 96 * 96; ++i) {
      double const x = static_cast<double>(i % 96) - 47.5, y = static_cast<double>(i / 96) - 47.5;
      Vec2d const turned{y, -x};
      Vec2d const exact = mid ? 2 * std::tan(t / 2) * turned : (std::cos(t) - 1) * Vec2d{x, y} + std::sin(t) * turned;
      double const off = length(Vec2d{map[2 * i], map[2 * i + 1]} - exact);
      worst = off <= worst ? worst : off;  // NaN counts as a difference
    }
    EXPECT_LT(worst, 1e-4) << name;
  }
}

/// Path of a particle in the Taylor-Green vortices u = A sin kx cos ky, v = -A cos kx sin ky, by fourth-order
/// Runge-Kutta steps. In a step of 1 us the phase changes by h = 2 pi 5 m/s 1 us / 5 mm = 0.006 at most, and the path
/// has an error of h^5 / 120 of a wavelength, far below 1e-9 px.
/// @param place  initial position [mm], Y up
Vec2d taylor_green_path(Vec2d place, double amplitude_m_s, double wavelength_mm, double time_us) {
  double const k = 2 * 3.14159265358979323846 / wavelength_mm, per_us = 1e-3 * amplitude_m_s;
  auto const velocity = [&](Vec2d p) {
    return Vec2d{per_us * std::sin(k * p.x) * std::cos(k * p.y), -per_us * std::cos(k * p.x) * std::sin(k * p.y)};
  };
  int const steps = 10;
  double const h = time_us / steps;
  for (int step = 0; step < steps; ++step) {
    Vec2d const a = velocity(place), b = velocity(place + h / 2 * a), c = velocity(place + h / 2 * b),
                d = velocity(place + h * c);
    place = place + h / 6 * (a + 2 * b + 2 * c + d);
  }
  return place;
}

// Vortices of 5 mm are not linear in the position: an interpolation between the 276 particles, 4 px apart, would have
// an error of some (k 4 px)^2 / 8 = 1 % of the displacement, 0.008 px. In the sheet, a pixel is 10 um (750 - 105) / 105
// wide.
TEST_F(SilentPhysics, ADatasetHoldsTheExactDisplacementOfVortices) {
  write("setup.toml", with(piv_setup, "kind = \"rotation\"\nrate_rad_s = 3000.0",
                           "kind = \"taylor_green\"\namplitude_m_s = 5.0\nwavelength_mm = 5.0"));
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"flow.amplitude_m_s\" = [5.0]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  succeed({"sweep", "run", "run", "--quiet", "--keep-images"});
  succeed({"sweep", "collect", "run", "--no-figures", "--quiet", "--dataset", "set.h5"});
  Hdf5Reader const set(in("set.h5").string());
  double const pixel_mm = 0.01 * (750.0 - 105.0) / 105.0;
  for (std::string const name : {"/displacement_px", "/displacement_mid_px"}) {
    bool const mid = name == "/displacement_mid_px";
    std::vector<double> const map = set.read(name);
    ASSERT_EQ(map.size(), 2u * 96 * 96);
    double worst = 0, largest = 0;
    for (std::size_t i = 0; i < 96 * 96; ++i) {
      Vec2d const place = pixel_mm * Vec2d{static_cast<double>(i % 96) - 47.5, 47.5 - static_cast<double>(i / 96)};
      Vec2d start = place, moved{};
      // half the displacement changes by at most pi 0.05 mm / 5 mm = 0.03 of a change of the start
      for (int round = 0; round < (mid ? 8 : 1); ++round) {
        moved = taylor_green_path(start, 5.0, 5.0, 10.0) - start;
        if (mid) start = place - 0.5 * moved;
      }
      Vec2d const exact{moved.x / pixel_mm, -moved.y / pixel_mm};
      largest = std::max(largest, length(exact));
      double const off = length(Vec2d{map[2 * i], map[2 * i + 1]} - exact);
      worst = off <= worst ? worst : off;  // NaN counts as a difference
    }
    EXPECT_GT(largest, 0.7) << name;
    EXPECT_LT(worst, 1e-4) << name;
  }
}

}  // namespace
}  // namespace gladstone::end_to_end
