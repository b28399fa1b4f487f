#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/medium/medium.h"
#include "render/medium/medium_setup.h"

namespace gladstone {

/// Whether there can be a medium of this n - 1: what no file and no closed form may exceed.
constexpr bool possible_refractivity(double refractivity) { return refractivity > -0.5 && refractivity < 3.0; }

/// The medium of a setup: owner of the grid behind the view, if there is one.
struct BuiltMedium {
  Medium<double> view = NoMedium<double>{};
  std::shared_ptr<void const> owner;  ///< keeps the grid's memory alive; media with one owner are one medium
  double finest = 0;                  ///< smallest length on which the field changes: cell, wavelength, radius ... [m]
  double coarsest_step = 0;           ///< largest step that is ever sensible: see plan_step [m]
  double steepest = 0;                ///< upper bound of |grad n|, where known [1/m]
  RegularGrid grid;                   ///< of a file's field
  double lowest = 0, highest = 0;     ///< n - 1 at the nodes of a file's field [1]
  std::vector<std::string> warnings;  ///< of what the file's numbers cannot give
};

/// Memory that the field of a setup will take [bytes]; opens a file to see its size.
std::size_t medium_bytes_needed(MediumSetup const& setup);

/// Steps across the medium that follow what the field changes on: a quarter of a wavelength or of a shock's thickness,
/// half a radius, two cells (trilinear: a quarter); at least four. Opens a file to see its grid.
/// @throws DataError for a file that cannot be read
double steps_across(MediumSetup const& setup);

/// Where the field of a file stands [m]; opens it to see its grid. @throws DataError for a file that cannot be read
Bounds<double> file_bounds(MediumSetup const& setup);

/// What BuiltMedium::finest will be [m]; opens a file to see its grid. @throws DataError for a file that cannot be read
double finest_length(MediumSetup const& setup);

/// Builds the medium; a file is read, scaled to n - 1 and prefiltered, with progress.
/// @throws DataError for files that are missing, broken or of the wrong shape
BuiltMedium build_medium(MediumSetup const& setup);

}  // namespace gladstone
