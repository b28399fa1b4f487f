#include "render/optics/prescription_readers/zmx_surface.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/even_asphere.h"
#include "render/optics/glass_name.h"
#include "render/optics/radial_asphere.h"

namespace gladstone::inline optics {
namespace {

bool is_glass(double nd, double vd) { return is_index_relative_to_air(nd) && vd >= 0; }

/// Reads a model glass from a line GLAS: nd and Vd in its fifth and sixth word. A Vd of 0 denotes a glass without
/// dispersion; that of a gas, whose nd is at most 1, is ignored.
PrescribedMedium model_glass(PrescriptionLine const& line, Warnings& warnings) {
  double const nd = line.number(4), vd = line.optional_number(5).value_or(0);
  if (nd == -1 && vd == 0) {
    warnings.push_back({WarningCode::assumed, line.where, "GLAS: an index of -1 is taken as a mirror"});
    return {PrescribedMedium::Mirror{}};
  }
  if (!is_glass(nd, vd)) {
    throw DataError(ErrorCode::out_of_range, line.where,
                    fmt::format("GLAS: nd = {:.6g}, Vd = {:.6g} of the model glass are impossible (nd must "
                                "lie between 1 and 5, or be that of a gas, Vd above 0); correct them or "
                                "name a glass",
                                nd, vd));
  }
  if (line.size() > 5 && !line.optional_number(5)) {
    warnings.push_back(
        {WarningCode::assumed, line.where,
         fmt::format("GLAS: the Vd of the model glass, \"{}\", is not a number; nd = {:.6g} is used at all wavelengths",
                     line[5].substr(0, 40), nd)});
  }
  if (line.optional_number(6).value_or(0) != 0) {
    warnings.push_back(
        {WarningCode::ignored, line.where, "GLAS: the deviation of a model glass' partial dispersion is not used"});
  }
  if (vd == 0 || nd <= 1) return {PrescribedMedium::Index{nd}};
  return {PrescribedMedium::Described{nd, vd}};
}

/// Reads the name of a catalogue glass. "MAKER-FAMILY|NAME" is converted to "MAKER:NAME", or to NAME if the maker has
/// no known catalogue, with a warning.
std::string glass_name(PrescriptionLine const& line, Warnings& warnings) {
  std::string const& word = line[1];
  std::size_t const bar = word.find('|');
  if (bar == std::string::npos || bar + 1 == word.size()) return word;
  std::string const maker = glass_key(word.substr(0, word.find_first_of("-_|"))), glass = word.substr(bar + 1);
  bool const known = maker_rank(maker) < maker_rank("");
  warnings.push_back({WarningCode::assumed, line.where,
                      fmt::format("GLAS: \"{}\" is read as glass {}{}", word.substr(0, 80), glass,
                                  known ? " of " + maker : std::string())});
  return known ? maker + ":" + glass : glass;
}

/// Reads a catalogue glass, with nd and Vd of the line as a fallback. 1.5 and 40 are ignored, since they are Zemax's
/// default values.
PrescribedMedium named_glass(PrescriptionLine const& line, Warnings& warnings) {
  PrescribedMedium::Named named{glass_name(line, warnings), std::nullopt};
  if (line.size() > 5) {
    std::optional<double> const nd = line.optional_number(4), vd = line.optional_number(5);
    if (!nd || !vd) {
      warnings.push_back({WarningCode::ignored, line.where,
                          fmt::format("GLAS: nd and Vd of the line, \"{}\" and \"{}\", are not numbers and are ignored",
                                      line[4].substr(0, 40), line[5].substr(0, 40))});
    } else if (is_glass(*nd, *vd) && *nd > 1 && *vd > 0 && !(*nd == 1.5 && *vd == 40)) {
      named.otherwise = {*nd, *vd};
    }
  }
  return {named};
}

PrescribedMedium medium_of(PrescriptionLine const& line, Warnings& warnings) {
  if (line.size() < 2) throw DataError(ErrorCode::syntax, line.where, "GLAS names no glass; the line is cut short");
  if (line[1] == "MIRROR") return {PrescribedMedium::Mirror{}};
  bool const blank = line[1] == "___BLANK";
  if (blank || (line.size() > 4 && line[2] == "1")) return model_glass(line, warnings);
  if (auto const code = read_glass_code(line[1])) return *code;
  return named_glass(line, warnings);
}

/// Reads the polynomial of extended aspheres: number of terms in XDAT 1, normalisation radius in XDAT 2, terms from
/// XDAT 3 on.
PrescribedSurface::RadialTerms extended_terms(ZmxSurface const& zmx, double unit, bool even_powers) {
  auto const datum = [&](int i) {
    auto const found = zmx.extra_data.find(i);
    return found == zmx.extra_data.end() ? 0.0 : found->second;
  };
  constexpr int first = 3;
  PrescribedSurface::RadialTerms radial{1, even_powers, {}};
  for (auto const& [i, value] : zmx.extra_data) {
    int const term = i - first;
    if (term < 0 || term >= datum(1) || value == 0) continue;
    if (term >= RadialAsphere<double>::terms) {
      throw DataError(ErrorCode::unsupported, zmx.extra_where,
                      fmt::format("{} has a term {} (XDAT {}; {} terms are traced)", zmx.type, term + 1, i,
                                  RadialAsphere<double>::terms));
    }
    radial.a.resize(static_cast<std::size_t>(term) + 1);
    radial.a.back() = value * unit;
  }
  if (radial.a.empty()) return radial;
  radial.scale = datum(2) * unit;
  if (!(radial.scale > 0)) {
    throw DataError(
        ErrorCode::out_of_range, zmx.extra_where,
        fmt::format("{} has a normalising radius of {:.6g} (XDAT 2); give a positive one", zmx.type, datum(2)));
  }
  return radial;
}

/// Warns of parameters of an asphere beyond its eight terms, which Zemax ignores as well.
void note_excess_terms(ZmxSurface const& zmx, std::vector<int> const& excess, double unit, Warnings& warnings) {
  if (excess.empty()) return;
  double const height = zmx.surface.semi_diameter / unit;
  double sag = 0;
  for (int const i : excess) sag += zmx.parameter(i) * std::pow(height, zmx.type == "EVENASPH" ? 2 * i : i);
  std::string const effect =
      std::isfinite(sag) && excess.front() > 0
          ? fmt::format("; as a term of the asphere it would be a sag of {:.2g} mm at the semi-diameter",
                        sag * unit / unit::millimetre)
          : "";
  warnings.push_back({WarningCode::ignored, zmx.excess_where,
                      fmt::format("PARM: {} has 8 terms, parameter {} is ignored, as by Zemax{}", zmx.type,
                                  fmt::join(excess, ", "), effect)});
}

}  // namespace

double ZmxSurface::parameter(int i) const {
  auto const found = parameters.find(i);
  return found == parameters.end() ? 0.0 : found->second;
}

void read_zmx_surface(PrescriptionLine const& line, double unit, ZmxSurface& zmx, Warnings& warnings) {
  PrescribedSurface& surface = zmx.surface;
  std::string const& key = line[0];
  if (key == "TYPE") {
    zmx.type = line.size() > 1 ? line[1] : "";
    zmx.type_where = line.where;
  }
  if (key == "STOP") surface.stop = true;
  if (key == "CURV") surface.curvature = line.number(1) / unit;
  if (key == "CONI") surface.conic = line.number(1);
  if (key == "PARM") {
    int const i = line.integer(1);
    zmx.parameters[i] = line.number(2);
    bool const excess = i < 1 || i > EvenAsphere<double>::terms;
    if (excess && line.number(2) != 0 && zmx.excess_where.empty()) zmx.excess_where = line.where;
  }
  if (key == "XDAT" && line.size() > 2) {
    zmx.extra_data[line.integer(1)] = line.number(2);
    if (line.number(2) != 0 && zmx.extra_where.empty()) zmx.extra_where = line.where;
  }
  if (key == "DISZ") {
    zmx.has_distance = true;
    surface.thickness = line.number_or_infinity(1) * unit;
  }
  if (key == "DIAM" && line.number_or_infinity(1) > 0) {
    surface.semi_diameter = line.number_or_infinity(1) * unit;
    surface.semi_diameter_vignettes = line.size() > 2 && line.integer(2) != 0;
  }
  if (key == "GLAS") {
    zmx.has_glass = true;
    surface.after = medium_of(line, warnings);
    surface.after.where = line.where;
  }
}

PrescribedSurface shaped_surface(ZmxSurface const& zmx, double unit, Warnings& warnings) {
  PrescribedSurface surface = zmx.surface;
  using Shape = PrescribedSurface::Shape;
  auto const no_extra_data = [&] {
    if (zmx.extra_where.empty()) return;
    warnings.push_back(
        {WarningCode::ignored, zmx.extra_where, fmt::format("XDAT: extra data of a surface {} are ignored", zmx.type)});
  };
  if (zmx.type == "STANDARD") {
    no_extra_data();
  } else if (zmx.type == "EVENASPH" || zmx.type == "ODDASPHE") {
    no_extra_data();
    bool const even = zmx.type == "EVENASPH";
    constexpr int terms = EvenAsphere<double>::terms;
    if (even) surface.asphere.assign(terms, 0.0);
    std::vector<int> excess;
    for (auto const& [i, value] : zmx.parameters) {
      if (value == 0) continue;
      if (i < 1 || i > terms) {
        excess.push_back(i);
      } else if (even) {
        surface.asphere[static_cast<std::size_t>(i - 1)] = value / std::pow(unit, 2 * i - 1);
      } else {  // coefficient of r^i, r in the file's unit
        surface.radial.a.resize(static_cast<std::size_t>(i));
        surface.radial.a.back() = value * unit;
      }
    }
    note_excess_terms(zmx, excess, unit, warnings);
    surface.radial.scale = unit;
    surface.radial.even_powers = false;
  } else if (zmx.type == "XASPHERE" || zmx.type == "XOSPHERE") {
    surface.radial = extended_terms(zmx, unit, zmx.type == "XASPHERE");
  } else if (zmx.type == "PARAXIAL") {
    surface.shape = Shape::ideal_lens;
    surface.focal_length = zmx.parameter(1) * unit;
    surface.curvature = surface.conic = 0;
  } else if (zmx.type == "TILTSURF") {
    surface.shape = Shape::tilted_plane;
    surface.slope = {zmx.parameter(1), zmx.parameter(2)};
    surface.curvature = surface.conic = 0;
  } else {
    throw DataError(ErrorCode::unsupported, zmx.type_where,
                    fmt::format("surface {}: type {} is not supported (STANDARD, EVENASPH, ODDASPHE, "
                                "XASPHERE, XOSPHERE, PARAXIAL, TILTSURF and COORDBRK are)",
                                zmx.label, zmx.type));
  }
  put_apertures(zmx.apertures, surface, warnings);
  return surface;
}

CoordinateBreak break_of(ZmxSurface const& zmx, double unit) {
  if (!std::isfinite(zmx.surface.thickness)) {
    throw DataError(ErrorCode::out_of_range, zmx.surface.where,
                    "the thickness of a coordinate break (DISZ) is infinite; give it a length");
  }
  return {{zmx.parameter(1) * unit, zmx.parameter(2) * unit},
          Vec3d{zmx.parameter(3), zmx.parameter(4), zmx.parameter(5)} * unit::degree,
          zmx.parameter(6) != 0,
          zmx.surface.thickness};
}

}  // namespace gladstone::inline optics
