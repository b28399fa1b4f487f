#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/optics/apparent_pupil.h"
#include "render/optics/paraxial.h"
#include "render/scene/trace_ray.h"

namespace gladstone::inline scene {

/// Paraxial model of a camera's lens: ray transfer in air along its axis.
struct ParaxialCamera {
  double front = 0;         ///< position of the first surface along the camera's z [m]
  RayTransfer to_stop;      ///< ray transfer from the first surface to the stop
  RayTransfer whole;        ///< ray transfer from the first surface to behind the last
  Pose<double> behind;      ///< pose of the last vertex in the camera's frame, as it appears from the sensor through
                            ///< plates; light leaves along its +z or -z
  double forwards = 1;      ///< 1: light leaves along +z; -1: along -z, after an odd number of mirrors
  double stop_radius = 0;   ///< radius of the stop [m]; 0: chief rays only
  double window_shift = 0;  ///< apparent shift of objects towards the lens by plates, sum of t (1 - 1/n) [m]

  /// Returns the slope of the chief ray of a point in object space per unit height of the point [1/m].
  /// @param distance  distance of the point in front of the first surface [m]
  double chief_slope(double distance) const;
  /// Returns the slope in object space of the marginal ray from an axial point to the edge of the stop [1].
  double marginal_slope(double distance) const;
  /// Returns the slope of the marginal ray in image space, 1 / (2 N_w) with the working f-number N_w [1].
  double image_slope(double distance) const;
};

/// Object point whose chief ray meets a pixel.
struct ImagedPoint {
  Vec2d place{};         ///< position in the frame of the object plane [m]
  Ray<double> chief;     ///< chief ray from the point towards the camera, in the world frame
  Vec2d by_x{}, by_y{};  ///< derivatives of the pixel position by the point's x and y in the plane [px/m]

  /// Returns the displacement of the pixel for a small displacement of the point in the plane [px].
  Vec2d moved(Vec2d by) const { return by.x * by_x + by.y * by_y; }
};

/// Entrance pupil as seen from a source: ellipse on the aim plane, in the world frame, that contains all rays passing
/// the stop.
struct WorldApparentPupil {
  Vec3d centre{}, a{}, b{};  ///< centre + a cos + b sin [m]
};

/// Camera for ray tracing: its pose, the optical elements on the light path and its sensor. No quantity is derived from
/// a magnification.
class Camera {
 public:
  Pose<double> pose;  ///< pose of the front principal plane (first vertex if it has none); z along the light
  std::vector<CameraElement<double>> elements;  ///< elements in the world frame, in the order of the light path
  std::vector<std::string> names;               ///< names of the elements in reports of lost rays
  int before_medium = 0;                        ///< number of elements on the target's side of the medium
  int before_lens = 0;                          ///< number of elements ahead of the lens
  int stop = 0;                                 ///< index of the stop in `elements`
  double stop_radius = 0;                       ///< radius of the stop [m]; 0: chief rays only
  double aim_step = 0;                          ///< step of finite differences on the aim plane [m]
  Pose<double> aim_plane;
  PosedSensor<double> sensor;
  ParaxialCamera paraxial;

  CameraView<double> view() const {
    return {elements.data(), before_medium, static_cast<int>(elements.size()), sensor, aim_plane};
  }
  /// Appends an element behind the others. @param name  its name in reports of lost rays
  void append(CameraElement<double> const& element, std::string name) {
    elements.push_back(element);
    names.push_back(std::move(name));
  }
  bool chief_rays_only() const { return stop_radius == 0; }
  /// Smooths the edge of the stop. Has no effect on a stop that is a glass surface or mirror, whose edge remains sharp.
  /// @param edge  width of the smoothed zone as a fraction of the stop's area [1]
  void smooth_stop(double edge);

  /// Returns the pixel position of a point's chief ray without medium [px]; nullopt if no chief ray reaches the sensor.
  /// Elements that divide the light among many images (lenslets) are ignored: the result is the centre of the images
  /// that they form of the point.
  std::optional<Vec2d> project(Vec3d point) const;
  /// Finds the point of a plane whose chief ray meets a pixel; nullopt if there is none.
  std::optional<ImagedPoint> unproject(Vec2d pixel, Pose<double> const& plane) const;
  /// Returns the chief ray of a point of a plane and the derivatives of its pixel position; nullopt if no chief ray
  /// passes.
  /// @param place  position in the plane's frame [m]
  std::optional<ImagedPoint> see(Vec2d place, Pose<double> const& plane) const;
  /// Returns the safety factor by which apparent_pupil() exceeds the entrance pupil of a lens without pupil aberrations
  /// [1].
  static double pupil_safety_factor();
  /// Returns the entrance pupil as seen from a source, enlarged by pupil_safety_factor(); without a stop, the point of
  /// the chief ray on the aim plane. nullopt if no chief ray passes.
  std::optional<WorldApparentPupil> apparent_pupil(Vec3d source) const;
  /// Returns the pixel position of a point's paraxial chief ray without distortion [px]: the camera as an ideal lens
  /// (collinear map).
  Vec2d ideal_project(Vec3d point) const;

 private:
  /// Intersections of a ray with the stop [m] and the sensor [px], whether or not it is vignetted.
  struct Sight {
    Vec2d in_stop{}, pixel{};
  };
  std::optional<Sight> sight(Vec3d point, Vec2d aim) const;
  std::optional<Vec2d> in_stop(Vec3d point, Vec2d aim) const;
  /// Returns the length by which positions in the stop are normalised: the stop's radius or, without a stop, 1e4 aim
  /// steps [m].
  double in_stop_unit() const;
  StopMapping stop_sight(Vec3d point) const;
  Vec2d paraxial_aim(Vec3d point) const;
  Ray<double> towards(Vec3d point, Vec2d aim) const;
  std::optional<Vec2d> chief_aim(Vec3d point) const;
  /// Finds the point of a plane whose chief ray meets a pixel by Newton's method in four unknowns (position in the
  /// plane, position on the aim plane). Solves for no chief ray in between.
  /// @param place  start value [m]
  std::optional<ImagedPoint> find_place_and_aim(Vec2d pixel, Pose<double> const& plane, Vec2d place) const;
  /// Like find_place_and_aim(), by damped Newton iterations over the position alone, with a chief ray found at each
  /// iterate. Slower, but robust in wide-angle lenses, where a small change of the aim point loses the ray.
  std::optional<ImagedPoint> find_place(Vec2d pixel, Pose<double> const& plane, Vec2d place) const;
  /// Computes the derivatives of the pixel position of the chief ray by the position of its object point. The chief ray
  /// continues to meet the same point of the stop.
  /// @param aim  point of the chief ray on the aim plane [m]
  /// @param seen  receives by_x and by_y at seen.place
  /// @return false if a neighbouring ray is lost
  bool differentiate(Vec2d aim, Pose<double> const& plane, ImagedPoint& seen) const;
  double place_step(Pose<double> const& plane) const;
};

}  // namespace gladstone::inline scene
