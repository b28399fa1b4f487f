#include "render/optics/glass.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "render/base/contracts.h"

namespace gladstone::inline optics {
namespace {

/// Coefficients of a formula; those missing in the catalogue are 0.
struct Coefficients {
  std::span<double const> values;
  double operator[](std::size_t k) const { return k < values.size() ? values[k] : 0.0; }
};

/// Returns the sum of B L^2 / (L^2 - C) over pairs (B, C).
double sellmeier_sum(Coefficients c, int pairs, double l2) {
  double sum = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(pairs); ++k) sum += c[2 * k] * l2 / (l2 - c[2 * k + 1]);
  return sum;
}

/// Returns the sum of c[k] L^power[k].
double power_sum(Coefficients c, std::span<int const> powers, double l) {
  double sum = 0;
  for (std::size_t k = 0; k < powers.size(); ++k) sum += c[k] * std::pow(l, powers[k]);
  return sum;
}

constexpr std::array schott_powers{0, 2, -2, -4, -6, -8};
constexpr std::array extended1_powers{0, 2, -2, -4, -6, -8, -10, -12};
constexpr std::array extended2_powers{0, 2, -2, -4, -6, -8, 4, 6};
constexpr std::array extended3_powers{0, 2, 4, -2, -4, -6, -8, -10, -12};

/// Returns the index by a dispersion formula. @param l  wavelength [um]
double index_by(DispersionFormula formula, Coefficients c, double l) {
  using std::sqrt;
  double const l2 = l * l;
  switch (formula) {
    case DispersionFormula::schott:
      return sqrt(power_sum(c, schott_powers, l));
    case DispersionFormula::sellmeier1:
      return sqrt(1 + sellmeier_sum(c, 3, l2));
    case DispersionFormula::herzberger: {
      double const w = 1 / (l2 - 0.028);
      return c[0] + c[1] * w + c[2] * w * w + c[3] * l2 + c[4] * l2 * l2 + c[5] * l2 * l2 * l2;
    }
    case DispersionFormula::sellmeier2:
      return sqrt(1 + c[0] + c[1] * l2 / (l2 - c[2] * c[2]) + c[3] / (l2 - c[4] * c[4]));
    case DispersionFormula::conrady:
      return c[0] + c[1] / l + c[2] / std::pow(l, 3.5);
    case DispersionFormula::sellmeier3:
      return sqrt(1 + sellmeier_sum(c, 4, l2));
    case DispersionFormula::handbook_of_optics1:
      return sqrt(c[0] + c[1] / (l2 - c[2]) - c[3] * l2);
    case DispersionFormula::handbook_of_optics2:
      return sqrt(c[0] + c[1] * l2 / (l2 - c[2]) - c[3] * l2);
    case DispersionFormula::sellmeier4:
      return sqrt(c[0] + c[1] * l2 / (l2 - c[2]) + c[3] * l2 / (l2 - c[4]));
    case DispersionFormula::extended1:
      return sqrt(power_sum(c, extended1_powers, l));
    case DispersionFormula::sellmeier5:
      return sqrt(1 + sellmeier_sum(c, 5, l2));
    case DispersionFormula::extended2:
      return sqrt(power_sum(c, extended2_powers, l));
    case DispersionFormula::extended3:
      return sqrt(power_sum(c, extended3_powers, l));
  }
  return 1;
}

/// Returns the index by Lagrange interpolation in 1/lambda^2 through the samples nearest to a wavelength [m].
double interpolated_index(std::span<Glass::Sample const> samples, double wavelength) {
  constexpr std::size_t most_samples = 4;
  auto const x = [](double at) { return 1e-12 / (at * at); };
  std::size_t const count = std::min(samples.size(), most_samples);
  auto const after = std::lower_bound(samples.begin(), samples.end(), wavelength,
                                      [](Glass::Sample const& sample, double at) { return sample.wavelength < at; });
  std::size_t const next = static_cast<std::size_t>(after - samples.begin());
  std::size_t const first = std::min(next > count / 2 ? next - count / 2 : 0, samples.size() - count);
  std::span<Glass::Sample const> const near = samples.subspan(first, count);
  double sum = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    double weight = 1;
    for (std::size_t j = 0; j < near.size(); ++j) {
      if (j == i) continue;
      weight *= (x(wavelength) - x(near[j].wavelength)) / (x(near[i].wavelength) - x(near[j].wavelength));
    }
    sum += weight * near[i].index;
  }
  return sum;
}

}  // namespace

double Glass::index(double wavelength) const {
  return samples.empty() ? index_by(formula, {coefficients}, wavelength * 1e6)
                         : interpolated_index(samples, wavelength);
}

double Glass::absorption(double wavelength) const {
  auto const loss = [](Transmission const& t) { return -std::log(std::max(t.transmission, 1e-30)) / t.thickness; };
  auto const after = std::find_if(transmission.begin(), transmission.end(),
                                  [&](Transmission const& t) { return t.wavelength >= wavelength; });
  if (transmission.empty()) return 0;
  if (after == transmission.begin()) return loss(transmission.front());
  if (after == transmission.end()) return loss(transmission.back());
  auto const before = after - 1;
  double const share = (wavelength - before->wavelength) / (after->wavelength - before->wavelength);
  return (1 - share) * loss(*before) + share * loss(*after);
}

Glass Glass::from_nd_vd(double nd, double vd) {
  // Schott's formula represents Cauchy's one exactly: n^2 = (A + B/l^2)^2 = A^2 + 2 A B l^-2 + B^2 l^-4
  auto const inverse_square = [](double wavelength) { return 1e-12 / (wavelength * wavelength); };
  double const b = (nd - 1) / (vd * (inverse_square(spectral_line::F) - inverse_square(spectral_line::C)));
  double const a = nd - b * inverse_square(spectral_line::d);
  Glass glass;
  glass.name = fmt::format("nd {:.5f}, Vd {:.2f}", nd, vd);
  glass.coefficients = {a * a, 0, 2 * a * b, b * b};
  glass.shortest = 0.3e-6;
  glass.longest = 2.5e-6;
  return glass;
}

Glass Glass::from_samples(std::string name, std::vector<Sample> samples) {
  GLADSTONE_EXPECTS(!samples.empty());
  std::sort(samples.begin(), samples.end(),
            [](Sample const& a, Sample const& b) { return a.wavelength < b.wavelength; });
  Glass glass;
  glass.name = std::move(name);
  glass.shortest = samples.size() > 1 ? samples.front().wavelength : 0;  // a single index applies to all wavelengths
  glass.longest = samples.size() > 1 ? samples.back().wavelength : 1;
  glass.samples = std::move(samples);
  return glass;
}

}  // namespace gladstone::inline optics
