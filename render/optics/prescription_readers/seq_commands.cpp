#include "render/optics/prescription_readers/seq_commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline optics {

void for_each_command(std::string_view text, std::function<void(std::string const& command, int line)> const& take) {
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

bool is_ignored_command(std::string const& command) {
  static std::set<std::string> const harmless{
      "LEN", "INI", "WTW", "WTF", "CCY", "CCX", "THC", "GLC", "DER", "GO",  "SLB", "KC",  "AC",  "BC",  "CC",  "DC",
      "HC",  "POL", "WID", "RES", "WAV", "REM", "CA",  "CLS", "PIK", "THM", "CUM", "DDM", "FFO", "ADC", "BDC", "CDC",
      "XDC", "YDC", "ZDC", "CUC", "RDC", "EC",  "FC",  "GC",  "JC",  "GCE", "SPH", "CON", "ASP", "COM", "COL"};
  return harmless.contains(command);
}

bool is_unsupported_command(std::string const& command) {
  static std::set<std::string> const refused{
      "GRT", "GRO", "GRS", "GRX", "GRY", "GRZ", "DIF", "HOE", "HOR", "HWL", "HCT", "HCO", "HV1", "HV2", "HX1",
      "HY1", "HZ1", "HX2", "HY2", "HZ2", "NSS", "NSC", "SPS", "SPL", "UDS", "UD1", "UD2", "CYL", "YTO", "XTO",
      "AAS", "ZRN", "CUX", "RDX", "KX",  "FRN", "GRI", "GRC", "BIR", "RET", "GLB", "LAR", "MLN", "BRF", "ARR"};
  return refused.contains(command);
}

void PrivateGlasses::read(PrescriptionLine const& line) {
  if (upper_case(line[0]) == "PWL") {
    wavelengths_.clear();
    for (std::size_t i = 1; i < line.size(); ++i) {
      double const wavelength = line.number(i) * unit::nanometre;
      std::string const fault = describe_wavelength_fault(line.number(i), unit::nanometre, "nm");
      if (!fault.empty())
        throw DataError(ErrorCode::out_of_range, line.where,
                        fmt::format("PWL: a wavelength of {} nm {}", line[i], fault));
      if (std::find(wavelengths_.begin(), wavelengths_.end(), wavelength) != wavelengths_.end()) {
        throw DataError(ErrorCode::invalid_value, line.where,
                        fmt::format("PWL: {} nm is given twice; remove one", line[i]));
      }
      wavelengths_.push_back(wavelength);
    }
    return;
  }
  std::string const name = upper_case(line[0]);
  bool const formula = line.size() > 1 && std::isalpha(static_cast<unsigned char>(line[1][0])) != 0;
  if (formula) {
    if (upper_case(line[1]) != "LAU") {
      throw DataError(
          ErrorCode::unsupported, line.where,
          fmt::format("glass {}: formula {} is not supported (LAU, and indices at the wavelengths of PWL, are)",
                      line[0], line[1]));
    }
    Glass glass;
    glass.name = line[0];
    glass.formula = DispersionFormula::schott;
    for (std::size_t i = 2; i < line.size(); ++i) glass.coefficients.push_back(line.number(i));
    glass.shortest = 0.3e-6;
    glass.longest = 2.5e-6;
    glasses_[name] = std::move(glass);
    return;
  }
  std::vector<Glass::Sample> samples;
  if (line.size() > 1 && line.size() != wavelengths_.size() + 1) {
    throw DataError(ErrorCode::wrong_shape, line.where,
                    fmt::format("glass {} has {} indices for {} wavelengths of PWL; give one for each wavelength, and "
                                "end the glasses by END",
                                line[0], line.size() - 1, wavelengths_.size()));
  }
  for (std::size_t i = 1; i < line.size(); ++i) {
    samples.push_back({wavelengths_[i - 1], line.number(i)});
  }
  if (samples.empty()) {
    throw DataError(ErrorCode::missing_content, line.where,
                    fmt::format("glass {} has no index (PRV has a line PWL of wavelengths, and for each glass "
                                "as many indices)",
                                line[0]));
  }
  for (Glass::Sample const& sample : samples) {
    if (sample.index > 0.99 && sample.index < 7) continue;
    throw DataError(ErrorCode::out_of_range, line.where,
                    fmt::format("glass {} has an index of {:.6g}; correct it", line[0], sample.index));
  }
  glasses_[name] = Glass::from_samples(line[0], std::move(samples));
}

Glass const* PrivateGlasses::find(std::string const& name) const {
  auto const found = glasses_.find(name);
  return found == glasses_.end() ? nullptr : &found->second;
}

}  // namespace gladstone::inline optics
