#include "render/optics/lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/axial_beam.h"
#include "render/optics/paraxial.h"

namespace gladstone {
namespace {

/// Index and absorption coefficient of a medium at the lens' wavelength.
struct Substance {
  double n = 1;
  double absorption = 0;  ///< [1/m]
};

/// Glass specified by nd and Vd only.
struct DescribedGlass {
  std::string name;
  std::string where;  ///< location of its first use
};

class LensBuilder {
 public:
  LensBuilder(Lens& lens, GlassCatalogue const& catalogue, LensOptions const& options)
      : lens_(lens), catalogue_(catalogue), options_(options) {}

  void place_surfaces() {
    Pose<double> frame;
    Substance before{substance(lens_.prescription.object_medium, lens_.prescription.file).n, 0};
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
      Substance const after = mirror ? before : substance(prescribed.after, prescribed.where);
      add_surface(frame, prescribed, before, after);
      double const n_before = forwards * before.n;
      if (mirror) forwards = -forwards;
      bool const last = i + 1 == lens_.prescription.surfaces.size();
      double const way = last && !std::isfinite(prescribed.thickness) ? 0 : prescribed.thickness;
      bool const ideal = prescribed.shape == PrescribedSurface::Shape::ideal_lens;
      lens_.paraxial.push_back(
          {vertex_curvature(prescribed), n_before, forwards * after.n, way, ideal ? 1 / prescribed.focal_length : 0});
      if (prescribed.stop) lens_.stop = static_cast<int>(i);
      frame = frame.moved({0, 0, way});
      before = after;
      if (last && (way != 0 || lens_.prescription.ends_at_image)) lens_.image_distance = way;
    }
    refuse_glasses();
    note_described_glasses();
  }

  /// Determines the radius of the stop and applies it to the stop surface.
  void open_stop() {
    PrescribedAperture const& aperture = lens_.prescription.aperture;
    using Kind = PrescribedAperture::Kind;
    PrescribedSurface const& stop = lens_.prescription.surfaces[static_cast<std::size_t>(lens_.stop)];
    bool const telecentric = is_telecentric(ray_transfer(lens_, 0, lens_.stop));
    double const prescribed = lens_.prescription.object_distance;
    if (options_.f_number && telecentric) {
      open_by_cone(*options_.f_number, options_.object_distance.value_or(prescribed));
    } else if (options_.f_number) {
      open_by_pupil(paraxial_lens(lens_).effective_focal_length / *options_.f_number);
    } else if (aperture.kind == Kind::working_f_number && std::isfinite(prescribed)) {
      open_by_cone(aperture.value, prescribed);
    } else if (aperture.kind == Kind::f_number || aperture.kind == Kind::working_f_number) {
      open_by_pupil(paraxial_lens(lens_).effective_focal_length / aperture.value);
    } else if (aperture.kind == Kind::entrance_pupil) {
      open_by_pupil(aperture.value);
    } else if (aperture.kind == Kind::object_na && std::isfinite(prescribed)) {
      double const s = std::min(aperture.value, 1.0);
      open_by_slope(s / std::sqrt(std::max(1 - s * s, 1e-12)), prescribed);
    } else if (std::isfinite(stop.semi_diameter)) {
      lens_.stop_radius = lens_.paraxial_stop_radius = stop.semi_diameter;
    } else {
      throw DataError(
          stop.where,
          "the stop has no semi-diameter, and the file sets no aperture from which it follows; add its "
          "semi-diameter (.zmx: DIAM, .seq: CIR, .toml: semi_diameter_mm), an entrance pupil or an f-number "
          "(ENPD, FNUM; EPD, FNO; entrance_pupil_mm, f_number), or lens.f_number to the setup");
    }
    if (stop.has_aperture) {  // limits the opening required by the system aperture
      if (options_.f_number && lens_.paraxial_stop_radius > stop.semi_diameter) {
        lens_.warnings.push_back(
            fmt::format("{}: the aperture on the stop opens to f/{:.4g} at the widest, not to f/{:.4g}", stop.where,
                        *options_.f_number * lens_.paraxial_stop_radius / stop.semi_diameter, *options_.f_number));
      }
      lens_.stop_radius = std::min(lens_.stop_radius, stop.semi_diameter);
      lens_.paraxial_stop_radius = std::min(lens_.paraxial_stop_radius, stop.semi_diameter);
    }
    if (!(lens_.stop_radius > 0) || !std::isfinite(lens_.stop_radius)) {
      throw DataError(stop.where,
                      "no light passes the stop (its radius is zero or infinite); correct the entrance pupil, the "
                      "f-number or the stop's semi-diameter");
    }
    auto& surface = lens_.surfaces[static_cast<std::size_t>(lens_.stop)];
    surface = surface.visit([&](auto opened) -> LensSurface<double> {
      opened.semi_diameter = lens_.stop_radius;
      return opened;
    });
  }

  /// Removes central obscurations without outer radius that are larger than the axial beam, and would block all of it.
  void open_rings() {
    RayTransfer const to_stop = ray_transfer(lens_, 0, lens_.stop);
    for (std::size_t i = 0; i < lens_.surfaces.size(); ++i) {
      PrescribedSurface const& prescribed = lens_.prescription.surfaces[i];
      if (!prescribed.obscured_without_end) continue;
      // height of a ray parallel to the axis at this surface, relative to that at the stop
      double const here = std::abs(ray_transfer(lens_, 0, static_cast<int>(i)).a / to_stop.a);
      if (prescribed.obscured < here * lens_.paraxial_stop_radius) continue;
      lens_.surfaces[i] = lens_.surfaces[i].visit([](auto opened) -> LensSurface<double> {
        opened.obscured = 0;
        return opened;
      });
      lens_.warnings.push_back(
          fmt::format("{}: an aperture from {:.6g} mm to infinity would block all light of the lens; it is ignored",
                      prescribed.where, prescribed.obscured / unit::millimetre));
    }
  }

  /// Traces the ray along the axis. @throws DataError if it is lost, in which case the lens cannot form an image
  void follow_axis() const {
    Ray<double> ray{{0, 0, -start_}, {0, 0, 1}};
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
    throw DataError(surface.where, fmt::format("surface {}: {}", failed_at + 1, why));
  }

 private:
  /// Sets the stop radius for an entrance pupil of the given diameter [m].
  void open_by_pupil(double diameter) {
    double const radius = std::abs(diameter) / 2;
    if (!std::isfinite(radius)) {
      throw DataError(lens_.prescription.file,
                      "an f-number does not define the aperture of an afocal lens; give the entrance pupil or the "
                      "stop's semi-diameter");
    }
    lens_.paraxial_stop_radius = std::abs(ray_transfer(lens_, 0, lens_.stop).a) * radius;
    lens_.stop_radius = height_at_stop({{radius, 0, -start_}, {0, 0, 1}}).value_or(lens_.paraxial_stop_radius);
  }

  /// Sets the stop radius for a cone from the axial point at a distance [m], whose marginal ray has the given slope.
  void open_by_slope(double slope, double distance) {
    RayTransfer const to_stop = ray_transfer(lens_, 0, lens_.stop);
    lens_.paraxial_stop_radius = std::abs(to_stop.a * distance + to_stop.b * lens_.object_index) * slope;
    lens_.stop_radius =
        height_at_stop({{0, 0, -distance}, normalized(Vec3d{slope, 0, 1})}).value_or(lens_.paraxial_stop_radius);
  }

  /// Sets the stop radius for an image-side cone of the given working f-number.
  void open_by_cone(double f_number, double distance) {
    RayTransfer const all = ray_transfer(lens_, 0, static_cast<int>(lens_.paraxial.size()));
    double const slope = 1 / (2 * f_number * std::abs(all.c * distance + all.d * lens_.object_index));
    if (!std::isfinite(distance) || !std::isfinite(slope)) {
      throw DataError(lens_.prescription.file,
                      "an f-number does not define the aperture of a telecentric lens without an object distance; give "
                      "the file's object distance, or the stop's semi-diameter");
    }
    open_by_slope(slope, distance);
  }

  static Pose<double> broken(Pose<double> frame, CoordinateBreak const& here) {
    Vec3d const shift{here.decentre.x, here.decentre.y, 0};
    if (here.tilt_first) {
      frame = frame.turned({0, 0, here.tilt.z}).turned({0, here.tilt.y, 0}).turned({here.tilt.x, 0, 0}).moved(shift);
    } else {
      frame = frame.moved(shift).turned(here.tilt);
    }
    return frame.moved({0, 0, here.advance});
  }

  /// Returns a glass of a catalogue, or the one with nd and Vd of its line if no catalogue contains it or if an assumed
  /// one contradicts them. Adds one warning about the choice.
  Glass named_glass(PrescribedMedium::Named const& named, std::string const& where) {
    std::string const& name = named.glass;
    std::vector<std::string> const& listed = lens_.prescription.catalogues;
    if (!named.otherwise) return found_glass(catalogue_.match(name, lens_.wavelength, where, listed), name, where);
    double const nd = named.otherwise->nd, vd = named.otherwise->vd;
    std::string const line_taken = fmt::format(
        "nd = {:.6g} and Vd = {:.4g} of its line are used for n = A + B/lambda^2 (add its catalogue for better "
        "accuracy)",
        nd, vd);
    std::string const key = fmt::format("{} {:.6g} {:.4g}", name, nd, vd);
    if (!catalogue_.has(name)) {
      note_once(key, fmt::format("{}: glass \"{}\" is in no catalogue; {}", where, name, line_taken));
      return Glass::from_nd_vd(nd, vd);
    }
    GlassMatch const match = catalogue_.match(name, lens_.wavelength, where, listed, nd);
    Glass const& glass = *match.glass;
    if (agrees_with_nd(glass, nd)) return found_glass(match, name, where);
    std::string const contradiction =
        fmt::format("{}: glass \"{}\": {} has nd = {:.6g}", where, name, place_of(glass), glass.nd());
    if (match.assumed) {
      note_once(key, fmt::format("{}; {}", contradiction, line_taken));
      return Glass::from_nd_vd(nd, vd);
    }
    note_once(key, fmt::format("{}, but its line says nd = {:.6g}; the catalogue's glass is used (if the line is "
                               "right, list the catalogue of its glass first in GCAT)",
                               contradiction, nd));
    return glass;
  }

  Substance substance(PrescribedMedium const& medium, std::string const& surface_where) {
    std::string const& where = medium.where.empty() ? surface_where : medium.where;
    double const wavelength = lens_.wavelength;
    auto const of_glass = [&](Glass const& glass) {
      return Substance{glass.index(wavelength), options_.absorption ? glass.absorption(wavelength) : 0};
    };
    try {
      if (auto const* const named = std::get_if<PrescribedMedium::Named>(&medium.is)) {
        return of_glass(named_glass(*named, where));
      }
      if (auto const* const own = std::get_if<PrescribedMedium::Private>(&medium.is)) {
        if (wavelength < own->glass.shortest || wavelength > own->glass.longest) {
          throw DataError(where, fmt::format("glass {} is given from {:.4g} to {:.4g} nm, not at {:.4g} nm; choose "
                                             "another wavelength",
                                             own->glass.name, own->glass.shortest / unit::nanometre,
                                             own->glass.longest / unit::nanometre, wavelength / unit::nanometre));
        }
        return of_glass(own->glass);
      }
    } catch (DataError const& error) {
      not_found_.push_back({error.file(), error.message()});
      return {};
    }
    if (auto const* const index = std::get_if<PrescribedMedium::Index>(&medium.is)) return {index->n, 0};
    if (auto const* const described = std::get_if<PrescribedMedium::Described>(&medium.is)) {
      Glass const glass = Glass::from_nd_vd(described->nd, described->vd);
      auto const known = std::find_if(described_.begin(), described_.end(),
                                      [&](DescribedGlass const& other) { return other.name == glass.name; });
      if (known == described_.end()) described_.push_back({glass.name, where});
      return {glass.index(wavelength), 0};
    }
    return {};
  }

  /// Returns the glass of a search and adds its notes, each once for a name.
  Glass found_glass(GlassMatch const& match, std::string const& name, std::string const& where) {
    for (std::string const& note : match.notes) note_once(name + note.substr(where.size()), note);
    return *match.glass;
  }

  /// Adds a warning about a glass, unless the glass already has one.
  void note_once(std::string const& key, std::string const& text) {
    if (noted_.insert(key).second) lens_.warnings.push_back(text);
  }

  /// Throws an error that lists all glasses that are unknown or not valid at this wavelength, with their locations.
  void refuse_glasses() const {
    if (not_found_.empty()) return;
    if (not_found_.size() == 1) throw DataError(not_found_.front().where, not_found_.front().message);
    throw SetupError(not_found_);
  }

  /// Returns the line number in a location "file:line" of the lens file.
  std::string_view line_in_file(std::string_view where) const {
    std::string const& file = lens_.prescription.file;
    bool const has_line = where.starts_with(file) && where.size() > file.size() + 1;
    return has_line ? where.substr(file.size() + 1) : where;
  }

  /// Adds one warning about all glasses specified by nd and Vd only, with the first line of each.
  void note_described_glasses() {
    if (described_.empty()) return;
    bool const one = described_.size() == 1;
    std::vector<std::string> names;
    for (DescribedGlass const& glass : described_) {
      names.push_back(one ? glass.name : fmt::format("{} (line {})", glass.name, line_in_file(glass.where)));
    }
    lens_.warnings.push_back(fmt::format(
        "{}: {} {} approximated by n = A + B/lambda^2, accurate to about 1e-3 away from 587.6 nm; name {} of a "
        "catalogue for better accuracy",
        described_.front().where,
        one ? "glass " + names.front() : fmt::format("{} glasses ({})", names.size(), fmt::join(names, "; ")),
        one ? "is" : "are", one ? "a glass" : "glasses"));
  }

  /// Adds a surface with its prescribed shape.
  void add_surface(Pose<double> const& frame, PrescribedSurface const& prescribed, Substance before, Substance after) {
    using Shape = PrescribedSurface::Shape;
    Quadric<double> const conic{prescribed.curvature, prescribed.conic,
                                prescribed.shape == Shape::cylinder ? 0.0 : 1.0};
    auto const add = [&](auto const& shape) {
      ShapedSurface<double, std::decay_t<decltype(shape)>> surface;
      surface.shape = shape;
      surface.pose = frame;
      surface.semi_diameter = std::numeric_limits<double>::infinity();
      if (prescribed.semi_diameter_vignettes) surface.semi_diameter = prescribed.semi_diameter;
      surface.n_before = before.n;
      surface.n_after = after.n;
      surface.absorption = before.absorption;
      surface.action = prescribed.after.is_mirror()            ? SurfaceAction::reflect
                       : prescribed.shape == Shape::ideal_lens ? SurfaceAction::focus
                       : before.n == after.n                   ? SurfaceAction::pass
                                                               : SurfaceAction::refract;
      surface.fresnel = options_.fresnel;
      surface.obscured = prescribed.obscured;
      if (surface.action == SurfaceAction::focus) surface.power = 1 / prescribed.focal_length;
      surface.outline = prescribed.outline;
      lens_.surfaces.push_back(surface);
      lens_.poses.push_back(frame);
    };
    if (prescribed.shape == Shape::ideal_lens) {
      add(Quadric<double>{});
    } else if (prescribed.shape == Shape::tilted_plane) {
      add(TiltedPlane<double>{prescribed.slope});
    } else if (!prescribed.radial.a.empty()) {
      add(radial_asphere(prescribed));
    } else if (!prescribed.asphere.empty()) {
      EvenAsphere<double> asphere{conic, {}};
      std::copy(prescribed.asphere.begin(), prescribed.asphere.end(), asphere.a);
      add(asphere);
    } else {
      add(conic);
    }
  }

  static RadialAsphere<double> radial_asphere(PrescribedSurface const& prescribed) {
    RadialAsphere<double> shape{
        {prescribed.curvature, prescribed.conic}, prescribed.radial.scale, prescribed.radial.even_powers, {}};
    std::copy(prescribed.radial.a.begin(), prescribed.radial.a.end(), shape.a);
    return shape;
  }

  /// Returns the curvature on the axis, including that of a polynomial's r^2 term [1/m].
  static double vertex_curvature(PrescribedSurface const& prescribed) {
    using Shape = PrescribedSurface::Shape;
    if (prescribed.shape == Shape::ideal_lens || prescribed.shape == Shape::tilted_plane) return 0;
    if (!prescribed.radial.a.empty()) return prescribed.curvature + radial_asphere(prescribed).vertex_curvature();
    return prescribed.curvature + (prescribed.asphere.empty() ? 0 : 2 * prescribed.asphere[0]);
  }

  /// Returns the distance from the stop's axis at which a ray intersects the stop [m]; nullopt if the ray is lost.
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

  static constexpr double start_ = 1;  // start of parallel rays, ahead of the first vertex [m]
  Lens& lens_;
  GlassCatalogue const& catalogue_;
  LensOptions const& options_;
  std::vector<SetupProblem> not_found_;    // unknown glasses
  std::vector<DescribedGlass> described_;  // glasses specified by nd and Vd only
  std::set<std::string> noted_;            // glasses with a warning
};

/// Returns the paraxial radius of the stop by the prescription's own aperture [m]; nullopt if it is not defined.
std::optional<double> prescribed_stop_radius(Lens lens, GlassCatalogue const& catalogue, LensOptions options) {
  options.f_number.reset();
  try {
    LensBuilder(lens, catalogue, options).open_stop();
  } catch (DataError const&) {
    return std::nullopt;
  }
  return lens.paraxial_stop_radius;
}

/// Warns if an f-number opens the stop wider than the prescription does, and reports the widest beam that the edges
/// pass.
void note_wide_stop(Lens& lens, double f_number, double own_radius, double object_distance) {
  constexpr double rounding = 1e-6;
  if (lens.paraxial_stop_radius <= (1 + rounding) * own_radius) return;
  std::string text = fmt::format("{}: f/{:.4g} opens the stop wider than the prescription itself, which is f/{:.4g}",
                                 lens.prescription.file, f_number, f_number * lens.paraxial_stop_radius / own_radius);
  if (auto const widest = max_axial_beam_radius(lens, object_distance)) {
    RayTransfer const to_stop = ray_transfer(lens, 0, lens.stop);
    double const asked = lens.paraxial_stop_radius / std::abs(to_stop.a + to_stop.b / object_distance);
    text += fmt::format(
        "; on the axis the lens passes f/{:.4g} at the widest, light outside this beam is lost at its edges",
        f_number * asked / *widest);
  } else {
    text += "; no edge of its surfaces limits that beam, for which the lens may not be designed: give semi-diameters";
  }
  lens.warnings.push_back(text);
}

}  // namespace

Lens build_lens(Prescription prescription, GlassCatalogue const& catalogue, double wavelength,
                LensOptions const& options) {
  Lens lens;
  lens.prescription = std::move(prescription);
  lens.wavelength = wavelength;
  lens.warnings = lens.prescription.warnings;
  LensBuilder builder(lens, catalogue, options);
  builder.place_surfaces();
  auto const own_radius = options.f_number ? prescribed_stop_radius(lens, catalogue, options) : std::nullopt;
  builder.open_stop();
  builder.open_rings();
  builder.follow_axis();
  double const object_distance = options.object_distance.value_or(lens.prescription.object_distance);
  if (auto const crossed = crossed_faces(lens, object_distance)) lens.warnings.push_back(*crossed);
  if (own_radius) note_wide_stop(lens, *options.f_number, *own_radius, object_distance);
  return lens;
}

}  // namespace gladstone
