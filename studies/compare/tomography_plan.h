#pragma once

#include <string>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline compare {

/// Options of setups that simulate a tomographic measurement.
struct TomographyPlan {
  std::string setup;               ///< path of the setup whose field is turned
  int views = 8;                   ///< number of views
  double arc = 3.141592653589793;  ///< range of the angles [rad]; view i has the angle i * arc / views
};

/// Writes one setup for each view of a turned field: `view_00.toml`, and the turned field `view_00.h5`. The field is
/// evaluated by the interpolation of the setup on a cubic grid that contains it at all angles, with the spacing of the
/// file (a closed form: a 64th of its depth), with a margin of ambient density across the view.
/// @param folder  existing folder
/// @return paths of the setups
/// @throws SetupError  for invalid options, or setups without a field of finite extent
/// @throws DataError, OutputError
std::vector<std::string> write_tomography_setups(TomographyPlan const& plan, std::string const& folder);

}  // namespace gladstone::inline compare
