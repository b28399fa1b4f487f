#pragma once

#include "studies/design/bounds.h"

/// Requirements that tests of designs name.
namespace gladstone::required {

inline Bound const* const gradient_min = &requirement("requirements.gradient_min_kg_m4");
inline Bound const* const resolution = &requirement("requirements.resolution_mm");
inline Bound const* const displacement_max = &requirement("requirements.displacement_max_px");
inline Bound const* const uncertainty_max = &requirement("requirements.uncertainty_max_px");
inline Bound const* const view_width = &requirement("requirements.field_of_view_mm[0]");
inline Bound const* const view_height = &requirement("requirements.field_of_view_mm[1]");
inline Bound const* const z_total = &requirement("limits.z_total_max_mm");

}  // namespace gladstone::required
