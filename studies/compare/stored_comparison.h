#pragma once

#include <string>

#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Returns a text that identifies the inputs of a comparison: build, options, and the hashes of its files in order.
std::string comparison_fingerprint(SourceFiles const& sources, CompareOptions const& options);

/// Writes the chain of displacements at the vectors of a comparison (comparison.h5, docs/file-formats.md).
/// @param errors  text of errors.json, whose SHA-256 is stored in the file
void write_chain(std::string const& path, Comparison const& comparison, std::string const& errors);

/// Fills a comparison, whose vectors are already set, with the chain that `gladstone compare` stored in a CASE.
/// @return false, with the comparison unchanged, if errors.json or comparison.h5 is missing, was computed from other
///   files, with other options or by another build, or if errors.json does not match the SHA-256 in comparison.h5
bool read_chain(std::string const& folder, std::string const& fingerprint, Comparison& comparison);

}  // namespace gladstone::inline compare
