#include "studies/case/uncertain_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "render/base/nearest_name.h"
#include "render/setup/toml_text.h"
#include "studies/case/correlation_matrix.h"

namespace gladstone::inline cases {
namespace {

constexpr std::array<char const*, 4> known_keys{"value", "sigma", "distribution", "degrees_of_freedom"};

/// Returns true if a table represents a number with its uncertainty, complete or not.
bool is_uncertain(SetupNode const& node) {
  return node.kind == SetupNode::Kind::table && node.find("value") && node.find("value")->is_number() &&
         !node.find("kind") && !node.find("label");
}

std::string dotted(std::vector<std::string> const& path) {
  std::string text;
  for (std::string const& part : path) text += (text.empty() || part.front() == '[' ? "" : ".") + part;
  return text;
}

class Reader {
 public:
  explicit Reader(SetupDocument& document) : document_(document) {}

  /// Replaces the uncertain numbers below a node by their values. @return true if there was one
  bool take(SetupNode& node) {
    bool changed = false;
    for (SetupMember& member : node.members) changed |= take_at(member.key, member.value);
    for (std::size_t i = 0; i < node.elements.size(); ++i) {
      changed |= take_at(fmt::format("[{}]", i), node.elements[i]);
    }
    return changed;
  }
  bool take_at(std::string const& step, SetupNode& node) {
    path_.push_back(step);
    bool const changed = is_uncertain(node) ? (replace(node), true) : take(node);
    path_.pop_back();
    return changed;
  }
  std::vector<UncertainInput> inputs;

 private:
  /// Adds a problem at the key of the number; for a number in an array, at the array.
  void problem(std::string const& message) {
    SetupTable table = document_.root();
    std::size_t i = 0;
    while (i + 1 < path_.size() && path_[i + 1].front() != '[') table = table.table(path_[i++]);
    table.problem(path_[i], message);
  }

  void replace(SetupNode& node) {
    UncertainInput input{
        path_, dotted(path_), node.find("value")->as_double(), 0, {}, UncertainInput{}.degrees_of_freedom, node, {}};
    for (SetupMember const& member : node.members) {
      bool const known = std::find(known_keys.begin(), known_keys.end(), member.key) != known_keys.end();
      if (known) continue;
      std::vector<std::string> const names(known_keys.begin(), known_keys.end());
      auto const nearest = nearest_name(member.key, names);
      problem("has the unknown key " + member.key + " in addition to its value" +
              (nearest ? "; did you mean " + *nearest + "?" : "; it may have " + quoted_list(names)));
    }
    read_sigma(node, input);
    read_distribution(node, input);
    read_degrees(node, input);
    SetupNode number = *node.find("value");
    number.place = node.place;
    inputs.push_back(std::move(input));
    node = std::move(number);
  }

  void read_sigma(SetupNode const& node, UncertainInput& input) {
    SetupNode const* const sigma = node.find("sigma");
    if (!sigma) {
      problem("has a value without an uncertainty; write { value = ..., sigma = ... }, or the number alone");
    } else if (!sigma->is_number() || !(sigma->as_double() >= 0) || !std::isfinite(sigma->as_double())) {
      problem("has a sigma that is not a standard uncertainty (" + toml_text(*sigma) +
              "); write a number of 0 or more");
    } else {
      input.sigma = sigma->as_double();
    }
  }
  void read_distribution(SetupNode const& node, UncertainInput& input) {
    SetupNode const* const word = node.find("distribution");
    if (!word) return;
    if (word->kind == SetupNode::Kind::text && word->text == "rectangular") {
      input.distribution = InputDistribution::rectangular;
    } else if (word->kind != SetupNode::Kind::text || word->text != "normal") {
      problem("has the unknown distribution " + toml_text(*word) + "; use \"normal\" or \"rectangular\"");
    }
  }
  void read_degrees(SetupNode const& node, UncertainInput& input) {
    SetupNode const* const degrees = node.find("degrees_of_freedom");
    if (!degrees) return;
    if (!degrees->is_number() || !(degrees->as_double() >= 1)) {
      problem("has degrees_of_freedom of " + toml_text(*degrees) + "; write a number of 1 or more, or omit it");
    } else {
      input.degrees_of_freedom = degrees->as_double();
    }
  }

  SetupDocument& document_;
  std::vector<std::string> path_;
};

/// Reads [[correlations]] and stores each one at both inputs.
class CorrelationReader {
 public:
  CorrelationReader(SetupDocument& document, std::vector<UncertainInput>& inputs)
      : document_(document),
        root_(document.root()),
        inputs_(inputs),
        coefficients_(Eigen::MatrixXd::Identity(static_cast<Eigen::Index>(inputs.size()),
                                                static_cast<Eigen::Index>(inputs.size()))) {}

  void read(SetupNode const& node) {
    std::vector<SetupTable> tables = root_.tables("correlations");
    for (std::size_t i = 0; i < tables.size(); ++i) {
      read_pair(node.kind == SetupNode::Kind::array ? node.elements[i] : node, tables[i]);
    }
    if (correlation_factor(coefficients_)) return;
    tables.back().problem("coefficient",
                          "makes the correlation matrix invalid (it has a negative eigenvalue); give smaller "
                          "coefficients, or those of the missing pairs");
  }

 private:
  void read_pair(SetupNode const& node, SetupTable& table) {
    static std::vector<std::string> const names{"keys", "coefficient"};
    for (SetupMember const& member : node.members) {
      if (std::find(names.begin(), names.end(), member.key) != names.end()) continue;
      table.problem(member.key, "is not a key of correlations; the keys are " + quoted_list(names));
    }
    auto const pair = pair_of(node, table);
    SetupNode const* const number = node.find("coefficient");
    if (!number || !number->is_number() || !(std::abs(number->as_double()) <= 1)) {
      table.problem("coefficient",
                    "must be a correlation coefficient (the covariance over both standard "
                    "uncertainties); write a number from -1 to 1");
      return;
    }
    if (pair) enter(pair->first, pair->second, number->as_double(), table);
  }

  std::optional<std::pair<std::size_t, std::size_t>> pair_of(SetupNode const& node, SetupTable& table) {
    SetupNode const* const keys = node.find("keys");
    bool const two = keys && keys->kind == SetupNode::Kind::array && keys->elements.size() == 2 &&
                     keys->elements[0].kind == SetupNode::Kind::text && keys->elements[1].kind == SetupNode::Kind::text;
    if (!two || keys->elements[0].text == keys->elements[1].text) {
      table.problem("keys", "must name two inputs; write keys = [\"geometry.z_a_mm\", \"geometry.z_d_mm\"]");
      return std::nullopt;
    }
    auto const a = input_of(keys->elements[0].text, table), b = input_of(keys->elements[1].text, table);
    if (!a || !b) return std::nullopt;
    return std::pair{*a, *b};
  }

  std::optional<std::size_t> input_of(std::string const& key, SetupTable& table) {
    auto const found =
        std::find_if(inputs_.begin(), inputs_.end(), [&key](UncertainInput const& one) { return one.key == key; });
    if (found == inputs_.end()) {
      if (has_sigma(key)) return std::nullopt;  // the problem with its value was reported there
      std::vector<std::string> names;
      for (UncertainInput const& input : inputs_) names.push_back(input.key);
      auto const nearest = nearest_name(key, names);
      table.problem("keys", "names " + key + ", which has no uncertainty" +
                                (nearest ? "; did you mean " + *nearest + "?"
                                         : "; write " + key + " = { value = ..., sigma = ... }"));
      return std::nullopt;
    }
    if (found->distribution != InputDistribution::normal) {
      table.problem("keys", "names " + key +
                                ", which is rectangular (only normal distributions can be correlated, JCGM 101:2008, "
                                "6.4.8); remove its distribution, or the correlation");
      return std::nullopt;
    }
    return static_cast<std::size_t>(found - inputs_.begin());
  }

  /// Returns true if a dotted key has a sigma, whatever its value.
  bool has_sigma(std::string const& key) const {
    std::vector<std::string> path;
    std::istringstream steps(key);
    for (std::string step; std::getline(steps, step, '.');) path.push_back(step);
    SetupNode const* const node = document_.find(path);
    return node && node->kind == SetupNode::Kind::table && node->find("sigma");
  }

  void enter(std::size_t a, std::size_t b, double coefficient, SetupTable& table) {
    for (InputCorrelation const& other : inputs_[a].correlations) {
      if (other.with != inputs_[b].key) continue;
      table.problem("keys", "are already correlated above; remove one of the two");
      return;
    }
    auto const i = static_cast<Eigen::Index>(a), k = static_cast<Eigen::Index>(b);
    coefficients_(i, k) = coefficients_(k, i) = coefficient;
    inputs_[a].correlations.push_back({inputs_[b].key, coefficient});
    inputs_[b].correlations.push_back({inputs_[a].key, coefficient});
  }

  SetupDocument const& document_;
  SetupTable root_;
  std::vector<UncertainInput>& inputs_;
  Eigen::MatrixXd coefficients_;
};

/// Returns the node of [[correlations]], with every pair once.
SetupNode correlations_node(std::vector<UncertainInput> const& inputs) {
  SetupNode all = setup_array({});
  for (UncertainInput const& input : inputs) {
    for (InputCorrelation const& one : input.correlations) {
      if (one.with < input.key) continue;
      SetupNode pair;
      pair.members.push_back({"keys", setup_array({setup_text(input.key), setup_text(one.with)})});
      pair.members.push_back({"coefficient", setup_number(one.coefficient)});
      all.elements.push_back(std::move(pair));
    }
  }
  return all;
}

/// Returns the node at a path of keys and "[i]"; null if it does not exist.
SetupNode* node_at(SetupNode& root, std::vector<std::string> const& path) {
  SetupNode* node = &root;
  for (std::string const& step : path) {
    if (step.front() == '[') {
      std::size_t const i = std::stoul(step.substr(1));
      if (node->kind != SetupNode::Kind::array || i >= node->elements.size()) return nullptr;
      node = &node->elements[i];
      continue;
    }
    if (node->kind == SetupNode::Kind::array && node->elements.size() == 1) node = &node->elements.front();
    node = node->find(step);
    if (!node) return nullptr;
  }
  return node;
}

}  // namespace

char const* to_string(InputDistribution distribution) {
  return distribution == InputDistribution::normal ? "normal" : "rectangular";
}

std::vector<UncertainInput> extract_uncertain_inputs(SetupDocument& document) {
  Reader reader(document);
  SetupNode const root = *document.find({});
  for (SetupMember const& member : root.members) {
    if (member.key == "correlations") continue;
    bool const question =
        member.key == "requirements" || member.key == "limits" || member.key == "inventory" || member.key == "free";
    if (question) continue;
    SetupNode value = member.value;
    if (reader.take_at(member.key, value)) document.set({member.key}, value);
  }
  SetupNode const* const correlations = root.find("correlations");
  bool const none = !correlations || (correlations->kind == SetupNode::Kind::array && correlations->elements.empty());
  if (!none) {
    CorrelationReader(document, reader.inputs).read(*correlations);
    document.set({"correlations"}, setup_array({}));  // removed, so that later readers of the setup find none
  }
  return reader.inputs;
}

void insert_uncertain_inputs(SetupDocument& document, std::vector<UncertainInput> const& inputs) {
  if (inputs.empty()) return;
  SetupNode root = *document.find({});
  for (UncertainInput const& input : inputs) {
    SetupNode* const node = node_at(root, input.path);
    if (node && node->is_number() && node->as_double() == input.value) *node = input.node;
  }
  for (SetupMember const& member : root.members) document.set({member.key}, member.value);
  document.remove({"correlations"});
  SetupNode const correlations = correlations_node(inputs);
  if (!correlations.elements.empty()) document.set({"correlations"}, correlations);
}

std::string insert_uncertain_inputs(std::string const& text, std::vector<UncertainInput> const& inputs) {
  if (inputs.empty()) return text;
  SetupDocument document = SetupDocument::from_text(text, "setup");
  insert_uncertain_inputs(document, inputs);
  return document.written();
}

}  // namespace gladstone::inline cases
