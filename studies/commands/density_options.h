#pragma once

#include <string>
#include <vector>

#include "studies/compare/reconstruct.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace gladstone::inline commands {

/// Parses "left", "top:3" or "X0,Y0,X1,Y1" in mm. @throws SetupError
ReferenceRegion parse_reference(std::string const& text);

/// Parses "vertical", "horizontal", "x=1.5" or "y=-2" in mm; empty: vertical. @throws SetupError
AxisOption parse_axis(std::string const& text);

/// Options of a command that reconstructs density, as given on the command line.
class DensityArguments {
 public:
  /// Adds the options to a command.
  /// @param group  heading of the options in the help; empty: among the other options
  void add_to(CLI::App& app, std::string const& group = "");
  /// Converts the arguments. @throws SetupError for values that cannot be parsed or options that conflict
  ReconstructOptions options() const;
  /// Returns the options that were given with their values, as words of a command line.
  std::vector<std::string> words() const;

 private:
  std::string axis_;
  std::vector<std::string> reference_;
  ReconstructOptions parsed_;
  bool axisymmetric_ = false;
  std::vector<CLI::Option*> added_;
};

}  // namespace gladstone::inline commands
