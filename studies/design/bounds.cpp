#include "studies/design/bounds.h"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>

#include "render/base/contracts.h"
#include "render/base/units.h"
#include "studies/design/simulation.h"

namespace gladstone::inline design {
namespace {

using unit::mm;
using Extreme = Bound::Extreme;

constexpr double clearance = 1.02;  ///< minimum distance of dots and lens from the mid-plane of the medium, in half
                                    ///< thicknesses
/// Maximum fraction of the target covered by dots; random discs without overlap reach 0.5.
constexpr double most_coverage = 0.45;

template <class T>
T logarithm(T const& ratio) {
  using std::log;
  return log(ratio);
}

/// Returns the smallest detectable gradient, at two standard deviations, from the simulated random error and
/// magnification.
Estimate gradient_seen(SimulatedDesign const& simulated, DesignPoint<double> const& bench) {
  double const per_px = 2 / (bench.sensitivity() * simulated.magnification / bench.magnification());
  return {simulated.random_px.value * per_px, simulated.random_px.standard_error * per_px};
}

/// Returns the prediction and the simulation of a number of pixels in the medium.
std::pair<double, Estimate> view_size(SimulatedDesign const& simulated, DesignPoint<double> const& bench, int pixels) {
  double const at_medium = simulated.magnification * bench.z_b() / bench.z_a;
  return {pixels * bench.pixel_at_medium(), Estimate{pixels * bench.given->camera.pixel_pitch / at_medium, 0}};
}

/// Table of the requirements, in the order of the output.
constexpr std::array requirement_rows{
    Bound{.name = "requirements.gradient_min_kg_m4",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            return logarithm(T(b.smallest_gradient() / limit));
          },
          .simulated =
              [](SimulatedDesign const& simulated, DesignPoint<double> const& b) {
                return std::pair{b.smallest_gradient(), gradient_seen(simulated, b)};
              }},
    Bound{
        .name = "requirements.resolution_mm",
        .unit = mm,
        .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
          return transfer_at_resolution - b.transfer(T(limit));
        },
        .simulated =
            [](SimulatedDesign const& simulated, DesignPoint<double> const& b) {
              return std::pair{resolved_wavelength(b), simulated.resolution};
            },
        .violation =
            [](double excess) {
              return fmt::format(
                  "does not meet requirements.resolution_mm: the chain transmits {:.3f} of that wavelength instead of "
                  "{:.3f}",
                  transfer_at_resolution - excess, transfer_at_resolution);
            }},
    Bound{.name = "requirements.displacement_max_px",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            if (b.given->largest_gradient == 0) return T(-1);  // no displacement
            return logarithm(T(b.largest_displacement_px() / limit));
          },
          .simulated =
              [](SimulatedDesign const& simulated, DesignPoint<double> const& b) {
                return std::pair{b.largest_displacement_px(), Estimate{simulated.displacement_px, 0}};
              }},
    Bound{.name = "requirements.uncertainty_max_px",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            return logarithm(T(b.random_error() / limit));
          },
          .simulated =
              [](SimulatedDesign const& simulated, DesignPoint<double> const& b) {
                return std::pair{b.random_error(), simulated.random_px};
              }},
    Bound{.name = "requirements.field_of_view_mm[0]",
          .unit = mm,
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            return logarithm(T(limit / (double(b.given->camera.columns) * b.pixel_at_medium())));
          },
          .from_below = true,
          .extreme = Extreme::far,
          .simulated = [](SimulatedDesign const& simulated,
                          DesignPoint<double> const& b) { return view_size(simulated, b, b.given->camera.columns); }},
    Bound{.name = "requirements.field_of_view_mm[1]",
          .unit = mm,
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            return logarithm(T(limit / (double(b.given->camera.rows) * b.pixel_at_medium())));
          },
          .from_below = true,
          .extreme = Extreme::far,
          .simulated = [](SimulatedDesign const& simulated,
                          DesignPoint<double> const& b) { return view_size(simulated, b, b.given->camera.rows); }},
    Bound{.name = "limits.z_total_max_mm",
          .unit = mm,
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T { return logarithm(T(b.z_b() / limit)); },
          .extreme = Extreme::near},
};

double percent(double excess) { return 100 * std::expm1(excess); }

/// Table of the bounds of every set-up besides `in_focus` and `below_full_well`.
constexpr std::array feasibility_rows{
    Bound{.name = "dots outside the medium",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T { return logarithm(T(limit / b.z_d)); },
          .extreme = Extreme::far,
          .violation = [](double) -> std::string { return "the dots are inside the medium"; },
          .given = [](FixedDesignParameters const& given) { return clearance * given.thickness / 2; }},
    Bound{.name = "lens outside the medium",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T { return logarithm(T(limit / b.z_a)); },
          .extreme = Extreme::far,
          .violation = [](double) -> std::string { return "the lens is inside the medium"; },
          .given = [](FixedDesignParameters const& given) { return clearance * given.thickness / 2; }},
    Bound{.name = "smallest dot images for which the random error is known",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            return logarithm(T(limit / b.geometric_dot_px()));
          },
          .violation =
              [](double excess) {
                return fmt::format(
                    "the dot images are too small: the random error is known from {:.3g} px on, {:.3g} % "
                    "more",
                    random_error_range.least_dot, percent(excess));
              },
          .given = [](FixedDesignParameters const&) { return random_error_range.least_dot; }},
    Bound{.name = "largest dot images for which the random error is known",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            return logarithm(T(b.dot_image_px() / limit));
          },
          .violation =
              [](double excess) {
                return fmt::format(
                    "the dot images are {:.3g} % larger than {:.3g} px, up to which the random error is "
                    "known",
                    percent(excess), random_error_range.most_image);
              },
          .given = [](FixedDesignParameters const&) { return random_error_range.most_image; }},
    Bound{.name = "space between the dots",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
            return logarithm(T(b.coverage() / limit));
          },
          .violation =
              [](double excess) {
                return fmt::format(
                    "the dots are too close to each other: they cover {:.3g} % more than the possible "
                    "{:.3g} % of the target",
                    percent(excess), 100 * most_coverage);
              },
          .given = [](FixedDesignParameters const&) { return most_coverage; }},
    Bound{.name = "largest image noise for which the random error is known",
          .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T { return logarithm(T(b.noise() / limit)); },
          .violation =
              [](double excess) {
                return fmt::format(
                    "too little light: the image noise is {:.3g} % above {:.3g} % of the peak, up to which "
                    "the random error is known",
                    percent(excess), 100 * random_error_range.most_noise);
              },
          .given = [](FixedDesignParameters const&) { return random_error_range.most_noise; }},
};

}  // namespace

constexpr Bound in_focus{
    .name = "focus on the dots",
    .excess = []<class T>(double, DesignPoint<T> const& b) -> T {
      return logarithm(T(closest_focus / (b.z_b() / b.focal_length)));
    },
    .extreme = Extreme::far,
    .violation = [](double) -> std::string { return "the dots are too close to the lens to be focused"; }};

constexpr Bound below_full_well{
    .name = "peaks below the full well",
    .excess = []<class T>(double limit, DesignPoint<T> const& b) -> T {
      return logarithm(T(b.peak_electrons() / limit));
    },
    .violation =
        [](double excess) {
          return fmt::format("too much light: the peaks exceed the full well by {:.3g} %", percent(excess));
        },
    .given = [](FixedDesignParameters const& given) { return given.camera.noise.full_well_e; }};

std::string Bound::table() const { return std::string(name, std::string_view(name).find('.')); }

std::string Bound::key() const {
  std::string_view const path = name;
  std::size_t const dot = path.find('.');
  return std::string(path.substr(dot + 1, path.find('[') - dot - 1));
}

int Bound::component() const {
  std::size_t const bracket = std::string_view(name).find('[');
  return bracket == std::string_view::npos ? -1 : name[bracket + 1] - '0';
}

std::span<Bound const> requirements() { return requirement_rows; }

Bound const& requirement(std::string_view name) {
  auto const found = std::find_if(requirement_rows.begin(), requirement_rows.end(),
                                  [name](Bound const& row) { return row.name == name; });
  GLADSTONE_EXPECTS(found != requirement_rows.end());
  return *found;
}

std::string describe_violation(Bound const& bound, double excess) {
  if (bound.violation) return bound.violation(excess);
  return fmt::format("does not meet {}: {:.3g} % too {}", bound.name, percent(excess),
                     bound.from_below ? "small" : "large");
}

std::vector<Limit> feasibility_limits(FixedDesignParameters const& given) {
  std::vector<Limit> limits{{&in_focus, 0}};
  for (Bound const& bound : feasibility_rows) limits.push_back({&bound, bound.given(given)});
  if (given.light || given.camera.exposure_e) {
    limits.push_back({&below_full_well, below_full_well.given(given)});
  }
  return limits;
}

}  // namespace gladstone::inline design
