#include "render/medium/gladstone_dale.h"

#include <gtest/gtest.h>

#include "render/base/units.h"

namespace gladstone {
namespace {

struct Row {
  double wavelength_nm, refractivity, ciddor, merzkirch;  // n_s - 1 in 1e-4; K in 1e-4 m^3/kg
};

// Ciddor 1996 for standard air (450 ppm CO2), rho_s = 1.225458 kg/m^3, and Merzkirch's fit, to all printed digits.
class GladstoneDale : public testing::TestWithParam<Row> {};

TEST_P(GladstoneDale, ConstantsAreThePrintedOnes) {
  Row const row = GetParam();
  double const wavelength = row.wavelength_nm * unit::nanometre;
  EXPECT_NEAR(gladstone_dale_ciddor(wavelength) * 1e4, row.ciddor, 0.51e-5);
  EXPECT_NEAR(gladstone_dale_ciddor(wavelength) * 1.225458 * 1e4, row.refractivity, 0.51e-7);
  EXPECT_NEAR(gladstone_dale_merzkirch(wavelength) * 1e4, row.merzkirch, 0.51e-5);
}
INSTANTIATE_TEST_SUITE_P(Air, GladstoneDale,
                         testing::Values(Row{486.1, 2.7935688, 2.27961, 2.26682},
                                         Row{532.0, 2.7820832, 2.27024, 2.25982},
                                         Row{587.6, 2.7717424, 2.26180, 2.25343},
                                         Row{589.3, 2.7714732, 2.26158, 2.25327},
                                         Row{632.8, 2.7653274, 2.25657, 2.24943}));

TEST(GladstoneDaleConstants, FallWithWavelength) {
  for (double nm = 250; nm < 1600; nm += 50) {
    EXPECT_GT(gladstone_dale_ciddor(nm * 1e-9), gladstone_dale_ciddor((nm + 50) * 1e-9));
    EXPECT_GT(gladstone_dale_merzkirch(nm * 1e-9), gladstone_dale_merzkirch((nm + 50) * 1e-9));
  }
}

}  // namespace
}  // namespace gladstone
