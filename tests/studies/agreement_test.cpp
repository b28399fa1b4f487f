#include "studies/compare/agreement.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "render/base/units.h"
#include "studies/case/case.h"
#include "studies/case/shared_folder.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// Set-up of Table 1 with one of the turbulence planes.
Setup table1(std::string const& plane, int rays) {
  return load_case_setup(shared_folder() + "/studies/cases/table1.toml",
                         {fmt::format("medium.field.file=\"{}/fields/{}\"", GLADSTONE_DATA_DIR, plane),
                          fmt::format("render.rays_per_dot={}", rays)})
      .setup;
}

// A plane of 64 nodes with four periods of 8 mm along x, seen in four views of 32 nodes each. In every view the rays
// are Eq. 9 times the transfer of the cone and that of the dot (3 px are 0.19 mm at the medium: 1 - (pi 0.19 / 8)^2 / 8
// = 0.9993), so that their correlation is 1, and all parts of the plane, each one period wide, are equal. 64 rays per
// dot have an error of 1e-3 of the amplitude, the obliquity of the rays 5e-4, the spline between 16 nodes per wave
// 3e-5. Eq. 9 is S a k cos(k x), S = 0.006626657 px per kg/m^4 for Table 1, in one of two components, with 24 dots per
// period.
TEST(AgreementOverPlane, OfOneWaveIsTheConesTransfer) {
  std::string const path = testing::TempDir() + "gladstone_wave_plane.nrrd";
  write_plane(path, 64, 64, [](int i, int) { return 1.225 + 1e-3 * std::sin(2 * pi * i / 16); });
  gladstone::Setup setup = table1("hbdt512_late_slice.h5", 64);
  setup.medium.field.file = path;
  setup.medium.field.dataset = "";
  setup.medium.field.scale = 1;
  FocusedDotsRenderer renderer;
  PlaneAgreement const traced = agreement_over_plane(setup, 32, 0.5e-3, renderer);
  std::filesystem::remove(path);
  EXPECT_EQ(traced.sums.dots, 96u * 96u);
  Agreement const value = traced.sums.agreement();
  EXPECT_NEAR(value.correlation, 1, 1e-5);
  EXPECT_NEAR(value.rms_ratio, cone_transfer(setup, 8e-3) * 0.9993, 2e-3);
  EXPECT_LT(traced.error.correlation, 1e-5);
  EXPECT_LT(traced.error.rms_ratio, 1e-3);
  double const amplitude = 0.006626657 * 1e-3 * 2 * pi / 8e-3;
  EXPECT_NEAR(traced.sums.eq9_px(), amplitude / 2, 1e-3 * amplitude);
}

/// Plane, and number of nodes in 32.7 mm.
struct PlaneCase {
  char const* file;
  int nodes;
};
class AgreementOfTurbulence : public testing::TestWithParam<PlaneCase> {};

// The theory has no free parameter and uses the same plane. The remaining differences: the dots are a sample (three
// standard errors of another plane of the same kind), and at the sharpest fronts the stop transmits other rays in the
// measurement image than in the reference image, a few hundredths of the rms of the rays (cone against rays, below).
// 16 rays per dot have at most four times the error of 64, 4e-3 of the amplitude, and change a correlation by its
// square.
TEST_P(AgreementOfTurbulence, IsWhatTheSpectrumPredicts) {
  auto const [file, nodes] = GetParam();
  gladstone::Setup const setup = table1(file, 16);
  double const spacing = 32.7 * unit::millimetre / (nodes - 1);
  FocusedDotsRenderer renderer;
  PlaneAgreement const traced = agreement_over_plane(setup, nodes, spacing, renderer);
  Agreement const value = traced.sums.agreement(),
                  predicted = predicted_agreement(gradient_spectrum(field_plane(setup.medium.field)), spacing, setup);
  double const refraction = std::abs(traced.sums.cone_px() / traced.sums.rays_px() - 1);
  EXPECT_LT(refraction, 0.03);
  EXPECT_NEAR(value.correlation, predicted.correlation, 3 * traced.error.correlation);
  EXPECT_NEAR(value.rms_ratio, predicted.rms_ratio, 3 * traced.error.rms_ratio + refraction * value.rms_ratio);
  // and the error bars are small
  EXPECT_LT(traced.error.correlation, 0.03);
  EXPECT_LT(traced.error.rms_ratio, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Planes, AgreementOfTurbulence,
                         testing::Values(PlaneCase{"hbdt512_kepeak_slice.h5", 128},
                                         PlaneCase{"hbdt512_late_slice.h5", 512}));

}  // namespace
}  // namespace gladstone
