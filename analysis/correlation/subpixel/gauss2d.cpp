#include "analysis/correlation/subpixel/gaussian_fits.h"

namespace gladstone::inline correlation {

PeakFit fit_gauss2d(PeakPatch const& patch) { return GaussOfAnyAxes()(patch); }

}  // namespace gladstone::inline correlation
