#include "studies/sweep/study_table.h"

#include <algorithm>
#include <filesystem>
#include <unordered_map>

#include "render/base/error.h"

namespace gladstone {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Gathers the distinct values of an axis in the order of appearance.
class AxisCollector {
 public:
  explicit AxisCollector(std::string key) { axis_.key = std::move(key); }

  std::size_t place_of(ParameterValue const& value) {
    auto const [known, fresh] = places_.try_emplace(value.label, axis_.labels.size());
    if (fresh) {
      axis_.labels.push_back(value.label);
      axis_.numbers.push_back(value.number.value_or(nan));
      axis_.numeric = axis_.numeric && value.number.has_value();
    }
    return known->second;
  }
  StudyAxis const& axis() const { return axis_; }

 private:
  StudyAxis axis_;
  std::unordered_map<std::string, std::size_t> places_;
};

template <class Items, class Name>
std::optional<std::size_t> place_in(Items const& items, Name const& matches) {
  auto const found = std::find_if(items.begin(), items.end(), matches);
  if (found == items.end()) return std::nullopt;
  return static_cast<std::size_t>(found - items.begin());
}

}  // namespace

std::optional<std::size_t> StudyTable::find_measure(std::string_view wanted) const {
  return place_in(measures, [&](std::string const& known) { return known == wanted; });
}

std::optional<std::size_t> StudyTable::find_axis(std::string_view wanted) const {
  return place_in(axes, [&](StudyAxis const& known) { return known.key == wanted; });
}

std::vector<std::size_t> StudyTable::unfinished() const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].status != CaseStatus::ok) places.push_back(i);
  }
  return places;
}

StudyTable read_study_table(std::string const& run) {
  std::vector<ManifestCase> const cases = read_manifest(run);
  StudyTable table;
  std::filesystem::path const folder = std::filesystem::absolute(run).lexically_normal();
  table.name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  std::vector<AxisCollector> axes;
  for (auto const& parameter : cases.front().parameters) axes.emplace_back(parameter.first);
  std::unordered_map<std::string, std::size_t> columns;
  for (ManifestCase const& one : cases) {
    StudyRow row;
    row.index = one.index;
    row.repeat = one.repeat;
    row.seed = one.seed;
    row.device = one.device;
    if (one.parameters.size() != axes.size()) {
      throw DataError((folder / run_file::manifest).string() + ':' + std::to_string(one.index + 1),
                      "has other axes than the first line; plan the study again");
    }
    for (std::size_t k = 0; k < axes.size(); ++k) row.value.push_back(axes[k].place_of(one.parameters[k].second));
    if (std::optional<CaseResult> const result = read_result(run, one)) {
      row.status = result->status;
      row.error = result->error;
      if (row.status == CaseStatus::ok) {
        row.seconds_render = result->seconds_render;
        row.seconds_correlate = result->seconds_correlate;
        row.seconds_compare = result->seconds_compare;
      }
      for (auto const& [name, value] : result->measures) {
        auto const [known, fresh] = columns.try_emplace(name, table.measures.size());
        if (fresh) table.measures.push_back(name);
        row.measures.resize(std::max(row.measures.size(), known->second + 1), nan);
        row.measures[known->second] = value;
      }
    }
    table.rows.push_back(std::move(row));
  }
  for (StudyRow& row : table.rows) row.measures.resize(table.measures.size(), nan);
  for (AxisCollector const& axis : axes) table.axes.push_back(axis.axis());
  return table;
}

}  // namespace gladstone
