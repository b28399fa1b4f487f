#include "render/light/mie.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/base/gauss_legendre.h"
#include "render/base/units.h"

namespace gladstone {
namespace {

using Complex = std::complex<double>;

/// Tolerance: half of the last one of so many printed digits, plus the rounding errors of our own computation.
double printed(double value, int digits) {
  return 0.501 * std::pow(10.0, std::floor(std::log10(std::abs(value))) - (digits - 1));
}

// Bohren & Huffman's example, x = 2 pi 0.525/0.6328 (the book prints 5.213), m = 1.55: efficiencies to 12 digits, and
// the book's table of the scattering matrix, S11/S11(0), POL = -S12/S11, S33/S11, S34/S11 (eq. 4.77).
TEST(Mie, BohrenAndHuffmansExampleToThePrintedDigits) {
  MieCoefficients const sphere(2 * pi * 0.525 / 0.6328, 1.55);
  MieEfficiencies const q = sphere.efficiencies();
  EXPECT_NEAR(q.q_ext, 3.10542553147, printed(3, 12));
  EXPECT_NEAR(q.q_sca, 3.10542553147, printed(3, 12));
  EXPECT_NEAR(q.q_back, 2.92534064971, printed(2, 12));
  EXPECT_NEAR(q.g, 0.633136758041, printed(0.6, 12));
  double const forward = sphere.amplitudes(0).s11();
  EXPECT_NEAR(forward, 518.619308642, printed(518, 12));
  double const table[20][5] = {{9, 0.78539043, -0.0045981123, 0.99940011, 0.03432611},
                               {18, 0.35689706, -0.045854052, 0.9860215, 0.16018427},
                               {27, 0.076611861, -0.36474445, 0.84360252, 0.39407648},
                               {36, 0.035535517, -0.53499716, 0.68696719, -0.49178667},
                               {45, 0.070184479, 0.0095995263, 0.95982519, -0.28043442},
                               {54, 0.057431338, 0.047792683, 0.98537111, 0.16358371},
                               {63, 0.021965961, -0.44060381, 0.64804287, 0.62121552},
                               {72, 0.012595886, -0.83199565, 0.20325513, -0.51620789},
                               {81, 0.017375007, 0.034167008, 0.79535367, -0.60518191},
                               {90, 0.012460081, 0.23046245, 0.93749705, 0.26074189},
                               {99, 0.0067909282, -0.71347188, -0.0071739754, 0.70064714},
                               {108, 0.009542386, -0.75625538, -0.039474754, -0.65308463},
                               {117, 0.0086341853, -0.28121531, 0.53625051, -0.79583499},
                               {126, 0.0022742117, -0.23961179, 0.9676018, 0.079579856},
                               {135, 0.0054399753, -0.8508037, 0.18753076, -0.49088215},
                               {144, 0.016024349, -0.70633444, 0.49525437, -0.50578134},
                               {153, 0.018885238, -0.89108117, 0.45327682, -0.02268173},
                               {162, 0.019525386, -0.78331948, -0.39161319, 0.48275222},
                               {171, 0.030167608, -0.1961939, -0.96206894, 0.18955556},
                               {180, 0.038318913, 0, -1, 0}};
  for (auto const& row : table) {
    auto const [s1, s2] = sphere.amplitudes(row[0] * unit::degree);
    double const s11 = (std::norm(s1) + std::norm(s2)) / 2;
    double const value[4] = {s11 / forward, (std::norm(s1) - std::norm(s2)) / (2 * s11),
                             (s1 * std::conj(s2)).real() / s11, -(s1 * std::conj(s2)).imag() / s11};
    for (int i = 0; i < 4; ++i) {
      // values printed as 0 are 0 up to rounding
      double const tolerance = row[i + 1] == 0 ? 1e-12 : printed(row[i + 1], 8);
      EXPECT_NEAR(value[i], row[i + 1], tolerance) << row[0] << " deg, column " << i + 1;
    }
  }
}

// Other published and independent values, to half of their last digit: Wiscombe's MIEV0 (NCAR TN-140, 1979) with
// absorption, and typical seeding particles.
TEST(Mie, PublishedEfficienciesToThePrintedDigits) {
  struct Known {
    double x;
    Complex m;
    double q_ext, q_sca, q_back, g;  ///< NaN: not given
  };
  double const none = std::nan("");
  for (auto const& [x, m, q_ext, q_sca, q_back, g] :
       {Known{3, 1.55, 3.70220134746, 3.70220134746, 0.802728344619, 0.707863653071},
        Known{10, 1.55, 2.94931116017, 2.94931116017, 8.44878727371, 0.751072443655},
        Known{1, {1.33, 1e-5}, none, 0.0939233027276, none, 0.184517346953},
        Known{100, {1.33, 1e-5}, none, 2.09659350639, none, 0.868959272002},
        Known{1, {1.5, 1}, 2.33632098467, 0.663453761516, none, 0.192136395892},
        Known{pi * 0.3 / 0.532, 2.6, 3.18221157164, 3.18221157164, none, 0.270918517347},
        Known{pi * 2 / 0.532, 1.335, 1.73265516154, 1.73265516154, none, none}}) {
    MieEfficiencies const q = MieCoefficients(x, m).efficiencies();
    double const pairs[4][2] = {{q.q_ext, q_ext}, {q.q_sca, q_sca}, {q.q_back, q_back}, {q.g, g}};
    for (auto const& pair : pairs) {
      if (!std::isnan(pair[1])) {
        EXPECT_NEAR(pair[0], pair[1], printed(pair[1], 12)) << "x = " << x;
      }
    }
  }
  // droplet of 1 um at 532 nm, x = 5.90524934885 to 12 digits: q_ext changes by up to 1 per unit of x
  MieCoefficients const droplet(pi / 0.532, 1.45);
  EXPECT_NEAR(droplet.efficiencies().q_ext, 3.51981554304, 1e-11);
  EXPECT_NEAR(droplet.efficiencies().q_back, 1.18152590667, 1e-11);
  EXPECT_NEAR(droplet.amplitudes(pi / 2).s11() / droplet.amplitudes(0).s11(), 0.0067497508, printed(0.0067, 8));
  EXPECT_NEAR(std::norm(droplet.amplitudes(pi / 2).s1), 4.933372, printed(4.9, 7));
  EXPECT_NEAR(std::norm(droplet.amplitudes(pi / 2).s2), 8.263150, printed(8.2, 7));
  MieCoefficients const ten(10, 1.5);
  EXPECT_NEAR(ten.efficiencies().q_ext, 2.881999, printed(2.8, 7));
  EXPECT_NEAR(std::norm(ten.amplitudes(0).s1), 5208.5594, printed(5208, 8));
  EXPECT_NEAR(std::norm(ten.amplitudes(pi / 2).s1), 9.422153, printed(9.4, 7));
  EXPECT_NEAR(std::norm(ten.amplitudes(pi).s1), 42.376590, printed(42, 8));
}

// A small sphere is a dipole of polarisability (m^2 - 1)/(m^2 + 2) (Rayleigh; Bohren & Huffman sec. 5.2): q_sca = 8/3
// x^4 |.|^2 (1 + 6/5 (m^2 - 2)/(m^2 + 2) x^2 + O(x^4)). The second term holds for real m, and O(x^4) is 1e-12 at x =
// 1e-3 (its factor is about one). Further, q_abs = 4 x Im(.) (1 + O(x^2)), and S2 = S1 cos theta up to O(x^2).
TEST(Mie, SmallSpheresAreDipoles) {
  double const x = 1e-3;
  for (double const m : {1.33, 1.45, 2.6}) {
    double const m2 = m * m, k = (m2 - 1) / (m2 + 2);
    double const expected = 8.0 / 3 * std::pow(x, 4) * k * k * (1 + 1.2 * (m2 - 2) / (m2 + 2) * x * x);
    MieCoefficients const sphere(x, m);
    EXPECT_NEAR(sphere.efficiencies().q_sca / expected, 1, 2e-11);
    EXPECT_NEAR(sphere.efficiencies().q_ext / expected, 1, 2e-11);
    EXPECT_NEAR(std::abs(sphere.amplitudes(1.0).s1) / (x * x * x * k), 1, 5 * x * x);
    EXPECT_NEAR(std::abs(sphere.amplitudes(1.0).s2 / sphere.amplitudes(1.0).s1), std::cos(1.0), 5 * x * x);
  }
  Complex const m(1.5, 0.1), k = (m * m - 1.0) / (m * m + 2.0);
  EXPECT_NEAR(MieCoefficients(x, m).efficiencies().q_ext / (4 * x * k.imag()), 1, 10 * x * x);
}

// Large spheres remove twice the light that falls on them, plus an edge term. For an absorbing sphere, which has no
// ripples, q_ext = 2 + 1.9923861 x^(-2/3) + O(1/x) (Nussenzveig & Wiscombe, Phys. Rev. Lett. 45 (1980) 1490); for m of
// order one, the factor of 1/x is of order one. Refraction causes ripples of order 1/x^(2/3) for a transparent sphere.
TEST(Mie, LargeSpheresHaveExtinctionEfficiencyTwo) {
  for (double const x : {1e3, 3e3, 1e4}) {
    double const edge = 1.9923861 * std::pow(x, -2.0 / 3);
    EXPECT_NEAR(MieCoefficients(x, {1.5, 1}).efficiencies().q_ext, 2 + edge, 1.5 / x);
    EXPECT_NEAR(MieCoefficients(x, {1.33, 0.5}).efficiencies().q_ext, 2 + edge, 1.5 / x);
    EXPECT_NEAR(MieCoefficients(x, 1.45).efficiencies().q_ext, 2, 3 * edge);
  }
}

// From x = 1e-3 to 1e4: a transparent sphere scatters all the light that it removes, in each multipole separately (Re
// a_n = |a_n|^2, since a_n is p/(p + i q) with real p and q); an absorbing sphere scatters less. The optical theorem:
// q_ext = 4/x^2 Re S(0) (eq. 4.76). Rounding errors accumulate along the recurrences of x orders.
TEST(Mie, EnergyIsConservedFromTheSmallestToTheLargest) {
  for (double x = 1e-3; x < 1.01e4; x *= std::pow(10.0, 0.25)) {
    double const rounding = 1e-12 + 1e-14 * x;
    for (double const m : {1.0003, 1.33, 1.45, 2.6}) {
      MieCoefficients const sphere(x, m);
      MieEfficiencies const q = sphere.efficiencies();
      EXPECT_NEAR(q.q_ext / q.q_sca, 1, rounding) << x << " " << m;
      EXPECT_NEAR(4 * sphere.amplitudes(0).s1.real() / (x * x) / q.q_ext, 1, rounding) << x << " " << m;
      for (std::size_t n = 0; n < sphere.a().size(); ++n) {
        EXPECT_LE(std::abs(sphere.a()[n].real() - std::norm(sphere.a()[n])), 1e-13);
        EXPECT_LE(std::abs(sphere.b()[n].real() - std::norm(sphere.b()[n])), 1e-13);
      }
    }
    for (Complex const m : {Complex(1.33, 1e-5), Complex(1.5, 0.5), Complex(0.2, 3.4)}) {
      MieCoefficients const sphere(x, m);
      MieEfficiencies const q = sphere.efficiencies();
      EXPECT_LT(q.q_sca, q.q_ext) << x << " " << m;
      EXPECT_GT(q.q_sca, 0);
      EXPECT_NEAR(4 * sphere.amplitudes(0).s1.real() / (x * x) / q.q_ext, 1, rounding) << x << " " << m;
    }
  }
}

// The integral of S11 over all directions is the scattered light, and its mean cosine is g: q_sca = 2/x^2 times the
// integral of S11 d(cos theta). S11 is a polynomial of degree 2 n_max in cos theta, which n_max + 2 Gauss-Legendre
// nodes integrate exactly, also if multiplied by cos theta.
TEST(Mie, ScatteredLightIntegratesToTheEfficiency) {
  for (double const x : {1e-3, 0.3, 5.9, 80.0, 700.0}) {
    for (Complex const m : {Complex(1.45, 0), Complex(1.5, 0.5)}) {
      MieCoefficients const sphere(x, m);
      GaussLegendre const rule(static_cast<int>(sphere.a().size()) + 2);
      double sum = 0, cosine = 0;
      for (std::size_t i = 0; i < rule.node.size(); ++i) {
        double const s11 = sphere.amplitudes(std::acos(rule.node[i])).s11();
        sum += rule.weight[i] * s11;
        cosine += rule.weight[i] * rule.node[i] * s11;
      }
      MieEfficiencies const q = sphere.efficiencies();
      EXPECT_NEAR(2 / (x * x) * sum / q.q_sca, 1, 1e-10) << x << " " << m;
      EXPECT_NEAR(cosine / sum, q.g, 1e-10) << x << " " << m;
    }
  }
}

// A sphere with the index of its surroundings scatters no light.
TEST(Mie, NothingIsScatteredWithoutAChangeOfIndex) {
  for (double const x : {1e-3, 1.0, 5.2, 300.0, 1e4}) {
    MieCoefficients const nothing(x, 1.0);
    MieEfficiencies const q = nothing.efficiencies();
    EXPECT_EQ(q.q_ext, 0);
    EXPECT_EQ(q.q_sca, 0);
    EXPECT_EQ(q.q_back, 0);
    EXPECT_EQ(q.g, 0);
    EXPECT_EQ(nothing.amplitudes(0.7).s1, 0.0);
    EXPECT_EQ(nothing.amplitudes(0.7).s2, 0.0);
  }
}

// If m tends to 1, every part of the sphere scatters independently (Rayleigh-Gans; Bohren & Huffman sec. 6.1): |S1| =
// 2/3 x^3 |m - 1| f(u), S2 = S1 cos theta, f = 3 (sin u - u cos u)/u^3, u = 2 x sin(theta/2). The relative error is of
// the order of m - 1 and of 2 x (m - 1), the phase shift of light in the sphere, at the forward amplitude.
TEST(Mie, FaintSpheresFollowRayleighAndGans) {
  double const delta = 1e-6;
  for (double const x : {0.01, 1.0, 6.0, 30.0}) {
    MieCoefficients const sphere(x, 1 + delta);
    double const forward = 2.0 / 3 * x * x * x * delta;
    for (double const angle : {0.0, 0.4, 1.2, pi / 2, 2.2, pi}) {
      double const u = 2 * x * std::sin(angle / 2);
      double const f = u < 1e-2 ? 1 - u * u / 10 : 3 * (std::sin(u) - u * std::cos(u)) / (u * u * u);
      auto const [s1, s2] = sphere.amplitudes(angle);
      // the series of f for small u has an error of u^4/280
      double const tolerance = 2 * (1 + x) * delta + 1e-10;
      EXPECT_NEAR(std::abs(s1) / forward, std::abs(f), tolerance) << x << " " << angle;
      EXPECT_NEAR(std::abs(s2) / forward, std::abs(f * std::cos(angle)), tolerance) << x << " " << angle;
    }
  }
}

// In forward and backward direction, no scattering plane is distinguished: S1 = S2 and S1 = -S2. The backscattered
// light determines q_back.
TEST(Mie, ForwardAndBackwardNoPolarisationIsSpecial) {
  for (double const x : {0.01, 5.9, 250.0}) {
    MieCoefficients const sphere(x, {1.45, 0.01});
    double const size = std::abs(sphere.amplitudes(0).s1);
    EXPECT_LT(std::abs(sphere.amplitudes(0).s1 - sphere.amplitudes(0).s2), 1e-13 * size);
    MieAmplitudes const back = sphere.amplitudes(pi);
    EXPECT_LT(std::abs(back.s1 + back.s2), 1e-13 * size);
    EXPECT_NEAR(4 * std::norm(back.s1) / (x * x) / sphere.efficiencies().q_back, 1, 1e-9);
  }
}

// Angles evaluated one at a time or several together have the same results, up to the rounding of fused products and
// sums.
TEST(Mie, AnglesTogetherAreTheAnglesAlone) {
  MieCoefficients const sphere(20, {1.5, 0.1});
  std::vector<double> angles;
  for (int i = 0; i < 21; ++i) angles.push_back(0.15 * i);
  std::vector<MieAmplitudes> together(angles.size());
  sphere.amplitudes(angles.data(), angles.size(), together.data());
  double const rounding = 1e-13 * std::abs(sphere.amplitudes(0).s1);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    EXPECT_LE(std::abs(together[i].s1 - sphere.amplitudes(angles[i]).s1), rounding);
    EXPECT_LE(std::abs(together[i].s2 - sphere.amplitudes(angles[i]).s2), rounding);
  }
}

}  // namespace
}  // namespace gladstone
