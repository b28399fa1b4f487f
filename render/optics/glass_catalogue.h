#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/optics/glass.h"

namespace gladstone {

/// A glass that was found by its name.
struct GlassMatch {
  Glass const* glass;
  std::vector<std::string> notes;  ///< what had to be assumed, for warnings
};

/// Glasses of one or several catalogues, to be found by name.
class GlassCatalogue {
 public:
  /// The catalogues that come with the program: the files of data/glasses, built into it.
  static GlassCatalogue const& shipped();

  /// Adds a catalogue in the AGF format, of which NM (name, number of the formula, nd), CD (coefficients), LD (range of
  /// wavelengths, um) and IT (internal transmission: um, share, mm) are read. Lines of numbers alone continue the line
  /// before them. A glass that cannot be used (no number, an unknown formula, an index that no glass has) is left out,
  /// and a warning names it.
  /// @param text UTF-8 @param catalogue its name @param file for messages
  /// @throws DataError with file and line, if no glass is usable
  void add(std::string_view text, std::string const& catalogue, std::string const& file);
  /// The same from a file in any encoding of decoded_text(); the file's name is the catalogue's.
  void add_file(std::string const& path);

  std::vector<Glass> const& glasses() const { return glasses_; }
  /// Of the catalogues that were added: glasses left out, lines passed over.
  std::vector<std::string> const& warnings() const { return warnings_; }

  /// The glass of that name in upper or lower case, with or without hyphens. "CATALOGUE:NAME" names its catalogue too,
  /// as does CODE V's "NAME_CATALOGUE" where no glass bears the whole name. Of several catalogues that have the name,
  /// the first of `preferred` counts, then SCHOTT, OHARA, HOYA, HIKARI, NIKON, CDGM, SUMITA, CORNING, then the order in
  /// which they were added; a note says so where their indices differ and no preferred one decided, and where a
  /// formula does not give the nd that is printed beside it. A glass that no catalogue has is its successor without
  /// lead, N-NAME, if there is one, with a note.
  /// @param wavelength [m] @param where the name was used, for messages
  /// @param preferred catalogues in the order of preference
  /// @throws DataError with candidates, if no glass has the name; or if the wavelength is outside the glass's range
  GlassMatch match(std::string_view name, double wavelength, std::string const& where,
                   std::vector<std::string> const& preferred = {}) const;
  /// The glass of match().
  Glass const& find(std::string_view name, double wavelength, std::string const& where) const {
    return *match(name, wavelength, where).glass;
  }
  /// Whether a usable glass has the name.
  bool has(std::string_view name) const { return !candidates(name).empty(); }

 private:
  /// "; did you mean ...?" with the nearest names; empty where none is near.
  std::string glasses_like(std::string_view name) const;
  /// Those of that name, in that catalogue unless it is empty.
  std::vector<Glass const*> named(std::string_view name, std::string_view catalogue) const;
  /// @throws DataError that names what the glass may have been meant to be
  [[noreturn]] void refuse_unknown(std::string_view name, std::string const& where) const;
  /// Those that a name as match() takes it may mean.
  std::vector<Glass const*> candidates(std::string_view name) const;

  std::vector<Glass> glasses_;
  struct LeftOut {
    std::string name, reason;
  };
  std::vector<LeftOut> left_out_;
  std::vector<std::string> warnings_;
};

}  // namespace gladstone
