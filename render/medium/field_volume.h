#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/medium/medium.h"
#include "render/medium/medium_setup.h"

namespace gladstone::inline medium {

/// Returns true if n - 1 is within the accepted range, which applies to files and closed forms alike.
constexpr bool is_plausible_refractivity(double refractivity) { return refractivity > -0.5 && refractivity < 3.0; }

/// Refractive medium of a setup. Owns the grid of the view, if there is one.
struct BuiltMedium {
  Medium<double> view = NoMedium<double>{};
  std::shared_ptr<void const> owner;  ///< owns the grid's memory; media with the same owner are identical
  double finest = 0;                  ///< length scale that limits the step size [m]
  double coarsest_step = 0;           ///< upper limit of the step size, see steps_across() [m]
  double steepest = 0;                ///< upper bound of |grad n|, if known [1/m]
  RegularGrid grid;                   ///< grid of a file's field
  double lowest = 0, highest = 0;     ///< range of n - 1 at the nodes of a file's field [1]
  Warnings warnings;                  ///< limitations of the file's data
};

/// Returns the memory required for the field of a setup [bytes]; opens a file and reads its header.
std::size_t medium_bytes_needed(MediumSetup const& setup);

/// Returns the number of steps across the medium at the upper limit of the step size, BuiltMedium::coarsest_step: a
/// quarter of a wavelength or of a shock's thickness, half a radius, a quarter of the medium's thickness; for the field
/// of a file two cells (trilinear: a quarter of a cell), but a quarter of the thickness for an extruded spline. Opens a
/// file and reads its header.
/// @throws DataError if the file cannot be read
double steps_across(MediumSetup const& setup);

/// Returns the warnings that follow from the header of a field's file: assumed units of length, and notes on its
/// reading. Empty for other fields. @throws DataError if the file cannot be read
Warnings header_warnings(MediumSetup const& setup);

/// Returns the region of a file's field [m]; reads the file's header. @throws DataError if the file cannot be read
Bounds<double> file_bounds(MediumSetup const& setup);

/// Returns BuiltMedium::finest [m] without building the medium; opens a file and reads its header.
/// @throws DataError if the file cannot be read
double finest_length(MediumSetup const& setup);

/// Builds the medium. A file is read, converted to n - 1 and prefiltered, with a progress bar.
/// @throws DataError if the file is missing or broken, or has an unsuitable shape
BuiltMedium build_medium(MediumSetup const& setup);

}  // namespace gladstone::inline medium
