#include "studies/case/render_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/version.h"
#include "render/files/fields/field_file.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "render/files/input_guard.h"
#include "render/files/output_destination.h"
#include "render/files/output_file.h"
#include "render/files/sha256.h"
#include "render/files/source_files.h"
#include "render/files/stop_point.h"
#include "studies/case/case_files.h"
#include "studies/case/json_text.h"
#include "studies/case/log_silencer.h"
#include "studies/case/pair_progress.h"
#include "studies/case/rendered_sequence_folder.h"
#include "studies/case/sequence_pair.h"
#include "studies/case/warning_json.h"
#include "studies/case/warning_kinds.h"

namespace gladstone::inline cases {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Hashes of input files, each computed once.
class InputHashes {
 public:
  std::string const& find(std::string const& path) {
    auto const [known, is_new] = hashes_.try_emplace(path);
    if (is_new) known->second = byte_sha256(path);
    return known->second;
  }

 private:
  std::map<std::string, std::string> hashes_;
};

/// Returns the hash of everything that determines a pair: version, setup and input files.
std::string hash_pair(SetupRenderer const& setup, InputHashes& inputs) {
  Sha256 hash;
  hash.add(fmt::format("gladstone {} {}\n{}\n", version, git_sha1, setup.written()));
  for (std::string const& file : setup.rendered_inputs()) hash.add(file + ' ' + inputs.find(file) + '\n');
  return hash.finish();
}

/// Returns the warnings of a pair's summary.json, those of all its cameras.
Warnings pair_warnings(Json const& summary) {
  Warnings warnings;
  auto const append = [&warnings](Json const& one) {
    Warnings const found = read_warnings(one);
    warnings.insert(warnings.end(), found.begin(), found.end());
  };
  append(summary);
  if (auto const cameras = summary.find("cameras"); cameras != summary.end())
    for (Json const& camera : *cameras) append(camera);
  return warnings;
}

/// One run of SequenceRenderer::render().
class SequenceRendering {
 public:
  SequenceRendering(fs::path folder, SequenceSetup const& sequence, std::vector<std::string> cameras)
      : folder_(std::move(folder)),
        sequence_(sequence),
        cameras_(std::move(cameras)),
        finished_(read_finished_pairs(folder_)) {
    for (std::string const& camera : cameras_) {
      shared_.cameras[camera].particles = std::make_shared<ParticleCache>();
      std::error_code error;
      fs::create_directories(frames_of(camera), error);
      if (error) OutputDestination(frames_of(camera).string()).fail("cannot be created", error.value());
    }
  }

  /// Retains a pair of an earlier run of the same setup, input files and version, unless its frames have been changed.
  /// @return false if there is none
  bool retain(std::size_t number, bool first, SetupRenderer const& setup) {
    auto const known = finished_.find(number);
    bool const same = known != finished_.end() && is_intact(number) &&
                      known->second.value("fingerprint", "") == hash_pair(setup, inputs_);
    if (same) add_pair(number, first, known->second, false);
    return same;
  }

  void render(std::size_t number, bool first, SetupRenderer& setup, Renderer& renderer) {
    add_pair(number, first, render_one_case(number, first, setup, renderer), true);
  }

  Json summary(bool complete) const {
    return {{"filetype", "gladstone rendered sequence"},
            {"version", 1},
            {"software_version", version},
            {"git_sha1", git_sha1},
            {"complete", complete},
            {"pairing", sequence_.consecutive ? "consecutive" : "reference"},
            {"cameras", cameras_.size() > 1 ? Json(cameras_) : Json(nullptr)},
            {"frames", pairs_.empty() ? 0 : pairs_.size() + 1},
            {"pairs", pairs_}};
  }
  void write_summary(bool complete) const {
    OutputFile::write_text((folder_ / rendered_sequence_file::summary).string(), json_text(summary(complete)) + '\n');
  }

  /// Summarises the warnings of all pairs but the first, which logged its own.
  Warnings later_warnings() const {
    WarningKinds kinds;
    if (pairs_.empty()) return {};
    Warnings const of_first = read_warnings(pairs_.front());
    for (std::size_t i = 1; i < pairs_.size(); ++i) {
      for (Warning const& warning : read_warnings(pairs_[i])) {
        if (std::find(of_first.begin(), of_first.end(), warning) != of_first.end()) continue;
        kinds.add(pairs_[i].at("folder").get<std::string>(), warning, warning.place);
      }
    }
    return kinds.summary();
  }
  std::size_t done() const { return pairs_.size(); }

 private:
  fs::path frames_of(std::string const& camera) const { return folder_ / rendered_sequence_file::frames / camera; }
  fs::path case_of(std::size_t number, std::string const& camera) const {
    return folder_ / rendered_sequence_file::pair(number) / camera;
  }
  /// Returns whether the case of a pair has all its files, and its frames are those to which its truth belongs.
  bool is_intact(std::size_t number) const {
    UnrecordedReading const of_own_files;
    return std::all_of(cameras_.begin(), cameras_.end(), [&](std::string const& camera) {
      fs::path const folder = case_of(number, camera);
      std::error_code error;
      if (!fs::exists(folder / case_file::setup, error) || !fs::exists(folder / case_file::summary, error))
        return false;
      try {
        Hdf5Reader const truth((folder / case_file::truth).string());
        return truth.attribute("reference_sha256") == pixel_sha256((folder / case_file::reference).string()) &&
               truth.attribute("flow_sha256") == pixel_sha256((folder / case_file::flow).string());
      } catch (DataError const&) {  // missing or damaged
        return false;
      }
    });
  }

  /// Reads frame A of a pair from the files of an earlier pair. All pairs of BOS have the same one.
  void read_earlier_frames(std::size_t number) {
    UnrecordedReading const of_own_files;
    for (std::string const& camera : cameras_) {
      if (!sequence_.consecutive && !shared_.cameras[camera].reference.empty()) continue;
      fs::path const earlier = sequence_.consecutive ? case_of(number - 1, camera) / case_file::flow
                                                     : frames_of(camera) / rendered_sequence_file::frame(0);
      shared_.cameras[camera].reference = integer_levels(read_levels(earlier.string()));
    }
  }

  /// Renders the case of a pair. @return its entry in summary.json
  Json render_one_case(std::size_t number, bool first, SetupRenderer& setup, Renderer& renderer) {
    std::string fingerprint = hash_pair(setup, inputs_);  // hash the files before they are read for rendering
    if (!first) read_earlier_frames(number);
    std::optional<LogSilencer> silencer;
    if (!first) silencer.emplace();
    RenderedSetup rendered = setup.render(renderer, (folder_ / rendered_sequence_file::pair(number)).string(), shared_);
    stop_point("pair-rendered");
    Json exposures = Json::array();
    double seconds = 0;
    for (RenderedCamera const& camera : rendered.cameras) {
      exposures.push_back(camera.exposure_e);
      seconds += camera.seconds;
    }
    if (sequence_.consecutive && !shared_.medium) {  // the field of BOS differs from pair to pair
      medium_ = std::move(rendered.medium);
      shared_.medium = &medium_;
    }
    Warnings const warnings = pair_warnings(*rendered.summary);
    return {{"pair", number},
            {"folder", rendered_sequence_file::pair(number)},
            {"frames", Json::array({first_frame(number), second_frame(number)})},
            {"fingerprint", std::move(fingerprint)},
            {"exposure_e", std::move(exposures)},
            {"device", rendered.cameras.front().device},
            {"seconds_render", seconds},
            {"warnings", to_strings(warnings)},
            {"warning_records", warnings}};
  }

  void add_pair(std::size_t number, bool first, Json pair, bool replace_frames) {
    pairs_.push_back(std::move(pair));
    if (first) adopt_exposures(pairs_.back());
    for (std::string const& camera : cameras_) add_frames(number, first, camera, replace_frames);
  }

  void adopt_exposures(Json const& pair) {
    Json const& exposures = pair.at("exposure_e");
    for (std::size_t i = 0; i < cameras_.size(); ++i)
      shared_.cameras[cameras_[i]].exposure_e = exposures.at(i).get<double>();
  }

  std::string first_frame(std::size_t number) const {
    return rendered_sequence_file::frame(sequence_.frames_of(number)[0]);
  }
  std::string second_frame(std::size_t number) const {
    return rendered_sequence_file::frame(sequence_.frames_of(number)[1]);
  }

  /// Adds the frames of a pair that no earlier pair contains to the folder of frames.
  void add_frames(std::size_t number, bool first, std::string const& camera, bool replace) const {
    auto const add = [&](char const* image, std::string const& name) {
      std::error_code error;
      fs::path const frame = frames_of(camera) / name;
      fs::path const original = case_of(number, camera) / image;
      // A frame whose file is not a second name of the recorded image may have been replaced.
      if (replace || !fs::equivalent(original, frame, error)) give_second_name(original, frame);
    };
    if (first) add(case_file::reference, first_frame(number));
    add(case_file::flow, second_frame(number));
  }

  fs::path folder_;
  SequenceSetup sequence_;
  std::vector<std::string> cameras_;
  std::map<std::size_t, Json> finished_;  ///< pairs of an earlier run
  InputHashes inputs_;
  BuiltMedium medium_;
  SharedParts shared_;
  std::vector<Json> pairs_;
};

/// Returns the setup of a sequence with the number of its first pair in [sequence], as the setups of the other pairs
/// have theirs. A setup that describes no sequence is returned unchanged; its readers report the problem.
SetupDocument with_first_pair(SetupDocument document) {
  SetupNode const* const sequence = document.find({"sequence"});
  if (!sequence || sequence->kind != SetupNode::Kind::table || sequence->find("pair")) return document;
  Experiment const& experiment = find_experiment(document);
  if (!experiment.consecutive_frames && !sequence->find("files")) return document;
  SetupNode first = setup_integer(static_cast<long long>(experiment.first_pair()));
  first.place = sequence->place;
  document.set({"sequence", "pair"}, first);
  return document;
}

}  // namespace

SequenceRenderer::SequenceRenderer(SetupDocument document, std::string path)
    : path_(std::move(path)), document_(std::move(document)), first_(with_first_pair(document_.copy()), path_) {
  std::optional<SequenceSetup> const sequence = first_.first_setup().sequence;
  if (!sequence)
    throw SetupError(
        {{path_, "has no table [sequence]; add it, or render a single pair", "sequence", ErrorCode::missing_key}});
  first_pair_ = sequence->pair;
  pair_count_ = sequence->frames - 1;
  if (sequence->consecutive) return;
  SetupDocument places = document_.copy();
  std::vector<std::string> const files = sequence_fields(places);
  check_fields(files);
  pair_count_ = files.size();
}

void SequenceRenderer::check_fields(std::vector<std::string> const& files) const {
  FieldSetup const& field = first_.first_setup().medium.field;
  std::optional<std::array<int, 3>> first_size;
  std::string first_name;
  std::string const where = document_.copy().root().table("sequence").where("files");
  std::vector<SetupProblem> problems;
  for (std::string const& file : files) {
    std::string problem;
    ErrorCode code = ErrorCode::inconsistent;
    try {
      auto const source = open_field(file, field.dataset, 1, field.axes);
      auto const& nodes = source->grid().nodes;
      std::array<int, 3> const size{nodes[0], nodes[1], nodes[2]};
      if (!first_size) {
        first_size = size;
        first_name = file;
      } else if (size != *first_size) {
        problem = fmt::format(
            "{} has {} x {} x {} nodes but {} has {} x {} x {} (all fields of a sequence must have one size); "
            "exclude it, or resample it",
            file, size[0], size[1], size[2], first_name, (*first_size)[0], (*first_size)[1], (*first_size)[2]);
      }
    } catch (DataError const& error) {
      problem = error.what();
      code = error.code();
    }
    if (!problem.empty()) problems.push_back({where, "sequence.files: " + problem, "sequence.files", code});
  }
  if (problems.empty()) return;
  std::size_t const more = problems.size() - std::min(problems.size(), max_reported_problems);
  problems.resize(problems.size() - more);
  throw SetupError(std::move(problems), more);
}

SetupRenderer SequenceRenderer::pair_setup(std::size_t number) const {
  SetupDocument document = document_.copy();
  document.override_key(fmt::format("sequence.pair={}", number));
  return {std::move(document), path_};
}

void SequenceRenderer::refuse_over_inputs(std::string const& folder) const {
  for (std::size_t k = 0; k < pair_count_; ++k)
    first_.refuse_over_inputs((fs::path(folder) / rendered_sequence_file::pair(first_pair_ + k)).string());
}

RenderedSequence SequenceRenderer::render(Renderer& renderer, std::string const& folder, bool show_progress) {
  auto const start = std::chrono::steady_clock::now();
  prepare_sequence_folder(folder, written_setup(document_.copy(), first_.cameras()));
  SequenceRendering run(folder, *first_.first_setup().sequence, first_.camera_names());
  RenderedSequence result;
  try {
    std::optional<PairProgress> progress;  // progress over the pairs after those of an earlier run
    for (std::size_t k = 0; k < pair_count_; ++k) {
      throw_if_interrupted();
      std::size_t const number = first_pair_ + k;
      std::optional<SetupRenderer> later;
      SetupRenderer& setup = k == 0 ? first_ : later.emplace(pair_setup(number));
      if (run.retain(number, k == 0, setup)) {
        ++result.resumed;
      } else {
        if (!progress) progress.emplace("render pairs", pair_count_ - k, show_progress);
        run.render(number, k == 0, setup, renderer);
      }
      run.write_summary(k + 1 == pair_count_);
      if (progress) progress->advance();
    }
  } catch (Interrupted const&) {
    throw Interrupted(
        fmt::format("interrupted; {} of {} pairs are done, and the same command continues with the others", run.done(),
                    pair_count_));
  }
  result.summary = json_text(run.summary(true));
  result.warnings = run.later_warnings();
  result.pairs = pair_count_;
  result.frames = pair_count_ + 1;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace gladstone::inline cases
