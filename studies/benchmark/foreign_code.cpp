#include "studies/benchmark/foreign_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "analysis/vectors/convention_report.h"
#include "analysis/vectors/vector_screening.h"
#include "render/base/error.h"
#include "render/base/median.h"
#include "studies/compare/compared_vectors.h"

namespace gladstone::inline benchmarks {
namespace {

namespace fs = std::filesystem;

using Verdict = DetectedConventions::Verdict;

/// Greatest median error of a code that measures, as a fraction of the displacement: one that finds whole pixels only
/// errs by a quarter of a pixel, a quarter of the vortex's median displacement.
constexpr double most_wrong = 0.3;

/// Grid nodes along one axis.
struct Nodes {
  std::size_t distinct = 0;  ///< number of distinct coordinates
  double spacing = 0.0;      ///< median distance between neighbouring coordinates [px]
  double low = 0.0, high = 0.0;

  /// Returns the number of nodes of a complete grid, which extends to within `margin` of either border.
  std::size_t expected(int size, double margin) const {
    double const first = low - spacing * std::max(0.0, std::floor((low - margin) / spacing));
    double const last = high + spacing * std::max(0.0, std::floor((size - 1 - margin - high) / spacing));
    return static_cast<std::size_t>(std::lround((last - first) / spacing)) + 1;
  }
};

Nodes find_nodes(DisplacementField const& field, double Vec2d::*component) {
  std::set<long long> cells;  // distinct coordinates, rounded to multiples of 0.01 px
  for (Vec2d const& p : field.position_px) cells.insert(std::llround(100.0 * p.*component));
  std::vector<double> levels, steps;
  for (long long const cell : cells) {
    double const at = 0.01 * static_cast<double>(cell);
    if (!levels.empty() && at - levels.back() < 0.05) continue;
    if (!levels.empty()) steps.push_back(at - levels.back());
    levels.push_back(at);
  }
  if (steps.empty()) return {levels.size(), 0.0, 0.0, 0.0};
  return {levels.size(), upper_median(std::move(steps)), levels.front(), levels.back()};
}

}  // namespace

std::map<std::string, std::string> find_vectors(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases) {
  std::map<std::string, std::string> files;
  std::error_code error;
  bool const is_folder = fs::is_directory(given.path, error);
  for (BenchmarkCase const& one : cases)
    for (char const* ending : {".csv", ".txt", ".h5", ".dat", ".vec", ".jvc"}) {
      fs::path const path = is_folder ? fs::path(given.path) / (one.name + ending) : fs::path(given.path);
      if (path.filename() == one.name + ending && fs::exists(path, error)) files.emplace(one.name, path.string());
    }
  if (files.empty())
    throw DataError(ErrorCode::missing_content, given.path,
                    fmt::format("contains no vectors of the selected cases (files must be named after the "
                                "cases, for example {0}.csv, {0}.txt or {0}.h5); rename them",
                                cases.front().name));
  return files;
}

ForeignCode::ForeignCode(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases)
    : name_(given.name), files_(find_vectors(given, cases)), told_(given.conventions) {}

void ForeignCode::read(std::string const& of_case, DisplacementAt const& truth, int columns, int rows) {
  auto const found = files_.find(of_case);
  if (found == files_.end()) return;
  std::string const& path = found->second;
  VectorFile file = read_vectors(path);
  log_remarks(file);
  if (!file.complete)
    mistakes_.push_back(fmt::format("{}: the header of {} declares another number of vectors", name_, path));
  if (told_) override_conventions(file, *told_);
  file = convert_to_pixels(std::move(file), path);
  bool const turned = file.conventions.exchanges_places();
  RejectedVectors const left_out =
      screen_vectors(file.field, file.conventions.offset_px, turned ? rows : columns, turned ? columns : rows);
  if (std::string const refusal = reason_to_reject_positions(file.field, left_out, columns, rows); !refusal.empty())
    throw DataError(ErrorCode::inconsistent, path, refusal);
  if (std::none_of(file.field.displacement_px.begin(), file.field.displacement_px.end(), is_finite))
    throw DataError(ErrorCode::missing_content, path,
                    "contains no finite displacement; export the vectors with their values");
  cases_.push_back({of_case, path, columns});
  vectors_.push_back({std::move(file), truth, rows});
}

std::vector<BenchmarkRow> ForeignCode::score() {
  VectorFile const& first = vectors_.front().file;
  bool const told = told_ && specifies_reading(*told_);
  bool const ours = !first.foreign && cases_.front().path.ends_with(".h5");
  VectorConventions conventions = first.conventions;
  if (told) reading_ = fmt::format("{} vectors, as specified: {}", first.format, describe(conventions));
  if (!told && !ours) {
    CommonConventions const common = detect_common_conventions(vectors_);
    auto const no_convention_fits = [](DetectedConventions const& one) {
      return one.verdict == Verdict::no_convention_fits;
    };
    auto const can_tell = [](DetectedConventions const& one) { return one.verdict != Verdict::cannot_be_told; };
    bool const any_tells = std::any_of(common.detected.begin(), common.detected.end(), can_tell);
    bool const none_fits = std::all_of(common.detected.begin(), common.detected.end(),
                                       [&](auto const& one) { return no_convention_fits(one) || !can_tell(one); });
    if (any_tells && none_fits && !common.mistake.found()) {
      auto const worst = std::find_if(common.detected.begin(), common.detected.end(), no_convention_fits);
      throw DataError(ErrorCode::inconsistent, cases_[static_cast<std::size_t>(worst - common.detected.begin())].path,
                      convention_report(*worst));
    }
    conventions = common.conventions;
    reading_ = fmt::format(
        "{} vectors read as {} ({}: rms difference from the truth {:.3g} px, rms of the truth {:.3g} px)", first.format,
        describe(conventions), cases_[common.decisive].name, common.fit.rms_px, common.fit.signal_px);
    DetectedConventions const& decisive = common.detected[common.decisive];
    if (decisive.conventions == conventions && conventions.offset_px != 0.0) reading_ += "; " + offset_report(decisive);
    if (common.ambiguous && !common.mistake.found())
      reading_ += "; another interpretation fits as well, and that of the format is used";
    if (std::string mistake = describe_mistakes(common); !mistake.empty()) mistakes_.push_back(std::move(mistake));
  }
  std::vector<BenchmarkRow> rows;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < cases_.size(); ++i) {
    Case const& one = cases_[i];
    VectorsWithTruth& vectors = vectors_[i];
    DisplacementField const field = apply_conventions(std::move(vectors.file.field), conventions, vectors.image_rows);
    if (std::string const refusal = reason_to_reject_gaps(field, one.columns, vectors.image_rows); !refusal.empty())
      throw DataError(ErrorCode::inconsistent, one.path, refusal);
    std::vector<Vec2d> const truth = truth_at_vectors(field, vectors.truth);
    rows.push_back({name_, one.name, score_case(one.name, field, vectors.truth, one.columns, vectors.image_rows), {}});
    bool const follows = median_relative_error(field, truth) < most_wrong;
    wrong += follows || is_too_fine_for_windows(field, vectors.truth) ? 0 : 1;
  }
  if (mistakes_.empty() && 2 * wrong > cases_.size())
    mistakes_.push_back(
        fmt::format("{}: in {} of {} cases half of the vectors differ from the truth by more than {:.0f} % of the "
                    "displacement, and no exchange of axes, factor or shift common to all of them explains this; check "
                    "that each file contains the vectors of the case that it is named after, in px",
                    name_, wrong, cases_.size(), 100.0 * most_wrong));
  return rows;
}

std::string ForeignCode::describe_mistakes(CommonConventions const& common) const {
  ProbableMistake const& mistake = common.mistake;
  if (mistake.found()) {
    std::string const& decisive = cases_[common.decisive].name;
    std::string cure = "correct the files";
    if (common.ambiguous) {
      cure = fmt::format("{} does not distinguish these; run a case that does, such as turbulence",
                         cases_.size() == 1 ? decisive : "these cases");
    } else if (!mistake.conventions.empty()) {
      cure += fmt::format(", or accept it with --conventions {}={}", name_, mistake.conventions);
    }
    return fmt::format(
        "{}: likely mistake: {} (by {}: without this the rms difference from the truth would be {:.3g} px, as scored "
        "it is {:.3g} px); {}",
        name_, describe_mistake(mistake), decisive, mistake.corrected_fit.rms_px, mistake.as_read.rms_px, cure);
  }
  if (common.mistaken.empty()) return {};
  constexpr std::size_t most_named = 3;
  std::string found;
  for (std::size_t k = 0; k < std::min(most_named, common.mistaken.size()); ++k) {
    std::size_t const i = common.mistaken[k];
    ProbableMistake const& own = common.detected[i].mistake;
    found +=
        fmt::format("{}{}: {}", found.empty() ? "" : "; ", cases_[i].name,
                    own.found() ? describe_mistake(own) : "the vectors do not follow the truth in any interpretation");
  }
  if (common.mistaken.size() > most_named)
    found += fmt::format("; and in {} more", common.mistaken.size() - most_named);
  return fmt::format("{}: likely mistake in {} of {} files: {}; correct {}", name_, common.mistaken.size(),
                     cases_.size(), found, common.mistaken.size() == 1 ? "it" : "them");
}

std::string reason_to_reject_gaps(DisplacementField const& field, int columns, int rows) {
  constexpr double margin_px = benchmark_border_px + 64.0;
  Nodes const x = find_nodes(field, &Vec2d::x), y = find_nodes(field, &Vec2d::y);
  bool const lattice = x.spacing > 0.0 && y.spacing > 0.0 &&
                       static_cast<double>(field.size()) > 0.05 * static_cast<double>(x.distinct * y.distinct);
  if (!lattice) return {};  // scattered, such as vectors of particle tracking
  std::size_t const expected = x.expected(columns, margin_px) * y.expected(rows, margin_px);
  if (field.size() >= expected) return {};
  return fmt::format(
      "has {} of the {} vectors of its grid ({:.4g} by {:.4g} px apart, from x {:.6g} to {:.6g} and y {:.6g} to {:.6g} "
      "of {} x {} px): {} are missing; write all of them, those without a measurement as nan or flagged as invalid",
      field.size(), expected, x.spacing, y.spacing, x.low, x.high, y.low, y.high, columns, rows,
      expected - field.size());
}

}  // namespace gladstone::inline benchmarks
