#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/error.h"
#include "render/optics/glass_catalogue.h"
#include "render/optics/prescription.h"

namespace gladstone::inline optics {

/// Index and absorption coefficient of a medium at the lens' wavelength.
struct LensMedium {
  double n = 1;           ///< [1]
  double absorption = 0;  ///< [1/m]
};

/// Media of a lens at its wavelength: finds the glasses of a prescription, and collects warnings and errors about them.
class LensMedia {
 public:
  /// @param prescription,catalogue  must outlive this object
  /// @param wavelength              [m]
  /// @param absorption              true: the absorption of glass is determined as well
  LensMedia(Prescription const& prescription, GlassCatalogue const& catalogue, double wavelength, bool absorption)
      : prescription_(prescription), catalogue_(catalogue), wavelength_(wavelength), absorption_(absorption) {}

  /// Returns the properties of a medium; an unknown glass is noted, and taken as air.
  /// @param surface_where  file and line of the surface, named in messages about media that share the surface's line
  LensMedium find(PrescribedMedium const& medium, std::string const& surface_where);

  /// Returns the catalogue's glass of this name. If no catalogue contains the name, or if an assumed glass contradicts
  /// the nd and Vd of the line, returns a glass with this nd and Vd. Adds one warning about the choice.
  /// @throws DataError if the glass is unknown or not valid at this wavelength
  Glass named_glass(PrescribedMedium::Named const& named, std::string const& where);

  /// Returns the warnings about the glasses found.
  /// @throws DataError if a glass is unknown or not valid at this wavelength; SetupError that lists several of them
  Warnings finish();

 private:
  /// Glass specified by nd and Vd only.
  struct DescribedGlass {
    std::string name;
    std::string where;  ///< location of its first use
  };

  /// Returns the glass of a search and adds its notes, each once for a name.
  Glass found_glass(GlassMatch const& match, std::string const& name);

  /// Adds a warning about a glass, unless the glass already has one.
  void note_once(std::string const& key, Warning const& warning);

  /// Throws an error that lists all glasses that are unknown or not valid at this wavelength, with their locations.
  void refuse_glasses() const;

  /// Returns the line number in a location "file:line" of the lens file.
  std::string_view line_in_file(std::string_view where) const;

  /// Adds one warning about all glasses specified by nd and Vd only, with the first line of each.
  void note_described_glasses();

  Prescription const& prescription_;
  GlassCatalogue const& catalogue_;
  double wavelength_;
  bool absorption_;
  Warnings warnings_;
  std::vector<SetupProblem> not_found_;    ///< unknown glasses
  std::vector<DescribedGlass> described_;  ///< glasses specified by nd and Vd only
  std::set<std::string> noted_;            ///< glasses with a warning
};

}  // namespace gladstone::inline optics
