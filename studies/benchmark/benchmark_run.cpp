#include "studies/benchmark/benchmark_run.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "analysis/correlation/standard_correlator.h"
#include "analysis/errors/deformed_window_truth.h"
#include "analysis/uncertainty/uncertainty.h"
#include "render/files/image_file.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "render/files/source_files.h"
#include "studies/benchmark/benchmark_coverage.h"
#include "studies/benchmark/foreign_code.h"
#include "studies/case/case.h"
#include "studies/case/case_files.h"
#include "studies/compare/correlate.h"

namespace gladstone::inline benchmarks {
namespace {

namespace fs = std::filesystem;

constexpr int truth_spacing_px = 8;

std::string truth_text(MadeCase const& made) {
  std::string text = "x_px,y_px,u_px,v_px\n";
  for (int y = 0; y < made.rows(); y += truth_spacing_px)
    for (int x = 0; x < made.columns(); x += truth_spacing_px) {
      Vec2d const d = made.truth({static_cast<double>(x), static_cast<double>(y)});
      text += fmt::format("{},{},{:.17g},{:.17g}\n", x, y, d.x, d.y);
    }
  return text;
}

void write_case_folder(MadeCase const& made, std::string const& folder) {
  OutputFolder output(folder, FolderContent{benchmark_truth, {case_file::setup}});
  output.fill([&](std::string const& place) {
    auto const in_place = [&](char const* name) { return (fs::path(place) / name).string(); };
    ImageMetadata const metadata{8, 0.0, "gladstone benchmark, " + made.record.of.name + ": " + made.record.of.what};
    write_tiff(in_place(case_file::reference), integer_levels(made.frames.reference()), metadata);
    write_tiff(in_place(case_file::flow), integer_levels(made.frames.flow()), metadata);
    if (!made.setup.empty()) OutputFile::write_text(in_place(case_file::setup), made.setup);
    OutputFile::write_text(in_place(benchmark_truth), truth_text(made));
  });
  output.commit();
}

bool is_wanted(std::vector<std::string> const& wanted, std::string const& name) {
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
}

std::vector<BenchmarkCase> wanted_cases(BenchmarkOptions const& options) {
  std::vector<BenchmarkCase> cases;
  for (BenchmarkCase const& one : benchmark_cases())
    if (is_wanted(options.cases, one.name)) cases.push_back(one);
  return cases;
}

bool runs_on(BenchmarkEstimator const& estimator, std::string const& of_case) {
  return !estimator.of_curve || of_case == noise_case || of_case == gain_case;
}

}  // namespace

MadeCase make_case(BenchmarkCase const& one, Backend const& device) {
  ParticlePair pair;
  DisplacementAt truth = one.flow;
  std::string setup;
  if (one.refracted()) {
    RefractedTurbulence const turbulence(one.particles.seed, *device.renderer);
    pair = turbulence.frames(one.particles.noise, one.particles.seed);
    truth = turbulence.truth();
    setup = turbulence.resolved();
  } else {
    pair = render_particle_pair(one.particles, one.flow);
  }
  CaseRecord record{one, pixel_sha256(integer_levels(pair.reference)), pixel_sha256(integer_levels(pair.flow))};
  HostFrames frames(std::move(pair.reference), std::move(pair.flow));
  return {std::move(record), std::move(frames), std::move(pair), std::move(truth), std::move(setup)};
}

WindowTruths compute_window_truths(DisplacementField const& field, ParticlePair const& dots,
                                   CorrelationSettings const& settings, int columns, int rows) {
  return {window_truth(dots.dot_reference_px, dots.dot_displacement_px, dots.dot_light, field.position_px,
                       correlation_window(window_weighting(settings), settings.window_px.back()))
              .displacement_px,
          deformed_window_truth(dots.dot_reference_px, dots.dot_displacement_px, dots.dot_light, field.position_px,
                                settings, columns, rows)
              .displacement_px};
}

std::vector<BenchmarkEstimator> const& benchmark_estimators() {
  static std::vector<BenchmarkEstimator> const all = [] {
    std::vector<BenchmarkEstimator> list{{"default", {}}};
    auto const add = [&](std::string const& name, std::vector<int> windows, double overlap, std::string const& method,
                         std::string const& subpixel, bool of_curve = false) {
      CorrelationSettings settings;
      settings.window_px = std::move(windows);
      settings.overlap = overlap;
      settings.method = method;
      settings.subpixel = subpixel;
      list.push_back({name, settings, of_curve});
    };
    add("default_gauss2d", CorrelationSettings{}.window_px, 0.6, "scc", "gauss2d");
    add("default_spc", CorrelationSettings{}.window_px, 0.6, "spc", "gauss3");
    add("one_pass", {32}, 0.5, "scc", "gauss3");
    add("one_pass_gauss2d", {32}, 0.5, "scc", "gauss2d");
    add("one_pass_rpc", {32}, 0.5, "rpc", "gauss3");
    for (char const* method : {"dis", "horn_schunck"})
      add(method, CorrelationSettings{}.window_px, 0.6, method, "gauss3");
    add("to_48_px", {64, 48}, 0.6, "scc", "gauss3", true);
    add("to_32_px", {64, 32}, 0.6, "scc", "gauss3", true);
    add("to_24_px", {64, 32, 24}, 0.6, "scc", "gauss3", true);
    add("to_16_px", {64, 32, 24, 16}, 0.6, "scc", "gauss3", true);
    add("to_12_px", {64, 32, 24, 16, 12}, 0.6, "scc", "gauss3", true);
    return list;
  }();
  return all;
}

bool is_of_curve(std::string const& name) {
  std::vector<BenchmarkEstimator> const& ours = benchmark_estimators();
  return std::any_of(ours.begin(), ours.end(),
                     [&](BenchmarkEstimator const& one) { return one.name == name && one.of_curve; });
}

std::vector<std::string> benchmark_case_files(BenchmarkOptions const& options) {
  std::vector<std::string> paths;
  for (BenchmarkCase const& one : wanted_cases(options))
    for (char const* name : {benchmark_truth, case_file::reference, case_file::flow, case_file::setup})
      paths.push_back((fs::path(options.folder) / one.name / name).string());
  return paths;
}

std::vector<std::string> foreign_vector_files(BenchmarkOptions const& options) {
  std::vector<std::string> paths;
  for (ForeignVectors const& given : options.vectors)
    for (auto const& [of_case, path] : find_vectors(given, wanted_cases(options))) paths.push_back(path);
  return paths;
}

BenchmarkResult run_benchmark(BenchmarkOptions const& options, Backend const& device) {
  std::vector<BenchmarkCase> const cases = wanted_cases(options);
  std::vector<ForeignCode> codes;
  for (ForeignVectors const& given : options.vectors) codes.emplace_back(given, cases);
  BenchmarkResult result;
  result.device = device.name();
  for (BenchmarkCase const& one : cases) {
    spdlog::info("{}: {}", one.name, one.what);
    MadeCase const made = make_case(one, device);
    write_case_folder(made, (fs::path(options.folder) / one.name).string());
    result.cases.push_back(made.record);
    auto const score = [&](std::string const& name, DisplacementField const& field, std::optional<double> seconds) {
      result.rows.push_back(
          {name, one.name, score_case(one.name, field, made.truth, made.columns(), made.rows()), seconds});
    };
    for (BenchmarkEstimator const& estimator : benchmark_estimators()) {
      if (!is_wanted(options.estimators, estimator.name) || !runs_on(estimator, one.name)) continue;
      Measurement measured = correlate_frames(made.frames, estimator.settings, device);
      score(estimator.name, measured.field, measured.seconds);
      if (estimator.name != "default") continue;
      std::vector<Vec2d> const point = truth_at_vectors(measured.field, made.truth);
      WindowTruths const on =
          compute_window_truths(measured.field, made.dots, estimator.settings, made.columns(), made.rows());
      VectorMask const mask = benchmark_mask(measured.field, made.columns(), made.rows());
      for (std::string const& method : uncertainty_methods()) {
        CorrelationSettings settings = estimator.settings;
        settings.uncertainty = method;
        estimate_uncertainty(measured.field, made.frames, settings);
        auto const& [displacement, sigma] = std::tie(measured.field.displacement_px, measured.field.sigma_px);
        result.uncertainties.push_back({method, one.name, uncertainty_quality(displacement, on.window, sigma, mask),
                                        uncertainty_quality(displacement, on.deformed_window, sigma, mask),
                                        uncertainty_quality(displacement, point, sigma, mask),
                                        uncertainty_bins(displacement, point, sigma, mask)});
      }
    }
    for (ForeignCode& code : codes) code.read(one.name, made.truth, made.columns(), made.rows());
  }
  for (ForeignCode& code : codes) {
    for (BenchmarkRow& row : code.score()) result.rows.push_back(std::move(row));
    if (!code.reading().empty()) result.conventions.push_back(code.name() + ": " + code.reading());
    result.mistakes.insert(result.mistakes.end(), code.mistakes().begin(), code.mistakes().end());
  }
  // keep the rows of a case together, in the order of the cases
  auto const place = [&](BenchmarkRow const& row) {
    return std::find_if(cases.begin(), cases.end(), [&](BenchmarkCase const& c) { return c.name == row.of_case; }) -
           cases.begin();
  };
  std::stable_sort(result.rows.begin(), result.rows.end(),
                   [&](BenchmarkRow const& a, BenchmarkRow const& b) { return place(a) < place(b); });
  result.seeds = options.seeds;
  if (options.seeds > 0) result.coverage = measure_coverage(options.seeds, device);
  return result;
}

}  // namespace gladstone::inline benchmarks
