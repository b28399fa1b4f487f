#include "render/scene/best_focus.h"

#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <cmath>
#include <vector>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/ray_bundle.h"
#include "render/scene/build_camera.h"

namespace gladstone::inline scene {
namespace {

constexpr int bundle_rays = 500;

/// Returns the aim points of rays from a point that reach the sensor, relative to the aim plane's origin [m].
std::vector<Vec3d> aims_of_bundle(Camera const& camera, Vec3d point) {
  auto const disc = camera.apparent_pupil(point);
  std::vector<Vec3d> aims;
  for (int k = 0; disc && k < bundle_rays; ++k) {
    Vec2d const at = sunflower(k, bundle_rays);
    Vec3d const aim = disc->centre + at.x * disc->a + at.y * disc->b;
    Ray<double> ray{point, normalized(aim - point)};
    RayAccount<double> account;
    CameraView<double> const view = camera.view();
    if (carry(view, 0, view.count, ray, account) == RayStatus::alive) aims.push_back(aim - camera.aim_plane.origin);
  }
  if (aims.size() < 10) {
    throw DataError(ErrorCode::invalid_value, KeyPath{"lens"},
                    "no light from the plane in focus passes it (too few axial rays reach the sensor); check "
                    "lens.focus, geometry and lens.f_number");
  }
  return aims;
}

/// Returns the best focus of the rays from a point, for a camera whose lens is moved along its axis [m]. The focus is
/// measured from the sensor's plane, which moves with the lens; elements ahead of the lens do not move.
/// @param moved  displacement of the lens [m]
template <class T>
T narrowest(Camera const& camera, std::vector<Vec3d> const& aims, Vec3<T> const& point, T const& moved) {
  Vec3<T> const by = moved * in_scalar<T>(camera.pose.z);
  std::vector<CameraElement<T>> elements;
  for (auto const& element : camera.elements) {
    elements.push_back(in_scalar<T>(element));
    if (static_cast<int>(elements.size()) <= camera.before_lens) continue;
    elements.back() = elements.back().visit([&](auto held) -> CameraElement<T> {
      held.pose.origin = held.pose.origin + by;
      return held;
    });
  }
  PosedSensor<T> sensor = camera.sensor.in_scalar<T>();
  sensor.pose.origin = sensor.pose.origin + by;
  Pose<T> aim_plane = in_scalar<T>(camera.aim_plane);
  aim_plane.origin = aim_plane.origin + by;
  CameraView<T> const view{elements.data(), camera.before_medium, static_cast<int>(elements.size()), sensor, aim_plane};
  std::vector<Vec2<T>> places, slopes;
  for (Vec3d const& aim : aims) {
    Ray<T> ray{point, normalized(aim_plane.origin + in_scalar<T>(aim) - point)};
    RayAccount<T> account;
    carry(view, 0, view.count, ray, account);
    Ray<T> const local = sensor.pose.inwards(ray);
    Vec2<T> const s{local.direction.x / local.direction.z, local.direction.y / local.direction.z};
    places.push_back({local.position.x - s.x * local.position.z, local.position.y - s.y * local.position.z});
    slopes.push_back(s);
  }
  return compute_bundle_spot(places, slopes).best_focus;
}

/// Residual for the solver: distance of the best focus from the fixed sensor, for a lens moved along its axis.
struct FocusMiss {
  Camera const& camera;
  std::vector<Vec3d> const& aims;
  Vec3d point;
  bool point_moves;  ///< true: the point moves with the lens
  double z_sensor;   ///< position of the fixed sensor [m]

  template <class T>
  bool operator()(T const* moved_mm, T* miss_mm) const {
    T const moved = moved_mm[0] * T(unit::millimetre);
    Vec3<T> seen = in_scalar<T>(point);
    if (point_moves) seen = seen + moved * in_scalar<T>(camera.pose.z);
    T const focus =
        T(camera.sensor.pose.origin.z) + moved + T(camera.sensor.pose.z.z) * narrowest(camera, aims, seen, moved);
    miss_mm[0] = (focus - T(z_sensor)) / T(unit::millimetre);
    return true;
  }
};

/// Returns the position of the lens in the paraxial approximation: Z of the front principal plane [m].
double paraxial_place(Setup const& setup) {
  double const f = setup.lens.focal_length, z_sensor = *setup.z_sensor;
  // apparent shift of objects by optical windows ahead of the lens [m]
  double const shift = paraxial_camera(setup).window_shift;
  double apart = 0;  // distance from the front to the rear principal plane [m]
  if (setup.lens.prescription) {
    Lens const& lens = *setup.lens.prescription;
    ParaxialLens const paraxial = paraxial_lens(lens);
    apart = lens.poses.back().origin.z + paraxial.rear_principal_plane - paraxial.front_principal_plane;
  }
  apart += setup.element_shift(ElementSide::sensor);  // plates behind the lens shift the image
  if (setup.lens.focus == Focus::distance) {
    double const u = setup.focus_distance() - shift;
    return z_sensor - apart - 1 / (1 / f - 1 / u);
  }
  // Given u + v, solve 1/u + 1/v = 1/f for the smaller v.
  double const sum = z_sensor + (setup.lens.focus == Focus::target ? setup.z_d : 0.0) - apart - shift;
  double const square = sum * sum - 4 * sum * f;
  if (!(square > 0)) {
    throw DataError(ErrorCode::invalid_value, KeyPath{"geometry.z_sensor_mm"},
                    "is too close to the plane in focus (an image requires a distance of at least four focal lengths); "
                    "move the sensor away, or use a shorter focal length");
  }
  return z_sensor - apart - (sum - std::sqrt(square)) / 2;
}

}  // namespace

double best_focus(Camera const& camera, Vec3d point) {
  return narrowest(camera, aims_of_bundle(camera, point), point, 0.0);
}

void position_lens_from_sensor(Setup& setup) {
  setup.z_a = paraxial_place(setup);
  if (!(setup.z_a > 0) || !std::isfinite(setup.z_a)) {
    throw DataError(ErrorCode::invalid_value, KeyPath{"geometry.z_sensor_mm"},
                    "leaves no room for the lens in front of the medium's mid-plane; move the sensor away from it");
  }
  bool const chief = std::isinf(setup.lens.f_number);
  if (chief || (!setup.lens.prescription && !setup.has_refracting_elements())) return;
  // The second pass aims the rays from the final position of the lens.
  for (int pass = 0; pass < 2; ++pass) {
    Camera const camera = build_camera(setup);
    Vec3d const point = camera.pose.origin - setup.focus_distance() * camera.pose.z;
    std::vector<Vec3d> const aims = aims_of_bundle(camera, point);
    FocusMiss const miss{camera, aims, point, setup.lens.focus == Focus::distance, *setup.z_sensor};
    using Function = ceres::TinySolverAutoDiffFunction<FocusMiss, 1, 1>;
    ceres::TinySolver<Function> solver;
    solver.options.max_num_iterations = 30;
    solver.options.gradient_tolerance = solver.options.function_tolerance = 0;
    solver.options.parameter_tolerance = 1e-14;
    solver.options.cost_threshold = 1e-24;  // [mm^2]
    Eigen::Matrix<double, 1, 1> moved = Eigen::Matrix<double, 1, 1>::Zero();
    auto const& summary = solver.Solve(Function(miss), &moved);
    constexpr double near_enough = 1e-7;  // tolerance of the focus [mm]
    if (!(std::sqrt(2 * summary.final_cost) < near_enough)) {
      throw DataError(ErrorCode::invalid_value, KeyPath{"geometry.z_sensor_mm"},
                      "receives no sharp image of the plane in focus at any position of the lens; check lens.focus");
    }
    setup.z_a += moved[0] * unit::millimetre;
  }
}

}  // namespace gladstone::inline scene
