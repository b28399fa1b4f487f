#include "studies/sweep/study_table.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <unordered_map>

#include "render/base/error.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline sweep {
namespace {

/// Collects the distinct values of an axis in order of first appearance.
class AxisCollector {
 public:
  explicit AxisCollector(std::string key) { axis_.key = std::move(key); }

  std::size_t place_of(ParameterValue const& value) {
    auto const [known, fresh] = places_.try_emplace(value.label, axis_.labels.size());
    if (fresh) {
      axis_.labels.push_back(value.label);
      axis_.numbers.push_back(value.number.value_or(not_a_number));
      axis_.numeric = axis_.numeric && value.number.has_value();
      any_label_ = any_label_ || value.has_own_label();
      axis_.labelled = axis_.numeric && any_label_;
    }
    return known->second;
  }
  StudyAxis const& axis() const { return axis_; }

 private:
  StudyAxis axis_;
  bool any_label_ = false;
  std::unordered_map<std::string, std::size_t> places_;
};

}  // namespace

std::optional<std::size_t> StudyTable::find_measure(std::string_view wanted) const {
  auto const found = std::find(measures.begin(), measures.end(), wanted);
  if (found == measures.end()) return std::nullopt;
  return static_cast<std::size_t>(found - measures.begin());
}

std::vector<std::size_t> StudyTable::unfinished() const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].status != CaseStatus::ok) places.push_back(i);
  }
  return places;
}

std::vector<std::size_t> StudyTable::warned() const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].warned) places.push_back(i);
  }
  return places;
}

std::size_t StudyTable::repeats() const {
  std::size_t most = 0;
  for (StudyPoint const& point : points) most = std::max(most, point.rows.size());
  return most;
}

namespace {

/// Adds the rows of the manifest, without results, and groups them into points.
void add_rows(Manifest const& cases, std::string const& manifest, StudyTable& table) {
  std::vector<AxisCollector> axes;
  ManifestCase const first = cases[0];
  for (auto const& parameter : first.parameters) axes.emplace_back(parameter.first);
  std::map<std::vector<std::size_t>, std::size_t> points;
  table.rows.reserve(cases.size());
  for (std::size_t index = 0; index < cases.size(); ++index) {
    ManifestCase const one = cases[index];
    StudyRow row;
    row.index = one.index;
    row.repeat = one.repeat;
    row.seed = one.seed;
    row.on_gpu = one.device == "cuda";
    if (one.parameters.size() != axes.size()) {
      throw DataError(ErrorCode::inconsistent, manifest + ':' + std::to_string(one.index + 1),
                      "has other axes than the first line; plan the study again");
    }
    row.value.reserve(axes.size());
    for (std::size_t k = 0; k < axes.size(); ++k) row.value.push_back(axes[k].place_of(one.parameters[k].second));
    auto const [known, fresh] = points.try_emplace(row.value, table.points.size());
    if (fresh) table.points.emplace_back();
    table.points[known->second].rows.push_back(table.rows.size());
    table.rows.push_back(std::move(row));
  }
  table.points.shrink_to_fit();
  for (AxisCollector const& axis : axes) table.axes.push_back(axis.axis());
}

/// Copies results to the rows of a table.
class RowFiller {
 public:
  explicit RowFiller(StudyTable& table) : table_(table) {}

  /// Fills the row of a case; measures that are not in the table yet become new columns.
  void fill(CaseResult const& result) {
    StudyRow& row = table_.rows[result.index];
    row.status = result.status;
    row.error = result.error;
    if (!result.build.empty()) builds_.insert(result.build);
    row.warned = !result.warnings.empty();
    if (row.warned && result.index < first_warned_) {
      first_warned_ = result.index;
      table_.first_warning = result.warnings.front();
    }
    if (row.status == CaseStatus::ok) {
      row.seconds_render = result.seconds_render;
      row.seconds_correlate = result.seconds_correlate;
      row.seconds_compare = result.seconds_compare;
    }
    row.measures.reserve(table_.measures.size());
    for (auto const& [name, value] : result.measures) {
      auto const [known, fresh] = columns_.try_emplace(name, table_.measures.size());
      if (fresh) table_.measures.push_back(name);
      row.measures.resize(std::max(row.measures.size(), known->second + 1), not_a_number);
      row.measures[known->second] = value;
    }
  }
  /// Completes the rows of cases with fewer measures than others, or none.
  void finish() {
    for (StudyRow& row : table_.rows) row.measures.resize(table_.measures.size(), not_a_number);
    table_.builds.assign(builds_.begin(), builds_.end());
  }

 private:
  StudyTable& table_;
  std::unordered_map<std::string, std::size_t> columns_;
  std::set<std::string> builds_;
  std::size_t first_warned_ = std::numeric_limits<std::size_t>::max();
};

}  // namespace

StudyTable read_study_table(std::string const& run) {
  Manifest const cases = read_manifest(run);
  StudyTable table;
  std::filesystem::path const folder = std::filesystem::absolute(run).lexically_normal();
  table.name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  add_rows(cases, (folder / run_file::manifest).string(), table);
  // Read point by point to limit the memory for errors of vectors to those of one point.
  RowFiller rows(table);
  std::size_t const compared = table.repeats() > 1 ? vector_error_names().size() : 0;
  for (StudyPoint& point : table.points) {
    std::vector<std::vector<std::vector<Vec2d>>> errors(compared);  // [kind][repeat][vector]
    for (std::size_t const index : point.rows) {
      std::optional<CaseResult> result = read_result(run, index, cases.line_hash(index));
      if (!result) continue;
      rows.fill(*result);
      for (std::size_t k = 0; k < std::min(errors.size(), result->vectors.size()); ++k) {
        errors[k].push_back(std::move(result->vectors[k].errors_px));
      }
    }
    for (auto const& repeats : errors) point.splits.push_back(split_repeats(repeats));
  }
  rows.finish();
  return table;
}

}  // namespace gladstone::inline sweep
