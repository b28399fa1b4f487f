#pragma once

#include <string>

#include "studies/compare.h"

namespace gladstone {

/// What a comparison is made from, as one text: the hashes of its files in their order, the options and the build.
std::string comparison_fingerprint(SourceFiles const& sources, CompareOptions const& options);

/// Writes the chain of displacements at the vectors of a comparison (comparison.h5, docs/file-formats.md).
/// @param errors text of errors.json, which the file names by its SHA-256
void write_chain(std::string const& path, Comparison const& comparison, std::string const& errors);

/// Fills a comparison whose vectors are known with the chain that `gladstone compare` has stored in a CASE.
/// @return false, and nothing is changed, where errors.json or comparison.h5 is missing, where it was made from other
/// files, with other options or by another build, or where errors.json is not the one that comparison.h5 names
bool read_chain(std::string const& folder, std::string const& fingerprint, Comparison& comparison);

}  // namespace gladstone
