#include "render/optics/prescription_readers/seq_surface.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <set>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/even_asphere.h"

namespace gladstone::inline optics {
namespace {

using Outline = SurfaceOutline<double>;

/// Returns the index of the aspheric coefficient of a letter, A to H and J; A is index 1, the term r^4.
std::size_t aspheric_term(char letter) { return static_cast<std::size_t>(letter == 'J' ? 9 : letter - 'A' + 1); }

/// Reads CIR, REX, REY, ELX or ELY: "CIR [OBS|HOL|EDG] [L'label'] value".
void read_aperture(std::string const& command, PrescriptionLine const& line, double unit, SeqSurface& seq,
                   Warnings& warnings) {
  std::string kind;
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    std::string const word = upper_case(line[i]);
    if (word == "OBS" || word == "HOL" || word == "EDG" || word == "CLR") kind = word;
  }
  if (line.size() < 2)
    throw DataError(ErrorCode::syntax, line.where, fmt::format("{} has no value; the line is cut short", command));
  if (kind == "EDG") return;  // edges are for drawings only
  double const value = line.number_or_infinity(line.size() - 1) * unit;
  if (kind == "HOL") {
    warnings.push_back(
        {WarningCode::approximated, line.where,
         fmt::format("{} HOL: light that meets the hole counts as lost, as behind an obscuration", command)});
  }
  bool const blocks = kind == "OBS" || kind == "HOL";
  if (value == 0 && blocks) return;
  if (!(value > 0))
    throw DataError(ErrorCode::out_of_range, line.where, command + ": the size of an aperture is positive; correct it");
  if (command == "CIR") {
    (blocks ? seq.surface.obscured : seq.surface.semi_diameter) = value;
    if (!blocks) seq.surface.has_aperture = true;
    return;
  }
  if (seq.shape.kind == Outline::Kind::none) {
    constexpr double endless = std::numeric_limits<double>::infinity();
    seq.shape = {Outline::Kind::rectangle, blocks, {endless, endless}, {}};
  }
  if (command.starts_with('E')) seq.shape.kind = Outline::Kind::ellipse;
  (command.ends_with('X') ? seq.shape.half.x : seq.shape.half.y) = value;
}

/// Reads XDE, YDE, ZDE, ADE, BDE or CDE. CODE V's angles are left-handed about x and y, right-handed about z.
void read_decentre(std::string const& command, PrescriptionLine const& line, double unit, SeqSurface& seq) {
  double const value = line.number(1);
  if (command == "XDE") seq.shift.x = value * unit;
  if (command == "YDE") seq.shift.y = value * unit;
  if (command == "ZDE") seq.shift.z = value * unit;
  if (command == "ADE") seq.tilt.x = -value * unit::degree;
  if (command == "BDE") seq.tilt.y = -value * unit::degree;
  if (command == "CDE") seq.tilt.z = value * unit::degree;
}

}  // namespace

std::vector<CoordinateBreak> SeqSurface::breaks_before() const {
  std::vector<CoordinateBreak> breaks;
  if (kind == Decentre::reverse) return breaks;
  if (shift.z != 0) breaks.push_back({{}, {}, false, shift.z});
  if (length(Vec2d{shift.x, shift.y}) != 0 || length(tilt) != 0) breaks.push_back({{shift.x, shift.y}, tilt});
  return breaks;
}

std::vector<CoordinateBreak> SeqSurface::breaks_behind() const {
  if (length(shift) == 0 && length(tilt) == 0) return {};
  if (kind == Decentre::ret || kind == Decentre::reverse) return {{{-shift.x, -shift.y}, -tilt, true, -shift.z}};
  if (kind == Decentre::bend) return {{{}, tilt}};
  return {};
}

bool read_seq_surface(std::string const& command, PrescriptionLine const& line, double unit, bool is_image,
                      SeqSurface& seq, Warnings& warnings) {
  static std::set<std::string> const apertures{"CIR", "REX", "REY", "ELX", "ELY"};
  static std::set<std::string> const decentres{"XDE", "YDE", "ZDE", "ADE", "BDE", "CDE"};
  PrescribedSurface& surface = seq.surface;
  if (command == "STO" || command == "STOP") {
    if (is_image)
      throw DataError(ErrorCode::invalid_value, line.where, "the image SI cannot be the stop; mark another one");
    surface.stop = true;
  } else if (command == "RMD") {
    std::string const mode = line.size() > 1 ? upper_case(line[1]) : "";
    if (mode == "REFL") {
      surface.after = {PrescribedMedium::Mirror{}, line.where};
    } else if (mode != "REFR") {
      throw DataError(ErrorCode::unsupported, line.where,
                      fmt::format("RMD {}: this refraction mode is not supported (REFL and REFR are)", mode));
    }
  } else if (command == "K") {
    surface.conic = line.number(1);
  } else if (apertures.contains(command)) {
    read_aperture(command, line, unit, seq, warnings);
  } else if (decentres.contains(command)) {
    read_decentre(command, line, unit, seq);
  } else if (command == "ADX" || command == "ADY") {
    (command == "ADX" ? seq.centre.x : seq.centre.y) = line.number(line.size() - 1) * unit;
  } else if (command == "ARO") {
    if (line.number(line.size() - 1) != 0) {
      warnings.push_back({WarningCode::ignored, line.where, "ARO: the rotation of an aperture is not traced"});
    }
  } else if (command == "DAR") {
    seq.kind = SeqSurface::Decentre::ret;
  } else if (command == "BEN") {
    seq.kind = SeqSurface::Decentre::bend;
  } else if (command == "REV") {
    seq.kind = SeqSurface::Decentre::reverse;
  } else if (command == "CUF") {
    if (line.number(1) != 0) {
      throw DataError(ErrorCode::unsupported, line.where,
                      "a Fresnel surface on a curved base (CUF) is not supported; write the lens as TOML");
    }
  } else if (command.size() == 1 && command[0] >= 'A' && command[0] <= 'J' && command[0] != 'I') {
    std::size_t const term = aspheric_term(command[0]);
    if (seq.asphere.size() <= term) seq.asphere.resize(term + 1);
    seq.asphere[term] = line.number(1);
  } else {
    return false;
  }
  return true;
}

void finish_seq_surface(SeqSurface& seq, double unit, Warnings& warnings) {
  PrescribedSurface& surface = seq.surface;
  while (!seq.asphere.empty() && seq.asphere.back() == 0) seq.asphere.pop_back();
  constexpr std::size_t terms = EvenAsphere<double>::terms;
  if (seq.asphere.size() > terms) {
    surface.radial = {unit, true, seq.asphere};
    for (double& a : surface.radial.a) a *= unit;
  } else if (!seq.asphere.empty()) {
    surface.asphere.assign(terms, 0.0);
    for (std::size_t i = 0; i < seq.asphere.size(); ++i) {
      surface.asphere[i] = seq.asphere[i] / std::pow(unit, 2 * static_cast<int>(i) + 1);
    }
  }
  surface.outline = seq.shape;
  surface.outline.centre = seq.centre;
  if (length(seq.centre) == 0) return;
  // represent circles off the axis as ellipses
  auto const as_outline = [&](double radius, bool blocks) {
    if (surface.outline.kind == Outline::Kind::none) {
      surface.outline = {Outline::Kind::ellipse, blocks, {radius, radius}, seq.centre};
    } else {
      warnings.push_back({WarningCode::ignored, surface.where,
                          "of several decentred apertures on a surface only one is traced; the others block no light"});
    }
  };
  if (std::isfinite(surface.semi_diameter)) {
    as_outline(surface.semi_diameter, false);
    surface.semi_diameter = std::numeric_limits<double>::infinity();
    surface.has_aperture = false;
  }
  if (surface.obscured > 0) {
    as_outline(surface.obscured, true);
    surface.obscured = 0;
  }
}

}  // namespace gladstone::inline optics
