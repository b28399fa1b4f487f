#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "render/base/error.h"
#include "render/base/text_encoding.h"
#include "render/base/text_file.h"
#include "render/base/units.h"
#include "render/optics/even_asphere.h"
#include "render/optics/prescription_readers/lines.h"
#include "render/optics/prescription_readers/readers.h"
#include "render/optics/prescription_readers/zmx_apertures.h"

namespace gladstone {
namespace {

/// Block SURF of a file: the surface, and what COORDBRK makes of its parameters.
struct ZmxSurface {
  PrescribedSurface surface;
  std::string type = "STANDARD";
  bool has_glass = false, has_distance = false;
  std::map<int, double> parameters;  // lengths in the file's unit
};

class ZmxReader {
 public:
  explicit ZmxReader(std::string const& path) : path_(path) { result_.file = path; }

  void read_line(PrescriptionLine const& line) {
    if (line.words.empty()) return;
    std::string const& key = line[0];
    if (key == "SURF") {
      if (line.integer(1) != static_cast<int>(surfaces_.size())) {
        throw DataError(line.where, fmt::format("surface {} comes after {}; the file is damaged", line[1],
                                                static_cast<int>(surfaces_.size()) - 1));
      }
      surfaces_.emplace_back();
      surfaces_.back().surface.where = line.where;
    } else if (surfaces_.empty()) {
      read_system(line);
      note_zmx_operand(line, result_.warnings);
    } else if (!read_zmx_aperture(line, unit_, surfaces_.back().surface)) {
      read_surface(line, surfaces_.back());
      note_zmx_operand(line, result_.warnings);
    }
  }

  Prescription finish() {
    if (surfaces_.size() < 3) {
      throw DataError(path_,
                      "describes no lens (a .zmx file has blocks SURF: the object, the lens' surfaces, the image)");
    }
    check_image(surfaces_.back());
    result_.object_distance = surfaces_.front().surface.thickness;
    if (primary_ >= 1 && primary_ <= static_cast<int>(wavelengths_.size())) {
      result_.primary_wavelength = wavelengths_[static_cast<std::size_t>(primary_ - 1)];
    }
    take_fields();
    std::vector<CoordinateBreak> breaks;
    for (std::size_t i = 1; i + 1 < surfaces_.size(); ++i) {
      ZmxSurface& zmx = surfaces_[i];
      PrescribedSurface& surface = zmx.surface;
      if (zmx.type == "COORDBRK") {
        breaks.push_back(break_of(zmx));
        continue;
      }
      if (zmx.type == "EVENASPH") {
        surface.asphere.assign(EvenAsphere<double>::terms, 0.0);
        for (auto const& [i_parameter, value] : zmx.parameters) {
          if (value == 0) continue;
          if (i_parameter < 1 || i_parameter > EvenAsphere<double>::terms) {
            throw DataError(surface.where, fmt::format("EVENASPH has no parameter {}", i_parameter));
          }
          surface.asphere[static_cast<std::size_t>(i_parameter - 1)] = value / std::pow(unit_, 2 * i_parameter - 1);
        }
      }
      if (!zmx.has_glass) surface.after = {};
      surface.before = std::move(breaks);
      breaks.clear();
      result_.surfaces.push_back(surface);
    }
    break_before_image(result_, std::move(breaks), surfaces_.back().surface.where);
    return std::move(result_);
  }

 private:
  void read_system(PrescriptionLine const& line) {
    std::string const& key = line[0];
    if (key == "MODE" && line.size() > 1 && line[1] != "SEQ") {
      throw DataError(line.where, fmt::format("mode {} is not read (sequential lenses, SEQ, are)", line[1]));
    }
    if (key == "NAME") {
      for (std::size_t i = 1; i < line.size(); ++i) result_.title += (i > 1 ? " " : "") + line[i];
    }
    if (key == "UNIT") {
      static std::map<std::string, double> const lengths{
          {"MM", 1e-3}, {"CM", 1e-2}, {"IN", 25.4e-3}, {"METER", 1.0}, {"M", 1.0}};
      auto const found = line.size() > 1 ? lengths.find(line[1]) : lengths.end();
      if (found == lengths.end()) throw DataError(line.where, "UNIT names no known unit (MM, CM, IN or METER)");
      unit_ = found->second;
    }
    using Kind = PrescribedAperture::Kind;
    if (key == "ENPD") result_.aperture = {Kind::entrance_pupil, line.number(1) * unit_};
    // the second value says which of two meanings the first has
    bool const other_meaning = line.size() > 2 && line[2] == "1";
    if (key == "FNUM") result_.aperture = {other_meaning ? Kind::working_f_number : Kind::f_number, line.number(1)};
    if (key == "OBNA") {
      double const value = line.number(1);
      result_.aperture = {Kind::object_na, other_meaning ? std::sin(value * unit::degree) : value};
    }
    if (key == "FLOA") result_.aperture = {};
    if (key == "FTYP" && line.integer(1) != 0) heights_at_ = line.where;
    if (key == "XFLN" || key == "XFLD") {
      for (std::size_t i = 1; i < line.size(); ++i) {
        if (line.number(i) != 0) across_at_ = line.where;
      }
    }
    if (key == "YFLN" || key == "YFLD") {
      for (std::size_t i = 1; i < line.size(); ++i) {
        double const angle = line.number(i) * unit::degree;
        if (angle != 0 || fields_.empty()) fields_.push_back(angle);
      }
    }
    if (key == "WAVL") {
      for (std::size_t i = 1; i < line.size(); ++i) wavelengths_.push_back(line.number(i) * unit::micrometre);
    }
    if (key == "WAVM") {
      line.integer(1);
      wavelengths_.push_back(line.number(2) * unit::micrometre);
    }
    if (key == "PWAV") primary_ = line.integer(1);
  }

  /// Fields are angles in the y-z plane; others are told of, and left out.
  void take_fields() {
    bool const any_along = std::any_of(fields_.begin(), fields_.end(), [](double angle) { return angle != 0; });
    if (heights_at_.empty()) result_.field_angles = fields_;
    if (!heights_at_.empty() && (any_along || !across_at_.empty())) {
      result_.warnings.push_back(heights_at_ +
                                 ": FTYP: fields that are heights are not read, the lens is judged on its axis alone; "
                                 "give field angles (FTYP 0)");
    } else if (!across_at_.empty()) {
      result_.warnings.push_back(across_at_ +
                                 ": XFLN: fields beside the y-z plane are left out; give them along y (YFLN)");
    }
  }

  void read_surface(PrescriptionLine const& line, ZmxSurface& zmx) {
    PrescribedSurface& surface = zmx.surface;
    std::string const& key = line[0];
    if (key == "TYPE") {
      static std::vector<std::string> const known{"STANDARD", "EVENASPH", "COORDBRK"};
      zmx.type = line.size() > 1 ? line[1] : "";
      if (std::find(known.begin(), known.end(), zmx.type) == known.end()) {
        throw DataError(line.where, fmt::format("surface {}: type {} is not read (STANDARD, EVENASPH and COORDBRK are)",
                                                surfaces_.size() - 1, zmx.type));
      }
    }
    if (key == "STOP") surface.stop = true;
    if (key == "CURV") surface.curvature = line.number(1) / unit_;
    if (key == "CONI") surface.conic = line.number(1);
    if (key == "PARM") zmx.parameters[line.integer(1)] = line.number(2);
    if (key == "DISZ") {
      zmx.has_distance = true;
      bool const infinite = line.size() > 1 && line[1] == "INFINITY";
      surface.thickness = infinite ? std::numeric_limits<double>::infinity() : line.number(1) * unit_;
    }
    if (key == "DIAM" && line.number(1) > 0 && !surface.has_aperture) {
      surface.semi_diameter = line.number(1) * unit_;
      surface.semi_diameter_is_an_edge = line.size() > 2 && line.integer(2) != 0;
    }
    if (key == "GLAS") {
      if (line.size() < 2) throw DataError(line.where, "GLAS names no glass; the line is cut short");
      zmx.has_glass = true;
      bool const described = line[1] == "___BLANK" || (line.size() > 2 && line[2] == "1");
      if (line[1] == "MIRROR") {
        surface.after.is = PrescribedMedium::Mirror{};
      } else if (described && line.size() > 5) {
        double const nd = line.number(4), vd = line.number(5);
        if (!(nd >= 1 && nd < 5 && vd >= 0)) {
          throw DataError(line.where, fmt::format("GLAS: a model glass of nd = {:.6g}, Vd = {:.6g} is none (nd lies "
                                                  "between 1 and 5, Vd above 0); correct it or name a glass",
                                                  nd, vd));
        }
        if (line.size() > 6 && line.number(6) != 0) {
          result_.warnings.push_back(line.where +
                                     ": GLAS: the deviation of a model glass' partial dispersion is not used");
        }
        if (vd == 0) {  // as Zemax has it: without dispersion
          surface.after.is = PrescribedMedium::Index{nd};
        } else {
          surface.after.is = PrescribedMedium::Described{nd, vd};
        }
      } else {
        surface.after.is = PrescribedMedium::Named{line[1]};
      }
    }
    if (key == "XDAT" && line.size() > 2 && line.number(2) != 0) {
      throw DataError(line.where, "extra data (XDAT) change the surface and are not read");
    }
  }

  /// Refuses a last block that is no image surface: what the file goes on with is missing.
  static void check_image(ZmxSurface const& last) {
    char const* const why = !last.has_distance            ? "has no DISZ"
                            : last.surface.thickness != 0 ? "has a thickness (DISZ)"
                            : last.has_glass              ? "has glass behind it (GLAS)"
                            : last.surface.stop           ? "is the stop"
                            : last.type == "COORDBRK"     ? "is a coordinate break"
                                                          : nullptr;
    if (why == nullptr) return;
    throw DataError(last.surface.where,
                    fmt::format("the last surface {}, so it is no image surface, with which a .zmx file ends: the file "
                                "is cut short; get it whole, or add the image (SURF, TYPE STANDARD, DISZ 0)",
                                why));
  }

  CoordinateBreak break_of(ZmxSurface const& zmx) const {
    if (!std::isfinite(zmx.surface.thickness)) {
      throw DataError(zmx.surface.where, "the thickness of a coordinate break (DISZ) is infinite; give it a length");
    }
    auto const parameter = [&](int i) {
      auto const found = zmx.parameters.find(i);
      return found == zmx.parameters.end() ? 0.0 : found->second;
    };
    return {{parameter(1) * unit_, parameter(2) * unit_},
            Vec3d{parameter(3), parameter(4), parameter(5)} * unit::degree,
            parameter(6) != 0,
            zmx.surface.thickness};
  }

  std::string path_;
  Prescription result_;
  std::vector<ZmxSurface> surfaces_;
  std::vector<double> wavelengths_, fields_;
  double unit_ = 1e-3;
  int primary_ = 1;
  std::string heights_at_,
      across_at_;  // lines that say that fields are heights, and that some lie beside the y-z plane
};

}  // namespace

Prescription read_zmx_prescription(std::string const& path) {
  std::string const text = decoded_text(read_text_file(path), path);
  ZmxReader reader(path);
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    std::size_t const end = std::min(rest.find('\n'), rest.size());
    PrescriptionLine const line{fmt::format("{}:{}", path, number), quoted_words(rest.substr(0, end))};
    if (end == rest.size() && !line.words.empty() && line[0] == "DISZ") {
      throw DataError(line.where,
                      "the file ends within the line DISZ: it is cut short, or its last line lacks its end");
    }
    reader.read_line(line);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return reader.finish();
}

}  // namespace gladstone
