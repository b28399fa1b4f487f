#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/warning.h"
#include "render/optics/glass.h"

namespace gladstone::inline optics {

/// Result of a search for a glass name.
struct GlassMatch {
  Glass const* glass;
  Warnings notes;        ///< warnings about assumptions that were made
  bool assumed = false;  ///< a successor, or from a shipped catalogue that the lens file does not list
};

/// Returns true if the nd of a glass equals the one that a lens file states to within the file's rounding (1e-3), or if
/// the glass is not described at the d line.
bool agrees_with_nd(Glass const& glass, double stated_nd);

/// Formats "CATALOGUE:NAME (file:line)".
std::string place_of(Glass const& glass);

/// Collection of glasses from one or more catalogues, searchable by name.
class GlassCatalogue {
 public:
  /// Returns the catalogues shipped with the program: the files of data/glasses, which are compiled in. Each of their
  /// glasses is read when it is first used.
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

  /// Returns all glasses, those of added catalogues first. Valid until the next catalogue is added.
  std::vector<Glass const*> glasses() const;
  /// Warnings about skipped glasses and lines of all added catalogues.
  Warnings const& warnings() const { return warnings_; }

  /// Returns the glass with the given name, ignoring case and hyphens. "CATALOGUE:NAME" selects a catalogue, as does
  /// CODE V's "NAME_CATALOGUE" if no glass has the complete name. If several catalogues contain the name, the order is:
  /// - those in `preferred`, in its order,
  /// - added catalogues, by maker_rank(), those of one rank in the order of addition,
  /// - shipped catalogues, by maker_rank().
  /// Among glasses of one name in other catalogues than the preferred and the added ones, those that agree with the
  /// stated nd come first. The lead-free successor N-NAME is returned if no catalogue contains the name, or if no
  /// preferred catalogue contains the name but one contains the successor, unless only the glass of that name agrees
  /// with the stated nd. One note reports the successor, candidates of different index if neither a preferred catalogue
  /// nor the stated nd decides, or that no preferred catalogue contains the name; another one a formula that disagrees
  /// with the printed nd.
  /// @param wavelength  [m]
  /// @param where       location where the name is used, for messages
  /// @param stated_nd   nd that the lens file states for the glass; nullopt: none
  /// @throws DataError with similar names if no glass has the name, or if the wavelength is out of range
  GlassMatch match(std::string_view name, double wavelength, std::string const& where,
                   std::vector<std::string> const& preferred = {},
                   std::optional<double> stated_nd = std::nullopt) const;
  /// Returns true if a usable glass has the name, or is its successor.
  bool has(std::string_view name) const { return !candidates(name).empty() || !successors(name).empty(); }

 private:
  /// Returns "; did you mean ...?" with the most similar names; empty if no name is similar.
  std::string suggest_glasses(std::string_view name) const;
  /// Returns the glasses with the given name, in the given catalogue or, if that is empty, in all; in the order of
  /// match() without preferred catalogues.
  std::vector<Glass const*> named(std::string_view name, std::string_view catalogue) const;
  /// Throws DataError for an unknown name, with suggestions.
  [[noreturn]] void refuse_unknown(std::string_view name, std::string const& where) const;
  /// Returns the glasses that a name in the syntax of match() can refer to.
  std::vector<Glass const*> candidates(std::string_view name) const;

  /// Returns the lead-free successors of a name: glasses with this name preceded by "N-".
  std::vector<Glass const*> successors(std::string_view name) const;
  struct FullName {
    std::string key, catalogue, name;
  };
  /// Returns the names of all glasses.
  std::vector<FullName> names() const;

  bool has_shipped_ = false;
  std::vector<Glass> glasses_;  ///< glasses of added catalogues
  struct LeftOut {
    std::string name, reason;
  };
  std::vector<LeftOut> left_out_;
  Warnings warnings_;
};

}  // namespace gladstone::inline optics
