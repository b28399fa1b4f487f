#include "studies/compare/correlate.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis/correlation/pair_assessment.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"
#include "render/files/input_file.h"
#include "render/files/output_file.h"
#include "studies/case/case.h"
#include "studies/case/json_text.h"
#include "studies/case/peak_locking.h"
#include "studies/case/result_rows.h"
#include "studies/case/warning_json.h"
#include "studies/case/warning_log.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/correlate_sequence.h"
#include "studies/compare/exchanged_frames.h"

namespace gladstone::inline commands {

CommandBody attach_correlate(CLI::App& app, GlobalOptions const& options) {
  struct Arguments : SequenceArguments {
    bool ensemble = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("input", arguments->inputs,
                 "A case folder, two images (frame A: the reference of BOS or the first pulse of PIV; frame B), or one "
                 "image file with both as pages; with "
                 "--ensemble any number of pairs; for a sequence two patterns ('A_*.tif' 'B_*.tif'), one pattern, a "
                 "folder, or an image file of many pages")
      ->required()
      ->expected(-1);
  app.add_flag("--ensemble", arguments->ensemble,
               "The images are pairs of one displacement field, reference and flow alternating: their correlation "
               "planes are averaged (on the CPU)");
  app.add_option("-o,--output", arguments->output,
                 "Vectors to write: .h5 or .csv; default CASE/vectors.h5; for a sequence a folder");
  app.add_option("--pairing", arguments->pairing,
                 "Pairs of a sequence: pairs (frame A and frame B of each instant; the default), reference (the first "
                 "image with each other one), consecutive (each image with the next one)")
      ->check(one_of({"pairs", "reference", "consecutive"}));
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figure of the statistics of a sequence");
  app.add_option("--config", arguments->config,
                 "TOML file with a table [correlate], for example a setup; default: the table of the case");
  app.add_option("--set", arguments->overrides, "Override a key: --set correlate.overlap=0.75")
      ->expected(1)
      ->take_all();
  return [arguments, &options]() -> int {
    if (arguments->ensemble && options.device == "cuda")
      throw DeviceError("--device cuda: ensembles are correlated on the CPU only; use --device auto");
    if (!arguments->ensemble) {
      std::vector<std::string> const expanded = expand_single_pair(*arguments);
      if (expanded == arguments->inputs && is_sequence(*arguments)) return run_sequence(*arguments, options);
      arguments->inputs = expanded;
    } else if (!arguments->pairing.empty()) {
      throw DataError(ErrorCode::arguments, "--pairing",
                      "conflicts with --ensemble (which has one result for all pairs); omit one");
    }
    std::size_t const given = arguments->inputs.size();
    if (arguments->ensemble && given % 2 != 0)
      throw DataError(ErrorCode::arguments, "--ensemble",
                      fmt::format("got {} images (pairs of frames A and B require an even number); give pairs", given));
    if (!arguments->ensemble && given > 2)
      throw DataError(ErrorCode::arguments, "images",
                      fmt::format("got {} images (a measurement requires frame A and frame B); "
                                  "give two, or --ensemble for pairs of one displacement",
                                  given));
    Backend const device = options.open_device();
    std::string const& output = arguments->output;
    if (!output.empty() && !output.ends_with(".h5") && !output.ends_with(".csv")) {
      throw OutputError(
          output,
          "has an ending that is neither .h5 nor .csv; choose one of them, and gladstone convert for other formats");
    }
    bool const configured = !arguments->config.empty() || !arguments->overrides.empty();
    std::string config = arguments->config;
    if (std::error_code error; config.empty() && configured && arguments->inputs.size() == 1 &&
                               std::filesystem::is_directory(arguments->inputs[0], error)) {
      config = in_case(arguments->inputs[0], case_file::setup);
    }
    CorrelationFile const other = !config.empty() ? read_correlation_file(config, arguments->overrides)
                                                  : default_correlation(arguments->overrides);
    Measurement measurement;
    std::string written = output;
    std::vector<std::string> inputs = arguments->inputs;
    std::error_code error;
    bool const is_case = inputs.size() == 1 && std::filesystem::is_directory(inputs[0], error);
    if (is_case) {
      std::string const& folder = arguments->inputs[0];
      if (written.empty()) written = in_case(folder, case_file::vectors);
      inputs = rendered_files(folder);
    } else {
      for (std::string const& name : inputs) require_input_file(name, "an image, or a case folder");
      if (output.empty())
        throw DataError(ErrorCode::arguments, "--output", "is required for images; add -o FILE.h5 or -o FILE.csv");
    }
    if (!config.empty()) inputs.push_back(config);
    std::vector<std::string> const& prepared_by = other.settings.preparation.files;
    inputs.insert(inputs.end(), prepared_by.begin(), prepared_by.end());
    refuse_inputs_as_outputs({written}, inputs);
    OutputFile const tried(written);
    if (is_case) {
      measurement = correlate_case(arguments->inputs[0], written, configured ? &other : nullptr, device);
    } else if (arguments->ensemble) {
      SourceFiles sources;
      add_preparation(other.settings, sources);
      measurement = correlate_ensemble_files(arguments->inputs, other.settings, sources);
      write_vectors(written, measurement.field,
                    {"gladstone vectors", 1, other.resolved, 0, measurement.device, std::move(sources)});
    } else {
      SourceFiles sources;
      bool const one_file = arguments->inputs.size() == 1;
      std::string const a = one_file ? inputs[0] + " (page 1)" : inputs[0];
      std::string const b = one_file ? inputs[0] + " (page 2)" : inputs[1];
      HostFrames const frames(
          one_file ? read_frames(inputs[0], sources)
                   : FramePair<double>{read_frame(a, "reference", sources), read_frame(b, "flow", sources)});
      add_preparation(other.settings, sources);
      measurement = correlate_frames(a, b, frames, other.settings, device);
      if (auto const advice = locking_advice(frames.reference()); advice && frames_correlate(measurement.field))
        measurement.field.warnings.push_back(*advice);
      warn_of_exchanged_frames(measurement.field, sources);
      write_vectors(written, measurement.field,
                    {"gladstone vectors", 1, other.resolved, 0, measurement.device, std::move(sources)});
    }
    std::size_t counts[4] = {};
    for (VectorStatus status : measurement.field.status) ++counts[static_cast<int>(status)];
    DisplacementField const& field = measurement.field;
    auto const clear = std::count(field.ambiguous.begin(), field.ambiguous.end(), Ambiguity::none);
    for (Warning const& warning : field.warnings) log_warning(at_place(written, warning));
    bool const any_valid = counts[0] + counts[1] > 0;
    if (!any_valid && field.warnings.empty()) {
      log_warning(
          {WarningCode::unreliable, written,
           fmt::format(
               "all {} vectors are invalid; check that both frames show the same scene, with dots in every window",
               field.size())});
    }
    std::vector<ResultRow> const rows{
        count_row("vectors", "vectors", field.size()),
        count_row("valid", "valid", counts[0]),
        count_row("replaced", "replaced", counts[1]),
        count_row("masked", "masked", counts[2]),
        count_row("invalid", "invalid", counts[3]),
        count_row("ambiguous", "ambiguous", field.ambiguous.size() - static_cast<std::size_t>(clear)),
        {.key = "seconds_correlate", .label = "duration", .value = measurement.seconds, .unit = "s"}};
    nlohmann::json json{{"file", written},
                        {"verdict", verdict_text(field.verdict)},
                        {"verdict_code", verdict_code(field.verdict.kind)},
                        {"uncertainty_method", field.uncertainty_method},
                        {"uncertainty_key", field.uncertainty_key},
                        {"warnings", to_strings(field.warnings)},
                        {"warning_records", field.warnings},
                        {"device", measurement.device}};
    json.update(rows_json(rows));
    print_result(options, json_text(json), written + '\n' + rows_text(rows));
    return any_valid ? ok : check_missed;
  };
}

}  // namespace gladstone::inline commands
