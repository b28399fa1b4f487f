#include "studies/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "analysis/errors/error_summary.h"
#include "render/base/error.h"
#include "render/files/image_file.h"
#include "render/files/output_file.h"
#include "studies/case/backend.h"
#include "studies/case/case_files.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/sweep/manifest.h"

namespace gladstone::inline report {

namespace fs = std::filesystem;

namespace {

constexpr int most_frame_px = 1024;  ///< maximum width and height of an image in a report

char const* words_of(SourceFiles::Holds holds) {
  return holds == SourceFiles::Holds::pixels ? "pixels" : holds == SourceFiles::Holds::datasets ? "numbers" : "bytes";
}

/// Encodes a frame as 8-bit PNG, scaled from black to white; of a large frame, the central part.
std::string png_of(Image<double> const& frame, double black, double white) {
  int const columns = std::min(frame.columns(), most_frame_px), rows = std::min(frame.rows(), most_frame_px);
  int const left = (frame.columns() - columns) / 2, top = (frame.rows() - rows) / 2;
  Image<std::uint8_t> picture(columns, rows);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double const share = (frame(left + column, top + row) - black) / (white - black);
      picture(column, row) = static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
    }
  }
  return encode_png(picture);
}

}  // namespace

ReportSection drawn_figures(
    ReportOptions const& options,
    std::function<std::vector<std::string>(std::string const& folder, std::string const& format)> const& draw) {
  ReportSection section{"Figures", {}};
  if (options.figures.empty()) return section;
  draw_or_warn([&] {
    fs::path const beside = fs::absolute(options.output).parent_path();
    for (std::string const& path : draw(options.figures, options.figure_format)) {
      section.blocks.emplace_back(
          FigureFile{fs::absolute(path).lexically_proximate(beside).string(), fs::path(path).stem().string()});
    }
  });
  return section;
}

ReportSection provenance_section(SourceFiles const& sources, std::vector<std::string> const& commands) {
  TextTable files{"Sources of this report (SHA-256)", {"what", "of its", "SHA-256"}, {}};
  for (SourceFiles::Source const& source : sources.all()) {
    if (!source.name.empty()) files.rows.push_back({{source.name}, {words_of(source.holds)}, {source.sha256}});
  }
  std::string text;
  for (std::string const& command : commands) text += command + '\n';
  return {"Reproduction and citation",
          {Paragraph{"gladstone " + build_text() + " wrote this report."}, std::move(files),
           Verbatim{"Commands that reproduce it", text},
           Paragraph{"Cite gladstone with its version and commit as above; for the method: L. K. Rajendran, S. P. M. "
                     "Bane, P. P. Vlachos, PIV/BOS synthetic image generation in variable density environments for "
                     "error analysis and experiment design, Measurement Science and Technology 30 (2019) 085302."}}};
}

WrittenReport write_report(ReportOptions const& options, Backend const& device) {
  bool const run = fs::exists(fs::path(options.source) / run_file::manifest);
  if (!run && !fs::exists(fs::path(options.source) / case_file::setup)) {
    throw DataError(ErrorCode::wrong_format, options.source,
                    fmt::format("is neither a study (no {} in it) nor a case (no {}); give the folder "
                                "of a planned and computed study, of a rendered case, or of a "
                                "measurement with its setup and vectors",
                                run_file::manifest, case_file::setup));
  }
  if (run && (!options.vectors.empty() || !options.conventions.empty())) {
    throw DataError(ErrorCode::arguments, options.vectors.empty() ? "--conventions" : "--vectors",
                    options.source +
                        " is a study, each of whose cases has its vectors; omit this option, or give the folder of "
                        "a case");
  }
  if (run && options.density) {
    throw DataError(ErrorCode::arguments, options.density_words.empty() ? "--reference" : options.density_words.front(),
                    options.source +
                        " is a study, whose report contains no density; omit this option, or give the folder of a "
                        "case or a measurement");
  }
  // fails early if the output cannot be written
  OutputFile output(options.output, options.markdown ? "Markdown" : "HTML");
  bool const measured = !run && !fs::exists(fs::path(options.source) / case_file::truth);
  if (!measured && !options.repeats.empty()) {
    throw DataError(ErrorCode::arguments, "--repeats",
                    options.source +
                        " is not a measurement (repeats determine the uncertainty of a measured mean, whose truth is "
                        "unknown); omit this option, or give the folder of a measurement");
  }
  ReportPage const page = run        ? run_report(options)
                          : measured ? measured_report(options, device)
                                     : case_report(options, device);
  std::string const text = options.markdown ? markdown_page(page) : html_page(page);
  output.write(text.data(), text.size());
  output.commit();
  WrittenReport written{"", page.doubtful};
  for (std::string const& finding : page.findings) written.findings += finding + '\n';
  return written;
}

FramePictures frame_pictures(FramePair<double> const& frames, std::string const& title) {
  auto const& [reference, flow] = frames;
  std::vector<double> levels(reference.begin(), reference.end());
  double const black = quantile(levels, 0), white = std::max(black + 1, quantile(levels, 0.999));
  bool const cut = reference.columns() > most_frame_px || reference.rows() > most_frame_px;
  return {
      title,
      fmt::format("{} x {} px{}, grey from {:.0f} to {:.0f}, equal for both frames", reference.columns(),
                  reference.rows(), cut ? fmt::format(", the middle {} px of them", most_frame_px) : "", black, white),
      "reference",
      "flow",
      png_of(reference, black, white),
      png_of(flow, black, white)};
}

}  // namespace gladstone::inline report
