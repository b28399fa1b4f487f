#pragma once

#include <string>

#include "studies/compare.h"

namespace gladstone {

/// Reads a file of vectors, ours or another code's, as its format says or the user tells; what no camera can have seen
/// is left out. What the case's truth shows to be wrong with them (axes, signs, units, places) is warned of and stands
/// in `detected`.
/// @throws DataError where nothing is left, no place is in px, or nothing fits
MeasuredVectors load_vectors(std::string const& path, CaseSetup const& loaded, GroundTruth const& truth,
                             CompareOptions const& options);

}  // namespace gladstone
