#include "render/optics/prescription_readers/zmx_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline optics {
namespace {

/// Reads the aperture of the system. @param unit_of_length  [m]
void read_zmx_system_aperture(PrescriptionLine const& line, double unit_of_length, Prescription& result) {
  std::string const& key = line[0];
  using Kind = PrescribedAperture::Kind;
  if (key == "ENPD") result.aperture = {Kind::entrance_pupil, line.number(1) * unit_of_length};
  // the second value selects the meaning of the first
  bool const other_meaning = line.size() > 2 && line[2] == "1";
  if (key == "FNUM") result.aperture = {other_meaning ? Kind::working_f_number : Kind::f_number, line.number(1)};
  if (key == "OBNA") {
    double const value = line.number(1);
    result.aperture = {Kind::object_na, other_meaning ? std::sin(value * unit::degree) : value};
  }
  if (key == "FLOA") result.aperture = {};
  if (key == "ENPD" || key == "FNUM" || key == "OBNA" || key == "FLOA") result.aperture.where = line.where;
}

/// Reads fields and wavelengths of the system.
void read_fields_and_wavelengths(PrescriptionLine const& line, ZmxSystem& system) {
  std::string const& key = line[0];
  if (key == "FTYP" && line.integer(1) != 0) system.heights_at = line.where;
  if (key == "XFLN" || key == "XFLD") {
    if (line.has_nonzero_number()) system.across_at = line.where;
  }
  if (key == "YFLN" || key == "YFLD") {
    for (std::size_t i = 1; i < line.size(); ++i) {
      double const angle = line.number(i) * unit::degree;
      if (angle != 0 || system.fields.empty()) system.fields.push_back(angle);
    }
  }
  if (key == "WAVL") {
    for (std::size_t i = 1; i < line.size(); ++i) system.wavelengths.push_back({line.number(i), line.where});
  }
  if (key == "WAVM") {
    line.integer(1);
    system.wavelengths.push_back({line.number(2), line.where});
  }
  if (key == "PWAV") system.primary = line.integer(1);
}

}  // namespace

void read_zmx_system(PrescriptionLine const& line, ZmxSystem& system, Prescription& result) {
  std::string const& key = line[0];
  if (key == "MODE" && line.size() > 1 && line[1] != "SEQ") {
    throw DataError(ErrorCode::unsupported, line.where,
                    fmt::format("mode {} is not supported (sequential lenses, SEQ, are)", line[1]));
  }
  if (key == "NAME") {
    for (std::size_t i = 1; i < line.size(); ++i) result.title += (i > 1 ? " " : "") + line[i];
  }
  if (key == "UNIT") {
    static std::map<std::string, double> const lengths{
        {"MM", 1e-3}, {"CM", 1e-2}, {"IN", 25.4e-3}, {"METER", 1.0}, {"M", 1.0}};
    auto const found = line.size() > 1 ? lengths.find(upper_case(line[1])) : lengths.end();
    if (found == lengths.end())
      throw DataError(ErrorCode::unknown_choice, line.where,
                      "UNIT: the unit is missing or unknown; write MM, CM, IN or METER");
    system.unit = found->second;
  }
  read_zmx_system_aperture(line, system.unit, result);
  read_fields_and_wavelengths(line, system);
  if (key == "GCAT") result.catalogues.assign(line.words.begin() + 1, line.words.end());
}

void take_zmx_fields(ZmxSystem const& system, Prescription& result) {
  bool const any_along =
      std::any_of(system.fields.begin(), system.fields.end(), [](double angle) { return angle != 0; });
  if (system.heights_at.empty()) result.field_angles = system.fields;
  if (!system.heights_at.empty() && (any_along || !system.across_at.empty())) {
    result.warnings.push_back(
        {WarningCode::ignored, system.heights_at,
         "FTYP: field heights are not supported, the lens is evaluated on its axis only; give field angles (FTYP 0)"});
  } else if (!system.across_at.empty()) {
    result.warnings.push_back({WarningCode::ignored, system.across_at,
                               "XFLN: fields outside the y-z plane are ignored; give them along y (YFLN)"});
  }
}

}  // namespace gladstone::inline optics
