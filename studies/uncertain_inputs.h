#pragma once

#include <limits>
#include <string>
#include <vector>

#include "render/base/setup_node.h"
#include "render/base/setup_table.h"

namespace gladstone {

/// How what is known of an input spreads about its value.
enum class InputDistribution { normal, rectangular };
char const* to_string(InputDistribution distribution);

/// That an input is correlated with another one.
struct InputCorrelation {
  std::string with;        ///< the other's key
  double coefficient = 0;  ///< from -1 to 1 (JCGM 100:2008, 5.2.2)
};

/// A number of a setup that is written with its standard uncertainty,
/// { value = 250.0, sigma = 1.0, distribution = "normal", degrees_of_freedom = 9 }. Numbers in the key's own unit.
struct UncertainInput {
  std::vector<std::string> path;  ///< keys from the root
  std::string key;                ///< the same with dots, for the reader: "geometry.z_d_mm"
  double value = 0;
  double sigma = 0;  ///< standard uncertainty, whatever the distribution: a rectangle is 2 sqrt(3) times as wide
  InputDistribution distribution = InputDistribution::normal;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< of sigma (JCGM 100, G.4)
  SetupNode node;                                                       ///< as written
  std::vector<InputCorrelation> correlations;                           ///< each stands at both inputs
};

/// Puts the value in place of every number that a setup writes with its uncertainty, so that all that reads it reads a
/// number, and tells of them; so with what [[correlations]] says of two of them each, { keys = [.., ..], coefficient =
/// -0.5 }. What is wrong with one goes to the document at its key. Tables of the question of a design have none.
std::vector<UncertainInput> take_uncertain_inputs(SetupDocument& document);

/// A setup with the uncertainties written at their numbers again, and what correlates them.
/// @param text TOML, in which each input's key is a number or absent
std::string with_uncertain_inputs(std::string const& text, std::vector<UncertainInput> const& inputs);

}  // namespace gladstone
