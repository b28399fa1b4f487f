#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/optics/glass.h"

namespace gladstone {

/// Glasses of one or several catalogues, to be found by name.
class GlassCatalogue {
 public:
  /// The catalogues that come with the program: the files of data/glasses, built into it.
  static GlassCatalogue const& shipped();

  /// Adds a catalogue in the AGF format, of which NM (name, number of the formula), CD (coefficients), LD (range of
  /// wavelengths, um) and IT (internal transmission: um, share, mm) are read.
  /// @param text UTF-8 @param catalogue its name @param file for messages
  /// @throws DataError with file and line: what is no number, an unknown formula, an index that no glass has
  void add(std::string_view text, std::string const& catalogue, std::string const& file);
  /// The same from a file in any encoding of decoded_text(); the file's name is the catalogue's.
  void add_file(std::string const& path);

  std::vector<Glass> const& glasses() const { return glasses_; }

  /// The glass of that name in upper or lower case, with or without hyphens. "CATALOGUE:NAME" names its catalogue too,
  /// as does CODE V's "NAME_CATALOGUE" where no glass bears the whole name.
  /// @param where the name was used, for messages
  /// @throws DataError with candidates, where nobody or several glasses of different index bear the name; or where the
  ///         wavelength [m] is outside the glass's range
  Glass const& find(std::string_view name, double wavelength, std::string const& where) const;

 private:
  /// "; did you mean ...?" with the nearest names; empty where none is near.
  std::string glasses_like(std::string_view name) const;
  /// Those of that name, in that catalogue unless it is empty.
  std::vector<Glass const*> named(std::string_view name, std::string_view catalogue) const;

  std::vector<Glass> glasses_;
};

}  // namespace gladstone
