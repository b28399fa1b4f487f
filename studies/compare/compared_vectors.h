#pragma once

#include <string>

#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Logs the warnings and notes of a file of vectors.
void log_remarks(VectorFile const& file);

/// Reads a file of vectors, our own or another code's, by the conventions of its format or those given by the user.
/// Rejects vectors that lie or point outside the image. Detects wrong axes, signs, units and positions by comparison
/// with the case's truth; warns of them and stores them in `detected`.
/// @param truth  truth of the case; null: unknown, and the conventions of the format are used without a test
/// @throws DataError if no vector remains, no position is in px, or no convention fits the truth
MeasuredVectors load_vectors(std::string const& path, CaseSetup const& loaded, GroundTruth const* truth,
                             CompareOptions const& options);

/// Comparison of the conventions of vectors with the truth.
enum class ConventionCheck {
  none,    ///< the conventions are certain
  warn,    ///< warns of vectors that fit the truth in no convention, such as those of an estimator that fails
  require  ///< rejects vectors that fit the truth in no convention
};

/// Checks and converts vectors as load_vectors() does, for vectors that are already in memory.
/// @param name   name of the origin of the vectors, for messages
/// @param check  check of the conventions; none takes place if `options` specifies them
MeasuredVectors accept_vectors(VectorFile file, std::string const& name, CaseSetup const& loaded,
                               GroundTruth const* truth, CompareOptions const& options, ConventionCheck check);

}  // namespace gladstone::inline compare
