#include "studies/sweep/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <string_view>
#include <utility>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/base/random.h"
#include "render/base/sobol.h"
#include "render/files/content_hash.h"
#include "render/scene/read_setup.h"
#include "studies/case/case.h"
#include "studies/case/correlation_setup.h"
#include "studies/case/sequence_pair.h"

namespace gladstone::inline sweep {
namespace {

/// Returns the seed of a repeat. TOML integers have 63 bits.
std::uint64_t case_seed(StudyFile const& study, std::size_t repeat) {
  return repeat == 0 ? study.seed : repeat_seed(study.seed, repeat) >> 1;
}

/// Returns true if the axes define the value at a key path, directly or in a table that contains it.
bool axes_give(StudyFile const& study, std::vector<AxisValue> const& values, std::vector<std::string> const& path) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::vector<std::string> const& above = study.axes[k].path;
    if (above.size() > path.size() || !std::equal(above.begin(), above.end(), path.begin())) continue;
    SetupNode const* node = &values[k].node;
    for (std::size_t i = above.size(); node && i < path.size(); ++i) node = node->find(path[i]);
    if (node) return true;
  }
  return false;
}

/// Composes a setup from the study's base and the axes' values, and sets the seeds that no axis defines.
SetupDocument compose(StudyFile const& study, std::vector<AxisValue> const& values, std::uint64_t seed) {
  SetupDocument document = study.base->copy();
  for (std::size_t k = 0; k < values.size(); ++k) document.set(study.axes[k].path, values[k].node);
  SetupNode number = setup_integer(static_cast<long long>(seed));
  number.place = study.place;
  SourceKind const& sources = find_experiment(document).sources;
  std::vector<std::vector<std::string>> const seeds{
      {sources.seed_table, "seed"}, {"render", "seed"}, {"camera", "noise", "seed"}};
  for (std::vector<std::string> const& path : seeds) {
    if (axes_give(study, values, path)) continue;
    SetupNode const* const table = document.find({path.begin(), path.end() - 1});
    if (!table && path.size() > 2) continue;  // do not add a noise table that the setup does not have
    // Skip a value that should be a table but is not; reading the setup reports it.
    if (table && table->kind != SetupNode::Kind::table && table->kind != SetupNode::Kind::array) continue;
    document.set(path, number);
  }
  return document;
}

/// Returns the values of all axes at a point of the study.
std::vector<AxisValue> values_at(StudyFile const& study, std::size_t point) {
  std::vector<AxisValue> values(study.axes.size());
  std::size_t rest = point;
  for (std::size_t k = values.size(); k-- > 0;) {
    AxisPlan const& axis = study.axes[k];
    if (study.mode == StudyMode::zip) {
      values[k] = axis.value(point);
    } else if (study.mode == StudyMode::grid) {
      values[k] = axis.value(rest % axis.size());
      rest /= axis.size();
    } else {
      auto const scrambling = static_cast<std::uint32_t>(mix64(study.seed + 0x9e3779b97f4a7c15ULL * (k + 1)));
      std::uint32_t const bits = sobol_bits(static_cast<std::uint32_t>(point), static_cast<int>(k));
      values[k] = axis.value_at(owen_scramble(bits, scrambling) * 0x1p-32);
    }
  }
  return values;
}

/// Returns true if the axis is a range that is sampled between its ends (sobol mode).
bool is_sampled(StudyFile const& study, AxisPlan const& axis) {
  return study.mode == StudyMode::sobol && axis.range.has_value();
}

/// Returns the number of values to check in addition to the first: all others, or the other end and one sample.
std::size_t further_values(StudyFile const& study, AxisPlan const& axis) {
  if (!is_sampled(study, axis)) return axis.size() - 1;
  return axis.size() > 1 ? 2 : 1;
}

/// Returns the number of points needed to check the further_values() of all axes.
std::size_t points_to_try(StudyFile const& study) {
  if (study.mode == StudyMode::zip) return study.points();
  std::size_t count = 1;
  for (AxisPlan const& axis : study.axes) count += further_values(study, axis);
  return count;
}

/// Returns the i-th point to check: first the first values of all axes, then the other values of each axis with the
/// first values of the others.
std::vector<AxisValue> point_to_try(StudyFile const& study, std::size_t i) {
  if (study.mode == StudyMode::zip) return values_at(study, i);
  std::vector<AxisValue> point;
  for (AxisPlan const& axis : study.axes) point.push_back(axis.value(0));
  for (std::size_t k = 0; i > 0; ++k) {
    AxisPlan const& axis = study.axes[k];
    std::size_t const further = further_values(study, axis);
    if (i > further) {
      i -= further;
      continue;
    }
    if (!is_sampled(study, axis)) {
      point[k] = axis.value(i);
    } else {
      point[k] = i < further ? axis.value(axis.size() - 1) : values_at(study, 0)[k];
    }
    break;
  }
  return point;
}

std::string where(StudyFile const& study, SetupPlace const& place) {
  return fmt::format("{}:{}:{}", study.path, place.line, place.column);
}

/// Assigns an unknown key to the axis instead of its values, and adds a remedy if a sampled range yields no integers.
void blame_the_axis(StudyFile const& study, std::vector<AxisValue> const& values, SetupProblem& problem) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (problem.where != where(study, values[k].node.place)) continue;
    if (problem.code == ErrorCode::unknown_key) problem.where = where(study, study.axes[k].place);
    if (study.mode == StudyMode::sobol && study.axes[k].range && problem.code == ErrorCode::wrong_type) {
      problem.message += "; \"sobol\" draws any numbers between the ends of a range, so write integers as a list";
    }
  }
}

std::vector<SetupProblem> problems_at(StudyFile const& study, std::vector<AxisValue> const& point, std::size_t& more) {
  try {
    load_case_setup(compose(study, point, study.seed), FieldMemory::taken);
  } catch (SetupError const& error) {
    std::vector<SetupProblem> problems = error.problems();
    for (SetupProblem& problem : problems) blame_the_axis(study, point, problem);
    more = error.more();
    return problems;
  }
  return {};
}

void try_all(StudyFile const& study) {
  std::size_t const points = points_to_try(study), tried = std::min(points, StudyPlan::most_tried);
  struct Found {
    std::vector<SetupProblem> problems;
    std::size_t more = 0;
  };
  std::vector<Found> found(tried);
  Progress progress("trying values", tried);
  parallel_chunks(tried, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // If there are too many points, check evenly spaced ones, including the first and the last.
      std::size_t const point = tried == points ? i : i * (points - 1) / (tried - 1);
      found[i].problems = problems_at(study, point_to_try(study, point), found[i].more);
    }
    progress.advance(end - begin);
  });
  std::vector<SetupProblem> problems;
  std::set<std::pair<std::string_view, std::string_view>> known;
  std::size_t more = 0;
  for (Found const& one : found) {
    more = std::max(more, one.more);
    for (SetupProblem const& problem : one.problems) {
      if (known.emplace(problem.where, problem.message).second) problems.push_back(problem);
    }
  }
  if (!problems.empty()) throw SetupError(std::move(problems), more);
}

/// Returns the values that can affect file names in a setup: texts and tables, but not numbers.
std::string words_of(std::vector<AxisValue> const& values) {
  std::string words;
  for (AxisValue const& value : values) words += (value.node.is_number() ? "" : value.parameter.label) + '\0';
  return words;
}

}  // namespace

struct StudyPlan::Parts {
  StudyFile study;
  std::string device;
  std::mutex mutex;  ///< protects the members below
  /// Paths of the keys that are file names, for each words_of() the axis values.
  std::map<std::string, std::vector<std::vector<std::string>>> file_keys;
  std::map<std::string, std::string> hashes;  ///< hash of each file, by name

  std::vector<std::vector<std::string>> keys_of_files(std::vector<AxisValue> const& values,
                                                      SetupDocument const& document) {
    std::string const words = words_of(values);
    {
      std::lock_guard const lock(mutex);
      if (auto const known = file_keys.find(words); known != file_keys.end()) return known->second;
    }
    SetupDocument read = document.copy();
    read_setup(read.root());
    read_correlation_settings(read.root().table("correlate"));
    std::lock_guard const lock(mutex);
    return file_keys[words] = read.file_keys();
  }

  std::string hash_of(std::string const& file) {
    std::lock_guard const lock(mutex);
    std::string& hash = hashes[file];
    if (hash.empty()) hash = file_hash(file);
    return hash;
  }
};

StudyPlan::StudyPlan(StudyFile study, std::string device) {
  try_all(study);
  parts_.reset(new Parts{std::move(study), std::move(device), {}, {}, {}});
}

StudyPlan::~StudyPlan() = default;
StudyPlan::StudyPlan(StudyPlan&&) noexcept = default;

StudyFile const& StudyPlan::study() const { return parts_->study; }

std::string StudyPlan::base() const {
  SetupDocument document = parts_->study.base->copy();
  document.name_files(parts_->keys_of_files({}, document));
  return document.written();
}

Warnings StudyPlan::warnings() const {
  StudyFile const& study = parts_->study;
  if (!describes_sequence(compose(study, point_to_try(study, 0), study.seed))) return {};
  return {{WarningCode::ignored, study.path,
           "every case is the first pair of the base's [sequence]; for other pairs add the axis \"sequence.pair\""}};
}

std::size_t StudyPlan::size() const { return parts_->study.points() * parts_->study.repeats; }

ManifestCase StudyPlan::without_hash(std::size_t index) const {
  StudyFile const& study = parts_->study;
  std::size_t const points = study.points();
  std::vector<AxisValue> const values = values_at(study, index % points);
  ManifestCase one;
  one.index = index;
  one.repeat = index / points;
  one.seed = case_seed(study, one.repeat);
  one.device = parts_->device;
  for (std::size_t k = 0; k < values.size(); ++k) {
    one.parameters.emplace_back(study.axes[k].key, values[k].parameter);
  }
  SetupDocument document = compose(study, values, one.seed);
  document.name_files(parts_->keys_of_files(values, document));
  one.setup = document.written();
  for (std::string const& name : document.file_names()) one.inputs[name] = parts_->hash_of(name);
  document.name_files({});  // the names are absolute now, and reading the setup lists them again
  one.document = std::make_shared<SetupDocument const>(std::move(document));
  return one;
}

ManifestCase StudyPlan::operator[](std::size_t index) const {
  ManifestCase one = without_hash(index);
  one.line_hash = hash_of_line(manifest_line(one));
  return one;
}

std::string StudyPlan::line(std::size_t index) const { return manifest_line(without_hash(index)); }

}  // namespace gladstone::inline sweep
