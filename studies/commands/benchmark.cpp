#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"
#include "render/files/output_destination.h"
#include "render/files/output_file.h"
#include "render/files/text_file.h"
#include "studies/benchmark/benchmark_coverage.h"
#include "studies/benchmark/benchmark_page.h"
#include "studies/benchmark/benchmark_results.h"
#include "studies/benchmark/benchmark_run.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"

namespace gladstone::inline commands {
namespace {

namespace fs = std::filesystem;

/// Parses NAME=F. @throws DataError
ForeignVectors parse_vectors(std::string const& given) {
  auto const equals = given.find('=');
  ForeignVectors vectors{given.substr(0, equals), equals == std::string::npos ? "" : given.substr(equals + 1)};
  if (vectors.name.empty() || vectors.path.empty())
    throw DataError(ErrorCode::arguments, "--vectors",
                    '"' + given +
                        "\" is not of the form NAME=F (a name for the code, and its folder of vectors); "
                        "write --vectors mine=FOLDER");
  if (vectors.name.find_first_of(",\n\"") != std::string::npos)
    throw DataError(ErrorCode::arguments, "--vectors",
                    '"' + given +
                        "\" has a comma, a quotation mark or a line break in its name, which would break "
                        "benchmark.csv; use another name");
  std::error_code error;
  if (!fs::exists(vectors.path, error))
    throw DataError(ErrorCode::missing_file, vectors.path, "does not exist; give the folder of vectors");
  for (BenchmarkEstimator const& ours : benchmark_estimators())
    if (ours.name == vectors.name)
      throw DataError(ErrorCode::arguments, "--vectors",
                      '"' + given + "\" has the name of one of our estimators; use another name");
  return vectors;
}

/// Assigns conventions to one external code (NAME=WORDS) or to all (WORDS). @throws DataError
void assign_conventions(std::vector<ForeignVectors>& vectors, std::string const& given) {
  bool used = false;
  auto const named = std::find_if(vectors.begin(), vectors.end(),
                                  [&](ForeignVectors const& one) { return given.starts_with(one.name + '='); });
  for (ForeignVectors& one : vectors) {
    if (named != vectors.end() && one.name != named->name) continue;
    one.conventions = named != vectors.end() ? given.substr(one.name.size() + 1) : given;
    parse_conventions(*one.conventions);  // throws for unknown words before anything is computed
    used = true;
  }
  if (!used)
    throw DataError(ErrorCode::arguments, "--conventions",
                    '"' + given + "\" applies to vectors of another code, but none are given; add --vectors");
}

std::vector<std::string> names_of_cases() {
  std::vector<std::string> names;
  for (BenchmarkCase const& one : benchmark_cases()) names.push_back(one.name);
  return names;
}

std::vector<std::string> names_of_estimators() {
  std::vector<std::string> names{"none"};
  for (BenchmarkEstimator const& one : benchmark_estimators()) names.push_back(one.name);
  return names;
}

/// Formats the report page; the figures are links to files in its folder.
std::string page_text(ReportPage page, std::vector<std::string> const& figures, bool markdown) {
  ReportSection drawn{"Curves", {}};
  for (std::string const& name : figures)
    drawn.blocks.emplace_back(
        FigureFile{name, name.starts_with("noise") ? "noise against gain" : "error against uncertainty"});
  if (!figures.empty()) page.sections.insert(page.sections.begin() + 1, std::move(drawn));
  return markdown ? markdown_page(page) : html_page(page);
}

std::string summary_of(BenchmarkResult const& result, std::string const& folder) {
  std::string text;
  for (std::string const& finding : benchmark_page(result, folder).findings) text += finding + '\n';
  for (std::string const& told : result.conventions) text += told + '\n';
  return text + fmt::format("{} cases, {} scores: {}", result.cases.size(), result.rows.size(),
                            (fs::path(folder) / "benchmark.html").string());
}

}  // namespace

CommandBody attach_benchmark(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    BenchmarkOptions benchmark;
    std::vector<std::string> vectors, conventions;
    bool no_figures = false, learn = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("-o,--output", arguments->benchmark.folder,
                 "Folder for the cases and benchmark.html, .md, .json, .csv")
      ->required();
  app.add_option("--vectors", arguments->vectors,
                 "NAME=F: another code's vectors, F a folder of files named after cases (vortex.csv, .txt, .h5)");
  app.add_option(
      "--conventions", arguments->conventions,
      "Conventions of --vectors, see gladstone compare --help, or NAME=WORDS for one code; default: the format's own");
  app.add_option("--cases", arguments->benchmark.cases, "Evaluate only these cases")->check(one_of(names_of_cases()));
  app.add_option("--estimators", arguments->benchmark.estimators,
                 "Evaluate only these estimators of gladstone; none: evaluate only --vectors")
      ->check(one_of(names_of_estimators()));
  app.add_option("--seeds", arguments->benchmark.seeds,
                 "Number of seeds for the coverage of every uncertainty method; 0: no coverage")
      ->check(whole_number(0, 1000));
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figures");
  app.add_flag("--learn", arguments->learn,
               "Only learn the weights of the combined uncertainty and write them to combination.csv (the built-in "
               "weights are data/uncertainty/combination.csv)");
  return [arguments, &options] {
    BenchmarkOptions benchmark = arguments->benchmark;
    for (std::string const& given : arguments->vectors) benchmark.vectors.push_back(parse_vectors(given));
    for (std::string const& given : arguments->conventions) assign_conventions(benchmark.vectors, given);
    fs::path const folder = benchmark.folder;
    auto const in_place = [&](char const* name) { return (folder / name).string(); };
    std::vector<std::string> inputs = foreign_vector_files(benchmark), outputs = benchmark_case_files(benchmark);
    for (ForeignVectors const& given : benchmark.vectors) inputs.push_back(given.path);
    for (char const* name : {"benchmark.html", "benchmark.md", "benchmark.json", "benchmark.csv",
                             "noise_against_gain.png", "error_against_uncertainty.png"})
      outputs.push_back(in_place(name));
    refuse_inputs_as_outputs(outputs, inputs);
    Backend const device = options.open_device();
    if (arguments->learn) {
      OutputFile file(in_place("combination.csv"));
      UncertaintyCombination const combination = learn_combination(device);
      std::string const text = combination_text(combination);
      file.write(text.data(), text.size());
      file.commit();
      nlohmann::ordered_json json{{"constant", combination.constant}};
      for (auto const& [method, weight] : combination.terms) json[method] = weight;
      print_result(options, json_text(json), text);
      return ok;
    }
    OutputFile html(in_place("benchmark.html"));  // checks that the page can be written
    BenchmarkResult const result = run_benchmark(benchmark, device);
    std::vector<std::string> figures;
    if (!arguments->no_figures) draw_or_warn([&] { figures = draw_benchmark(result, benchmark.folder); });
    ReportPage const page = benchmark_page(result, benchmark.folder);
    std::string const json = benchmark_json(result), text = page_text(page, figures, false);
    OutputFile::write_text(in_place("benchmark.json"), json);
    OutputFile::write_text(in_place("benchmark.csv"), benchmark_csv(result));
    OutputFile::write_text(in_place("benchmark.md"), page_text(page, figures, true));
    html.write(text.data(), text.size());
    html.commit();
    for (std::string const& mistake : result.mistakes) log_warning({WarningCode::implausible, "", mistake});
    print_result(options, json, summary_of(result, benchmark.folder));
    return result.mistakes.empty() ? ok : check_missed;
  };
}

}  // namespace gladstone::inline commands
