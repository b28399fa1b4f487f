#include "render/optics/prescription.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/base/units.h"
#include "render/optics/lens.h"
#include "render/optics/prescription_readers/lines.h"
#include "render/optics/prescription_readers/readers.h"

namespace gladstone::inline optics {
namespace {

struct PrescriptionFormat {
  char const* extension;
  Prescription (*read)(std::string const& path);
};

/// Supported file formats: file name extension and reader.
constexpr std::array formats{
    PrescriptionFormat{".toml", read_toml_prescription},
    PrescriptionFormat{".zmx", read_zmx_prescription},
    PrescriptionFormat{".seq", read_seq_prescription},
};

constexpr double longest = 1e3;  // upper limit of any length in a lens [m]
// Overlap of two surfaces on the axis up to which a lens is traced, with a warning [m]. It is below any tolerance of a
// thickness. Optimisers store such values for surfaces in contact.
constexpr double contact_tolerance = 1e-6;

/// Returns true for an ideal lens, and for a surface that is a mirror or borders on a medium other than air. Reference
/// planes and stops in air are excluded.
bool is_real(Prescription const& lens, std::size_t i) {
  PrescribedMedium const& before = i > 0 ? lens.surfaces[i - 1].after : lens.object_medium;
  return lens.surfaces[i].shape == PrescribedSurface::Shape::ideal_lens || !lens.surfaces[i].after.is_air() ||
         !before.is_air();
}

/// Returns the sag of a prescribed surface at a radius [m]; 0 for a tilted plane.
double sag(PrescribedSurface const& surface, double height) {
  if (surface.shape == PrescribedSurface::Shape::tilted_plane) return 0;
  return make_shape(surface).visit([height](auto const& shape) { return shape.sag(height, 0); });
}

bool is_turned(PrescribedSurface const& surface) {
  return std::any_of(surface.before.begin(), surface.before.end(),
                     [](CoordinateBreak const& here) { return length(here.decentre) != 0 || length(here.tilt) != 0; });
}

/// Checks whether a surface intersects the next real surface within their edges; reference planes between them are
/// skipped. Semi-diameters for drawings are not considered as edges. An intersection off the axis causes a warning
/// only, since it may be outside the light, and so does one within the contact tolerance.
/// @param forwards  sign of the light's direction between the surfaces
/// @return a warning; nullopt: the surfaces do not overlap
/// @throws DataError if they overlap on the axis
std::optional<Warning> find_overlap(Prescription const& lens, std::size_t i, double forwards) {
  PrescribedSurface const& one = lens.surfaces[i];
  double way = 0;
  std::size_t next_real = i + 1;
  for (; next_real < lens.surfaces.size(); ++next_real) {
    if (is_turned(lens.surfaces[next_real])) return {};
    way += lens.surfaces[next_real - 1].thickness + advance(lens.surfaces[next_real]);
    if (is_real(lens, next_real)) break;
  }
  if (next_real == lens.surfaces.size()) return {};
  PrescribedSurface const& next = lens.surfaces[next_real];
  double const height = std::min(one.semi_diameter, next.semi_diameter);
  if (!std::isfinite(height) || !one.semi_diameter_vignettes || !next.semi_diameter_vignettes) return {};
  for (int k = 0; k <= 32; ++k) {
    double const r = height * k / 32;
    double const gap = forwards * (way + sag(next, r) - sag(one, r));
    if (!(gap < -1e-9 * std::max(height, 1e-3))) continue;
    std::string const what =
        fmt::format("this surface and the one before it ({}) overlap by {:.4g} mm at a height of {:.4g} mm", one.where,
                    -gap / unit::millimetre, r / unit::millimetre);
    if (gap < -contact_tolerance && k == 0)
      throw DataError(ErrorCode::invalid_value, next.where, what + " (check radius, thickness and semi-diameter)");
    return Warning{WarningCode::inconsistent, next.where,
                   fmt::format("{}, within their semi-diameters; rays are traced from surface to surface all the same "
                               "(check radius, thickness and semi-diameter)",
                               what)};
  }
  return {};
}

/// Checks that an index, or nd and Vd, are those of a glass. @throws DataError
void check_medium(PrescribedMedium const& medium, std::string const& surface_where) {
  std::string const& where = medium.where.empty() ? surface_where : medium.where;
  auto const* const index = std::get_if<PrescribedMedium::Index>(&medium.is);
  if (index && !is_index_relative_to_air(index->n)) {
    throw DataError(
        ErrorCode::out_of_range, where,
        fmt::format("an index of {:.4g} is not that of a glass (between 1 and 5) or a gas; correct it", index->n));
  }
  auto const* const described = std::get_if<PrescribedMedium::Described>(&medium.is);
  if (described && !(described->nd > 1 && described->nd < 5 && described->vd > 0)) {
    throw DataError(ErrorCode::out_of_range, where,
                    fmt::format("nd = {:.4g}, Vd = {:.4g} are not those of a glass (nd between 1 and 5, Vd "
                                "above 0); correct them or name a glass",
                                described->nd, described->vd));
  }
}

/// Returns a warning if a surface ends inside its semi-diameter.
std::optional<Warning> find_short_surface(PrescribedSurface const& surface) {
  bool const edge = surface.semi_diameter_vignettes && std::isfinite(surface.semi_diameter);
  if (!edge || std::isfinite(sag(surface, surface.semi_diameter))) return {};
  return Warning{WarningCode::inconsistent, surface.where,
                 fmt::format("a surface of radius {:.4g} mm does not reach its semi-diameter of {:.4g} mm; rays beyond "
                             "its rim miss it (check radius and semi-diameter)",
                             1 / surface.curvature / unit::millimetre, surface.semi_diameter / unit::millimetre)};
}

/// Checks the lengths of a surface.
/// @param last  the surface is the last one, whose thickness may be infinite
/// @throws DataError for lengths that no lens has
void check_dimensions(PrescribedSurface const& surface, bool last) {
  if (!(std::abs(surface.thickness) <= longest) && !last) {
    throw DataError(ErrorCode::out_of_range, surface.where,
                    fmt::format("a thickness of {:.4g} mm is too long for a lens (at most a kilometre)",
                                surface.thickness / unit::millimetre));
  }
  if (!(std::abs(advance(surface)) <= longest)) {
    throw DataError(
        ErrorCode::out_of_range, surface.where,
        fmt::format(
            "the coordinate breaks before this surface move it along the axis by {:.4g} mm, but at most a kilometre is "
            "allowed; correct their thicknesses",
            advance(surface) / unit::millimetre));
  }
  if (!(surface.semi_diameter > 0)) {
    throw DataError(ErrorCode::out_of_range, surface.where,
                    "the semi-diameter is not positive; give the radius within which light passes");
  }
  double const edge = surface.semi_diameter_vignettes ? surface.semi_diameter : HUGE_VAL;
  if (!(surface.obscured >= 0 && surface.obscured < edge)) {
    throw DataError(ErrorCode::invalid_value, surface.where,
                    fmt::format("an obscuration of radius {:.4g} mm covers the surface's semi-diameter of {:.4g} mm; "
                                "make it smaller",
                                surface.obscured / unit::millimetre, surface.semi_diameter / unit::millimetre));
  }
}

/// Checks that the thickness of glass behind a surface is directed along the light.
/// @param forwards  sign of the light's direction behind the surface
/// @return true if the thickness is directed against the light by at most contact_tolerance
/// @throws DataError if it is directed against the light by more
bool check_direction(PrescribedSurface const& surface, double forwards, bool last) {
  bool const against =
      !surface.after.is_mirror() && !surface.after.is_air() && forwards * surface.thickness < 0 && !last;
  if (against && std::abs(surface.thickness) > contact_tolerance) {
    throw DataError(ErrorCode::invalid_value, surface.where,
                    fmt::format("a thickness of {:.4g} mm of glass is directed against the light, which travels {} "
                                "here; change its sign (behind an odd number of mirrors thicknesses are negative)",
                                surface.thickness / unit::millimetre, forwards > 0 ? "forwards" : "back"));
  }
  return against;
}

/// Checks the aperture of a lens that has a stop.
/// @return warning that the aperture is not defined for this object; nullopt: it is
/// @throws DataError if it is not positive
std::optional<Warning> check_aperture(Prescription const& lens) {
  auto const& aperture = lens.aperture;
  if (aperture.kind != PrescribedAperture::Kind::stop && !(aperture.value > 0)) {
    throw DataError(ErrorCode::out_of_range, aperture.where.empty() ? lens.file : aperture.where,
                    "the aperture is not positive; correct it");
  }
  if (aperture.kind != PrescribedAperture::Kind::object_na || std::isfinite(lens.object_distance)) return {};
  auto const at = std::find_if(lens.surfaces.begin(), lens.surfaces.end(), [](auto const& s) { return s.stop; });
  return Warning{WarningCode::assumed, aperture.where.empty() ? at->where : aperture.where,
                 "a numerical aperture on the object's side does not define the aperture for an object at infinity; "
                 "the semi-diameter of the stop is used"};
}

}  // namespace

double advance(PrescribedSurface const& surface) {
  double sum = 0;
  for (CoordinateBreak const& here : surface.before) sum += here.advance;
  return sum;
}

void break_before_image(Prescription& lens, std::vector<CoordinateBreak> breaks, std::string const& where) {
  auto const idle = [](CoordinateBreak const& here) {
    return length(here.decentre) == 0 && length(here.tilt) == 0 && here.advance == 0;
  };
  if (std::all_of(breaks.begin(), breaks.end(), idle)) return;
  PrescribedSurface plane;
  plane.where = where;
  plane.thickness = std::exchange(breaks.back().advance, 0);
  plane.before = std::move(breaks);
  lens.surfaces.push_back(plane);
  lens.ends_at_image = true;
}

Prescription read_prescription(std::string const& path) {
  std::string const extension = lower_case(std::filesystem::path(path).extension().string());
  std::string known;
  for (auto const& format : formats) {
    if (extension == format.extension) {
      Prescription prescription = format.read(path);
      Warnings const warnings = check_prescription(prescription);
      prescription.warnings.insert(prescription.warnings.end(), warnings.begin(), warnings.end());
      return prescription;
    }
    known += (known.empty() ? "" : ", ") + std::string(format.extension);
  }
  throw DataError(ErrorCode::unsupported, path,
                  "has no supported format of lens prescriptions; supported are " + known);
}

void assume_stop(Prescription& lens) {
  bool const named = std::any_of(lens.surfaces.begin(), lens.surfaces.end(), [](auto const& s) { return s.stop; });
  if (named || lens.surfaces.empty()) return;
  lens.surfaces.front().stop = true;
  lens.warnings.push_back({WarningCode::assumed, lens.surfaces.front().where,
                           "the file names no stop (STOP, STO); the first surface is taken as the stop"});
}

void assume_aperture(Prescription& lens, char const* commands) {
  PrescribedAperture& aperture = lens.aperture;
  bool const is_set = aperture.kind == PrescribedAperture::Kind::stop ? !aperture.where.empty() : aperture.value > 0;
  auto const stop = std::find_if(lens.surfaces.begin(), lens.surfaces.end(), [](auto const& s) { return s.stop; });
  if (is_set || stop == lens.surfaces.end()) return;
  lens.warnings.push_back(
      {WarningCode::assumed, aperture.where.empty() ? stop->where : aperture.where,
       fmt::format("the file sets no aperture ({}); the semi-diameter of the stop is used", commands)});
  aperture = {};
}

Warnings check_prescription(Prescription const& lens) {
  Warnings warnings;
  auto const warn = [&warnings](std::optional<Warning> const& warning) {
    if (warning) warnings.push_back(*warning);
  };
  if (lens.surfaces.empty())
    throw DataError(ErrorCode::missing_content, lens.file, "has no surface; a lens needs at least one");
  constexpr std::size_t most_surfaces = 1000;
  if (lens.surfaces.size() > most_surfaces) {
    throw DataError(ErrorCode::out_of_range, lens.file,
                    fmt::format("has {} surfaces (at most {} are read)", lens.surfaces.size(), most_surfaces));
  }
  check_medium(lens.object_medium, lens.file);
  std::string stop;
  bool any_real = false;
  double forwards = 1;  // sign of the light's direction, which mirrors reverse
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    PrescribedSurface const& surface = lens.surfaces[i];
    bool const last = i + 1 == lens.surfaces.size();
    any_real = any_real || is_real(lens, i);
    if (surface.stop) {
      if (!stop.empty())
        throw DataError(ErrorCode::invalid_value, surface.where,
                        "a second stop (the first one is at " + stop + "); remove one");
      stop = surface.where;
    }
    check_dimensions(surface, last);
    if (surface.after.is_mirror()) forwards = -forwards;
    bool const against = check_direction(surface, forwards, last);
    warn(find_short_surface(surface));
    if (surface.shape == PrescribedSurface::Shape::ideal_lens && surface.focal_length == 0) {
      throw DataError(ErrorCode::out_of_range, surface.where,
                      "an ideal thin lens has a focal length of 0; give it another one");
    }
    check_medium(surface.after, surface.where);
    auto const overlap = is_real(lens, i) ? find_overlap(lens, i, forwards) : std::nullopt;
    warn(overlap);
    if (against && !overlap) {
      warn(Warning{WarningCode::inconsistent, surface.where,
                   fmt::format("a thickness of {:.4g} mm of glass is directed against the light; it is traced, since "
                               "the surfaces are in contact to within {:.4g} mm",
                               surface.thickness / unit::millimetre, contact_tolerance / unit::millimetre)});
    }
  }
  if (!any_real)
    throw DataError(ErrorCode::missing_content, lens.file,
                    "has no surface that refracts or reflects (every medium is air)");
  if (stop.empty())
    throw DataError(ErrorCode::missing_content, lens.file,
                    "has no stop; mark the surface that limits the light (stop = true, STOP, STO)");
  warn(check_aperture(lens));
  return warnings;
}

}  // namespace gladstone::inline optics
