#include "studies/report/report.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/density_options.h"

namespace gladstone::inline commands {
namespace {

/// Rejects the name of a new file without the ending of a report. Whether an existing file may be replaced is checked
/// when it is opened.
void check_report_ending(std::string const& output) {
  std::error_code error;
  bool const known = output.ends_with(".html") || output.ends_with(".htm") || output.ends_with(".md");
  if (output.empty() || known || std::filesystem::exists(output, error)) return;
  throw OutputError(output, "is not the name of a report: it must end in .html or .md");
}

}  // namespace

CommandBody attach_report(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    ReportOptions report;
    std::string format = "html";
    DensityArguments density;
  };
  auto arguments = std::make_shared<Arguments>();
  arguments->report.figure_format = "png";
  app.add_option("folder", arguments->report.source, "RUN of a study, or CASE")->required();
  app.add_option("-o,--output", arguments->report.output, "File, default report.html (report.md) in the folder");
  app.add_option("--format", arguments->format,
                 "html (one file that works offline) or md; an --output that ends in .md also selects md")
      ->check(one_of({"html", "md"}))
      ->capture_default_str();
  app.add_option("--vectors", arguments->report.vectors, "For a CASE: file of vectors, see gladstone compare --help");
  app.add_option("--repeats", arguments->report.repeats,
                 "For a measured CASE: repeated measurements of the same field, for a type A evaluation");
  app.add_option("--conventions", arguments->report.conventions,
                 "For a CASE: conventions of its vectors, see gladstone compare --help");
  app.add_option("--figures", arguments->report.figures, "Folder for the figures as separate files");
  app.add_option("--figure-format", arguments->report.figure_format, "png, svg or pdf")
      ->check(one_of({"png", "svg", "pdf"}))
      ->capture_default_str();
  arguments->density.add_to(app, "Density of a CASE or a measurement, as gladstone reconstruct computes it");
  return [arguments, &options] {
    ReportOptions report = arguments->report;
    report.density_words = arguments->density.words();
    if (!report.density_words.empty()) report.density = arguments->density.options();
    check_report_ending(report.output);
    report.markdown = arguments->format == "md" || report.output.ends_with(".md");
    if (report.output.empty()) {
      report.output = (std::filesystem::path(report.source) / ("report." + arguments->format)).string();
    }
    if (report.markdown && report.figures.empty()) {
      report.figures = std::filesystem::path(report.output).replace_extension("").string() + "_figures";
    }
    WrittenReport const written = write_report(report, options.open_device());
    for (std::string const& file : written.doubtful) {
      log_warning(
          {WarningCode::unreliable, file,
           "the vectors of this file are incomplete, or their axes and signs were probably misread, so that the report "
           "is doubtful (reasons above); export them again, or state their axes and signs with --conventions"});
    }
    print_result(options,
                 json_text(nlohmann::json{
                     {"report", report.output}, {"findings", written.findings}, {"doubtful", written.doubtful}}),
                 written.findings + "wrote " + report.output + '\n');
    return written.doubtful.empty() ? ok : check_missed;
  };
}

}  // namespace gladstone::inline commands
