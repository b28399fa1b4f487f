#pragma once

#include <string>
#include <vector>

#include "studies/commands/command.h"

namespace gladstone::inline commands {

/// Arguments of `gladstone correlate`, except for those of ensembles.
struct SequenceArguments {
  std::vector<std::string> inputs, overrides;
  std::string output, config;
  std::string pairing;  ///< text of --pairing; empty: not given
  bool no_figures = false;
};

/// Returns the two images if the inputs are patterns that match exactly one pair and the output is a file: such a pair
/// is correlated like two named images. Otherwise returns the inputs.
std::vector<std::string> expand_single_pair(SequenceArguments const& arguments);

/// Returns true if the arguments ask for a sequence: by --pairing, an output folder, patterns, or more than two images
/// without a file as output.
bool is_sequence(SequenceArguments const& arguments);

/// Correlates a sequence and prints a summary. @return exit code
int run_sequence(SequenceArguments const& arguments, GlobalOptions const& options);

}  // namespace gladstone::inline commands
