#pragma once

#include "studies/design/sheet.h"

namespace gladstone::inline design {

/// Computes the sheet of a PIV setup: imaging, particle images, particles per window, light and admissible
/// displacements.
/// @throws DataError for an invalid file of particles
/// @pre loaded.setup.piv
DesignSheet piv_sheet(CaseSetup const& loaded);

}  // namespace gladstone::inline design
