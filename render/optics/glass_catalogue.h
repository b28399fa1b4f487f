#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/optics/glass.h"

namespace gladstone {

/// Result of a search for a glass name.
struct GlassMatch {
  Glass const* glass;
  std::vector<std::string> notes;  ///< warnings about assumptions that were made
};

/// Collection of glasses from one or more catalogues, searchable by name.
class GlassCatalogue {
 public:
  /// Returns the catalogues shipped with the program: the files of data/glasses, which are compiled in.
  static GlassCatalogue const& shipped();

  /// Adds a catalogue in AGF format. Reads the lines NM (name, number of the formula, nd), CD (coefficients), LD (range
  /// of wavelengths, um) and IT (internal transmittance: um, transmittance, mm). Lines that contain only numbers
  /// continue the previous line. Unusable glasses (invalid number, unknown formula, implausible index) are skipped with
  /// a warning.
  /// @param text       content in UTF-8
  /// @param catalogue  name of the catalogue
  /// @param file       file name for messages
  /// @throws DataError with file and line if no glass is usable
  void add(std::string_view text, std::string const& catalogue, std::string const& file);
  /// Adds a catalogue from a file in any encoding supported by decoded_text(), under the file's name.
  void add_file(std::string const& path);

  std::vector<Glass> const& glasses() const { return glasses_; }
  /// Warnings about skipped glasses and lines of all added catalogues.
  std::vector<std::string> const& warnings() const { return warnings_; }

  /// Returns the glass with the given name, ignoring case and hyphens. "CATALOGUE:NAME" selects a catalogue, as does
  /// CODE V's "NAME_CATALOGUE" if no glass has the complete name. If several catalogues contain the name, they are
  /// ranked: `preferred` in its order, then SCHOTT, OHARA, HOYA, HIKARI, NIKON, CDGM, SUMITA, CORNING, then all others
  /// in the order of addition. A name that is not found is replaced by its lead-free successor N-NAME.
  /// Notes report such replacements, candidates of different index if no preferred catalogue decides, and formulas that
  /// disagree with the printed nd.
  /// @param wavelength  [m]
  /// @param where       location where the name is used, for messages
  /// @throws DataError with similar names if no glass has the name, or if the wavelength is out of range
  GlassMatch match(std::string_view name, double wavelength, std::string const& where,
                   std::vector<std::string> const& preferred = {}) const;
  /// Like match(), without notes.
  Glass const& find(std::string_view name, double wavelength, std::string const& where) const {
    return *match(name, wavelength, where).glass;
  }
  /// Returns true if a usable glass has the name.
  bool has(std::string_view name) const { return !candidates(name).empty(); }

 private:
  /// Returns "; did you mean ...?" with the most similar names; empty if no name is similar.
  std::string glasses_like(std::string_view name) const;
  /// Returns the glasses with the given name, in the given catalogue or, if that is empty, in all.
  std::vector<Glass const*> named(std::string_view name, std::string_view catalogue) const;
  /// Throws DataError for an unknown name, with suggestions.
  [[noreturn]] void refuse_unknown(std::string_view name, std::string const& where) const;
  /// Returns the glasses that a name in the syntax of match() can refer to.
  std::vector<Glass const*> candidates(std::string_view name) const;

  std::vector<Glass> glasses_;
  struct LeftOut {
    std::string name, reason;
  };
  std::vector<LeftOut> left_out_;
  std::vector<std::string> warnings_;
};

}  // namespace gladstone
