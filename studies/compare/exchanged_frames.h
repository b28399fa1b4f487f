#pragma once

#include "analysis/vectors/displacement_field.h"
#include "render/files/source_files.h"

namespace gladstone::inline compare {

/// Adds a warning if frames A and B of a case were exchanged, according to the hashes in truth.h5 of the same folder or
/// to their file names.
void warn_of_exchanged_frames(DisplacementField& field, SourceFiles const& sources);

}  // namespace gladstone::inline compare
