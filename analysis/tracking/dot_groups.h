#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline tracking {

/// Largest number of dots that are fitted together.
inline constexpr std::size_t largest_group = 8;

/// Divides dots into groups whose images overlap (Stetson, PASP 99 (1987) 191, section III.C). Two dots closer than the
/// linking distance belong to the same group. Groups of more than `largest_group` dots are divided again by smaller
/// distances; before the fit, the caller must subtract the light of neighbouring dots in other groups.
/// @param centres  centres of the dots [px]
/// @param distance_px  linking distance [px]
/// @return indices of the dots of each group; each dot is in exactly one group
std::vector<std::vector<std::size_t>> group_dots(std::span<Vec2d const> centres, double distance_px);

}  // namespace gladstone::inline tracking
