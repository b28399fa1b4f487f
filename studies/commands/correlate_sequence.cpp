#include "studies/commands/correlate_sequence.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/files/file_pattern.h"
#include "studies/case/case_files.h"
#include "studies/case/json_text.h"
#include "studies/compare/sequence.h"
#include "studies/compare/sequence_frames.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/sequence_figure.h"

namespace gladstone::inline commands {
namespace {

namespace fs = std::filesystem;

bool is_vector_file(std::string const& output) {
  std::error_code error;
  return (output.ends_with(".h5") || output.ends_with(".csv")) && !fs::is_directory(output, error);
}

bool is_folder(std::string const& output) {
  std::error_code error;
  return output.ends_with('/') || fs::is_directory(output, error);
}

bool has_patterns(std::vector<std::string> const& inputs) {
  return std::any_of(inputs.begin(), inputs.end(), is_pattern);
}

/// Returns true if the only input is a case, which is one pair with its own settings.
bool is_case(std::vector<std::string> const& inputs) {
  std::error_code error;
  return inputs.size() == 1 && fs::exists(fs::path(inputs[0]) / case_file::setup, error);
}

nlohmann::json describe_failures(SequenceResult const& result) {
  nlohmann::json failed = nlohmann::json::array();
  for (PairRecord const& record : result.pairs)
    if (!record.error.empty()) failed.push_back({{"vectors", record.pair.vectors}, {"error", record.error}});
  return failed;
}

/// Draws the statistics, or warns if gnuplot is not installed.
void draw_statistics(std::string const& path, SequenceMoments const& moments) {
  if (draw_or_warn([&] { draw_figure(make_sequence_figure(moments), path); })) spdlog::info("drew {}", path);
}

}  // namespace

std::vector<std::string> expand_single_pair(SequenceArguments const& arguments) {
  if (!arguments.pairing.empty() || !is_vector_file(arguments.output) || !has_patterns(arguments.inputs))
    return arguments.inputs;
  auto const pairs = form_pairs(list_sequence_files(arguments.inputs, Pairing::pairs), Pairing::pairs);
  if (pairs.size() != 1 || !pairs[0].problem.empty()) return arguments.inputs;
  SequencePair const& pair = pairs[0];
  if (pair.reference.path == pair.flow.path) return {pair.reference.path};
  return {pair.reference.path, pair.flow.path};
}

bool is_sequence(SequenceArguments const& arguments) {
  if (arguments.pairing.empty() && is_case(arguments.inputs)) return false;
  return !arguments.pairing.empty() || is_folder(arguments.output) || has_patterns(arguments.inputs) ||
         (arguments.inputs.size() > 2 && !is_vector_file(arguments.output));
}

int run_sequence(SequenceArguments const& arguments, GlobalOptions const& options) {
  std::string const& folder = arguments.output;
  if (folder.empty()) throw DataError(ErrorCode::arguments, "--output", "is required for a sequence; add -o DIR/");
  if (is_vector_file(folder))
    throw OutputError(folder, "is a file (a sequence has one file of vectors per pair); name a folder: -o DIR/");
  Pairing const pairing = parse_pairing(arguments.pairing);
  SequenceSettings const settings = read_sequence_settings(pairing, arguments.config, arguments.overrides);
  std::vector<SequencePair> const pairs = form_pairs(list_sequence_files(arguments.inputs, pairing), pairing);
  SequenceResult const result = correlate_sequence(pairs, settings, folder, options.open_device(), !options.quiet);
  std::size_t const done = result.count(PairState::done);
  report_sequence(result, folder);
  if (!arguments.no_figures) draw_statistics((fs::path(folder) / sequence_file::figure).string(), result.statistics);
  nlohmann::json const json{{"pairs", pairs.size()},
                            {"done", done},
                            {"resumed", result.count_resumed()},
                            {"failed", describe_failures(result)},
                            {"vectors", result.vectors()},
                            {"folder", folder},
                            {"statistics", (fs::path(folder) / sequence_file::statistics).string()},
                            {"sequence", (fs::path(folder) / sequence_file::state).string()},
                            {"device", result.device},
                            {"seconds_correlate", result.seconds}};
  print_result(options, json_text(json),
               fmt::format("{}: {} of {} pairs correlated ({} by an earlier run), {} vectors each, {:.2f} s", folder,
                           done, pairs.size(), result.count_resumed(), result.vectors(), result.seconds));
  return done == pairs.size() ? ok : check_missed;
}

}  // namespace gladstone::inline commands
