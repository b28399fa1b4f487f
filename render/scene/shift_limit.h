#pragma once

namespace gladstone::inline scene {

/// Checks that the medium deflects no ray by more than 45 degrees before it reaches the lens: no real set-up does so,
/// and the search for a sufficient pupil margin would not terminate.
/// @param shift  deflection on the lens plane [m]
/// @param z_b  distance from the dots to the lens [m]
/// @throws DataError if shift > z_b
void check_deflection_limit(double shift, double z_b);

}  // namespace gladstone::inline scene
