#include "render/optics/field_analysis.h"

#include <cmath>
#include <map>
#include <utility>

#include "render/base/interrupt.h"
#include "render/optics/ray_bundle.h"

namespace gladstone::inline optics {
namespace {

/// Image plane behind the last surface, perpendicular to its axis.
class ImagePlane {
 public:
  ImagePlane(Lens const& lens, double distance) : pose_(lens.poses.back().moved({0, 0, distance})) {}

  Ray<double> in_its_frame(Ray<double> const& ray) const { return pose_.inwards(ray); }
  static Vec2d meets(Ray<double> const& local, double z) {
    double const way = (z - local.position.z) / local.direction.z;
    return {local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
  }
  Vec3d outwards(Vec2d p) const { return pose_.point_to_outer({p.x, p.y, 0}); }

 private:
  Pose<double> pose_;
};

Vec2d slope(Ray<double> const& ray) { return {ray.direction.x / ray.direction.z, ray.direction.y / ray.direction.z}; }

class FieldTracer {
 public:
  FieldTracer(Lens const& lens, ParaxialLens const& paraxial, double image_plane, int rays)
      : lens_(lens), paraxial_(paraxial), plane_(lens, image_plane), image_plane_(image_plane), rays_(rays) {}

  FieldPoint at(double angle) const {
    FieldPoint point;
    point.angle = angle;
    RayOrigin const origin = field_origin(lens_, paraxial_, angle);
    auto const disc = find_apparent_pupil(lens_, origin);
    if (!disc) return point;
    trace_spot(origin, *disc, point);
    trace_chief(origin, *disc, point);
    return point;
  }

 private:
  void trace_spot(RayOrigin const& origin, ApparentPupil const& disc, FieldPoint& point) const {
    int through_stop = 0;
    std::map<std::pair<int, RayStatus>, int> lost;
    std::vector<Ray<double>> arrived;
    for (int k = 0; k < rays_; ++k) {
      Ray<double> ray = origin.ray_through(disc.at(sunflower(k, rays_)));
      auto const in_stop = intersect_stop(lens_, ray);
      if (in_stop && length(*in_stop) > lens_.stop_radius) continue;  // misses the stop
      through_stop += in_stop ? 1 : 0;
      RayAccount<double> account;
      int failed_at;
      RayStatus const status = lens_.view().carry(ray, account, 0, lens_.view().count, failed_at);
      if (status == RayStatus::alive) {
        arrived.push_back(plane_.in_its_frame(ray));
      } else {
        ++lost[{failed_at, status}];
      }
    }
    for (auto const& [where, count] : lost) {
      point.lost.push_back({where.first, where.second, static_cast<double>(count) / rays_});
    }
    if (arrived.empty()) return;
    point.imaged = true;
    point.vignetting = 1 - static_cast<double>(arrived.size()) / through_stop;
    std::vector<Vec2d> slopes;
    for (auto const& ray : arrived) {
      point.spot.push_back(ImagePlane::meets(ray, 0));
      slopes.push_back(slope(ray));
    }
    BundleSpot<double> const spot = compute_bundle_spot(point.spot, slopes);
    point.centroid = spot.centroid;
    point.spot_rms = std::sqrt(spot.mean_square);
    point.best_focus = spot.best_focus;
    point.best_spot_rms = std::sqrt(spot.best_mean_square);
  }

  void trace_chief(RayOrigin const& origin, ApparentPupil const& disc, FieldPoint& point) const {
    auto const through = [&](Vec2d p) {
      Ray<double> ray = origin.ray_through(disc.at(p));
      RayAccount<double> account;
      lens_.view().carry(ray, account);
      return plane_.in_its_frame(ray);
    };
    Ray<double> const chief = through({});
    point.chief = ImagePlane::meets(chief, 0);
    RayTransfer const m = ray_transfer(lens_, 0, static_cast<int>(lens_.paraxial.size()));
    // paraxial chief ray, through the centre of the entrance pupil
    double const u = std::tan(point.angle);
    double const y0 = std::isfinite(paraxial_.entrance.position) ? -paraxial_.entrance.position * u : 0;
    double const n_image = lens_.paraxial.back().n_after;
    double const nu = lens_.object_index * u;
    double const y = m.a * y0 + m.b * nu, slope_out = (m.c * y0 + m.d * nu) / n_image;
    double const ideal = y + slope_out * image_plane_;
    if (ideal != 0) point.distortion = point.chief.y / ideal - 1;
    // two rays on either side of the chief ray, close enough for a difference quotient
    constexpr double near = 1e-3;
    auto const focus = [&](Vec2d towards, double Vec2d::*component) {
      Ray<double> const one = through(near * towards), other = through(-near * towards);
      double const apart = ImagePlane::meets(one, 0).*component - ImagePlane::meets(other, 0).*component;
      double const closing = slope(one).*component - slope(other).*component;
      return -apart / closing;
    };
    point.tangential_focus = focus(along(disc, {0, 1}), &Vec2d::y);
    point.sagittal_focus = focus(along(disc, {1, 0}), &Vec2d::x);
  }

  /// Returns the point of the unit disc that maps to a given direction from the ellipse's centre.
  static Vec2d along(ApparentPupil const& disc, Vec2d direction) {
    double const determinant = disc.a.x * disc.b.y - disc.a.y * disc.b.x;
    Vec2d const p{(direction.x * disc.b.y - direction.y * disc.b.x) / determinant,
                  (disc.a.x * direction.y - disc.a.y * direction.x) / determinant};
    return p / length(p);
  }

  Lens const& lens_;
  ParaxialLens const& paraxial_;
  ImagePlane plane_;
  double image_plane_;
  int rays_;
};

/// Returns the distance of the paraxial image from the last vertex [m].
double paraxial_image(Lens const& lens, ParaxialLens const& paraxial) {
  double const distance = lens.prescription.object_distance;
  if (!std::isfinite(distance)) return paraxial.back_focal_length;
  RayTransfer const m = ray_transfer(lens, 0, static_cast<int>(lens.paraxial.size()));
  // Ray from the axial object point: y = distance, n u = n. The reduced distance is multiplied by n', negative after a
  // mirror.
  double const n = lens.object_index;
  return -lens.paraxial.back().n_after * (m.a * distance + m.b * n) / (m.c * distance + m.d * n);
}

}  // namespace

RayOrigin field_origin(Lens const& lens, ParaxialLens const& paraxial, double angle) {
  double const distance = lens.prescription.object_distance;
  if (!std::isfinite(distance)) return RayOrigin::direction({0, std::sin(angle), std::cos(angle)});
  // if the pupil is at infinity, the angle is measured at the first vertex
  double const from_pupil = distance + (std::isfinite(paraxial.entrance.position) ? paraxial.entrance.position : 0.0);
  return RayOrigin::point({0, -from_pupil * std::tan(angle), -distance});
}

FieldAnalysis analyse_field(Lens const& lens, ParaxialLens const& paraxial, int rays) {
  FieldAnalysis analysis;
  analysis.image_plane =
      lens.image_distance ? *lens.image_distance : paraxial_image(lens, paraxial) + lens.prescription.defocus;
  FieldTracer const tracer(lens, paraxial, analysis.image_plane, rays);
  std::vector<double> angles = lens.prescription.field_angles;
  if (angles.empty()) angles.push_back(0);
  for (double const angle : angles) {
    throw_if_interrupted();
    analysis.points.push_back(tracer.at(angle));
  }
  return analysis;
}

std::vector<Vec3d> follow_ray(Lens const& lens, Ray<double> ray, double image_plane) {
  std::vector<Vec3d> points{ray.position};
  LensView<double> const view = lens.view();
  for (int i = 0; i < view.count; ++i) {
    RayAccount<double> account;
    int failed_at;
    RayStatus const status = view.carry(ray, account, i, i + 1, failed_at);
    if (status != RayStatus::alive && status != RayStatus::vignetted) return points;
    points.push_back(ray.position);
    if (status == RayStatus::vignetted) return points;
  }
  ImagePlane const plane(lens, image_plane);
  points.push_back(plane.outwards(ImagePlane::meets(plane.in_its_frame(ray), 0)));
  return points;
}

}  // namespace gladstone::inline optics
