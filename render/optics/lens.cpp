#include "render/optics/lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/paraxial.h"

namespace gladstone {
namespace {

/// Index and absorption of what lies behind a surface.
struct Substance {
  double n = 1;
  double absorption = 0;  ///< [1/m]
};

class LensBuilder {
 public:
  LensBuilder(Lens& lens, GlassCatalogue const& catalogue, LensOptions const& options)
      : lens_(lens), catalogue_(catalogue), options_(options) {}

  void place_surfaces() {
    Pose<double> frame;
    Substance before;
    double forwards = 1;  // sign of the paraxial index: mirrors turn it
    for (std::size_t i = 0; i < lens_.prescription.surfaces.size(); ++i) {
      PrescribedSurface const& prescribed = lens_.prescription.surfaces[i];
      for (CoordinateBreak const& here : prescribed.before) frame = broken(frame, here);
      bool const mirror = prescribed.after.is_mirror();
      Substance const after = mirror ? before : substance(prescribed);
      SurfaceAction const action = mirror                ? SurfaceAction::reflect
                                   : before.n == after.n ? SurfaceAction::pass
                                                         : SurfaceAction::refract;
      Quadric<double> const conic{prescribed.curvature, prescribed.conic,
                                  prescribed.shape == PrescribedSurface::Shape::cylinder ? 0.0 : 1.0};
      double vertex_curvature = prescribed.curvature;
      if (prescribed.asphere.empty()) {
        add(ShapedSurface<double, Quadric<double>>{{}, conic}, frame, prescribed, before, after, action);
      } else {
        EvenAsphere<double> asphere{conic, {}};
        std::copy(prescribed.asphere.begin(), prescribed.asphere.end(), asphere.a);
        vertex_curvature += 2 * asphere.a[0];
        add(ShapedSurface<double, EvenAsphere<double>>{{}, asphere}, frame, prescribed, before, after, action);
      }
      double const n_before = forwards * before.n;
      if (mirror) forwards = -forwards;
      bool const last = i + 1 == lens_.prescription.surfaces.size();
      double const way = last && !std::isfinite(prescribed.thickness) ? 0 : prescribed.thickness;
      lens_.paraxial.push_back({vertex_curvature, n_before, forwards * after.n, way});
      if (prescribed.stop) lens_.stop = static_cast<int>(i);
      frame = frame.moved({0, 0, way});
      before = after;
      if (last) lens_.image_distance = way;
    }
  }

  /// Finds the stop's radius and gives it to the stop.
  void open_stop() {
    PrescribedAperture const& aperture = lens_.prescription.aperture;
    RayTransfer const to_stop = ray_transfer(lens_, 0, lens_.stop);
    double pupil = 0;  // diameter of the entrance pupil
    if (options_.f_number) {
      pupil = paraxial_lens(lens_).effective_focal_length / *options_.f_number;
    } else if (aperture.kind == PrescribedAperture::Kind::f_number) {
      pupil = paraxial_lens(lens_).effective_focal_length / aperture.value;
    } else if (aperture.kind == PrescribedAperture::Kind::entrance_pupil) {
      pupil = aperture.value;
    }
    pupil = std::abs(pupil);
    PrescribedSurface const& stop = lens_.prescription.surfaces[static_cast<std::size_t>(lens_.stop)];
    if (pupil > 0) {
      if (!std::isfinite(pupil)) {
        throw DataError(lens_.prescription.file,
                        "an f-number sets no stop of an afocal lens; give the entrance pupil or the "
                        "stop's semi-diameter");
      }
      Ray<double> const rim{{pupil / 2, 0, -start_}, {0, 0, 1}};
      lens_.paraxial_stop_radius = std::abs(to_stop.a) * pupil / 2;
      lens_.stop_radius = height_at_stop(rim).value_or(lens_.paraxial_stop_radius);
    } else if (aperture.kind == PrescribedAperture::Kind::object_na &&
               std::isfinite(lens_.prescription.object_distance)) {
      double const s = std::min(aperture.value, 1.0), distance = lens_.prescription.object_distance;
      double const slope = s / std::sqrt(std::max(1 - s * s, 1e-12));
      Ray<double> const rim{{0, 0, -distance}, {s, 0, std::sqrt(std::max(0.0, 1 - s * s))}};
      lens_.paraxial_stop_radius = std::abs(to_stop.a * distance + to_stop.b) * slope;
      lens_.stop_radius = height_at_stop(rim).value_or(lens_.paraxial_stop_radius);
    } else {
      lens_.stop_radius = lens_.paraxial_stop_radius = stop.semi_diameter;
    }
    if (!(lens_.stop_radius > 0) || !std::isfinite(lens_.stop_radius)) {
      throw DataError(stop.where, "no light passes the stop (its aperture comes to nothing or to no end)");
    }
    auto& surface = lens_.surfaces[static_cast<std::size_t>(lens_.stop)];
    surface = surface.visit([&](auto opened) -> LensSurface<double> {
      opened.semi_diameter = lens_.stop_radius;
      return opened;
    });
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

  Substance substance(PrescribedSurface const& surface) {
    auto const& is = surface.after.is;
    if (auto const* const named = std::get_if<PrescribedMedium::Named>(&is)) {
      Glass const& glass = catalogue_.find(named->glass, lens_.wavelength, surface.where);
      return {glass.index(lens_.wavelength), options_.absorption ? glass.absorption(lens_.wavelength) : 0};
    }
    if (auto const* const index = std::get_if<PrescribedMedium::Index>(&is)) return {index->n, 0};
    if (auto const* const described = std::get_if<PrescribedMedium::Described>(&is)) {
      Glass const glass = Glass::from_nd_vd(described->nd, described->vd);
      lens_.warnings.push_back(
          fmt::format("{}: glass {} is taken as n = A + B/lambda^2, good to about 1e-3 away from "
                      "587.6 nm; name a glass of a catalogue for more",
                      surface.where, glass.name));
      return {glass.index(lens_.wavelength), 0};
    }
    return {};
  }

  template <class Surface>
  void add(Surface surface, Pose<double> const& frame, PrescribedSurface const& prescribed, Substance before,
           Substance after, SurfaceAction action) {
    surface.pose = frame;
    surface.semi_diameter = prescribed.semi_diameter;
    surface.n_before = before.n;
    surface.n_after = after.n;
    surface.absorption = before.absorption;
    surface.action = action;
    surface.fresnel = options_.fresnel;
    lens_.surfaces.push_back(surface);
    lens_.poses.push_back(frame);
  }

  /// How far from the stop's axis a ray meets it; nothing where it is lost on the way.
  std::optional<double> height_at_stop(Ray<double> ray) const {
    RayAccount<double> account;
    int failed_at;
    RayStatus const status = lens_.view().carry(ray, account, 0, lens_.stop, failed_at);
    if (status != RayStatus::alive) return std::nullopt;
    Pose<double> const& stop = lens_.poses[static_cast<std::size_t>(lens_.stop)];
    Ray<double> local = stop.inwards(ray);
    double way = 0;
    bool const met = lens_.surfaces[static_cast<std::size_t>(lens_.stop)].visit(
        [&](auto const& surface) { return surface.shape.intersect(local, way); });
    if (!met) return std::nullopt;
    local.position = local.position + way * local.direction;
    return std::hypot(local.position.x, local.position.y);
  }

  static constexpr double start_ = 1;  // where parallel light is begun, in front of the first vertex [m]
  Lens& lens_;
  GlassCatalogue const& catalogue_;
  LensOptions const& options_;
};

}  // namespace

Lens build_lens(Prescription prescription, GlassCatalogue const& catalogue, double wavelength,
                LensOptions const& options) {
  Lens lens;
  lens.prescription = std::move(prescription);
  lens.wavelength = wavelength;
  LensBuilder builder(lens, catalogue, options);
  builder.place_surfaces();
  builder.open_stop();
  return lens;
}

}  // namespace gladstone
