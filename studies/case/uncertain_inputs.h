#pragma once

#include <limits>
#include <string>
#include <vector>

#include "render/setup/setup_node.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline cases {

/// Probability distribution of an uncertain input about its value.
enum class InputDistribution { normal, rectangular };
char const* to_string(InputDistribution distribution);

/// Correlation of an input with another one.
struct InputCorrelation {
  std::string with;        ///< key of the other input
  double coefficient = 0;  ///< correlation coefficient, from -1 to 1 (JCGM 100:2008, 5.2.2)
};

/// A number of a setup given with its standard uncertainty, in the unit of its key: { value = 250.0, sigma = 1.0,
/// distribution = "normal", degrees_of_freedom = 9 }.
struct UncertainInput {
  std::vector<std::string> path;  ///< keys from the root
  std::string key;                ///< path joined by dots, e.g. "geometry.z_d_mm"
  double value = 0;
  /// standard uncertainty for either distribution; a rectangular one has the full width 2 sqrt(3) sigma
  double sigma = 0;
  InputDistribution distribution = InputDistribution::normal;
  /// degrees of freedom of sigma (JCGM 100:2008, G.4) [1]
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  SetupNode node;                              ///< node of the setup file that contains the number and its uncertainty
  std::vector<InputCorrelation> correlations;  ///< correlations with other inputs, each stored at both inputs
};

/// Replaces every number given with an uncertainty by its value, so that all readers find a plain number, and returns
/// the uncertainties. Also removes and returns the correlations in [[correlations]], { keys = [.., ..], coefficient =
/// -0.5 }. Problems are added to the document at the key concerned. Tables that request a design (requirements, limits,
/// ...) are not searched.
std::vector<UncertainInput> extract_uncertain_inputs(SetupDocument& document);

/// Inserts the uncertainties at their numbers, and their correlations; inverse of extract_uncertain_inputs().
/// @param document  setup in which each input's key is a number or missing
void insert_uncertain_inputs(SetupDocument& document, std::vector<UncertainInput> const& inputs);
/// @param text  setup as TOML
std::string insert_uncertain_inputs(std::string const& text, std::vector<UncertainInput> const& inputs);

}  // namespace gladstone::inline cases
