#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/text_encoding.h"
#include "render/files/text_file.h"
#include "render/optics/prescription_readers/lines.h"
#include "render/optics/prescription_readers/readers.h"
#include "render/optics/prescription_readers/zmx_apertures.h"
#include "render/optics/prescription_readers/zmx_surface.h"
#include "render/optics/prescription_readers/zmx_system.h"

namespace gladstone::inline optics {
namespace {

/// Number of a surface, which other programs also write as 3.5 or 5AS: a number and a suffix.
struct SurfaceNumber {
  double number = 0;
  std::string suffix;

  auto operator<=>(SurfaceNumber const&) const = default;
  bool is_whole() const { return suffix.empty() && number == std::floor(number); }
};

/// Reads the number of a line SURF. @throws DataError
SurfaceNumber surface_number(PrescriptionLine const& line) {
  std::string const word = line.size() > 1 ? line[1] : "";
  SurfaceNumber read;
  char const* const end_of_word = word.data() + word.size();
  auto const [end, error] = std::from_chars(word.data(), end_of_word, read.number, std::chars_format::fixed);
  if (error != std::errc() || !std::isfinite(read.number)) return {line.number(1), ""};
  read.suffix.assign(end, end_of_word);
  return read;
}

/// Returns true if the words of an operand are numbers, except for the first.
bool has_numbers(std::string const& key) {
  static std::set<std::string> const numeric{"ENPD", "FNUM", "OBNA", "XFLN", "YFLN", "XFLD", "YFLD", "WAVL",
                                             "WAVM", "CURV", "CONI", "PARM", "XDAT", "DISZ", "DIAM", "GLAS",
                                             "CLAP", "FLAP", "OBSC", "SQAP", "SQOB", "ELAP", "ELOB", "OBDC"};
  return numeric.contains(key);
}

class ZmxReader {
 public:
  explicit ZmxReader(std::string const& path) : path_(path) { result_.file = path; }

  void read_line(PrescriptionLine line) {
    if (line.words.empty()) return;
    std::string const& key = line[0];
    if (has_numbers(key)) replace_commas(line);
    if (key == "SURF") {
      numbers_.push_back(surface_number(line));
      surfaces_.emplace_back();
      surfaces_.back().label = line[1].substr(0, 40);
      surfaces_.back().surface.where = line.where;
    } else if (surfaces_.empty()) {
      read_zmx_system(line, system_, result_);
      notes_.read(line);
    } else if (!read_zmx_aperture(line, system_.unit, surfaces_.back().apertures, result_.warnings)) {
      read_zmx_surface(line, system_.unit, surfaces_.back(), result_.warnings);
      notes_.read(line);
    }
  }

  /// Warns that the file ends within a line DISZ, and may be truncated.
  void note_end(PrescriptionLine const& line) {
    result_.warnings.push_back(
        {WarningCode::incomplete, line.where,
         "the file ends within its line DISZ, without a line end; if it was cut short there, copy it again"});
  }

  Prescription finish() {
    note_commas();
    if (!surfaces_.empty()) check_order();
    if (surfaces_.size() < 3) {
      throw DataError(ErrorCode::missing_content, path_,
                      "describes no lens (a .zmx file has blocks SURF: the object, the lens' surfaces, the image)");
    }
    if (object_assumed_ && why_no_image(surfaces_.back())) {
      surfaces_.emplace_back();
      surfaces_.back().surface.where = path_;
    } else {
      check_image(surfaces_.back());
    }
    PrescribedSurface const& object = surfaces_.front().surface;
    if (object.after.is_mirror())
      throw DataError(ErrorCode::invalid_value, object.where,
                      "the object is a mirror (GLAS); name the medium ahead of the lens");
    result_.object_distance = object.thickness;
    result_.object_medium = object.after;
    bool const is_listed = system_.primary >= 1 && system_.primary <= static_cast<int>(system_.wavelengths.size());
    set_primary_wavelength(result_,
                           is_listed ? &system_.wavelengths[static_cast<std::size_t>(system_.primary - 1)] : nullptr,
                           unit::micrometre, "um", surfaces_.front().surface.where, "WAVM, PWAV");
    take_zmx_fields(system_, result_);
    take_surfaces();
    assume_stop(result_);
    assume_aperture(result_, "ENPD, FNUM, OBNA");
    Warnings const notes = notes_.warnings();
    result_.warnings.insert(result_.warnings.end(), notes.begin(), notes.end());
    return std::move(result_);
  }

 private:
  /// Converts the blocks between object and image to the surfaces of the lens.
  void take_surfaces() {
    std::vector<CoordinateBreak> breaks;
    for (std::size_t i = 1; i + 1 < surfaces_.size(); ++i) {
      ZmxSurface const& zmx = surfaces_[i];
      PrescribedSurface surface;
      if (zmx.type == "COORDBRK") {
        breaks.push_back(break_of(zmx, system_.unit));
        if (!zmx.surface.stop) continue;
        surface.where = zmx.surface.where;  // a stop surface may be in the transformed frame
        surface.stop = true;
        surface.semi_diameter = zmx.surface.semi_diameter;
        surface.thickness = std::exchange(breaks.back().advance, 0);
      } else {
        surface = shaped_surface(zmx, system_.unit, result_.warnings);
      }
      surface.before = std::exchange(breaks, {});
      result_.surfaces.push_back(std::move(surface));
    }
    PrescribedSurface const& image = surfaces_.back().surface;
    if (image.curvature != 0) {
      result_.warnings.push_back(
          {WarningCode::ignored, image.where, "the image is curved; the lens is evaluated on a plane"});
    }
    break_before_image(result_, std::move(breaks), image.where);
  }

  void replace_commas(PrescriptionLine& line) {
    std::string const number = replace_decimal_commas(line.words);
    if (number.empty()) return;
    if (comma_lines_.empty()) first_comma_ = number;
    comma_lines_.push_back(line.where);
  }

  /// Warns of decimal commas, with the first line that has one.
  void note_commas() {
    if (comma_lines_.empty()) return;
    result_.warnings.push_back(
        {WarningCode::assumed, comma_lines_.front(),
         fmt::format("numbers with a comma, such as \"{}\", are read with a decimal point (lines of this kind: {})",
                     first_comma_, comma_lines_.size())});
  }

  /// Checks the numbers of the surfaces. Surfaces are read in the order of the file if their numbers increase, with a
  /// warning if they are not consecutive, or if they decrease to 1, as in files of lenses reversed by hand. Adds the
  /// object if the file omits it.
  /// @throws DataError for any other order
  void check_order() {
    constexpr std::size_t fewest_reversed = 3;  // fewer surfaces whose numbers decrease may just have been exchanged by
                                                // mistake
    auto const find_fault = [this](auto const& compare) {
      return std::adjacent_find(numbers_.begin(), numbers_.end(),
                                [&](auto const& a, auto const& b) { return !compare(a, b); });
    };
    auto const fault = find_fault(std::less<>{});
    bool const reversed = numbers_.size() >= fewest_reversed && numbers_.back() == SurfaceNumber{1, ""} &&
                          find_fault(std::greater<>{}) == numbers_.end();
    std::string const first = surfaces_.front().surface.where;
    if (fault != numbers_.end() && !reversed) {
      auto const i = static_cast<std::size_t>(fault - numbers_.begin());
      throw DataError(
          ErrorCode::damaged, surfaces_[i + 1].surface.where,
          fmt::format("surface {} comes after {}; the file is damaged", surfaces_[i + 1].label, surfaces_[i].label));
    }
    if (reversed) {
      result_.warnings.push_back(
          {WarningCode::assumed, first,
           fmt::format("the surfaces are numbered backwards, from {} to 1; they are read in the order of the file",
                       surfaces_.front().label)});
    } else {
      if (numbers_.front().number != 0 && numbers_.front().number != 1) {
        throw DataError(
            ErrorCode::damaged, first,
            fmt::format("the first surface is {}, not the object 0; the file is damaged", surfaces_.front().label));
      }
      note_gaps();
    }
    if (numbers_.front().number != 0) assume_object(first);
  }

  /// Warns of surfaces that are not numbered consecutively.
  void note_gaps() {
    std::vector<std::string> steps;
    std::string where;
    for (std::size_t i = 1; i < numbers_.size(); ++i) {
      bool const gap = numbers_[i].number > std::floor(numbers_[i - 1].number) + 1;
      if (!gap && numbers_[i].is_whole()) continue;
      if (steps.empty()) where = surfaces_[i].surface.where;
      steps.push_back(fmt::format("{} after {}", surfaces_[i].label, surfaces_[i - 1].label));
    }
    if (steps.empty()) return;
    result_.warnings.push_back({WarningCode::assumed, where,
                                fmt::format("surfaces are not numbered consecutively ({}); they are read in the order "
                                            "of the file; check that no surface is missing",
                                            fmt::join(steps, ", "))});
  }

  /// Assumes an object at infinity if the file contains the surfaces of the lens only.
  void assume_object(std::string const& where) {
    object_assumed_ = true;
    result_.warnings.push_back({WarningCode::assumed, where,
                                "the file has no surface 0, the object, which is taken at infinity; its last surface "
                                "is the image only if it has no thickness"});
    ZmxSurface object;
    object.surface.where = where;
    object.surface.thickness = HUGE_VAL;
    surfaces_.insert(surfaces_.begin(), std::move(object));
  }

  /// Returns the reason why a block cannot be the image surface, or null if it can.
  static char const* why_no_image(ZmxSurface const& last) {
    return !last.has_distance            ? "has no DISZ"
           : last.surface.thickness != 0 ? "has a thickness (DISZ)"
           : last.surface.stop           ? "is the stop"
           : last.type == "COORDBRK"     ? "is a coordinate break"
                                         : nullptr;
  }

  /// Throws a DataError if the last block cannot be the image surface, since the file is truncated then.
  static void check_image(ZmxSurface const& last) {
    char const* const why = why_no_image(last);
    if (why == nullptr) return;
    throw DataError(ErrorCode::damaged, last.surface.where,
                    fmt::format("the last surface {}, so it is not the image surface with which a .zmx file ends: the "
                                "file is cut short; copy it again, or add the image (SURF, TYPE STANDARD, DISZ 0)",
                                why));
  }

  std::string path_;
  Prescription result_;
  ZmxSystem system_;
  std::vector<ZmxSurface> surfaces_;
  std::vector<SurfaceNumber> numbers_;  // numbers of the surfaces in the file
  std::vector<std::string> comma_lines_;
  std::string first_comma_;  // first number with a decimal comma
  ZmxNotes notes_;
  bool object_assumed_ = false;
};

}  // namespace

Prescription read_zmx_prescription(std::string const& path) {
  std::string const text = decoded_text(read_text_file(path), path);
  ZmxReader reader(path);
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    std::size_t const end = std::min(rest.find('\n'), rest.size());
    PrescriptionLine const line{fmt::format("{}:{}", path, number), quoted_words(rest.substr(0, end))};
    reader.read_line(line);
    if (end == rest.size() && !line.words.empty() && line[0] == "DISZ") reader.note_end(line);
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return reader.finish();
}

}  // namespace gladstone::inline optics
