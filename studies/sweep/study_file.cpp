#include "studies/sweep/study_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/base/sobol.h"
#include "render/files/text_file.h"
#include "render/setup/setup_table.h"

namespace gladstone {
namespace {

using Kind = SetupNode::Kind;

/// Rounds to twelve digits, so that values of a range are short decimals: 0.1 instead of 0.30000000000000004 - 0.2.
double rounded_setting(double value) {
  std::string const text = fmt::format("{:.12g}", value);
  double result = value;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

AxisValue number_value(double number, bool whole, SetupPlace const& place) {
  AxisValue value;
  value.node.place = place;
  bool const integer = whole && number == std::floor(number) && std::abs(number) < 0x1p53;
  value.node.kind = integer ? Kind::integer : Kind::number;
  value.node.integer = integer ? static_cast<long long>(number) : 0;
  value.node.number = number;
  value.parameter = {number_label(number), number};
  return value;
}

double along(AxisPlan::Range const& range, double t) {
  if (!range.logarithmic) return rounded_setting(range.first + t * (range.last - range.first));
  return rounded_setting(range.first * std::pow(range.last / range.first, t));
}

/// Returns true if adjacent values of the range certainly differ after rounding to twelve digits, a relative error of
/// at most 1e-11.
bool surely_tells_values_apart(AxisPlan::Range const& range) {
  double const steps = static_cast<double>(range.count - 1);
  if (range.logarithmic) return std::abs(std::log(range.last / range.first)) > 2e-11 * steps;
  return std::abs(range.last - range.first) > 2e-11 * steps * std::max(std::abs(range.first), std::abs(range.last));
}

/// Reads a study file and collects its problems with their positions.
class StudyReader {
 public:
  StudyReader(std::string const& path, std::string text)
      : document_(SetupDocument::from_text(text, path, folder_of(path))),
        source_(std::make_shared<SetupSource const>(SetupSource{path, folder_of(path)})) {
    study_.path = path;
    study_.text = std::move(text);
    if (document_.empty()) {
      throw SetupError({{path, "is empty (no key is set); gladstone sweep plan --help shows an example"}});
    }
  }

  StudyFile read() {
    SetupTable root = document_.root();
    study_.base_path = root.required_path("base");
    if (!study_.base_path.empty()) {
      try {
        study_.base_text = read_text_file(study_.base_path, "a setup file", most_setup_bytes);
        if (SetupDocument::from_text(study_.base_text, study_.base_path).empty()) {
          throw DataError(study_.base_path, "is empty (no key is set)");
        }
      } catch (DataError const& error) {
        root.problem("base", fmt::format("{} (the setup that every case starts from; relative names start at the "
                                         "study's folder)",
                                         error.what()));
      }
    }
    read_settings(root.table("study"));  // first, since the mode determines which lists are allowed
    read_axes(root);
    check_sizes();
    document_.finish();
    return std::move(study_);
  }

 private:
  static std::string folder_of(std::string const& path) {
    return std::filesystem::absolute(path).parent_path().string();
  }
  /// Adds this file as source to a position, for values that are inserted into another document.
  SetupPlace placed(SetupPlace place) const {
    place.source = source_;
    return place;
  }
  void problem(SetupPlace const& place, std::string message) {
    document_.add_problem(fmt::format("{}:{}:{}", study_.path, std::max(place.line, 1), std::max(place.column, 1)),
                          std::move(message));
  }

  void read_axes(SetupTable& root) {
    if (!root.has("axes"))
      root.problem("axes", "is missing; write [axes] and below it \"key.path\" = [values]", ProblemCode::missing_key);
    root.mark_as_read("axes");
    SetupNode const* const axes = document_.find({"axes"});
    if (!axes) return;
    study_.place = placed(axes->place);
    if (axes->kind != Kind::table) {
      problem(axes->place, "axes must be a table; write [axes] and below it \"key.path\" = [values]");
      return;
    }
    if (axes->members.empty()) problem(axes->place, "[axes] is empty; name at least one key of the setup");
    if (axes->members.size() > most_axes) {
      problem(axes->place, fmt::format("[axes] has {} keys ({} at most); put those that do not change into the base",
                                       axes->members.size(), most_axes));
      return;
    }
    for (auto const& [key, node] : axes->members) study_.axes.push_back(read_axis(key, node));
    std::stable_sort(study_.axes.begin(), study_.axes.end(), [](AxisPlan const& a, AxisPlan const& b) {
      return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
    });
  }

  AxisPlan read_axis(std::string const& key, SetupNode const& node) {
    AxisPlan axis;
    axis.key = key;
    axis.place = placed(node.place);
    axis.path.emplace_back();
    for (char const c : key) {
      if (c == '.') {
        axis.path.emplace_back();
      } else {
        axis.path.back().push_back(c);
      }
    }
    if (std::find(axis.path.begin(), axis.path.end(), "") != axis.path.end()) {
      problem(node.place, fmt::format("\"{}\" is not a key path; write it as \"table.key\"", excerpt(key)));
    }
    if (axis.path.size() > most_setup_depth) {
      problem(node.place, fmt::format("\"{}\" has {} parts (no key of a setup has so many); correct it", excerpt(key),
                                      axis.path.size()));
    }
    if (node.kind == Kind::array) {
      read_list(node, axis);
    } else if (node.kind == Kind::table) {
      read_range(node, axis);
    } else {
      problem(node.place, fmt::format("\"{0}\" must be a list of values (it is {1}); write [{2}]", key, kind_name(node),
                                      toml_text(node)));
    }
    return axis;
  }

  void read_list(SetupNode const& array, AxisPlan& axis) {
    if (array.elements.empty()) {
      problem(array.place,
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
      // In a zip, values of one axis may repeat, but points may not; see refuse_points_twice().
      if (!fresh && (renamed || study_.mode != StudyMode::zip)) {
        std::string const names = !renamed ? "" : fmt::format(" (as \"{}\" and as \"{}\")", known->second, shown.label);
        problem(element.place, fmt::format("\"{}\" has the value {} twice{}; remove one (repeats = N gives every case "
                                           "N times, with other dots)",
                                           axis.key, what, names));
      } else if (fresh && !labels.insert(shown.label).second) {
        problem(element.place, fmt::format("\"{}\" has two values with the label {}; give one of them another label",
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
        problem(label ? label->place : element.place,
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
    std::string const forms = "must be a list, { linear = [first, last, count] } or { log = [first, last, count] }";
    if (table.members.size() != 1 || (table.members[0].key != "linear" && table.members[0].key != "log")) {
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
      problem(table.place, fmt::format("\"{}\" {} (it is a table with {}){}", axis.key, forms, found, hint));
      return;
    }
    std::string const& form = table.members.front().key;
    SetupNode const& values = table.members.front().value;
    auto const refuse = [&](std::string const& message) {
      problem(values.place, fmt::format("\"{}\": {} {}", axis.key, form, message));
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

  void read_settings(SetupTable table) {
    std::string const mode = table.word("mode", "grid", {"grid", "zip", "sobol"});
    if (mode == "zip") study_.mode = StudyMode::zip;
    if (mode == "sobol") study_.mode = StudyMode::sobol;
    if (study_.mode == StudyMode::sobol) {
      study_.samples = static_cast<std::size_t>(table.required_integer("samples", 1, most));
    } else {
      table.refuse("samples",
                   "applies to mode = \"sobol\" only (the axes determine the number of cases of a grid or a zip)");
    }
    study_.repeats = static_cast<std::size_t>(table.integer("repeats", 1, 1, most));
    study_.seed = static_cast<std::uint64_t>(table.integer("seed", 1, 0, most));
  }

  void check_sizes() {
    if (document_.has_problems() || study_.axes.empty()) return;
    refuse_axes_within_axes();
    SetupTable table = document_.root().table("study");
    if (study_.mode == StudyMode::sobol && study_.axes.size() > sobol_dimensions) {
      table.problem("mode", fmt::format("\"sobol\" takes up to {} axes (the study has {}); use fewer, or a grid",
                                        sobol_dimensions, study_.axes.size()));
    }
    if (study_.mode == StudyMode::zip) {
      AxisPlan const& first = study_.axes.front();
      for (AxisPlan const& axis : study_.axes) {
        if (axis.size() == first.size()) continue;
        problem(axis.place, fmt::format("\"{}\" has {} values but \"{}\" has {} (a zip combines the values of all axes "
                                        "one by one); give equally many, or use mode = \"grid\"",
                                        axis.key, axis.size(), first.key, first.size()));
      }
    }
    double cases = static_cast<double>(study_.repeats);
    if (study_.mode == StudyMode::sobol) cases *= static_cast<double>(study_.samples);
    if (study_.mode == StudyMode::zip) cases *= static_cast<double>(study_.axes.front().size());
    if (study_.mode == StudyMode::grid) {
      for (AxisPlan const& axis : study_.axes) cases *= static_cast<double>(axis.size());
    }
    if (cases > static_cast<double>(most_cases)) {
      problem(study_.place,
              fmt::format("the study has {} cases ({} at most); take fewer values or repeats, or mode = "
                          "\"sobol\" with samples",
                          cases < 1e15 ? fmt::format("{:.0f}", cases) : fmt::format("{:.3g}", cases), most_cases));
    } else if (study_.mode != StudyMode::sobol) {
      for (AxisPlan const& axis : study_.axes) refuse_steps_of_nothing(axis);
      if (study_.mode == StudyMode::zip && !document_.has_problems()) refuse_points_twice();
    }
  }

  /// Reports points of a zip at which all axes have the same values; they would count as repeats of one point.
  void refuse_points_twice() {
    std::unordered_map<std::string, std::size_t> points;
    for (std::size_t i = 0; i < study_.points(); ++i) {
      std::string labels;
      for (AxisPlan const& axis : study_.axes) labels += axis.value(i).parameter.label + '\0';
      auto const [known, fresh] = points.try_emplace(std::move(labels), i);
      if (fresh) continue;
      std::string named;
      for (AxisPlan const& axis : study_.axes) {
        named += fmt::format("{}{} = {}", named.empty() ? "" : ", ", axis.key, axis.value(i).parameter.label);
      }
      problem(study_.axes.front().value(i).node.place,
              fmt::format("the values {} and {} of the axes are the same ({}); remove one (repeats = N gives every "
                          "case N times, with other dots)",
                          known->second + 1, i + 1, named));
    }
  }

  /// Reports an axis for a key within a table that is itself an axis; the later one would overwrite the other.
  void refuse_axes_within_axes() {
    for (AxisPlan const& above : study_.axes) {
      for (AxisPlan const& axis : study_.axes) {
        if (axis.path.size() <= above.path.size()) continue;
        if (!std::equal(above.path.begin(), above.path.end(), axis.path.begin())) continue;
        problem(axis.place,
                fmt::format("\"{0}\" is part of \"{1}\", which is also an axis (line {2}), so that one would overwrite "
                            "the other; write its values into the tables of \"{1}\", or remove one of the two",
                            axis.key, above.key, above.place.line));
      }
    }
  }

  /// Reports a range that is so fine that two of its values are equal.
  void refuse_steps_of_nothing(AxisPlan const& axis) {
    if (!axis.range || surely_tells_values_apart(*axis.range)) return;
    for (std::size_t i = 1; i < axis.size(); ++i) {
      ParameterValue const value = axis.value(i).parameter;
      if (value.number != axis.value(i - 1).parameter.number) continue;
      problem(axis.place, fmt::format("\"{}\" has the value {} twice (numbers of a range have twelve digits); give a "
                                      "smaller count",
                                      axis.key, value.label));
      return;
    }
  }

  static constexpr long long most = std::numeric_limits<long long>::max();
  static constexpr std::size_t most_axes = 100;
  SetupDocument document_;
  std::shared_ptr<SetupSource const> source_;
  StudyFile study_;
};

}  // namespace

AxisValue AxisPlan::value(std::size_t i) const {
  if (!range) return list[i];
  double number = range->first;
  if (i > 0) number = i + 1 == range->count ? range->last : along(*range, static_cast<double>(i) / (range->count - 1));
  return number_value(number, range->whole, place);
}

AxisValue AxisPlan::value_at(double u) const {
  if (range) return number_value(along(*range, u), false, place);
  return list[std::min(list.size() - 1, static_cast<std::size_t>(u * static_cast<double>(list.size())))];
}

std::size_t StudyFile::points() const {
  if (mode == StudyMode::sobol) return samples;
  if (mode == StudyMode::zip) return axes.front().size();
  std::size_t count = 1;
  for (AxisPlan const& axis : axes) count *= axis.size();
  return count;
}

StudyFile read_study(std::string const& path) {
  std::string text;
  try {
    text = read_text_file(path, "a study file", most_setup_bytes);
  } catch (DataError const& error) {
    throw SetupError({{path, error.message(), "", ProblemCode::unreadable_file}});
  }
  return StudyReader(path, std::move(text)).read();
}

}  // namespace gladstone
