#include "render/optics/prescription_readers/zmx_apertures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline optics {
namespace {

using Outline = SurfaceOutline<double>;

/// Returns true if an operand has no effect on rays and their number.
bool is_harmless(std::string const& key) {
  static std::set<std::string> const harmless{
      "VERS", "MODE", "NAME", "NOTE", "UNIT", "ENPD", "FNUM", "OBNA", "FLOA", "FTYP", "ROPD", "PICB", "XFLN", "YFLN",
      "XFLD", "YFLD", "FWGN", "FWGT", "WAVL", "WAVM", "WAVN", "WWGT", "WWGN", "PWAV", "GCAT", "GFAC", "GLRS", "PFIL",
      "LANG", "EFFL", "SDMA", "OMMA", "RAIM", "PUSH", "HYPR", "GSTD", "NSCD", "COFN", "CFLT", "POLS", "BLNK", "PTYP",
      "RDTY", "TOL",  "MOFF", "MCOF", "SURF", "TYPE", "STOP", "CURV", "CONI", "PARM", "DISZ", "DIAM", "GLAS", "XDAT",
      "COMM", "HIDE", "MIRR", "SLAB", "POPS", "MEMA", "OEMA", "MAZH", "FIMP", "TCEX", "TCE",  "PPAR", "PCUR", "CNFG",
      "EDGE", "DBDT", "DRAW", "ISNA", "SCOL", "COLR", "SHOW", "OPDX", "ELOT", "VPAR", "VCUR", "VDIS", "VGLA", "VCON",
      "FCOM", "USAP", "FLDT", "CONF", "THIC", "UDAD", "MCOM", "ZVAR", "AUTH", "SDIA", "IWDP", "EERA", "LUID", "SSID"};
  return harmless.contains(key);
}

Outline read_outline(PrescriptionLine const& line, double unit, Outline::Kind kind, bool blocks) {
  Vec2d const half{line.number_or_infinity(1) * unit, line.number_or_infinity(2) * unit};
  if (half.x > 0 && half.y > 0) return {kind, blocks, half, {}};
  throw DataError(ErrorCode::out_of_range, line.where,
                  fmt::format("{}: the half widths along x and y, {} and {}, must both be positive; correct them",
                              line[0], line[1], line[2]));
}

}  // namespace

bool read_zmx_aperture(PrescriptionLine const& line, double unit, ZmxApertures& apertures, Warnings& warnings) {
  std::string const& key = line[0];
  if (key == "SPID" || key == "UDAP" || key == "UDOB") {
    warnings.push_back({WarningCode::ignored, line.where,
                        fmt::format("{}: {} not traced and do not block light", key,
                                    key == "SPID" ? "spiders are" : "user-defined shapes are")});
    return true;
  }
  if (key == "OBDC") {
    apertures.centre = {line.number(1) * unit, line.number(2) * unit};
  } else if (key == "SQAP" || key == "SQOB") {
    apertures.outline = read_outline(line, unit, Outline::Kind::rectangle, key == "SQOB");
  } else if (key == "ELAP" || key == "ELOB") {
    apertures.outline = read_outline(line, unit, Outline::Kind::ellipse, key == "ELOB");
  } else if (key == "CLAP" || key == "FLAP" || key == "OBSC") {
    double const least = line.number(1) * unit, largest = line.number_or_infinity(2) * unit;
    if (!(least >= 0 && largest >= least)) {
      throw DataError(
          ErrorCode::invalid_value, line.where,
          fmt::format("{}: the inner radius {} must be at least 0 and at most the outer radius {}; correct them", key,
                      line[1], line[2]));
    }
    if (key != "OBSC") {
      apertures.aperture = {least, largest};
    } else if (least == 0) {
      apertures.disc = std::max(apertures.disc, largest);
    } else if (largest > 0) {
      apertures.obscured_ring = {least, largest};
    }
  } else {
    return false;
  }
  apertures.where = line.where;
  return true;
}

void put_apertures(ZmxApertures const& apertures, PrescribedSurface& surface, Warnings& warnings) {
  auto const warn = [&](WarningCode code, std::string const& text) {
    warnings.push_back({code, apertures.where, text});
  };
  Vec2d const centre = apertures.centre;
  double disc = apertures.disc, largest = 0;
  if (apertures.aperture) {
    disc = std::max(disc, apertures.aperture->least);
    largest = apertures.aperture->largest;
    surface.obscured_without_end = disc > 0 && std::isinf(largest);
  }
  if (auto const& ring = apertures.obscured_ring) {
    // the obscured ring reaches the rim: only the disc within its inner radius remains open
    if (ring->largest >= surface.semi_diameter) {
      largest = largest > 0 ? std::min(largest, ring->least) : ring->least;
    } else {
      warn(WarningCode::ignored,
           "OBSC: a ring-shaped obscuration within the surface is not traced and blocks no light");
    }
  }
  surface.outline = apertures.outline;
  surface.outline.centre = centre;
  bool const off_axis = length(centre) > 0;
  // represent circles off the axis as ellipses
  auto const as_outline = [&](double radius, bool blocks) {
    if (surface.outline.kind != Outline::Kind::none) {
      warn(WarningCode::ignored,
           "of several decentred apertures on a surface only one is traced; the others block no light");
    } else {
      surface.outline = {Outline::Kind::ellipse, blocks, {radius, radius}, centre};
    }
  };
  if (std::isfinite(largest) && largest > 0) {
    if (off_axis) {
      as_outline(largest, false);
    } else {
      surface.semi_diameter = largest;
      surface.semi_diameter_vignettes = surface.has_aperture = true;
    }
  }
  if (disc > 0) {
    if (off_axis) {
      as_outline(disc, true);
    } else {
      surface.obscured = disc;
    }
  }
  bool const edge = surface.semi_diameter_vignettes && !surface.has_aperture;
  if (edge && surface.outline.kind != Outline::Kind::none && !surface.outline.blocks) {
    surface.semi_diameter_vignettes = false;  // the aperture replaces it
  }
  double const blocked = off_axis ? 0 : disc;
  if (edge && blocked > 0 && blocked >= surface.semi_diameter) {
    surface.semi_diameter_vignettes = false;
    warn(WarningCode::assumed,
         fmt::format("the opaque disc is as large as the surface, whose semi-diameter is {:.6g} mm, so that no light "
                     "would pass; the semi-diameter is taken as that of the disc alone, and light outside it passes "
                     "(to limit that light, add an aperture, CLAP)",
                     surface.semi_diameter / unit::millimetre));
  }
}

void ZmxNotes::note(std::string const& key, std::string const& where, std::string const& text) {
  if (keys_.insert(key).second) notes_.push_back({WarningCode::ignored, where, text});
}

void ZmxNotes::read(PrescriptionLine const& line) {
  std::string const& key = line[0];
  static std::set<std::string> const vignetting{"VDXN", "VDYN", "VCXN", "VCYN", "VANN", "VDXD", "VDYD", "VCXD", "VCYD"};
  if (vignetting.contains(key)) {
    if (!line.has_nonzero_number()) return;
    note("vignetting", line.where, key + ": vignetting factors are not used; the edges of the surfaces vignette");
  } else if (key == "COAT") {
    note(key, line.where, "COAT: coatings are ignored; surfaces transmit all light");
  } else if (key == "MNUM") {
    if (line.size() > 1 && line[1] != "1") {
      note(key, line.where,
           fmt::format("MNUM: of {} configurations, only the one stored in the surfaces is read",
                       line[1].substr(0, 40)));
    }
  } else if (key == "ENVD") {
    // temperature, pressure, and flag: adjust indices to them
    if (line.size() > 3 && line[3] != "0" && (line.number(1) != 20 || line.number(2) != 1)) {
      note(key, line.where,
           "ENVD: indices are not adjusted to an environment; those of the catalogue are used, at 20 "
           "degrees and 1 atmosphere");
    }
  } else if (!is_harmless(key) && keys_.insert(key).second) {
    if (unknown_.empty()) unknown_where_ = line.where;
    unknown_.push_back(key.substr(0, 40));
  }
}

Warnings ZmxNotes::warnings() const {
  Warnings all = notes_;
  if (!unknown_.empty()) {
    bool const one = unknown_.size() == 1;
    all.push_back({WarningCode::ignored, unknown_where_,
                   fmt::format("{} {} {} unknown and {} ignored; check that {} not change the lens",
                               one ? "operand" : "operands", fmt::join(unknown_, ", "), one ? "is" : "are",
                               one ? "was" : "were", one ? "it does" : "they do")});
  }
  return all;
}

}  // namespace gladstone::inline optics
