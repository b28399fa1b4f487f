#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/optics/lens.h"

namespace gladstone::inline cases {

/// Glass of a lens: how its file names it, and which glass was taken.
struct LensGlass {
  std::string name;                    ///< name of the glass in the lens file
  std::string catalogue;               ///< catalogue and name, "SCHOTT:N-BK7"; empty: described by the lens file itself
  std::string place;                   ///< file and line of the catalogue
  double index = 1;                    ///< refractive index at the wavelength of the lens [1]
  std::vector<std::size_t> surfaces;   ///< surfaces behind which it is, from 1
  std::vector<std::string> also_in{};  ///< glasses of the same name in other catalogues
};

/// Returns the glasses of a lens in the order of the light path, each once.
/// @param catalogue  catalogues with which the lens was built
std::vector<LensGlass> list_lens_glasses(Lens const& lens, GlassCatalogue const& catalogue);

/// Returns the list for summary.json and `gladstone info lens --json`.
nlohmann::json lens_glasses_json(std::vector<LensGlass> const& glasses);

/// Returns one line for each glass: "N-BK7 behind surface 1: SCHOTT:N-BK7 (...), n = 1.5168".
std::string lens_glasses_text(std::vector<LensGlass> const& glasses);

}  // namespace gladstone::inline cases
