#pragma once

#include <string>

#include "render/files/source_files.h"
#include "studies/case/case.h"

namespace gladstone::inline compare {

/// Setup, truth and vectors that a comparison reads, with their hashes at the time of reading.
struct ComparedFiles {
  std::string setup, truth, vectors;
  SourceFiles sources;
  std::string unverified;  ///< file without hashes of its frames; empty: both files have hashes, and they agree
};
/// Locates and hashes the files of a comparison.
/// @param vectors  path; empty: those of the case
/// @throws DataError if a file is missing, or the vectors were measured on frames other than those of the truth
ComparedFiles compared_files(std::string const& folder, std::string const& vectors);

/// Checks that the files named in a case's setup are unchanged since it was rendered. Missing files are ignored here;
/// their readers report them.
/// @throws DataError for a changed file
void require_unchanged_inputs(std::string const& folder);

/// Prepares a stored case for ray tracing, without its strain map. @throws DataError if one of its input files has
/// changed
PreparedCase prepare_stored_case(std::string const& folder);

}  // namespace gladstone::inline compare
