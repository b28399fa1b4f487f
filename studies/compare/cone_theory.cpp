#include "studies/compare/cone_theory.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>

#include "analysis/density/disc_transfer.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"
#include "render/base/units.h"

namespace gladstone::inline compare {
namespace {

/// Returns the mean square of a wave averaged along chief rays through stacked planes, over the view and all wave
/// directions, relative to the unaveraged wave.
double chief_ray_energy(Setup const& setup, double wavenumber) {
  double const on_target = setup.camera.pixel_pitch / setup.imaging().magnification;
  // slopes of the chief rays at the view's edges
  double const half_x = setup.camera.columns * on_target / 2 / setup.z_b();
  double const half_y = setup.camera.rows * on_target / 2 / setup.z_b();
  constexpr int places = 6, directions = 12;
  double sum = 0;
  for (int i = 0; i < places; ++i) {
    for (int j = 0; j < places; ++j) {
      for (int turn = 0; turn < directions; ++turn) {
        double const angle = pi * (turn + 0.5) / directions;
        double const slope =
            half_x * (i + 0.5) / places * std::cos(angle) + half_y * (j + 0.5) / places * std::sin(angle);
        double const phase = wavenumber * slope * setup.medium.thickness / 2;
        double const sinc = std::abs(phase) < 1e-6 ? 1 : std::sin(phase) / phase;
        sum += sinc * sinc;
      }
    }
  }
  return sum / (places * places * directions);
}

/// e^(-2 pi i n / count)
std::vector<std::complex<double>> roots_of_unity(int count) {
  std::vector<std::complex<double>> roots;
  for (int n = 0; n < count; ++n) roots.push_back(std::polar(1.0, -2 * pi * n / count));
  return roots;
}

/// Sum of values[i] e^(-2 pi i n mode / count), n = 0 ... count - 1.
template <class Value>
std::complex<double> fourier_sum(Value const* values, int count, int mode,
                                 std::vector<std::complex<double>> const& roots) {
  double real = 0, imaginary = 0;
  for (int n = 0, turn = 0; n < count; ++n) {
    std::complex<double> const value = values[n], root = roots[static_cast<std::size_t>(turn)];
    real += value.real() * root.real() - value.imag() * root.imag();
    imaginary += value.real() * root.imag() + value.imag() * root.real();
    turn += mode;
    if (turn >= count) turn -= count;
  }
  return {real, imaginary};
}

}  // namespace

double cone_transfer(Setup const& setup, double wavelength) {
  return density::cone_transfer(setup.imaging().entrance_pupil, setup.z_b(), setup.z_d, setup.medium.thickness,
                                wavelength);
}

double cone_width(Setup const& setup) { return setup.imaging().entrance_pupil * setup.z_d / setup.z_b(); }

double GradientSpectrum::structure_size() const {
  double sum = 0, second = 0;
  for (std::size_t i = 0; i < energy.size(); ++i) {
    sum += energy[i];
    second += energy[i] * wavenumber[i] * wavenumber[i];
  }
  return 2 * pi * std::sqrt(sum / second);
}

GradientSpectrum gradient_spectrum(Image<double> const& plane) {
  GLADSTONE_EXPECTS(!plane.empty());
  int const columns = plane.columns(), rows = plane.rows(), half = columns / 2 + 1;
  auto const along_x = roots_of_unity(columns), along_y = roots_of_unity(rows);
  // Transform along x, for half of the wavenumbers since the plane is real, then along y.
  Image<std::complex<double>> partial(rows, half);
  parallel_for(static_cast<std::size_t>(rows), [&](std::size_t line) {
    int const row = static_cast<int>(line);
    for (int m = 0; m < half; ++m) {
      partial(row, m) = fourier_sum(&plane(0, row), columns, m, along_x);
    }
  });
  Image<double> power(half, rows);
  parallel_for(static_cast<std::size_t>(half), [&](std::size_t line) {
    int const m = static_cast<int>(line);
    for (int n = 0; n < rows; ++n) power(m, n) = std::norm(fourier_sum(&partial(0, m), rows, n, along_y));
  });

  double const shell = 2 * pi / std::max(columns, rows);
  GradientSpectrum spectrum;
  for (int n = 0; n < rows; ++n) {
    for (int m = 0; m < half; ++m) {
      double const kx = 2 * pi * m / columns, ky = 2 * pi * std::min(n, rows - n) / rows, k = std::hypot(kx, ky);
      if (k == 0) continue;
      auto const index = static_cast<std::size_t>(k / shell);
      if (index >= spectrum.energy.size()) {
        spectrum.energy.resize(index + 1);
        spectrum.wavenumber.resize(index + 1);
      }
      double const both_signs = m == 0 || 2 * m == columns ? 1 : 2;
      double const energy = both_signs * k * k * power(m, n);
      spectrum.energy[index] += energy;
      spectrum.wavenumber[index] += k * energy;
    }
  }
  for (std::size_t i = 0; i < spectrum.energy.size(); ++i) {
    spectrum.wavenumber[i] = spectrum.energy[i] > 0 ? spectrum.wavenumber[i] / spectrum.energy[i] : shell * (i + 0.5);
  }
  return spectrum;
}

Agreement predicted_agreement(GradientSpectrum const& spectrum, double spacing, Setup const& setup) {
  double const dot = setup.dot_diameter() * setup.z_a / setup.z_b();
  double eq9 = 0, both = 0, rays = 0;
  for (std::size_t i = 0; i < spectrum.energy.size(); ++i) {
    double const wavenumber = spectrum.wavenumber[i] / spacing, wavelength = 2 * pi / wavenumber;
    double const energy = spectrum.energy[i] * chief_ray_energy(setup, wavenumber);
    double const transfer = cone_transfer(setup, wavelength) * disc_transfer(dot, wavelength);
    eq9 += energy;
    both += energy * transfer;
    rays += energy * transfer * transfer;
  }
  return {both / std::sqrt(eq9 * rays), std::sqrt(rays / eq9)};
}

}  // namespace gladstone::inline compare
