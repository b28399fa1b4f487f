#include "render/light/mie_scattering.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

#include "render/base/available_memory.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/light/mie.h"

namespace gladstone::inline light {
namespace {

/// Node spacing of a table, as phase [rad] of the fastest significant ripple of |S|^2, cos(2 x theta). The error of a
/// cubic spline is then 0.5^4 / 384 = 1.6e-4 of the ripple's amplitude.
constexpr double node_phase = 0.5;

/// Number of iterations of spline_coefficients(), and of additional samples at each end.
constexpr int series_terms = 6;

/// Number of diameters per task.
constexpr std::size_t diameters_at_once = 16;

std::vector<double> distinct(std::vector<double> diameters) {
  std::sort(diameters.begin(), diameters.end());
  diameters.erase(std::unique(diameters.begin(), diameters.end()), diameters.end());
  return diameters;
}

double wave_number_in(MieSetting const& setting) { return 2 * pi * setting.surroundings / setting.wavelength; }

double size_parameter_of(double diameter, MieSetting const& setting) { return diameter / 2 * wave_number_in(setting); }

bool scatters(double size_parameter) { return size_parameter >= least_size_parameter; }

/// Returns the number of table cells for a sphere. For x < 1 the intensity varies as cos^2 theta for any size.
double cells_for(double size_parameter, AngleInterval angles) {
  if (!scatters(size_parameter)) return 1;
  return std::ceil((angles.most - angles.least) * 2 * (size_parameter + 1) / node_phase);
}

/// Returns the number of coefficients of a table with the given number of cells, for S1 and S2 together. A cubic spline
/// on c cells has c + 3 coefficients.
std::uint64_t coefficients_for(double cells) { return 2 * (static_cast<std::uint64_t>(cells) + 3); }

double bytes_of(std::vector<double> const& diameters, std::size_t particles, MieSetting const& setting,
                AngleInterval angles) {
  double bytes = static_cast<double>(particles * sizeof(std::uint32_t) + diameters.size() * sizeof(MieTable));
  for (double const diameter : diameters) {
    bytes += (cells_for(size_parameter_of(diameter, setting), angles) + 3) * 2 * sizeof(float);
  }
  return bytes;
}

/// Samples of |S1|^2 and |S2|^2 at `count` angles from `first` in steps of `step` [rad].
struct Intensities {
  std::vector<double> s1, s2;

  Intensities(MieCoefficients const& sphere, double first, double step, std::size_t count) : s1(count), s2(count) {
    std::vector<double> angle(count);
    for (std::size_t i = 0; i < count; ++i) angle[i] = first + step * static_cast<double>(i);
    std::vector<MieAmplitudes> amplitude(count);
    sphere.amplitudes(angle.data(), count, amplitude.data());
    for (std::size_t i = 0; i < count; ++i) {
      s1[i] = std::norm(amplitude[i].s1);
      s2[i] = std::norm(amplitude[i].s2);
    }
  }
};

/// Computes the coefficients c of the cubic B-spline through equidistant samples f. With the second difference d^2, f =
/// (1 + d^2/6) c, which is solved by iterating c = f - d^2 c / 6 (Unser, Aldroubi & Eden 1993). Each iteration
/// invalidates one more coefficient at each end.
std::vector<double> spline_coefficients(std::vector<double> const& f) {
  std::vector<double> c = f, last;
  for (std::size_t turn = 1; turn <= series_terms; ++turn) {
    last = c;
    for (std::size_t i = turn; i + turn < f.size(); ++i) {
      c[i] = f[i] - (last[i - 1] - 2 * last[i] + last[i + 1]) / 6;
    }
  }
  return c;
}

/// Computes the table of one sphere.
/// @return largest error midway between nodes, relative to the mean of |S1|^2 and |S2|^2
double fill_table(MieCoefficients const& sphere, AngleInterval angles, MieTable const& table, float* coefficient) {
  double const step = 1 / static_cast<double>(table.cells_per_radian);
  std::size_t const cells = table.cells, kept = cells + 3;
  Intensities const nodes(sphere, angles.least - (1 + series_terms) * step, step, kept + 2 * series_terms);
  auto const c1 = spline_coefficients(nodes.s1), c2 = spline_coefficients(nodes.s2);
  for (std::size_t i = 0; i < kept; ++i) {
    coefficient[2 * i] = static_cast<float>(c1[i + series_terms]);
    coefficient[2 * i + 1] = static_cast<float>(c2[i + series_terms]);
  }

  MieTable const alone{0, table.cells, table.cells_per_radian};
  std::uint32_t const only = 0;
  MieScatteringView<double> const view{&only, &alone, coefficient, angles.least, 1};
  Intensities const between(sphere, angles.least + step / 2, step, cells);
  double sum = 0, worst = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    double s1 = 0, s2 = 0;
    view.intensities(0, angles.least + step * (static_cast<double>(i) + 0.5), s1, s2);
    worst = std::max({worst, std::abs(s1 - between.s1[i]), std::abs(s2 - between.s2[i])});
    sum += (between.s1[i] + between.s2[i]) / 2;
  }
  return sum > 0 ? worst / (sum / static_cast<double>(cells)) : 0;
}

}  // namespace

double MieScattering::bytes_needed(std::vector<double> const& diameters, MieSetting const& setting,
                                   AngleInterval angles) {
  return bytes_of(distinct(diameters), diameters.size(), setting, angles);
}

MieScattering::MieScattering(std::vector<double> const& diameters, MieSetting const& setting, AngleInterval angles)
    : angles_(angles), wave_number_(wave_number_in(setting)) {
  GLADSTONE_EXPECTS(angles.least >= 0 && angles.least < angles.most && angles.most <= pi);
  std::vector<double> const sizes = distinct(diameters);
  if (sizes.empty()) return;
  GLADSTONE_EXPECTS(sizes.front() >= 0);

  constexpr double always_there = 64e6;  // [bytes], up to which tables are allocated without a check
  double const bytes = bytes_of(sizes, diameters.size(), setting, angles);
  double const available = available_memory();
  if (bytes > always_there && bytes > available) {
    throw DataError(
        ErrorCode::memory, KeyPath{"particles"},
        fmt::format(
            "the light scattered by {} different diameters of up to {:.4g} um needs a table of {:.3g} GB of memory "
            "({:.3g} GB are available); use fewer particles, fewer or smaller diameters, or scattering = \"lambert\"",
            sizes.size(), sizes.back() / unit::micrometre, bytes / 1e9, available / 1e9));
  }

  table_of_.resize(diameters.size());
  for (std::size_t i = 0; i < diameters.size(); ++i) {
    auto const place = std::lower_bound(sizes.begin(), sizes.end(), diameters[i]);
    table_of_[i] = static_cast<std::uint32_t>(place - sizes.begin());
  }
  std::uint64_t next = 0;
  tables_.reserve(sizes.size());
  for (double const size : sizes) {
    double const cells = cells_for(size_parameter_of(size, setting), angles);
    // round down, so that the last cell does not end before the interval
    float const density = std::nextafter(static_cast<float>(cells / (angles.most - angles.least)), 0.0f);
    tables_.push_back({next, static_cast<std::uint32_t>(cells), density});
    next += coefficients_for(cells);
  }
  coefficients_.resize(next);

  std::complex<double> const relative_index = setting.index / setting.surroundings;
  Progress progress("scattering", sizes.size());
  std::mutex mutex;
  parallel_chunks(sizes.size(), diameters_at_once, [&](std::size_t begin, std::size_t end) {
    double worst = 0;
    for (std::size_t i = begin; i < end; ++i) {
      double const x = size_parameter_of(sizes[i], setting);
      if (!scatters(x)) continue;
      MieTable const& table = tables_[i];
      worst =
          std::max(worst, fill_table(MieCoefficients(x, relative_index), angles, table, &coefficients_[table.first]));
    }
    progress.advance(end - begin);
    std::lock_guard const lock(mutex);
    error_ = std::max(error_, worst);
  });
}

}  // namespace gladstone::inline light
