#include "studies/benchmark/benchmark_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "studies/case/backend.h"

namespace gladstone::inline benchmarks {
namespace {

/// Returns the estimators except those that are only points of the curve of settings.
std::vector<std::string> codes_of(BenchmarkResult const& result) {
  std::vector<std::string> codes;
  for (BenchmarkRow const& row : result.rows)
    if (!is_of_curve(row.estimator) && std::find(codes.begin(), codes.end(), row.estimator) == codes.end())
      codes.push_back(row.estimator);
  return codes;
}

BenchmarkRow const* find_row(BenchmarkResult const& result, std::string const& code, std::string const& of_case) {
  for (BenchmarkRow const& row : result.rows)
    if (row.estimator == code && row.of_case == of_case) return &row;
  return nullptr;
}

/// Creates a table of one measure: a row per case, a column per estimator.
TextTable table_of(BenchmarkResult const& result, std::string const& caption,
                   std::function<TableCell(BenchmarkScore const&)> const& cell,
                   std::function<bool(CaseRecord const&)> const& shown = {}) {
  std::vector<std::string> const codes = codes_of(result);
  TextTable table{caption, {"case"}, {}};
  table.header.insert(table.header.end(), codes.begin(), codes.end());
  for (CaseRecord const& one : result.cases) {
    if (shown && !shown(one)) continue;
    std::vector<TableCell> row{{one.of.name}};
    for (std::string const& code : codes) {
      BenchmarkRow const* const found = find_row(result, code, one.of.name);
      row.push_back(found ? cell(found->score) : TableCell{"-"});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

TableCell fixed(double value, int digits) {
  if (!std::isfinite(value)) return {"unknown"};
  return {fmt::format("{:.{}f}", value, digits), value};
}

std::string with_error(SeedMean const& mean) {
  return std::isfinite(mean.error) ? fmt::format("{:.3f} ± {:.3f}", mean.mean, mean.error)
                                   : fmt::format("{:.3f}", mean.mean);
}

/// Creates a table of noise and gain of all estimators that ran on both cases, in ascending order of gain.
std::optional<TextTable> curve_table(BenchmarkResult const& result) {
  TextTable table{"Noise against gain",
                  {"code", fmt::format("rms error in {} [px]", noise_case), fmt::format("gain in {}", gain_case),
                   fmt::format("rms error in {} [px]", gain_case)},
                  {}};
  for (BenchmarkRow const& row : result.rows) {
    BenchmarkRow const* const quiet = find_row(result, row.estimator, noise_case);
    if (row.of_case != gain_case || !quiet) continue;
    table.rows.push_back({{row.estimator},
                          fixed(quiet->score.errors["rms_without_gross_px"], 4),
                          fixed(row.score.gain, 4),
                          fixed(row.score.errors["rms_without_gross_px"], 4)});
  }
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [](auto const& a, auto const& b) { return a[2].number.value_or(0.0) < b[2].number.value_or(0.0); });
  return table.rows.empty() ? std::nullopt : std::optional(std::move(table));
}

ReportSection error_section(BenchmarkResult const& result) {
  ReportSection section{"Errors", {}};
  section.blocks.emplace_back(Paragraph{
      "Errors per component relative to the displacement at the position of the vector; vectors closer than 32 px to "
      "the border are excluded. Gross error: above 1 px. Gain: the fraction of the displacement that the vectors "
      "follow. Compare rms and gain together: large windows have little noise, but do not resolve fine structures."});
  section.blocks.emplace_back(table_of(result, "rms error, gross errors excluded [px]", [](BenchmarkScore const& s) {
    return fixed(s.errors["rms_without_gross_px"], 4);
  }));
  section.blocks.emplace_back(
      table_of(result, "gross errors, and vectors that are missing or invalid", [](auto const& s) {
        std::size_t const gross = s.errors.count("gross"), missing = s.vectors - s.errors.count();
        return TableCell{fmt::format("{} + {} of {}", gross, missing, s.vectors), static_cast<double>(gross + missing)};
      }));
  section.blocks.emplace_back(table_of(
      result, "gain", [](BenchmarkScore const& s) { return fixed(s.gain, 4); },
      [](CaseRecord const& one) { return one.of.name.starts_with("sine") || one.of.refracted(); }));
  section.blocks.emplace_back(table_of(
      result, "width of the response to a step, from 10 to 90 % [px]",
      [](BenchmarkScore const& s) { return fixed(s.step_width_px, 1); },
      [](CaseRecord const& one) { return one.of.name == step_case; }));
  section.blocks.emplace_back(
      table_of(result, "bias of u / of v, gross errors included [px]", [](BenchmarkScore const& s) {
        double const u = s.errors["bias_u_px"], v = s.errors["bias_v_px"];
        return TableCell{fmt::format("{:+.4f} / {:+.4f}", u, v), std::max(std::abs(u), std::abs(v))};
      }));
  if (std::optional<TextTable> curve = curve_table(result)) section.blocks.emplace_back(std::move(*curve));
  return section;
}

ReportSection uncertainty_section(BenchmarkResult const& result) {
  ReportSection section{"Uncertainty", {}};
  TextTable table{"Estimated uncertainty of our default passes and their errors",
                  {"case", "method", "within sigma (0.68)", "within 2 sigma (0.95)", "rms(sigma)/rms(error)",
                   "correlation with |error|", "rms(sigma) [px]", "window mean within sigma",
                   "total error within sigma", "gross", "without sigma"},
                  {},
                  true};
  auto const number = [](std::size_t vectors) {
    return TableCell{fmt::format("{}", vectors), static_cast<double>(vectors)};
  };
  for (UncertaintyRow const& row : result.uncertainties)
    table.rows.push_back({{row.of_case},
                          {row.method},
                          fixed(row.deformed_window.coverage_1, 3),
                          fixed(row.deformed_window.coverage_2, 3),
                          fixed(row.deformed_window.rms_ratio, 3),
                          fixed(row.deformed_window.correlation, 3),
                          fixed(row.deformed_window.sharpness_px, 4),
                          fixed(row.window.coverage_1, 3),
                          fixed(row.point.coverage_1, 3),
                          number(row.deformed_window.gross),
                          number(row.deformed_window.without_sigma)});
  section.blocks.emplace_back(Paragraph{
      "Both components together, gross errors excluded, relative to the truth on the deformed windows: the "
      "displacement that the passes would determine from the true displacements of the dots without noise. The two "
      "columns after rms(sigma) are coverages of errors against other truths: the mean over the dots of a window, and "
      "the displacement at the position of the vector. No method accounts for the differences between these truths. "
      "The "
      "last columns count vectors with gross errors and without sigma."});
  section.blocks.emplace_back(std::move(table));
  if (!result.coverage.empty()) {
    TextTable coverage{fmt::format("Coverage over {} seeds: mean and its standard error", result.seeds),
                       {"method", "flow", "noise [%]", "within sigma", "window mean within sigma",
                        "total error within sigma", "rms(sigma)/rms(error)", "rms(sigma)/rms(total error)"},
                       {},
                       true};
    for (CoverageRow const& row : result.coverage)
      coverage.rows.push_back({{row.method},
                               {row.flow},
                               {fmt::format("{:.0f}", 100.0 * row.noise), row.noise},
                               {with_error(row.deformed_window), row.deformed_window.mean},
                               {with_error(row.window), row.window.mean},
                               {with_error(row.total), row.total.mean},
                               {with_error(row.rms_ratio_deformed_window), row.rms_ratio_deformed_window.mean},
                               {with_error(row.rms_ratio_total), row.rms_ratio_total.mean}});
    section.blocks.emplace_back(std::move(coverage));
  }
  return section;
}

/// Summarises each estimator's error in the vortex and at 5 % noise, and its gain at fine structures.
std::vector<std::string> summarize_findings(BenchmarkResult const& result) {
  std::vector<std::string> findings;
  for (std::string const& code : codes_of(result)) {
    std::string text;
    auto const tell = [&](char const* of_case, char const* in_words) {
      BenchmarkRow const* const row = find_row(result, code, of_case);
      if (!row) return;
      if (!text.empty()) text += ", ";
      BenchmarkScore const& score = row->score;
      // Report gross errors as well, since the rms excludes them.
      double const gross = score.errors["gross_fraction"];
      if (score.errors.count() == 0) {
        text += fmt::format("no valid vector {}", in_words);
      } else if (gross == 1) {
        text += fmt::format("every vector off by more than {:.0f} px {}", gross_error_px, in_words);
      } else {
        text += fmt::format("{:.4f} px {}", score.errors["rms_without_gross_px"], in_words);
        if (gross > 0.01) text += fmt::format(" ({:.0f} % of the vectors are gross errors)", 100.0 * gross);
      }
    };
    tell("vortex", "in the vortex");
    tell(noise_case, "at 5 % noise");
    if (BenchmarkRow const* const row = find_row(result, code, gain_case))
      if (std::isfinite(row->score.gain))
        text += fmt::format("{}a gain of {:.3f} at sines of 64 px", text.empty() ? "" : ", ", row->score.gain);
    if (!text.empty()) findings.push_back(fmt::format("{}: {}.", code, text));
  }
  return findings;
}

}  // namespace

ReportPage benchmark_page(BenchmarkResult const& result, std::string const& folder) {
  ReportPage page;
  page.title = "Accuracy of displacement estimators";
  page.question = "How accurately do estimators measure image pairs with known displacements?";
  page.findings = summarize_findings(result);
  page.sections.push_back(error_section(result));
  if (!result.uncertainties.empty() || !result.coverage.empty()) page.sections.push_back(uncertainty_section(result));
  TextTable cases{"Cases: each has a folder with reference.tif, flow.tif and truth.csv",
                  {"case", "what it shows", "SHA-256 of reference", "of flow"},
                  {}};
  for (CaseRecord const& one : result.cases)
    cases.rows.push_back({{one.of.name}, {one.of.what}, {one.reference_sha256}, {one.flow_sha256}});
  ReportSection made{"Cases, and how to score your own code", {std::move(cases)}};
  made.blocks.emplace_back(
      Paragraph{"The frames have 8 bits, most of them 1024 x 1024 px. Particles are at -d/2 in frame A (reference.tif) "
                "and at +d/2 in frame B (flow.tif); d is the displacement at their mid-position. Measure every pair "
                "with your code, write its vectors to a file named after the case (vortex.csv, .txt or .h5: ours, "
                "OpenPIV's, PIVlab's, or columns x, y, u, v in px), and give the folder. Axes, offsets and likely "
                "mistakes are determined from all cases together."});
  made.blocks.emplace_back(
      Verbatim{"Command", fmt::format("gladstone benchmark -o {} --vectors NAME=FOLDER\n", folder)});
  if (!result.conventions.empty()) made.blocks.emplace_back(TextList{result.conventions});
  if (!result.mistakes.empty()) made.blocks.emplace_back(TextList{result.mistakes});
  made.blocks.emplace_back(Paragraph{"gladstone " + build_text() + ", on " + result.device + "."});
  page.sections.push_back(std::move(made));
  return page;
}

}  // namespace gladstone::inline benchmarks
