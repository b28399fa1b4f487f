#include "studies/benchmark/foreign_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "analysis/vectors/vector_screening.h"
#include "render/base/error.h"
#include "studies/compared_vectors.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

using Verdict = DetectedConventions::Verdict;

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
  std::set<long long> cells;  // coordinates in units of 0.01 px
  for (Vec2d const& p : field.position_px) cells.insert(std::llround(100.0 * p.*component));
  std::vector<double> levels, steps;
  for (long long const cell : cells) {
    double const at = 0.01 * static_cast<double>(cell);
    if (!levels.empty() && at - levels.back() < 0.05) continue;
    if (!levels.empty()) steps.push_back(at - levels.back());
    levels.push_back(at);
  }
  if (steps.empty()) return {levels.size(), 0.0, 0.0, 0.0};
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  return {levels.size(), steps[steps.size() / 2], levels.front(), levels.back()};
}

/// Combined evidence of all cases for an alternative interpretation of the vectors.
struct Evidence {
  VectorConventions reading;
  double sum = 0.0;
  std::string strongest;  ///< the case with the strongest evidence
  double most = 0.0, rms_px = 0.0, rms_as_read = 0.0;
};

bool same_axes(VectorConventions const& a, VectorConventions const& b) {
  return a.y_up == b.y_up && a.v_up == b.v_up && a.swapped == b.swapped && a.exchange == b.exchange;
}

/// Computes the combined evidence for every choice of axes, signs and columns that the format does not allow. Combining
/// the cases resolves ambiguities of individual ones.
std::vector<Evidence> weigh_readings(std::vector<std::pair<std::string, DetectedConventions>> const& cases,
                                     std::vector<VectorConventions> const& own) {
  std::vector<Evidence> all;
  for (auto const& [of_case, detected] : cases) {
    for (ConventionFit const& fit : detected.tried) {
      auto const same = [&fit](VectorConventions const& reading) { return same_axes(reading, fit.conventions); };
      if (std::any_of(own.begin(), own.end(), same)) continue;
      auto known = std::find_if(all.begin(), all.end(), [&](Evidence const& one) { return same(one.reading); });
      if (known == all.end()) known = all.insert(all.end(), Evidence{fit.conventions, 0.0, {}, 0.0, 0.0, 0.0});
      double const evidence = evidence_for(fit, detected.fit);
      if (std::isfinite(evidence)) known->sum += evidence;
      if (!(evidence > known->most)) continue;
      known->most = evidence;
      known->strongest = of_case;
      known->rms_px = fit.rms_px;
      known->rms_as_read = detected.fit.rms_px;
    }
  }
  return all;
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
    throw DataError(given.path, fmt::format("holds no vectors of a case that is run (files named after cases, such as "
                                            "{0}.csv, {0}.txt or {0}.h5); name them so",
                                            cases.front().name));
  return files;
}

ForeignCode::ForeignCode(ForeignVectors const& given, std::vector<BenchmarkCase> const& cases)
    : name_(given.name), files_(find_vectors(given, cases)), told_(given.conventions) {}

DisplacementField ForeignCode::read(std::string const& of_case, DisplacementAt const& truth, int columns, int rows) {
  std::string const& path = files_.at(of_case);
  VectorFile file = read_vectors(path);
  log_remarks(file);
  if (!file.complete)
    incomplete_.push_back(fmt::format("{}: the header of {} declares another number of vectors", name_, path));
  if (told_) override_conventions(file, *told_);
  file = convert_to_pixels(std::move(file), path);
  if (conventions_) {
    file.also.push_back(file.conventions);
    file.conventions = *conventions_;
  }
  bool const turned = file.conventions.exchanges_places();
  LeftOutVectors const left_out =
      screen_vectors(file.field, file.conventions.offset_px, turned ? rows : columns, turned ? columns : rows);
  if (std::string const refusal = refusal_of_places(file.field, left_out, columns, rows); !refusal.empty())
    throw DataError(path, refusal);
  auto const is_known = [](Vec2d const& d) { return std::isfinite(d.x) && std::isfinite(d.y); };
  if (std::none_of(file.field.displacement_px.begin(), file.field.displacement_px.end(), is_known))
    throw DataError(path, "holds no displacement that is a number; export the vectors with their values");
  bool const told = told_ && specifies_reading(*told_);
  if (told && reading_.empty())
    reading_ = fmt::format("{} vectors, as told: {}", file.format, describe(file.conventions));
  bool const ours = !file.foreign && path.ends_with(".h5");
  if (!told && !ours) {
    DetectedConventions detected = detect_conventions(file, truth, rows);
    if (!conventions_) {
      if (detected.verdict == Verdict::fits_none) throw DataError(path, detected.report);
      own_ = file.also;
      own_.push_back(file.conventions);
      conventions_ = detected.conventions;
      reading_ = fmt::format("{} (by {})", detected.report, of_case);
    }
    file.conventions = *conventions_;
    detected_.emplace_back(of_case, std::move(detected));
  }
  DisplacementField field = apply_conventions(std::move(file.field), file.conventions, rows);
  if (std::string const refusal = refusal_of_gaps(field, columns, rows); !refusal.empty())
    throw DataError(path, refusal);
  return field;
}

std::string ForeignCode::mistake() const {
  std::size_t judged = 0, mistaken = 0;
  for (auto const& [of_case, detected] : detected_) {
    mistaken += detected.mistake.found() ? 1 : 0;
    judged += detected.verdict != Verdict::cannot_be_told && detected.verdict != Verdict::fits_none ? 1 : 0;
  }
  if (mistaken == 0) return {};
  VectorConventions const& own = *conventions_;
  std::vector<Evidence> const all = weigh_readings(detected_, own_);
  auto best =
      std::max_element(all.begin(), all.end(), [](Evidence const& a, Evidence const& b) { return a.sum < b.sum; });
  if (best != all.end() && best->sum > 16.0 && best->rms_px < 0.9 * best->rms_as_read) {
    // Choose the likeliest of those that fit about as well: estimator errors in a flow of similar appearance can
    // account for a tenth of the evidence.
    double const most = best->sum, alike = std::max(9.0, 0.1 * most);
    for (auto one = all.begin(); one != all.end(); ++one) {
      if (most - one->sum <= alike && unlikelihood(one->reading, own) < unlikelihood(best->reading, own)) best = one;
    }
    std::string text = difference_of(best->reading, own);
    bool alone = true;
    for (Evidence const& other : all) {
      bool const as_likely = unlikelihood(other.reading, own) < unlikelihood(best->reading, own) + 0.5;
      if (&other == &*best || most - other.sum > alike || !as_likely) continue;
      text += ", or " + difference_of(other.reading, own);
      alone = false;
    }
    if (!alone) text += fmt::format(", which {} cannot tell apart", judged == 1 ? best->strongest : "these cases");
    return fmt::format(
        "{}: likely mistake: {} (by {}: so read its vectors differ from the truth by {:.3g} px rms, as they are scored "
        "by {:.3g} px); mend the files, or accept it with --conventions {}={}",
        name_, text, best->strongest, best->rms_px, best->rms_as_read, name_, describe(best->reading));
  }
  // With several cases, an indication from a minority may be due to estimator errors where the flow is finer than the
  // windows.
  if (2 * mistaken <= judged) return {};
  auto const first =
      std::find_if(detected_.begin(), detected_.end(), [](auto const& one) { return one.second.mistake.found(); });
  return fmt::format("{}: likely mistake: {}: {}", name_, first->first, first->second.mistake.warning());
}

std::string refusal_of_gaps(DisplacementField const& field, int columns, int rows) {
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

}  // namespace gladstone
