#pragma once

#include <string>

#include "studies/compare.h"

namespace gladstone {

/// Reads a file of vectors, ours or another code's: its conventions told or detected by the case's truth, what no
/// camera can have seen left out, with what gave ours.
/// @throws DataError where nothing is left, no place is in px, or no conventions fit
MeasuredVectors load_vectors(std::string const& path, CaseSetup const& loaded, GroundTruth const& truth,
                             CompareOptions const& options);

}  // namespace gladstone
