#pragma once

#include <string>

#include "render/base/source_files.h"

namespace gladstone {

/// The files that a comparison reads: setup, truth and vectors of a CASE, as they are now.
struct ComparedFiles {
  std::string setup, truth, vectors;
  SourceFiles sources;
  std::string unverified;  ///< which of them does not tell its frames; empty: both do, and they are the same
};
/// @param vectors a file; empty: those of the case
/// @throws DataError where one is not there, or the vectors were measured on other frames than the truth belongs to
ComparedFiles compared_files(std::string const& folder, std::string const& vectors);

/// Requires the files that a case's setup names to be those that it was rendered from; missing ones are left to their
/// readers. @throws DataError for one that has changed
void require_unchanged_inputs(std::string const& folder);

}  // namespace gladstone
