#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "render/base/error.h"
#include "render/base/text_encoding.h"
#include "render/base/text_file.h"
#include "render/base/units.h"
#include "render/optics/even_asphere.h"
#include "render/optics/prescription_readers/lines.h"
#include "render/optics/prescription_readers/readers.h"

namespace gladstone {
namespace {

/// Commands that say nothing about where rays go: weights, variables, solves whose values are written out, names.
bool is_harmless(std::string const& command) {
  static std::set<std::string> const harmless{"LEN", "INI", "WTW", "WTF", "CCY", "CCX", "THC", "GLC", "PIM", "DER",
                                              "GO",  "SLB", "KC",  "AC",  "BC",  "CC",  "DC",  "HC",  "POL", "WID",
                                              "RES", "WAV", "REM", "TEM", "PRE", "CA",  "CLS", "PIK", "THM", "CUM",
                                              "DDM", "FFO", "ADC", "BDC", "CDC", "XDC", "YDC", "ZDC", "CUC"};
  return harmless.contains(command);
}

std::string in_capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

class SeqReader {
 public:
  explicit SeqReader(std::string const& path) { result_.file = path; }

  void read_command(PrescriptionLine const& line) {
    std::string const command = in_capitals(line[0]);
    if (command == "SO" || command == "S" || command == "SI" || is_numbered_surface(command))
      return begin_surface(command, line);
    if (command == "RDM") {
      radii_ = line.size() < 2 || in_capitals(line[1]) != "N";
    } else if (command == "TITLE" || command == "TIT") {
      if (line.size() > 1) result_.title = line[1];
    } else if (command == "DIM") {
      static std::map<std::string, double> const units{{"M", 1e-3}, {"C", 1e-2}, {"I", 25.4e-3}};
      auto const found = line.size() > 1 ? units.find(in_capitals(line[1]).substr(0, 1)) : units.end();
      if (found == units.end()) throw DataError(line.where, "DIM names no known unit (M: mm, C: cm, I: inches)");
      unit_ = found->second;
    } else if (command == "EPD") {
      pupil_ = line.number(1);
      result_.aperture.kind = PrescribedAperture::Kind::entrance_pupil;
    } else if (command == "FNO") {
      result_.aperture = {PrescribedAperture::Kind::f_number, line.number(1)};
    } else if (command == "NAO") {
      result_.aperture = {PrescribedAperture::Kind::object_na, line.number(1)};
    } else if (command == "WL") {
      for (std::size_t i = 1; i < line.size(); ++i) wavelengths_.push_back(line.number(i) * unit::nanometre);
    } else if (command == "REF") {
      reference_ = line.integer(1);
    } else if (command == "YAN") {
      for (std::size_t i = 1; i < line.size(); ++i) result_.field_angles.push_back(line.number(i) * unit::degree);
    } else if (is_other_field(command)) {
      note_unless_zero(line, "fields are angles in the y-z plane (YAN) here; these are not judged");
    } else if (command == "VUX" || command == "VLX" || command == "VUY" || command == "VLY") {
      note_unless_zero(line, "vignetting factors are not used; the edges of the surfaces vignette");
    } else if (!read_surface_command(command, line) && !is_harmless(command)) {
      throw DataError(line.where,
                      fmt::format("command {} is not read; leave it out if it does not change the lens", line[0]));
    }
  }

  Prescription finish() {
    if (surfaces_.size() < 2) {
      throw DataError(result_.file,
                      "describes no lens (a .seq file has lines SO, S ..., SI: the object, the lens' "
                      "surfaces, the image)");
    }
    if (!image_) throw DataError(result_.file, "has no image surface SI; the file is cut short");
    result_.object_distance = surfaces_.front().thickness;
    if (result_.aperture.kind == PrescribedAperture::Kind::entrance_pupil) result_.aperture.value = pupil_ * unit_;
    result_.surfaces.assign(surfaces_.begin() + 1, surfaces_.end());
    break_before_image(result_, std::move(image_surface_.before), image_surface_.where);
    if (reference_ >= 1 && reference_ <= static_cast<int>(wavelengths_.size())) {
      result_.primary_wavelength = wavelengths_[static_cast<std::size_t>(reference_ - 1)];
    } else if (!wavelengths_.empty()) {
      result_.primary_wavelength = wavelengths_[wavelengths_.size() / 2];
    }
    return std::move(result_);
  }

 private:
  static bool is_numbered_surface(std::string const& command) {
    return command.size() > 1 && command.size() < 5 && command[0] == 'S' &&
           std::all_of(command.begin() + 1, command.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  }

  /// Field points that are no angles in the y-z plane.
  static bool is_other_field(std::string const& command) {
    static std::set<std::string> const other{"XAN", "XOB", "YOB", "XIM", "YIM", "XRI", "YRI"};
    return other.contains(command);
  }

  void note_unless_zero(PrescriptionLine const& line, char const* what) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      if (line.number(i) == 0) continue;
      result_.warnings.push_back(fmt::format("{}: {}: {}", line.where, in_capitals(line[0]), what));
      return;
    }
  }

  /// "S radius thickness [glass]"
  void begin_surface(std::string const& command, PrescriptionLine const& line) {
    if (image_) throw DataError(line.where, "a surface comes after the image SI; the file is damaged");
    if ((command == "SO") != surfaces_.empty()) {
      throw DataError(line.where, command == "SO" ? "a second object surface SO; the file is damaged"
                                                  : "the lens begins without its object surface SO");
    }
    double const first = line.number(1);
    double const thickness = line.size() > 2 ? line.number(2) * unit_ : 0.0;
    if (command == "SI") {
      image_ = true;
      image_surface_.where = line.where;
      surfaces_.back().thickness += thickness;  // the defocus of the image
      return;
    }
    PrescribedSurface surface;
    surface.where = line.where;
    surface.curvature = (radii_ ? (first == 0 ? 0.0 : 1 / first) : first) / unit_;
    surface.thickness = std::abs(thickness) > 1e10 * unit_ ? std::numeric_limits<double>::infinity() : thickness;
    if (line.size() > 3) surface.after = medium(line, line[3]);
    surfaces_.push_back(surface);
  }

  static PrescribedMedium medium(PrescriptionLine const& line, std::string const& word) {
    std::string const name = in_capitals(word);
    if (name == "AIR") return {};
    if (name == "REFL") return {PrescribedMedium::Mirror{}};
    // a fictitious glass, "517.642" or "517642": nd - 1 in thousandths and ten times Vd, or "1.5168:64.2"
    if (std::isdigit(static_cast<unsigned char>(name[0])) == 0) return {PrescribedMedium::Named{word}};
    auto const number = [&line](std::string const& text) {
      return PrescriptionLine{line.where, {"glass", text}}.number(1);
    };
    if (auto const colon = name.find(':'); colon != std::string::npos) {
      return {PrescribedMedium::Described{number(name.substr(0, colon)), number(name.substr(colon + 1))}};
    }
    auto const point = name.find('.');
    std::string const index = point == std::string::npos ? name.substr(0, name.size() / 2) : name.substr(0, point);
    std::string const abbe = point == std::string::npos ? name.substr(name.size() / 2) : name.substr(point + 1);
    if (index.empty() || abbe.size() < 2) throw DataError(line.where, fmt::format("\"{}\" is no glass", word));
    return {
        PrescribedMedium::Described{1 + number("0." + index), number(abbe.substr(0, 2) + '.' + abbe.substr(2) + '0')}};
  }

  /// The surface that a command names ("STO S6", counted from the object's S0), and the command without its name.
  PrescribedSurface& named_surface(PrescriptionLine& line) {
    if (line.size() > 1 && is_numbered_surface(in_capitals(line[1]))) {
      PrescriptionLine const digits{line.where, {line[0], line[1].substr(1)}};
      auto const number = static_cast<std::size_t>(digits.integer(1));
      if (number == 0 || number >= surfaces_.size()) {
        throw DataError(line.where,
                        fmt::format("{} {}: there is no such surface before this line (S1 to S{} are); correct the "
                                    "number, or put the command below its surface",
                                    line[0], line[1], surfaces_.size() - 1));
      }
      line.words.erase(line.words.begin() + 1);
      return surfaces_[number];
    }
    if (in_capitals(line[0]) == "STO" && line.size() > 1) {
      throw DataError(line.where, fmt::format("STO {}: names no surface; give its number (STO S6)", line[1]));
    }
    return image_ ? image_surface_ : surfaces_.back();
  }

  /// Commands that belong to the surface before them, or to the one that they name.
  bool read_surface_command(std::string const& command, PrescriptionLine line) {
    static std::set<std::string> const known{"STO", "K",   "CIR", "CON", "ASP", "SPH", "CYL", "XDE", "YDE", "ZDE",
                                             "ADE", "BDE", "CDE", "A",   "B",   "C",   "D",   "E",   "F",   "G"};
    if (!known.contains(command)) return false;
    if (surfaces_.empty()) throw DataError(line.where, fmt::format("{} comes before any surface", command));
    PrescribedSurface& surface = named_surface(line);
    if (command == "STO") {
      if (&surface == &image_surface_) throw DataError(line.where, "the image SI cannot be the stop; mark another one");
      surface.stop = true;
    }
    if (command == "K") surface.conic = line.number(1);
    if (command == "CYL") {
      throw DataError(line.where, "cylinders (CYL) are not read from CODE V files; write the lens as TOML");
    }
    if (command == "CIR") {
      std::string const kind = line.size() > 1 ? in_capitals(line[1]) : "";
      if (kind == "EDG") return true;  // for drawings
      if (kind == "HOL") {
        throw DataError(line.where, "holes (CIR HOL) are not read; remove the line to trace without it");
      }
      if (kind == "OBS") {
        surface.obscured = line.number(2) * unit_;
      } else {
        surface.semi_diameter = line.number(1) * unit_;
      }
    }
    if (command.size() == 1 && command[0] >= 'A' && command[0] <= 'G') {  // of r^4, r^6, ...
      int const term = command[0] - 'A' + 1;
      surface.asphere.resize(EvenAsphere<double>::terms, 0.0);
      surface.asphere[static_cast<std::size_t>(term)] = line.number(1) / std::pow(unit_, 2 * term + 1);
    }
    if (command.size() == 3 && command.ends_with("DE")) {
      if (surface.before.empty()) surface.before.emplace_back();
      CoordinateBreak& here = surface.before.back();
      double const value = line.number(1);
      if (command == "XDE") here.decentre.x = value * unit_;
      if (command == "YDE") here.decentre.y = value * unit_;
      if (command == "ZDE") throw DataError(line.where, "ZDE is not read; add the shift to the thickness before it");
      // CODE V turns left-handed about x and y, right-handed about z
      if (command == "ADE") here.tilt.x = -value * unit::degree;
      if (command == "BDE") here.tilt.y = -value * unit::degree;
      if (command == "CDE") here.tilt.z = value * unit::degree;
    }
    return true;
  }

  Prescription result_;
  std::vector<PrescribedSurface> surfaces_;  // the object first
  PrescribedSurface image_surface_;          // of which the frame counts
  std::vector<double> wavelengths_;
  double unit_ = 1e-3, pupil_ = 0;
  int reference_ = 0;
  bool radii_ = false, image_ = false;
};

/// Cuts a file into commands: lines end them, ";" too, "&" joins lines, "!" begins a comment, not within quotes.
void for_each_command(std::string_view text, std::function<void(std::string const&, int)> const& take) {
  std::string command;
  char quote = 0;
  int line = 1, begun_at = 1;
  auto const end_command = [&] {
    if (command.find_first_not_of(" \t") != std::string::npos) take(command, begun_at);
    command.clear();
    begun_at = line;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    if (c == '\n') {
      ++line;
      quote = 0;
      std::size_t const last = command.find_last_not_of(" \t");
      if (last != std::string::npos && command[last] == '&') {
        command.resize(last);
        command.push_back(' ');
        continue;
      }
      end_command();
    } else if (quote == 0 && c == ';') {
      end_command();
    } else if (quote == 0 && c == '!') {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else {
      if (quote == 0 && (c == '"' || c == '\'')) {
        quote = c;
      } else if (c == quote) {
        quote = 0;
      }
      command.push_back(c);
    }
  }
  end_command();
}

}  // namespace

Prescription read_seq_prescription(std::string const& path) {
  std::string const text = decoded_text(read_text_file(path), path);
  SeqReader reader(path);
  for_each_command(text, [&](std::string const& command, int line) {
    reader.read_command({fmt::format("{}:{}", path, line), quoted_words(command)});
  });
  return reader.finish();
}

}  // namespace gladstone
