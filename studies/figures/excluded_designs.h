#pragma once

#include <string>
#include <vector>

#include "studies/design/design_point.h"
#include "studies/design/question.h"

namespace gladstone::inline figures {

/// Rectangle of the design map.
struct MapArea {
  double least_sensitivity, most_sensitivity;  ///< [px per kg/m^4]
  double least_wavelength, most_wavelength;    ///< wavelength of density with a transfer of 1/sqrt(2) [m]
};

/// Part of the design map in which a limit is the first one that the set-ups miss.
struct ExcludedDesigns {
  std::string limit;  ///< name of the limit, for requirements with its value: "requirements.resolution_mm = 4"
  std::vector<MapArea> areas;
};

/// Determines which set-ups of the design map are excluded: first by the requirements, then by the intervals of Z_D and
/// f-number in [limits], then by the limits of every set-up. Lens, Z_A and the size of the dot images are those of
/// `bench`.
/// @param question  requested design; null: only the limits of every set-up
/// @return only limits that exclude a part of the map
std::vector<ExcludedDesigns> excluded_designs(DesignPoint<double> const& bench, DesignQuestion const* question);

}  // namespace gladstone::inline figures
