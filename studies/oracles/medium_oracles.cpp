#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/medium/field_volume.h"
#include "render/medium/gladstone_dale.h"
#include "render/medium/trace_medium.h"
#include "studies/oracles/oracle_media.h"
#include "studies/oracles/oracles.h"

namespace gladstone::inline oracles::oracle {
namespace {

/// Integrates a ray by Sharma's scheme over the parameter t, with its optical path.
struct Walk {
  RayState<double> end;
  double optical_path = 0;
};
template <class Medium>
Walk walk(Medium const& medium, RayState<double> ray, double t, int steps) {
  Walk way{ray};
  for (int i = 0; i < steps; ++i) {
    way.optical_path +=
        step_increment(medium, Integrator::rk4, way.end.position, way.end.optical_direction, t / steps).optical_path;
    way.end = advance(medium, way.end, t / steps);
  }
  return way;
}

/// Launches a ray in the x-z plane at `angle` from the z axis [rad].
template <class Medium>
RayState<double> launch(Medium const& medium, Vec3d at, double angle) {
  double const n = 1 + medium.sample(at).refractivity;
  return {at, {n * std::sin(angle), 0, n * std::cos(angle)}};
}

Walk through_luneburg(double height) {
  return walk(LuneburgSphere{}, {{height, 0, -std::sqrt(1 - height * height)}, {0, 0, 1}}, pi / 2, 1000);
}

double rod_error(double step) {
  Ray<double> const start{{1, 0, 0}, {0, 0, 1}};
  auto const way =
      trace_medium(ParabolicRod{}, TracingOptions<double>{step, 0, Integrator::rk4, Faces::matched}, start);
  return exit_position(start, way).x - -0.425287303350492;
}

MediumSetup setup_of(FieldSetup const& field, double thickness = 0.01) {
  MediumSetup setup;
  setup.field = field;
  setup.thickness = thickness;
  return setup;
}

/// Traces a ray through a setup's field.
MediumPassage<double> trace(MediumSetup const& setup, double step, Ray<double> const& start) {
  TracingOptions<double> const options{step, setup.ambient_refractivity(), setup.integrator, setup.faces};
  BuiltMedium const built = build_medium(setup);
  return std::visit([&](auto const& medium) { return trace_medium(medium, options, start); }, built.view);
}

Ray<double> axial_ray(double x) { return {{x, 0, -0.25}, {0, 0, 1}}; }

double slope_behind(MediumSetup const& setup, double step, double x) {
  Ray<double> const start = axial_ray(x);
  Vec3d const d = exit_direction(start, trace(setup, step, start));
  return d.x / d.z;
}

double slab_displacement(double gradient, Faces faces) {
  MediumSetup setup = setup_of(UniformGradient<double>{{}, {gradient, 0, 0}});
  setup.faces = faces;
  Ray<double> const start = axial_ray(0);
  return apparent_ray(start, trace(setup, 1e-3, start)).position.x;
}

/// Skew ray through the rod [mm], and its tracing options.
Ray<double> skew_ray() { return {{0.7, -0.4, -2}, normalized(Vec3d{0.03, 0.05, 1})}; }
constexpr TracingOptions<double> fine{0.01, 0, Integrator::rk4, Faces::refract};

}  // namespace

double linear_index_x(Renderer&) {
  LinearSquaredIndex const medium;
  return advance(medium, launch(medium, {}, 10 * unit::degree), 5.0).position.x;
}

double rod_position_mm(Renderer&) { return rod_error(0.02) + -0.425287303350492; }
double rod_error_ratio(Renderer&) { return rod_error(1) / rod_error(0.5); }

double luneburg_focus(Renderer&) {
  double farthest = 0;
  for (double height : {0.1, 0.25, 0.5, 0.8}) {
    farthest = std::max(farthest, length(through_luneburg(height).end.position - Vec3d{0, 0, 1}));
  }
  return farthest;
}

double luneburg_optical_path(Renderer&) {
  double const height = 0.5;
  return 1 - std::sqrt(1 - height * height) + through_luneburg(height).optical_path;
}

double fish_eye_miss(Renderer&) {
  FishEye const eye;
  double const t = 8 * pi / 3 - 4 * std::sqrt(3.0);  // parameter of the circle that starts at 30 degrees
  return length(walk(eye, launch(eye, {0, 0, -1}, 30 * unit::degree), t, 4000).end.position - Vec3d{0, 0, 1});
}

double slab_matched_m(Renderer&) { return slab_displacement(10, Faces::matched); }
double slab_refracting_m(Renderer&) { return slab_displacement(10, Faces::refract); }
double steep_slab_refracting_m(Renderer&) { return slab_displacement(1000, Faces::refract); }

double eikonal_drift(Renderer&) {
  ParabolicRod const rod;
  Ray<double> const skew = skew_ray();
  MediumPassage<double> const way =
      trace_medium(rod, TracingOptions<double>{0.1, 0, Integrator::rk4, Faces::matched}, skew);
  return std::abs(length(way.straight + way.turn) - std::sqrt(rod.squared_index(exit_position(skew, way))));
}

double reversal_miss_mm(Renderer&) {
  ParabolicRod const rod;
  Ray<double> const skew = skew_ray();
  MediumPassage<double> const out = trace_medium(rod, fine, skew);
  Vec3d const d = exit_direction(skew, out);
  Ray<double> const back{exit_position(skew, out) + d * 3.0, -d};
  MediumPassage<double> const home = trace_medium(rod, fine, back);
  Vec3d const p = exit_position(back, home), e = exit_direction(back, home);
  return length(p + e * dot(skew.position - p, e) - skew.position);
}

double spline_polynomial_error(Renderer&) {
  auto const f = [](double x) { return ((x - 2) * x - 3) * x + 1; };
  auto const slope = [](double x) { return (3 * x - 4) * x - 3; };
  RegularGrid grid;
  grid.nodes = {7, 7, 1};
  using Plane = RefractiveIndexVolume<double>;
  Plane const plane(grid, Plane::Interpolation::cubic_bspline, 1, 0, [&](int, int, std::span<double> out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      std::size_t const column = i % 7, row = i / 7;
      // whole numbers are exact in float
      out[i] = static_cast<float>(f(static_cast<double>(column)) * f(static_cast<double>(row)));
    }
  });
  auto const view = plane.view<double, CubicBspline, 2>(-1, 1);
  double worst = 0;
  for (double x = 0; x <= 6; x += 0.25) {
    for (double y = 0; y <= 6; y += 0.25) {
      IndexSample<double> const at = view.sample({x, y, 0});
      worst = std::max({worst, std::abs(at.refractivity - f(x) * f(y)), std::abs(at.gradient.x - slope(x) * f(y)),
                        std::abs(at.gradient.y - f(x) * slope(y))});
    }
  }
  return worst / (f(6) * f(6));
}

double plume_deflection(Renderer&) {
  double const a = 5e-3;
  MediumSetup const setup = setup_of(GaussianPlume<double>{{{}, 1e-3, a}}, 12 * a);
  double const dn = setup.gladstone_dale * 1e-3 / (1 + setup.ambient_refractivity());
  return -slope_behind(setup, a / 20, a / std::sqrt(2.0)) / dn;
}

double tilted_shock_slope(Renderer&) {
  MediumSetup const setup = setup_of(NormalShock<double>::front(2, 0.5, 1e-3, 30 * unit::degree), 0.02);
  double const incidence = 60 * unit::degree;
  double const n1 = 1 + setup.gladstone_dale * 0.5, n2 = 1 + setup.gladstone_dale * 0.5 * 8 / 3;
  double const snell = std::tan(incidence - std::asin(n1 / n2 * std::sin(incidence)));
  return slope_behind(setup, 2.5e-5, 0) / snell;
}

double shock_ratio_mach_2(Renderer&) { return shock_density_ratio(2, constant::gamma_air); }
double ciddor_532(Renderer&) { return gladstone_dale_ciddor(532e-9); }
double merzkirch_532(Renderer&) { return gladstone_dale_merzkirch(532e-9); }

}  // namespace gladstone::inline oracles::oracle
