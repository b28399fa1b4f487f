#include "render/sensor/diffraction_spot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "render/base/units.h"
#include "tests/support/edge_integral.h"

namespace gladstone {
namespace {

// For Table 1, N (1 + M) lambda = 11 * 1.117318 * 532 nm = 6.5385 um.
TEST(SpotSize, Table1IsSixteenMicrometresToTheFirstZero) {
  SpotSize const spot{11 * (1 + 0.105 / 0.895) * 532e-9};
  EXPECT_NEAR(spot.scale, 6.538547e-6, 1e-12);
  // 15.954 um contains the rounded factor 2.44
  EXPECT_NEAR(spot.first_zero_diameter(), 15.954e-6 * 2.43934 / 2.44, 6e-9);
}

// The first zero of J1(pi r)/(pi r) is at r = 1.2196698912664505.
TEST(SpotSize, FirstZeroIsWhereBesselVanishes) {
  EXPECT_NEAR(SpotSize{1.0}.first_zero_diameter(), 2 * 1.2196698912664505, 1e-6);
  EXPECT_NEAR(std::cyl_bessel_j(1.0, pi * SpotSize{1.0}.first_zero_diameter() / 2), 0, 2e-6);
}

// The Gaussian with the smallest area-weighted squared deviation from the Airy pattern within its first zero, with the
// same peak: the sum of r (airy - exp(-r^2/2s^2))^2 has its minimum at the matched s.
TEST(SpotSize, MatchedSigmaFitsTheAiryPatternBest) {
  auto const misfit = [](double sigma) {
    double sum = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      double const r = (i + 0.5) * 1.2196698912664505 / n, v = pi * r;
      double const airy = std::pow(2 * std::cyl_bessel_j(1.0, v) / v, 2);
      sum += r * std::pow(airy - std::exp(-r * r / (2 * sigma * sigma)), 2);
    }
    return sum;
  };
  double const sigma = SpotSize{1.0}.matched_sigma();
  EXPECT_NEAR(sigma, 0.4206042622, 1e-12);
  EXPECT_LT(misfit(sigma), misfit(sigma * 1.0005));
  EXPECT_LT(misfit(sigma), misfit(sigma * 0.9995));
}

std::vector<double> gaussian_shares(GaussianSpot<double> const& spot, double p, Footprint& at) {
  at = spot.footprint({p, p});
  std::vector<double> shares(static_cast<std::size_t>(at.width));
  spot.shares(p, at.column, at.width, shares.data());
  return shares;
}

// The light outside the footprint is erfc((5.5 sigma + 0.5)/(sqrt 2 sigma)) < 4e-8 per axis. The centroid of the shares
// differs from the position by the aliasing of the pixels, sum of exp(-2 pi^2 k^2 sigma^2)/(pi k); the tolerance is
// 1e-6 px more.
TEST(GaussianSpot, KeepsItsLightAndItsCentroid) {
  for (double const sigma : {0.1, 0.275, 0.65, 1.0, 2.5}) {
    for (double const p : {10.0, 10.25, 10.4999, 10.5, -3.3}) {
      Footprint at{};
      auto const shares = gaussian_shares({sigma}, p, at);
      EXPECT_LE(at.width, GaussianSpot<double>::most_width);
      double const sum = std::accumulate(shares.begin(), shares.end(), 0.0);
      EXPECT_NEAR(sum, 1, 4e-7) << sigma << " " << p;
      double centroid = 0;
      for (int i = 0; i < at.width; ++i) centroid += shares[static_cast<std::size_t>(i)] * (at.column + i);
      double aliasing = 0;
      for (int k = 1; k < 20; ++k) aliasing += std::exp(-2 * std::pow(pi * k * sigma, 2)) / (pi * k);
      EXPECT_NEAR(centroid, p, aliasing + 1e-6) << sigma << " " << p;
    }
  }
}

// Compares pixel shares with a midpoint rule of 2000 points per pixel, whose error is (1/24) (1/2000)^2 max|f''| <
// 1e-7 (the bound is twice this), and with the integrals at single edges up to rounding. The footprints of 7 to 35
// pixels have fewer and more edges than are evaluated at a time.
TEST(GaussianSpot, SharesAreIntegralsOverPixels) {
  for (double const sigma : {0.4, 0.65, 0.83, 1.5, 3.0}) {
    Footprint at{};
    double const p = 20.37;
    auto const shares = gaussian_shares({sigma}, p, at);
    for (int i = 0; i < at.width; ++i) {
      double integral = 0;
      for (int k = 0; k < 2000; ++k) {
        double const x = at.column + i - 0.5 + (k + 0.5) / 2000 - p;
        integral += std::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * pi)) / 2000;
      }
      double const share = shares[static_cast<std::size_t>(i)];
      GaussianSpot<double> const spot{sigma};
      EXPECT_NEAR(share, integral, 2e-7);
      EXPECT_NEAR(share, edge_integral(spot, p, at.column, i + 1) - edge_integral(spot, p, at.column, i), 1e-15);
    }
  }
}

struct Shares {
  AiryTable table;
  AiryTable::View view;
  int width;
  explicit Shares(double scale) : table(scale), view(table.view()), width(2 * view.half_width + 1) {}
  double operator()(int sub_x, int sub_y, int column, int row) const {
    std::ptrdiff_t const at = static_cast<std::ptrdiff_t>(sub_y) * (view.subdivisions + 1) + sub_x;
    return view.shares[(at * width + row) * width + column];
  }
};

TEST(AiryTable, SumsToOneAndIsSymmetric) {
  for (double const scale : {0.3, 0.654, 1.5}) {
    Shares const shares(scale);
    int const n = shares.view.subdivisions, last = shares.width - 1;
    for (int sub_y = 0; sub_y <= n; sub_y += n / 4) {
      for (int sub_x = 0; sub_x <= n; ++sub_x) {
        double sum = 0;
        for (int row = 0; row <= last; ++row) {
          for (int column = 0; column <= last; ++column) {
            sum += shares(sub_x, sub_y, column, row);
            ASSERT_NEAR(shares(sub_x, sub_y, column, row), shares(n - sub_x, sub_y, last - column, row), 1e-12);
            ASSERT_NEAR(shares(sub_x, sub_y, column, row), shares(sub_y, sub_x, row, column), 1e-12);
          }
        }
        ASSERT_NEAR(sum, 1, 1e-12);
      }
    }
  }
}

// Compares the share of every pixel with a midpoint rule of 80 x 80 points, both normalised over the footprint. The
// table is built from 62 points per pixel; the error of such a rule is h^2/24 times the Laplacian, pi^2/scale^2 at the
// peak: 2.5e-4 of a share that is below 0.4.
TEST(AiryTable, SharesAreIntegralsOverPixels) {
  double const scale = 0.654;
  Shares const shares(scale);
  int const n = shares.view.subdivisions, half = shares.view.half_width, fine = 80;
  for (int const sub_x : {0, n / 2, n / 2 + 5}) {
    int const sub_y = n / 3;
    double const x0 = static_cast<double>(sub_x) / n - 0.5, y0 = static_cast<double>(sub_y) / n - 0.5;
    std::vector<double> direct;
    for (int row = -half; row <= half; ++row) {
      for (int column = -half; column <= half; ++column) {
        double sum = 0;
        for (int j = 0; j < fine; ++j) {
          for (int i = 0; i < fine; ++i) {
            double const r = std::hypot(column - 0.5 + (i + 0.5) / fine - x0, row - 0.5 + (j + 0.5) / fine - y0);
            double const v = pi * r / scale;
            double const amplitude = v < 1e-6 ? 1.0 : 2 * std::cyl_bessel_j(1.0, v) / v;
            if (r <= half + 1) sum += amplitude * amplitude;
          }
        }
        direct.push_back(sum);
      }
    }
    double const total = std::accumulate(direct.begin(), direct.end(), 0.0);
    for (int i = 0; i < shares.width * shares.width; ++i) {
      ASSERT_NEAR(shares(sub_x, sub_y, i % shares.width, i / shares.width), direct[static_cast<std::size_t>(i)] / total,
                  1e-4);
    }
  }
}

// 83.778 % of the light of an Airy pattern is within its first zero, and 1 - J0^2 - J1^2 within radius r; the table is
// cut between r = 6.05 and 6.1 scales. At a scale of 10 px, the pixels resolve the first zero, where the irradiance
// vanishes. Tolerance: 2e-3.
TEST(AiryTable, HoldsEightyFourPercentWithinTheFirstZero) {
  double const scale = 10;
  Shares const shares(scale);
  int const half = shares.view.half_width, middle = shares.view.subdivisions / 2;
  double inside = 0;
  for (int row = -half; row <= half; ++row) {
    for (int column = -half; column <= half; ++column) {
      if (std::hypot(column, row) < 1.21967 * scale) inside += shares(middle, middle, column + half, row + half);
    }
  }
  double const v = pi * (half + 0.75) / scale;
  double const held = 1 - std::pow(std::cyl_bessel_j(0.0, v), 2) - std::pow(std::cyl_bessel_j(1.0, v), 2);
  EXPECT_NEAR(held, 0.967, 1e-3);
  EXPECT_NEAR(inside, 0.8377848691733143 / held, 2e-3);
}

}  // namespace
}  // namespace gladstone
