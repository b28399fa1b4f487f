#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <utility>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/text_encoding.h"
#include "render/files/text_file.h"
#include "render/optics/prescription_readers/lines.h"
#include "render/optics/prescription_readers/readers.h"
#include "render/optics/prescription_readers/seq_commands.h"
#include "render/optics/prescription_readers/seq_surface.h"
#include "render/optics/prescription_readers/seq_system.h"

namespace gladstone::inline optics {
namespace {

class SeqReader {
 public:
  explicit SeqReader(std::string const& path) { result_.file = path; }

  void read_command(PrescriptionLine const& line) {
    if (line.words.empty()) return;
    std::string const command = upper_case(line[0]);
    if (!system_.private_glasses_where.empty()) {
      if (command == "SO" || command == "S" || command == "SI") refuse_missing_end();
      if (command == "END") {
        system_.private_glasses_where.clear();
      } else {
        private_glasses_.read(line);
      }
    } else if (command == "SO" || command == "S" || command == "SI" || is_numbered_surface(command)) {
      begin_surface(command, line);
    } else if (read_seq_system(command, line, system_, result_)) {
      return;
    } else if (is_unsupported_command(command)) {
      throw DataError(ErrorCode::unsupported, line.where,
                      fmt::format("command {} is not supported; remove it if it does not change the lens", line[0]));
    } else if (!read_of_surface(command, line) && !is_ignored_command(command)) {
      if (unknown_.empty()) unknown_where_ = line.where;
      if (std::find(unknown_.begin(), unknown_.end(), command) == unknown_.end()) {
        unknown_.push_back(command.substr(0, 40));
      }
    }
  }

  Prescription finish() {
    if (!system_.private_glasses_where.empty()) refuse_missing_end();
    if (surfaces_.size() < 2) {
      throw DataError(ErrorCode::missing_content, result_.file,
                      "describes no lens (a .seq file has lines SO, S ..., SI: the object, the lens' "
                      "surfaces, the image)");
    }
    if (!image_) {
      warn({WarningCode::incomplete, surfaces_.back().surface.where,
            "the file has no image surface SI behind this one, whose thickness is taken as the distance to the image; "
            "if the file was cut short, copy it again"});
    }
    if (!system_.radii_said) judge_curvatures();
    if (result_.aperture.kind == PrescribedAperture::Kind::entrance_pupil)
      result_.aperture.value = system_.pupil * system_.unit;
    PrescribedSurface const& object = surfaces_.front().surface;
    if (object.after.is_mirror())
      throw DataError(ErrorCode::invalid_value, object.where,
                      "the object is a mirror (REFL); name the medium ahead of the lens");
    result_.object_distance = object.thickness;
    result_.object_medium = resolved(object.after);
    take_surfaces();
    solve_paraxial_image();
    set_primary_wavelength(result_, system_.primary_wavelength(), unit::nanometre, "nm",
                           surfaces_.front().surface.where, "WL, REF");
    assume_stop(result_);
    assume_aperture(result_, "EPD, FNO, NAO");
    if (!unknown_.empty()) {
      bool const one = unknown_.size() == 1;
      warn({WarningCode::ignored, unknown_where_,
            fmt::format("{} {} {} unknown and {} ignored; check that {} not change the lens",
                        one ? "command" : "commands", fmt::join(unknown_, ", "), one ? "is" : "are",
                        one ? "was" : "were", one ? "it does" : "they do")});
    }
    return std::move(result_);
  }

 private:
  static bool is_numbered_surface(std::string const& command) {
    return command.size() > 1 && command.size() < 5 && command[0] == 'S' &&
           std::all_of(command.begin() + 1, command.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  }

  [[noreturn]] void refuse_missing_end() const {
    throw DataError(ErrorCode::syntax, system_.private_glasses_where,
                    "PRV: the list of private glasses that begins here has no END; put END behind the last glass");
  }

  /// Applies PIM: the image is at the paraxial image plus the defocus of SI, whatever the last thickness is. Behind a
  /// coordinate break, the thickness of the file is used.
  void solve_paraxial_image() {
    if (system_.paraxial_image_where.empty()) return;
    if (result_.ends_at_image) {
      warn({WarningCode::ignored, system_.paraxial_image_where,
            "PIM: the image is behind a decentre or tilt; the last thickness of the file is used"});
      return;
    }
    result_.surfaces.back().thickness = 0;
    if (std::isfinite(image_defocus_)) result_.defocus = image_defocus_;
  }

  void warn(Warning warning) { result_.warnings.push_back(std::move(warning)); }

  /// Adds the surface that starts with the line "S radius thickness [glass]".
  void begin_surface(std::string const& command, PrescriptionLine const& line) {
    if (image_)
      throw DataError(ErrorCode::damaged, line.where,
                      "a surface follows the image SI; the file is damaged, copy it again");
    if ((command == "SO") != surfaces_.empty()) {
      throw DataError(ErrorCode::damaged, line.where,
                      command == "SO" ? "a second object surface SO; the file is damaged, copy it again"
                                      : "the lens begins without its object surface SO");
    }
    double const first = line.number_or_infinity(1);
    double const thickness = line.size() > 2 ? line.number_or_infinity(2) * system_.unit : 0.0;
    if (command == "SI") {
      image_ = true;
      image_surface_.surface.where = line.where;
      surfaces_.back().surface.thickness += thickness;  // add the defocus of the image
      image_defocus_ = thickness;
      return;
    }
    SeqSurface seq;
    seq.surface.where = line.where;
    seq.surface.curvature = curvature_of(first, system_.radii);
    bool const endless = std::abs(thickness) > 1e10 * system_.unit;
    seq.surface.thickness = endless ? std::copysign(HUGE_VAL, thickness) : thickness;
    if (line.size() > 3) seq.surface.after = medium(line, 3);
    surfaces_.push_back(std::move(seq));
  }

  double curvature_of(double value, bool is_radius) const {
    if (std::isinf(value) || value == 0) return 0;
    return (is_radius ? 1 / value : value) / system_.unit;
  }

  /// Parses word i of a line as a medium.
  static PrescribedMedium medium(PrescriptionLine const& line, std::size_t i) {
    std::string const name = upper_case(line[i]);
    if (name.empty() || name == "AIR") return {};
    if (name == "REFL") return {PrescribedMedium::Mirror{}, line.where};
    if (auto const code = read_glass_code(name)) return {code->is, line.where};
    return {PrescribedMedium::Named{line[i], std::nullopt}, line.where};
  }

  /// Returns the private glass that a medium names, if there is one, else the medium itself.
  PrescribedMedium resolved(PrescribedMedium const& medium) const {
    auto const* const named = std::get_if<PrescribedMedium::Named>(&medium.is);
    Glass const* const own = named ? private_glasses_.find(upper_case(named->glass)) : nullptr;
    return own ? PrescribedMedium{PrescribedMedium::Private{*own}, medium.where} : medium;
  }

  /// Returns the surface named by a command ("STO S6"; the object is S0), by default the latest one, and removes its
  /// name from the line.
  SeqSurface& named_surface(PrescriptionLine& line) {
    if (line.size() > 1 && is_numbered_surface(upper_case(line[1]))) {
      PrescriptionLine const digits{line.where, {line[0], line[1].substr(1)}};
      auto const number = static_cast<std::size_t>(digits.integer(1));
      if (number == 0 || number >= surfaces_.size()) {
        throw DataError(ErrorCode::invalid_value, line.where,
                        fmt::format("{} {}: this surface does not precede this line (S1 to S{} do); "
                                    "correct the number, or put the command below its surface",
                                    line[0], line[1], surfaces_.size() - 1));
      }
      line.words.erase(line.words.begin() + 1);
      return surfaces_[number];
    }
    if (upper_case(line[0]).starts_with("STO") && line.size() > 1) {
      PrescriptionLine const number{line.where, {line[0], "S" + line[1]}};
      if (is_numbered_surface(number[1])) {  // the surface is given by its number, "stop 2"
        line.words[1] = number[1];
        return named_surface(line);
      }
      throw DataError(ErrorCode::syntax, line.where,
                      fmt::format("STO {}: names no surface; give its number (STO S6)", line[1]));
    }
    return image_ ? image_surface_ : surfaces_.back();
  }

  /// Reads a command for the surface it names, by default the latest one. @return false if it is not such a command
  bool read_of_surface(std::string const& command, PrescriptionLine line) {
    if (!is_surface_command(command)) return false;
    if (surfaces_.empty())
      throw DataError(ErrorCode::syntax, line.where, fmt::format("{} comes before any surface", command));
    SeqSurface& seq = named_surface(line);
    if (command == "THI" || command == "RDY" || command == "CUY" || command == "GLA") {
      change_surface(command, line, seq.surface);
      return true;
    }
    return read_seq_surface(command, line, system_.unit, &seq == &image_surface_, seq, result_.warnings);
  }

  static bool is_surface_command(std::string const& command) {
    static std::set<std::string> const known{"STO", "STOP", "K",   "CIR", "REX", "REY", "ELX", "ELY", "ADX",
                                             "ADY", "ARO",  "XDE", "YDE", "ZDE", "ADE", "BDE", "CDE", "DAR",
                                             "BEN", "REV",  "CUF", "RMD", "THI", "RDY", "CUY", "GLA", "A",
                                             "B",   "C",    "D",   "E",   "F",   "G",   "H",   "J"};
    return known.contains(command);
  }

  /// Changes one value of a surface ("THI S3 2.5"). A word instead of a number is a solve, whose value is in the line
  /// of the surface.
  void change_surface(std::string const& command, PrescriptionLine const& line, PrescribedSurface& surface) const {
    if (line.size() < 2) return;
    if (command == "GLA") {
      surface.after = medium(line, 1);
    } else if (std::isalpha(static_cast<unsigned char>(line[1][0])) != 0 && upper_case(line[1]) != "INF") {
      return;
    } else if (command == "THI") {
      surface.thickness = line.number_or_infinity(1) * system_.unit;
    } else {
      surface.curvature = curvature_of(line.number_or_infinity(1), command == "RDY");
    }
  }

  /// Decides whether a file without RDM contains radii instead of curvatures, CODE V's default. Radii are assumed if
  /// more than half of the curvatures are implausible: the radius of curvature would be smaller than the pupil radius,
  /// or than a quarter of the adjacent glass thickness (half of it for a ball lens).
  void judge_curvatures() {
    double const pupil =
        result_.aperture.kind == PrescribedAperture::Kind::entrance_pupil ? system_.pupil * system_.unit / 2 : 0;
    int curved = 0, impossible = 0;
    for (std::size_t i = 1; i < surfaces_.size(); ++i) {
      PrescribedSurface const& surface = surfaces_[i].surface;
      if (surface.curvature == 0) continue;
      PrescribedSurface const& before = surfaces_[i - 1].surface;
      auto const glass = [](PrescribedSurface const& s) {
        return s.after.is_air() || s.after.is_mirror() || !std::isfinite(s.thickness) ? 0 : std::abs(s.thickness);
      };
      double const least = std::max(pupil, std::max(glass(surface), glass(before)) / 4);
      ++curved;
      impossible += 1 / std::abs(surface.curvature) < least ? 1 : 0;
    }
    if (2 * impossible <= curved) return;
    for (std::size_t i = 1; i < surfaces_.size(); ++i) {
      PrescribedSurface& surface = surfaces_[i].surface;
      surface.curvature = curvature_of(surface.curvature * system_.unit, true);
    }
    warn({WarningCode::assumed, surfaces_[1].surface.where,
          "the file has no RDM, so that its numbers would be curvatures, CODE V's default; surfaces with such "
          "curvatures would be narrower than the beam, so the numbers are taken as radii (write RDM, or RDM N for "
          "curvatures)"});
  }

  /// Moves the surfaces, with their coordinate breaks and that of the image, to the result.
  void take_surfaces() {
    std::vector<CoordinateBreak> behind;
    auto const breaks_ahead = [&behind](SeqSurface const& seq) {
      std::vector<CoordinateBreak> breaks = std::exchange(behind, {});
      std::vector<CoordinateBreak> const own = seq.breaks_before();
      breaks.insert(breaks.end(), own.begin(), own.end());
      return breaks;
    };
    for (std::size_t i = 1; i < surfaces_.size(); ++i) {
      SeqSurface& seq = surfaces_[i];
      finish_seq_surface(seq, system_.unit, result_.warnings);
      PrescribedSurface surface = seq.surface;
      surface.after = resolved(surface.after);
      surface.before = breaks_ahead(seq);
      behind = seq.breaks_behind();
      if (!behind.empty()) behind.back().advance += std::exchange(surface.thickness, 0);
      result_.surfaces.push_back(std::move(surface));
    }
    break_before_image(result_, breaks_ahead(image_surface_), image_surface_.surface.where);
  }

  Prescription result_;
  SeqSystem system_;
  std::vector<SeqSurface> surfaces_;  // surfaces of the file; the first one is the object
  SeqSurface image_surface_;          // image SI, of which only the coordinate frame is used
  PrivateGlasses private_glasses_;
  std::vector<std::string> unknown_;  // unknown commands
  std::string unknown_where_;
  double image_defocus_ = 0;
  bool image_ = false;
};

}  // namespace

Prescription read_seq_prescription(std::string const& path) {
  std::string const text = decoded_text(read_text_file(path), path);
  SeqReader reader(path);
  for_each_command(text, [&](std::string const& command, int line) {
    reader.read_command({fmt::format("{}:{}", path, line), quoted_words(command)});
  });
  return reader.finish();
}

}  // namespace gladstone::inline optics
