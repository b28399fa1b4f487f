#include "render/optics/prescription_readers/seq_system.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline optics {
namespace {

/// Warns that a command has no effect, unless all its numbers are 0.
void note_unless_zero(PrescriptionLine const& line, char const* what, Prescription& result) {
  if (line.has_nonzero_number())
    result.warnings.push_back({WarningCode::ignored, line.where, fmt::format("{}: {}", upper_case(line[0]), what)});
}

/// Reads field angles in the y-z plane; other fields cause a warning. @return false if it is not a field command
bool read_seq_fields(std::string const& command, PrescriptionLine const& line, Prescription& result) {
  static std::set<std::string> const others{"XAN", "XOB", "YOB", "XIM", "YIM", "XRI", "YRI"};
  static std::set<std::string> const vignetting{"VUX", "VLX", "VUY", "VLY"};
  if (command == "YAN") {
    for (std::size_t i = 1; i < line.size(); ++i) result.field_angles.push_back(line.number(i) * unit::degree);
  } else if (others.contains(command)) {
    note_unless_zero(line, "only field angles in the y-z plane (YAN) are supported; these fields are ignored", result);
  } else if (vignetting.contains(command)) {
    note_unless_zero(line, "vignetting factors are not used; the edges of the surfaces vignette", result);
  } else {
    return false;
  }
  return true;
}

/// Reads a command of aperture, wavelengths, units, title or environment. @return false if it is not such a command
bool read_seq_commands(std::string const& command, PrescriptionLine const& line, SeqSystem& system,
                       Prescription& result) {
  using Kind = PrescribedAperture::Kind;
  if (command == "RDM") {
    system.radii = line.size() < 2 || upper_case(line[1]) != "N";
    system.radii_said = true;
  } else if (command == "TITLE" || command == "TIT") {
    if (line.size() > 1) result.title = line[1];
  } else if (command == "DIM") {
    static std::map<std::string, double> const units{{"M", 1e-3}, {"C", 1e-2}, {"I", 25.4e-3}};
    auto const found = line.size() > 1 ? units.find(upper_case(line[1]).substr(0, 1)) : units.end();
    if (found == units.end())
      throw DataError(ErrorCode::unknown_choice, line.where,
                      "DIM: the unit is missing or unknown; write M (mm), C (cm) or I (inches)");
    system.unit = found->second;
  } else if (command == "EPD") {
    system.pupil = line.number(1);
    result.aperture = {Kind::entrance_pupil, 0, line.where};
  } else if (command == "FNO") {
    result.aperture = {Kind::f_number, line.number(1), line.where};
  } else if (command == "NAO") {
    result.aperture = {Kind::object_na, line.number(1), line.where};
  } else if (command == "WL") {
    for (std::size_t i = 1; i < line.size(); ++i) system.wavelengths.push_back({line.number(i), line.where});
  } else if (command == "REF") {
    system.reference = line.integer(1);
  } else if (command == "PRV") {
    system.private_glasses_where = line.where;
  } else if (command == "PIM") {
    system.paraxial_image_where = line.where;
  } else if (command == "TEM" || command == "PRE") {
    double const standard = command == "TEM" ? 20 : 760;  // [degC], [mmHg]
    if (line.size() > 1 && line.number(1) != standard) {
      result.warnings.push_back({WarningCode::ignored, line.where,
                                 fmt::format("{}: indices are not adjusted to the temperature or pressure; the "
                                             "catalogue's indices, at 20 degrees C and 760 mmHg, are used",
                                             command)});
    }
  } else if (command == "ZOO") {
    result.warnings.push_back(
        {WarningCode::ignored, line.where, "ZOO: only the zoom position stored in the surfaces is read"});
  } else {
    return false;
  }
  return true;
}

}  // namespace

ListedWavelength const* SeqSystem::primary_wavelength() const {
  if (wavelengths.empty()) return nullptr;
  auto const count = static_cast<int>(wavelengths.size());
  int const at = reference >= 1 && reference <= count ? reference - 1 : count / 2;
  return &wavelengths[static_cast<std::size_t>(at)];
}

bool read_seq_system(std::string const& command, PrescriptionLine const& line, SeqSystem& system,
                     Prescription& result) {
  return read_seq_commands(command, line, system, result) || read_seq_fields(command, line, result);
}

}  // namespace gladstone::inline optics
