#pragma once

#include <optional>
#include <vector>

#include "render/optics/aim_disc.h"
#include "render/optics/paraxial.h"
#include "render/scene/trace_ray.h"

namespace gladstone {

/// How paraxial light runs through a camera's lens, in air, along its axis.
struct ParaxialCamera {
  double front = 0;         ///< first surface, along the camera's z [m]
  RayTransfer to_stop;      ///< from there to the stop
  RayTransfer whole;        ///< from there to behind the last surface
  Pose<double> behind;      ///< of the last surface's vertex in the camera's frame; light leaves along its z, or back
  double forwards = 1;      ///< -1: it leaves along -z, after an odd number of mirrors
  double stop_radius = 0;   ///< [m]; 0: chief rays only
  double window_shift = 0;  ///< by which windows bring things nearer, sum of t (1 - 1/n) [m]

  /// Slope of the chief ray of a point on its way in, over the point's height. @param distance before the front [m]
  double chief_slope(double distance) const;
  /// Slope of the ray from a point of the axis to the stop's rim.
  double marginal_slope(double distance) const;
  /// The same behind the lens: half of one over the working f-number.
  double image_slope(double distance) const;
};

/// A point that a pixel sees.
struct SeenPoint {
  Vec2d place{};         ///< in the plane's frame [m]
  Ray<double> chief;     ///< from the point towards the camera, in the world
  Vec2d by_x{}, by_y{};  ///< derivatives of the pixel by the place along the plane's x and y [px/m]

  /// By how much the pixel changes where the place moves [px].
  Vec2d moved(Vec2d by) const { return by.x * by_x + by.y * by_y; }
};

/// The footprint of a source's rays that pass the stop on the aim plane, in the world.
struct WorldAimDisc {
  Vec3d centre{}, a{}, b{};  ///< centre + a cos + b sin [m]
};

/// A camera: where it stands, what its light meets on the way, its sensor. Rays are traced through it; nothing about it
/// is known as a magnification.
class Camera {
 public:
  Pose<double> pose;  ///< of the front principal plane (of the first vertex where there is none); z along the light
  std::vector<CameraElement<double>> elements;  ///< in the world, in the order light meets them
  int before_medium = 0;                        ///< of them, those on the target's side of the medium
  int stop = 0;                                 ///< of them
  double stop_radius = 0;                       ///< that rays meet [m]; 0: chief rays only
  double aim_step = 0;                          ///< differences on the aim plane are taken over [m]
  Pose<double> aim_plane;
  PosedSensor<double> sensor;
  ParaxialCamera paraxial;

  CameraView<double> view() const {
    return {elements.data(), before_medium, static_cast<int>(elements.size()), sensor, aim_plane};
  }
  bool chief_rays_only() const { return stop_radius == 0; }
  /// Gives the stop a smoothed rim, as a share of its area. A stop that is a surface of glass keeps its sharp one.
  void smooth_stop(double edge);

  /// Where the chief ray of a point ends without medium [px]; nothing where none gets through. Lenslets are looked
  /// past: the middle of the small pictures that they make of the point.
  std::optional<Vec2d> project(Vec3d point) const;
  /// The point of a plane (its frame's x and y) whose chief ray ends at a pixel.
  std::optional<SeenPoint> unproject(Vec2d pixel, Pose<double> const& plane) const;
  /// What the camera sees of a point of a plane: its chief ray, and how its pixel changes. place is in the plane's
  /// frame.
  std::optional<SeenPoint> see(Vec2d place, Pose<double> const& plane) const;
  /// What a source sees of the stop, a little wide: by this factor where nothing distorts it.
  static double sight_margin();
  std::optional<WorldAimDisc> aim_disc(Vec3d source) const;
  /// Where the paraxial chief ray of a point ends, without distortion: the camera as an ideal lens, a collinear map
  /// [px].
  Vec2d ideal_project(Vec3d point) const;

 private:
  /// What becomes of the ray from a point through a point of the aim plane, vignetted or not.
  struct Sight {
    Vec2d in_stop{}, pixel{};
  };
  std::optional<Sight> sight(Vec3d point, Vec2d aim) const;
  std::optional<Vec2d> in_stop(Vec3d point, Vec2d aim) const;
  /// What places in the stop are small or large beside [m].
  double in_stop_unit() const;
  StopSight stop_sight(Vec3d point) const;
  Vec2d paraxial_aim(Vec3d point) const;
  Ray<double> towards(Vec3d point, Vec2d aim) const;
  std::optional<Vec2d> chief_aim(Vec3d point) const;
  /// The point of a plane whose chief ray ends at a pixel, by Newton's method for place and aim together, which follows
  /// no chief ray on the way. @param place to start from
  std::optional<SeenPoint> find_place_and_aim(Vec2d pixel, Pose<double> const& plane, Vec2d place) const;
  /// The same by Newton's method for the place alone, with the chief ray of every place on the way: slower, and sure
  /// where a small change of the aim loses the ray, as in wide-angle lenses.
  std::optional<SeenPoint> find_place(Vec2d pixel, Pose<double> const& plane, Vec2d place) const;
  /// Derivatives of the pixel that the chief ray of a point of a plane ends at.
  bool differentiate(Vec2d aim, Pose<double> const& plane, SeenPoint& seen) const;
  double place_step(Pose<double> const& plane) const;
};

}  // namespace gladstone
