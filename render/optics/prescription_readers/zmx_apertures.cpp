#include "render/optics/prescription_readers/zmx_apertures.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "render/base/error.h"

namespace gladstone {
namespace {

/// Operands that say nothing about where rays go, or how many.
bool is_harmless(std::string const& key) {
  static std::set<std::string> const harmless{
      "VERS", "MODE", "NAME", "NOTE", "UNIT", "ENPD", "FNUM", "OBNA", "FLOA", "FTYP", "ROPD", "PICB", "XFLN", "YFLN",
      "XFLD", "YFLD", "FWGN", "FWGT", "WAVL", "WAVM", "WAVN", "WWGT", "WWGN", "PWAV", "GCAT", "GFAC", "GLRS", "PFIL",
      "LANG", "EFFL", "SDMA", "OMMA", "RAIM", "PUSH", "HYPR", "GSTD", "NSCD", "COFN", "CFLT", "POLS", "BLNK", "PTYP",
      "RDTY", "TOL",  "MNUM", "MOFF", "MCOF", "SURF", "TYPE", "STOP", "CURV", "CONI", "PARM", "DISZ", "DIAM", "GLAS",
      "XDAT", "COMM", "HIDE", "MIRR", "SLAB", "POPS", "MEMA", "OEMA", "MAZH", "FIMP", "TCEX", "TCE",  "PPAR", "PCUR",
      "CNFG", "EDGE", "DBDT", "DRAW", "ISNA", "SCOL", "COLR", "SHOW", "OPDX", "ELOT", "VPAR", "VCUR", "VDIS", "VGLA",
      "VCON", "FCOM", "USAP", "FLDT", "CONF", "THIC", "UDAD", "MCOM", "ZVAR"};
  return harmless.contains(key);
}

/// Operands that block light in shapes that are not traced.
char const* shape_of(std::string const& key) {
  static std::map<std::string, char const*> const shapes{{"SQAP", "a rectangular aperture"},
                                                         {"SQOB", "a rectangular obscuration"},
                                                         {"ELAP", "an elliptical aperture"},
                                                         {"ELOB", "an elliptical obscuration"},
                                                         {"SPID", "a spider"},
                                                         {"UDAP", "an aperture of the user's own"},
                                                         {"UDOB", "an obscuration of the user's own"}};
  auto const found = shapes.find(key);
  return found == shapes.end() ? nullptr : found->second;
}

bool any_but_zero(PrescriptionLine const& line) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line.number(i) != 0) return true;
  }
  return false;
}

}  // namespace

bool read_zmx_aperture(PrescriptionLine const& line, double unit, PrescribedSurface& surface) {
  std::string const& key = line[0];
  if (char const* const shape = shape_of(key)) {
    throw DataError(line.where, fmt::format("{} stands on this surface ({} is not traced: circular ones about the axis "
                                            "are); remove the line to trace without it",
                                            shape, key));
  }
  if (key == "OBDC") {
    if (any_but_zero(line)) {
      throw DataError(line.where,
                      "the aperture is decentred (OBDC is not traced: circular ones about the axis are); remove the "
                      "line to trace it about the axis");
    }
    return true;
  }
  if (key != "CLAP" && key != "FLAP" && key != "OBSC") return false;
  double const least = line.number(1) * unit, largest = line.number(2) * unit;
  if (!(least >= 0 && largest >= least)) {
    throw DataError(line.where, fmt::format("{}: radii from {} to {} are none of a ring; give the least, then the "
                                            "largest",
                                            key, line[1], line[2]));
  }
  if (key == "OBSC") {  // blocks between its radii
    if (largest == 0) return true;
    if (least > 0) {
      throw DataError(line.where, "an obscuration is a ring (OBSC with a least radius of 0 is traced, a full disc)");
    }
    surface.obscured = std::max(surface.obscured, largest);
    return true;
  }
  surface.obscured = std::max(surface.obscured, least);
  if (largest > 0) {
    surface.semi_diameter = largest;
    surface.semi_diameter_is_an_edge = surface.has_aperture = true;
  }
  return true;
}

void note_zmx_operand(PrescriptionLine const& line, std::vector<std::string>& warnings) {
  std::string const& key = line[0];
  auto const note = [&](std::string const& what) { warnings.push_back(fmt::format("{}: {}", line.where, what)); };
  static std::set<std::string> const vignetting{"VDXN", "VDYN", "VCXN", "VCYN", "VANN", "VDXD", "VDYD", "VCXD", "VCYD"};
  if (vignetting.contains(key)) {
    if (any_but_zero(line)) note(key + ": vignetting factors are not used; the edges of the surfaces vignette");
  } else if (key == "COAT") {
    note("COAT: coatings take and give no light here; surfaces pass all of it");
  } else if (key == "ENVD") {
    // temperature, pressure, whether indices follow them
    if (line.size() > 3 && line[3] != "0" && (line.number(1) != 20 || line.number(2) != 1)) {
      throw DataError(line.where,
                      "indices are adjusted to an environment (ENVD; those of the catalogue are traced, at "
                      "20 degrees and 1 atmosphere); turn the adjustment off");
    }
  } else if (!is_harmless(key)) {
    note(fmt::format("operand {} is not known here and was passed over; check that it does not change the lens",
                     key.substr(0, 40)));
  }
}

}  // namespace gladstone
