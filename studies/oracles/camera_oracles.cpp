#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/base/units.h"
#include "render/planning.h"
#include "render/render.h"
#include "render/scene/build_camera.h"
#include "render/scene/scene.h"
#include "render/sensor/diffraction_spot.h"
#include "studies/oracles/oracles.h"

namespace gladstone::inline oracles::oracle {
namespace {

/// Setup of Table 1 of Rajendran, Bane & Vlachos (2019), which is the default of all readers; dots are points.
Setup table_1() {
  Setup setup;
  setup.target.dot_diameter_px = 0;
  return setup;
}

/// Traces points on the target [m] with the given number of rays each.
GroundTruth truth_of(Setup const& setup, std::vector<Vec2d> const& points, std::uint64_t rays, Renderer& renderer) {
  Scene scene;
  scene.setup = setup;
  scene.imaging = setup.imaging();
  scene.camera = build_camera(setup);
  scene.dots.centre = points;
  scene.medium = build_medium(setup.medium);
  RenderPlan plan = plan_step(scene);
  plan.rays = rays;
  return render(scene, plan, renderer, RenderImages::no, RenderTheory::yes).truth;
}

/// Traces an axial point with 2^15 rays through a density wave along X with a peak gradient of 10 kg/m^4 on the axis.
GroundTruth behind_wave(double wavelength, Renderer& renderer) {
  Setup setup = table_1();
  setup.medium.field = Sinusoid<double>::wave(10 * wavelength / (2 * pi), wavelength);
  return truth_of(setup, {{0, 0}}, std::uint64_t{1} << 15, renderer);
}

double cone_average(double wavelength, Renderer& renderer) {
  GroundTruth const truth = behind_wave(wavelength, renderer);
  return truth.displacement_px[0].x / truth.eq9_px[0].x;
}

}  // namespace

double magnification(Renderer&) { return table_1().imaging().magnification; }
double image_distance_m(Renderer&) { return table_1().imaging().image_distance; }

double cone_diameter_m(Renderer&) {
  Setup const setup = table_1();
  return setup.imaging().entrance_pupil * setup.z_d / setup.z_b();
}

double spot_diameter_px(Renderer&) {
  Scene scene;
  scene.setup = table_1();
  scene.imaging = scene.setup.imaging();
  return SpotSize{scene.spot_scale_px()}.first_zero_diameter();
}

double spot_energy(Renderer&) {
  Scene scene;
  scene.setup = table_1();
  scene.imaging = scene.setup.imaging();
  GaussianSpot<double> const spot{scene.spot_sigma_px()};
  Vec2d const at{20.3, 11.8};
  Footprint const footprint = spot.footprint(at);
  double columns[GaussianSpot<double>::most_width], rows[GaussianSpot<double>::most_width];
  spot.shares(at.x, footprint.column, footprint.width, columns);
  spot.shares(at.y, footprint.row, footprint.width, rows);
  double energy = 0;
  for (int i = 0; i < footprint.width * footprint.width; ++i) {
    energy += columns[i % footprint.width] * rows[i / footprint.width];
  }
  return energy;
}

double off_axis_column_px(Renderer& renderer) {
  return truth_of(table_1(), {{0.01, 0}}, 4096, renderer).reference_px[0].x;
}

double uniform_density_px(Renderer& renderer) {
  Setup setup = table_1();
  setup.medium.field = UniformGradient<double>{};
  GroundTruth const truth = truth_of(setup, {{0, 0}, {0.01, -0.02}, {-0.015, 0.003}}, 256, renderer);
  double largest = 0;
  for (Vec2d d : truth.displacement_px) {
    if (!(length(d) < 1)) return std::numeric_limits<double>::quiet_NaN();
    largest = std::max(largest, length(d));
  }
  return largest;
}

double sensitivity_px(Renderer& renderer) {
  Setup setup = table_1();
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  setup.medium.field = UniformGradient<double>{{}, {10, 0, 0}};
  return -truth_of(setup, {{0, 0}}, 1, renderer).displacement_px[0].x / 10;
}

double cone_average_4mm(Renderer& renderer) { return cone_average(4e-3, renderer); }
double cone_average_8mm(Renderer& renderer) { return cone_average(8e-3, renderer); }

double ray_spread_8mm(Renderer& renderer) {
  GroundTruth const truth = behind_wave(8e-3, renderer);
  return truth.displacement_std_px[0].x / std::abs(truth.eq9_px[0].x);
}

}  // namespace gladstone::inline oracles::oracle
