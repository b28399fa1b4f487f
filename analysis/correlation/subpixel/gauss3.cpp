#include "analysis/correlation/subpixel/gaussian_fits.h"

namespace gladstone::inline correlation {

PeakFit fit_gauss3(PeakPatch const& patch) { return GaussAlongAxes()(patch); }

}  // namespace gladstone::inline correlation
