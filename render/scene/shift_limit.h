#pragma once

namespace gladstone {

/// Refuses a medium that bends rays by more than 45 degrees on their way: no bench sees those, and the search for a
/// pupil so wide that none is lost would not end.
/// @param shift on the lens plane [m] @param z_b from the dots to the lens [m] @throws DataError
void refuse_shift_beyond_any_bench(double shift, double z_b);

}  // namespace gladstone
