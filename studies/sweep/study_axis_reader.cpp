#include "studies/sweep/study_axis_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "render/base/nearest_name.h"
#include "render/files/text_file.h"
#include "render/setup/setup_table.h"
#include "render/setup/toml_text.h"

namespace gladstone::inline sweep {
namespace {

using Kind = SetupNode::Kind;

/// Splits a key path at its points.
std::vector<std::string> key_path(std::string const& key) {
  std::vector<std::string> path{""};
  for (char const c : key) {
    if (c == '.') {
      path.emplace_back();
    } else {
      path.back().push_back(c);
    }
  }
  return path;
}

/// Reads the axes of a study file and collects their problems.
class AxisReader {
 public:
  AxisReader(std::shared_ptr<SetupSource const> source, StudyMode mode, ReportProblem const& problem)
      : source_(std::move(source)), mode_(mode), problem_(problem) {}

  AxisPlan read(std::string const& key, SetupNode const& node) {
    AxisPlan axis;
    axis.key = key;
    axis.place = node.place;
    axis.place.source = source_;
    axis.path = key_path(key);
    if (std::find(axis.path.begin(), axis.path.end(), "") != axis.path.end()) {
      problem_(node.place, fmt::format("\"{}\" is not a key path; write it as \"table.key\"", excerpt(key)));
    }
    if (axis.path.size() > most_setup_depth) {
      problem_(node.place, fmt::format("\"{}\" has {} parts (no key of a setup has so many); correct it", excerpt(key),
                                       axis.path.size()));
    }
    if (node.kind == Kind::array) {
      read_list(node, axis);
    } else if (node.kind == Kind::table) {
      read_range(node, axis);
    } else {
      problem_(node.place, fmt::format("\"{0}\" must be a list of values (it is {1}); write [{2}]", key,
                                       kind_name(node), toml_text(node)));
    }
    return axis;
  }

 private:
  void read_list(SetupNode const& array, AxisPlan& axis) {
    if (array.elements.empty()) {
      problem_(array.place,
               fmt::format("\"{}\" is empty (the study would have no case); give at least one value", axis.key));
    }
    std::map<std::string, std::string> label_of;  // label of each distinct value
    std::set<std::string> labels;
    for (SetupNode const& element : array.elements) {
      AxisValue value = read_value(element, axis.key);
      ParameterValue const& shown = value.parameter;
      std::string const what = shown.number ? number_label(*shown.number) : toml_text(value.node);
      auto const [known, fresh] = label_of.try_emplace(what, shown.label);
      bool const renamed = known->second != shown.label;
      // In a zip, values of one axis may repeat, but points may not; see read_study().
      if (!fresh && (renamed || mode_ != StudyMode::zip)) {
        std::string const names = !renamed ? "" : fmt::format(" (as \"{}\" and as \"{}\")", known->second, shown.label);
        problem_(element.place, fmt::format("\"{}\" has the value {} twice{}; remove one (repeats = N gives every case "
                                            "N times, with other dots)",
                                            axis.key, what, names));
      } else if (fresh && !labels.insert(shown.label).second) {
        problem_(element.place, fmt::format("\"{}\" has two values with the label {}; give one of them another label",
                                            axis.key, shown.label));
      }
      axis.list.push_back(std::move(value));
    }
  }

  AxisValue read_value(SetupNode const& element, std::string const& key) {
    AxisValue value;
    value.node = element;
    set_source(value.node, source_);
    if (element.is_number()) {
      value.parameter = {number_label(element.as_double()), element.as_double()};
    } else if (element.kind == Kind::text) {
      value.parameter.label = element.text;
    } else if (element.kind != Kind::table) {
      value.parameter.label = toml_text(element);
    } else {
      auto& members = value.node.members;
      SetupNode const* const label = element.find("label");
      if (!label || label->kind != Kind::text || label->text.empty()) {
        problem_(label ? label->place : element.place,
                 fmt::format("a table as a value of \"{}\" needs a label for tables and figures; write {{ label = "
                             "\"name\", ... }}",
                             key));
      } else {
        value.parameter.label = label->text;
      }
      std::erase_if(members, [](SetupMember const& member) { return member.key == "label"; });
      if (members.size() == 1 && members.front().key == "value") {  // a label for a value that is not a table
        SetupNode const inner = members.front().value;
        value.node = inner;
        if (inner.is_number()) value.parameter.number = inner.as_double();
      }
    }
    return value;
  }

  void read_range(SetupNode const& table, AxisPlan& axis) {
    if (table.members.size() != 1 || (table.members[0].key != "linear" && table.members[0].key != "log"))
      return refuse_form(table, axis);
    std::string const& form = table.members.front().key;
    SetupNode const& values = table.members.front().value;
    auto const refuse = [&](std::string const& message) {
      problem_(values.place, fmt::format("\"{}\": {} {}", axis.key, form, message));
    };
    auto const& e = values.elements;
    bool const numbers = values.kind == Kind::array && e.size() == 3 &&
                         std::all_of(e.begin(), e.end(), [](SetupNode const& one) { return one.is_number(); });
    if (!numbers) return refuse("must be [first, last, count], three numbers");
    AxisPlan::Range range;
    range.first = e[0].as_double();
    range.last = e[1].as_double();
    range.logarithmic = form == "log";
    range.whole = e[0].kind == Kind::integer && e[1].kind == Kind::integer;
    if (!std::isfinite(range.first) || !std::isfinite(range.last)) return refuse("requires finite ends");
    if (range.logarithmic && !(range.first > 0 && range.last > 0)) return refuse("requires ends above 0");
    if (e[2].kind != Kind::integer || e[2].integer < 1)
      return refuse("requires an integer count of at least 1 as the third number");
    range.count = static_cast<std::size_t>(e[2].integer);
    if (range.count > 1 && range.first == range.last) return refuse("has equal ends; write this value once, in a list");
    axis.range = range;
  }

  /// Reports a table that is not one of the forms of a range.
  void refuse_form(SetupNode const& table, AxisPlan const& axis) {
    std::string const forms = "must be a list, { linear = [first, last, count] } or { log = [first, last, count] }";
    std::string const found = table.members.empty() ? "nothing" : '"' + table.members[0].key + '"';
    std::string hint;
    if (!table.members.empty()) {
      std::string const& key = table.members[0].key;
      auto nearest = nearest_name(key, {"linear", "log"});
      if (key.starts_with("lin")) nearest = "linear";
      if (key.starts_with("log")) nearest = "log";
      if (nearest) {
        hint = fmt::format("; did you mean \"{}\"?", *nearest);
      } else if (axis.path.size() == 1) {  // lens.f_number = ...: "lens" was read as the axis
        hint = fmt::format("; write a key path in quotes: \"{}.{}\" = ...", axis.key, key);
      }
    }
    problem_(table.place, fmt::format("\"{}\" {} (it is a table with {}){}", axis.key, forms, found, hint));
  }

  std::shared_ptr<SetupSource const> source_;
  StudyMode mode_;
  ReportProblem const& problem_;
};

}  // namespace

AxisPlan read_study_axis(std::string const& key, SetupNode const& node,
                         std::shared_ptr<SetupSource const> const& source, StudyMode mode,
                         ReportProblem const& problem) {
  return AxisReader(source, mode, problem).read(key, node);
}

}  // namespace gladstone::inline sweep
