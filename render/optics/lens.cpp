#include "render/optics/lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "render/base/error.h"
#include "render/optics/axial_beam.h"
#include "render/optics/lens_media.h"
#include "render/optics/lens_stop.h"

namespace gladstone::inline optics {
namespace {

class LensBuilder {
 public:
  LensBuilder(Lens& lens, GlassCatalogue const& catalogue, LensOptions const& options)
      : lens_(lens), options_(options), media_(lens.prescription, catalogue, lens.wavelength, options.absorption) {}

  void place_surfaces() {
    Pose<double> frame;
    LensMedium before{media_.find(lens_.prescription.object_medium, lens_.prescription.file).n, 0};
    lens_.object_index = before.n;
    double forwards = 1;  // sign of the paraxial index, which changes at every mirror
    for (std::size_t i = 0; i < lens_.prescription.surfaces.size(); ++i) {
      PrescribedSurface const& prescribed = lens_.prescription.surfaces[i];
      for (CoordinateBreak const& here : prescribed.before) frame = broken(frame, here);
      if (i > 0) {
        lens_.paraxial.back().to_next += advance(prescribed);
      } else {  // the frame's origin is in the plane of the first vertex
        lens_.prescription.object_distance += frame.origin.z;
        frame.origin.z = 0;
      }
      bool const mirror = prescribed.after.is_mirror();
      LensMedium const after = mirror ? before : media_.find(prescribed.after, prescribed.where);
      add_surface(frame, prescribed, before, after);
      double const n_before = forwards * before.n;
      if (mirror) forwards = -forwards;
      bool const last = i + 1 == lens_.prescription.surfaces.size();
      double const way = last && !std::isfinite(prescribed.thickness) ? 0 : prescribed.thickness;
      bool const ideal = prescribed.shape == PrescribedSurface::Shape::ideal_lens;
      double const curvature = make_shape(prescribed).visit([](auto const& shape) { return shape.vertex_curvature(); });
      lens_.paraxial.push_back({curvature, n_before, forwards * after.n, way, ideal ? 1 / prescribed.focal_length : 0});
      if (prescribed.stop) lens_.stop = static_cast<int>(i);
      frame = frame.moved({0, 0, way});
      before = after;
      if (last && (way != 0 || lens_.prescription.ends_at_image)) lens_.image_distance = way;
    }
    Warnings const notes = media_.finish();
    lens_.warnings.insert(lens_.warnings.end(), notes.begin(), notes.end());
  }

  /// Traces the ray along the axis. @throws DataError if it is lost, in which case the lens cannot form an image
  void follow_axis() const {
    Ray<double> ray{{0, 0, -start_of_parallel_rays}, {0, 0, 1}};
    RayAccount<double> account;
    int failed_at;
    RayStatus const status = lens_.view().carry(ray, account, 0, lens_.view().count, failed_at);
    if (status == RayStatus::alive || status == RayStatus::vignetted) return;
    PrescribedSurface const& surface = lens_.prescription.surfaces[static_cast<std::size_t>(failed_at)];
    char const* const why =
        status == RayStatus::total_internal_reflection
            ? "the ray along the axis is totally reflected here; check the surface's tilt and radius "
              "and the glass before it"
            : "the ray along the axis does not meet this surface; check its radius, its tilt and "
              "decentre, and the thickness before it";
    throw DataError(ErrorCode::invalid_value, surface.where, fmt::format("surface {}: {}", failed_at + 1, why));
  }

 private:
  static Pose<double> broken(Pose<double> frame, CoordinateBreak const& here) {
    Vec3d const shift{here.decentre.x, here.decentre.y, 0};
    if (here.tilt_first) {
      frame = frame.turned({0, 0, here.tilt.z}).turned({0, here.tilt.y, 0}).turned({here.tilt.x, 0, 0}).moved(shift);
    } else {
      frame = frame.moved(shift).turned(here.tilt);
    }
    return frame.moved({0, 0, here.advance});
  }

  /// Adds a surface with its prescribed shape.
  void add_surface(Pose<double> const& frame, PrescribedSurface const& prescribed, LensMedium before,
                   LensMedium after) {
    bool const ideal = prescribed.shape == PrescribedSurface::Shape::ideal_lens;
    make_shape(prescribed).visit([&](auto const& shape) {
      ShapedSurface<double, std::decay_t<decltype(shape)>> surface;
      surface.shape = shape;
      surface.pose = frame;
      surface.semi_diameter = std::numeric_limits<double>::infinity();
      if (prescribed.semi_diameter_vignettes) surface.semi_diameter = prescribed.semi_diameter;
      surface.n_before = before.n;
      surface.n_after = after.n;
      surface.absorption = before.absorption;
      surface.action = prescribed.after.is_mirror() ? SurfaceAction::reflect
                       : ideal                      ? SurfaceAction::focus
                       : before.n == after.n        ? SurfaceAction::pass
                                                    : SurfaceAction::refract;
      surface.fresnel = options_.fresnel;
      surface.obscured = prescribed.obscured;
      if (surface.action == SurfaceAction::focus) surface.power = 1 / prescribed.focal_length;
      surface.outline = prescribed.outline;
      lens_.surfaces.push_back(surface);
      lens_.poses.push_back(frame);
    });
  }

  Lens& lens_;
  LensOptions const& options_;
  LensMedia media_;
};

}  // namespace

LensShape<double> make_shape(PrescribedSurface const& surface) {
  using Shape = PrescribedSurface::Shape;
  if (surface.shape == Shape::ideal_lens) return Quadric<double>{};
  if (surface.shape == Shape::tilted_plane) return TiltedPlane<double>{surface.slope};
  Quadric<double> const conic{surface.curvature, surface.conic, surface.shape == Shape::cylinder ? 0.0 : 1.0};
  if (!surface.radial.a.empty()) {
    RadialAsphere<double> shape{conic, surface.radial.scale, surface.radial.even_powers, {}};
    std::copy(surface.radial.a.begin(), surface.radial.a.end(), shape.a);
    return shape;
  }
  if (surface.asphere.empty()) return conic;
  EvenAsphere<double> shape{conic, {}};
  std::copy(surface.asphere.begin(), surface.asphere.end(), shape.a);
  return shape;
}

Lens build_lens(Prescription prescription, GlassCatalogue const& catalogue, double wavelength,
                LensOptions const& options) {
  Lens lens;
  lens.prescription = std::move(prescription);
  lens.wavelength = wavelength;
  lens.warnings = lens.prescription.warnings;
  LensBuilder builder(lens, catalogue, options);
  builder.place_surfaces();
  auto const own_radius = options.f_number ? prescribed_stop_radius(lens, options) : std::nullopt;
  open_stop(lens, options);
  open_rings(lens);
  builder.follow_axis();
  double const object_distance = options.object_distance.value_or(lens.prescription.object_distance);
  if (auto const crossed = crossed_faces(lens, object_distance)) lens.warnings.push_back(*crossed);
  if (own_radius) note_wide_stop(lens, *options.f_number, *own_radius, object_distance);
  return lens;
}

}  // namespace gladstone::inline optics
