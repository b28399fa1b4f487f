#include "studies/compare/sequence.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <sstream>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/pair_assessment.h"
#include "analysis/vectors/sequence_statistics.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/version.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_pages.h"
#include "render/files/input_guard.h"
#include "render/files/sha256.h"
#include "render/files/stop_point.h"
#include "studies/case/pair_progress.h"
#include "studies/case/peak_locking.h"
#include "studies/case/warning_kinds.h"
#include "studies/compare/sequence_folder.h"

namespace gladstone {
namespace {

/// Pairs per thread that are correlated before their vectors are added to the statistics, in their order.
constexpr std::size_t pairs_per_thread = 8;

struct SequenceImage {
  Image<double> levels;
  std::string sha256;
  std::vector<std::string> warnings;
};

SequenceImage read_sequence_image(SequenceFrame const& frame) {
  ImageMetadata metadata;
  SequenceImage image;
  image.levels = frame.pages > 1 ? read_page(frame.path, frame.page, &metadata) : read_image(frame.path, &metadata);
  image.sha256 = pixel_sha256(image.levels, metadata.sample_bits);
  if (metadata.channels >= 3)
    image.warnings.push_back(frame.name() + " is a colour image: its luminance (Rec. 709) is correlated");
  if (metadata.orientation != 1)
    image.warnings.push_back(fmt::format("{} is stored rotated or mirrored (Orientation {}), and was rotated upright",
                                         frame.name(), metadata.orientation));
  if (std::size_t const bad = count_not_finite(image.levels); bad == image.levels.size()) {
    throw DataError(frame.name(), "all of its pixels are nan or infinite; export it again");
  } else if (bad > 0) {
    image.warnings.push_back(
        fmt::format("{}: {} pixels are nan or infinite, and are excluded from their windows", frame.name(), bad));
  }
  return image;
}

/// Correlator that several owners share.
class SharedCorrelator final : public Correlator {
 public:
  explicit SharedCorrelator(std::shared_ptr<Correlator const> shared) : shared_(std::move(shared)) {}
  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    return shared_->correlate(reference, flow);
  }
  DisplacementField correlate_pair(FramePair const& frames) const override { return shared_->correlate_pair(frames); }

 private:
  std::shared_ptr<Correlator const> shared_;
};

/// Returns the device with one correlator for all pairs, so that a GPU allocates its memory once. Correlators may be
/// used by several threads; that of a GPU serves them in turn.
Backend share_correlator(Backend device) {
  struct Made {
    std::once_flag once;
    std::shared_ptr<Correlator const> correlator;
  };
  auto const made = std::make_shared<Made>();
  auto const make = device.correlator;
  device.correlator = [made, make](CorrelationSettings const& settings) {
    std::call_once(made->once, [&] { made->correlator = make(settings); });
    return std::make_unique<SharedCorrelator>(made->correlator);
  };
  return device;
}

/// Removes the data that the statistics do not use.
DisplacementField without_details(DisplacementField field) {
  field.sigma_px = field.raw_px = {};
  field.peak_ratio = field.correlation = {};
  field.failed = {};
  field.ambiguous = {};
  return field;
}

std::vector<std::string> split_lines(std::string const& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Summarises warnings that differ only in their numbers and in the names of the frames.
std::vector<std::string> summarise_warnings(std::vector<PairRecord> const& pairs) {
  WarningKinds kinds;
  for (PairRecord const& record : pairs) {
    for (std::string const& warning : record.warnings) {
      std::string kind = warning;
      for (SequenceFrame const* frame : {&record.pair.reference, &record.pair.flow}) {
        auto const at = frame->path.empty() ? std::string::npos : kind.find(frame->name());
        if (at != std::string::npos) kind.erase(at, frame->name().size());
      }
      kinds.add(record.pair.vectors, warning, std::move(kind));
    }
  }
  return kinds.summary();
}

/// Implementation of correlate_sequence().
class SequenceRun {
 public:
  SequenceRun(std::vector<SequencePair> const& pairs, SequenceSettings const& settings, Backend device, bool shown)
      : settings_(settings), device_(share_correlator(std::move(device))), shown_(shown) {
    for (SequencePair const& pair : pairs) {
      PairRecord record;
      record.pair = pair;
      if (!pair.problem.empty()) {
        record.state = PairState::failed;
        record.error = pair.problem;
      }
      result_.pairs.push_back(std::move(record));
    }
    result_.device = device_.correlates_on(correlation());
  }

  SequenceResult run(std::string const& path) {
    auto const start = std::chrono::steady_clock::now();
    find_size();
    SequenceFolder const folder(path);
    hash_settings();
    write_state(folder, false);
    stop_point("correlating");
    try {
      correlate_all(folder);
    } catch (Interrupted const&) {
      try {
        write_state(folder, false);
      } catch (Interrupted const&) {  // vectors alone suffice to continue
      }
      throw Interrupted(
          fmt::format("interrupted; {} of {} pairs are done, and the same command continues with the others",
                      count_with_vectors(), result_.pairs.size()));
    }
    finish(folder);
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::move(result_);
  }

 private:
  CorrelationSettings const& correlation() const { return settings_.correlation.settings; }

  std::size_t count_with_vectors() const {
    return static_cast<std::size_t>(std::count_if(result_.pairs.begin(), result_.pairs.end(),
                                                  [](PairRecord const& record) { return record.has_vectors(); }));
  }

  /// Reads the first readable frame, whose size all others must have, and checks that the windows fit into it.
  void find_size() {
    std::exception_ptr first_error;
    for (PairRecord const& record : result_.pairs) {
      if (!record.pair.problem.empty()) continue;
      try {
        SequenceImage image = read_sequence_image(record.pair.reference);
        columns_ = image.levels.columns();
        rows_ = image.levels.rows();
        sized_ = record.pair.reference.name();
        if (settings_.pairing == Pairing::reference) common_reference_ = std::move(image);
        break;
      } catch (DataError const&) {
        if (!first_error) first_error = std::current_exception();
        if (settings_.pairing == Pairing::reference) break;
      }
    }
    if (sized_.empty() && first_error) std::rethrow_exception(first_error);
    if (sized_.empty()) throw DataError("correlate", "no pair is complete (" + result_.pairs.front().error + ")");
    if (std::string const problem = window_problem(correlation(), columns_, rows_); !problem.empty())
      throw DataError(sized_, problem);
  }

  void check_size(Image<double> const& levels, std::string const& name) const {
    if (levels.columns() == columns_ && levels.rows() == rows_) return;
    throw DataError(name, fmt::format("is {} x {} px but {} is {} x {} px (all frames must have one size)",
                                      levels.columns(), levels.rows(), sized_, columns_, rows_));
  }

  /// Computes the backgrounds of the sequence, and the hash of everything that affects the vectors besides the frames.
  void hash_settings() {
    Sha256 hash;
    hash.add(fmt::format("gladstone {}\n{}\n", version, settings_.correlation.resolved));
    auto const add = [&](std::string const& name, std::string const& sha256) {
      sources_.add_known(name, sha256);
      hash.add(name + ' ' + sha256 + '\n');
    };
    std::size_t number = 0;
    for (std::string const& file : correlation().preparation.files)
      add(fmt::format("preparation_{}", ++number), pixel_sha256(file));
    number = 0;
    for (auto const& background : settings_.backgrounds) {
      compute_images(*background);
      ++number;
      add(fmt::format("background_{}_reference", number), pixel_sha256(background->reference, 64));
      add(fmt::format("background_{}_flow", number), pixel_sha256(background->flow, 64));
    }
    settings_sha256_ = hash.finish();
    sources_.add_known("settings", settings_sha256_);
  }

  /// Computes the background of frames A and that of frames B. With another pairing than Pairing::pairs they are images
  /// of one series, and the background is that of all frames.
  void compute_images(SequenceBackground& background) const {
    std::vector<SequenceFrame> first, second;
    for (PairRecord const& record : result_.pairs) {
      if (!record.pair.problem.empty()) continue;
      first.push_back(record.pair.reference);
      second.push_back(record.pair.flow);
    }
    bool const pairs = settings_.pairing == Pairing::pairs;
    if (settings_.pairing == Pairing::reference) first = {first.front()};
    if (settings_.pairing == Pairing::consecutive) second = {second.back()};
    if (!pairs) first.insert(first.end(), second.begin(), second.end());
    background.reference = compute_image(background.statistic, first);
    background.flow = pairs ? compute_image(background.statistic, second) : background.reference;
    if (background.reference.empty() || background.flow.empty())
      throw DataError("correlate.preprocess", "no frame is suitable for the background; check that they are readable");
  }

  Image<double> compute_image(std::string const& statistic, std::vector<SequenceFrame> const& frames) const {
    PairProgress progress("background", frames.size(), shown_);
    return compute_background(statistic, frames.size(), [&](std::size_t k) -> std::optional<Image<double>> {
      throw_if_interrupted();
      progress.advance();
      try {
        SequenceImage image = read_sequence_image(frames[k]);
        check_size(image.levels, frames[k].name());
        if (count_not_finite(image.levels) > 0) return std::nullopt;
        return std::move(image.levels);
      } catch (DataError const&) {  // its pair reports the problem
        return std::nullopt;
      }
    });
  }

  /// Correlates the pairs in batches. After each, the fields are added to the statistics in their order, so that the
  /// sums do not depend on the number of threads.
  void correlate_all(SequenceFolder const& folder) {
    PairProgress progress("correlate pairs", result_.pairs.size(), shown_);
    auto const threads = static_cast<std::size_t>(thread_count());
    std::size_t const batch = pairs_per_thread * threads;
    for (std::size_t begin = 0; begin < result_.pairs.size(); begin += batch) {
      std::size_t const end = std::min(result_.pairs.size(), begin + batch);
      std::vector<DisplacementField> fields(end - begin);
      std::atomic<std::size_t> next{begin};
      std::mutex mutex;
      std::exception_ptr fatal;
      // Bodies do not throw: an exception would cancel the parallel loops within the other bodies.
      parallel_for(std::min(threads, end - begin), [&](std::size_t) {
        for (std::size_t k = next++; k < end; k = next++) {
          try {
            fields[k - begin] = process(folder, result_.pairs[k]);
          } catch (...) {
            std::lock_guard const lock(mutex);
            if (!fatal) fatal = std::current_exception();
            next = end;
            return;
          }
          progress.advance();
        }
      });
      if (fatal) std::rethrow_exception(fatal);
      for (std::size_t k = begin; k < end; ++k) {
        if (result_.pairs[k].has_vectors())
          statistics_.add(fields[k - begin]);
        else
          statistics_.skip();
      }
    }
  }

  /// Correlates a pair unless its vectors exist, and sets its record.
  /// @return its vectors; empty if it failed
  /// @throws Interrupted, OutputError, DeviceError, which concern all pairs
  DisplacementField process(SequenceFolder const& folder, PairRecord& record) {
    if (record.state == PairState::failed) return {};
    try {
      throw_if_interrupted();
      DisplacementField field = measure(folder, record);
      bool any = false;
      for (std::size_t i = 0; i < field.size() && !any; ++i) any = field.counts(i);
      record.state = any ? PairState::done : PairState::no_valid_vector;
      if (!any) record.error = "none of its vectors is valid; check that both frames show one scene";
      return without_details(std::move(field));
    } catch (Interrupted const&) {
      throw;
    } catch (OutputError const&) {
      throw;
    } catch (DeviceError const&) {
      throw;
    } catch (std::exception const& error) {
      record.state = PairState::failed;
      record.error = format_user_message(error);
      return {};
    }
  }

  DisplacementField measure(SequenceFolder const& folder, PairRecord& record) {
    SequenceImage reference = common_reference_ ? *common_reference_ : read_sequence_image(record.pair.reference);
    SequenceImage flow = read_sequence_image(record.pair.flow);
    check_size(reference.levels, record.pair.reference.name());
    check_size(flow.levels, record.pair.flow.name());
    record.reference_sha256 = reference.sha256;
    record.flow_sha256 = flow.sha256;
    std::string const path = folder.file(record.pair.vectors);
    if (std::optional<DisplacementField> finished = read_finished(path, record)) return std::move(*finished);

    HostFrames const frames(std::move(reference.levels), std::move(flow.levels));
    Measurement measurement = correlate_frames(frames, correlation(), device_);
    throw_if_interrupted();  // the measurement may be incomplete
    DisplacementField& field = measurement.field;
    field.warnings.insert(field.warnings.begin(), flow.warnings.begin(), flow.warnings.end());
    field.warnings.insert(field.warnings.begin(), reference.warnings.begin(), reference.warnings.end());
    if (std::string advice = locking_advice(frames.reference()); frames_correlate(field) && !advice.empty())
      field.warnings.push_back(std::move(advice));
    record.warnings = field.warnings;
    SourceFiles sources = sources_;
    sources.add_known("reference", record.reference_sha256);
    sources.add_known("flow", record.flow_sha256);
    write_vectors(path, field,
                  {"gladstone vectors", 1, settings_.correlation.resolved, 0, measurement.device, std::move(sources)});
    stop_point("pair-finished");
    return std::move(field);
  }

  /// Reads the vectors of an earlier run.
  /// @return nullopt if they are missing or damaged, or if they belong to other frames or settings
  std::optional<DisplacementField> read_finished(std::string const& path, PairRecord& record) const {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return std::nullopt;
    UnrecordedReading const to_be_replaced;
    try {
      Hdf5Reader const file(path);
      if (file.attribute("settings_sha256") != settings_sha256_ ||
          file.attribute("reference_sha256") != record.reference_sha256 ||
          file.attribute("flow_sha256") != record.flow_sha256)
        return std::nullopt;
      DisplacementField field = read_vectors(path).field;
      if (field.size() != final_grid(correlation(), columns_, rows_).size()) return std::nullopt;
      record.warnings = split_lines(file.attribute("warnings"));
      record.resumed = true;
      return field;
    } catch (DataError const&) {  // damaged: it is computed again
      return std::nullopt;
    }
  }

  void finish(SequenceFolder const& folder) {
    result_.warnings = summarise_warnings(result_.pairs);
    if (count_with_vectors() > 0) {
      SequenceMoments const moments = statistics_.moments();
      result_.vectors = moments.position_px.size();
      if (moments.unresolved * 10 > result_.vectors)
        result_.warnings.push_back(fmt::format(
            "{} of {} points remain correlated over all {} recorded lags (so that standard errors are too small); "
            "record a longer sequence at a lower rate",
            moments.unresolved, result_.vectors, moments.lags));
      SourceFiles sources;
      sources.add_known("settings", settings_sha256_);
      sources.add_known("sequence", hash_pairs());
      write_sequence_statistics(
          folder.file(sequence_file::statistics), moments,
          {"gladstone statistics", 1, settings_.correlation.resolved, 0, result_.device, std::move(sources)});
    }
    write_state(folder, count_with_vectors() > 0);
  }

  /// Computes the hash of the hashes of all frames that the statistics include.
  std::string hash_pairs() const {
    Sha256 hash;
    for (PairRecord const& record : result_.pairs)
      if (record.has_vectors()) hash.add(record.reference_sha256 + ' ' + record.flow_sha256 + '\n');
    return hash.finish();
  }

  void write_state(SequenceFolder const& folder, bool complete) const {
    write_sequence_state(
        folder.file(sequence_file::state),
        {settings_.pairing, complete, columns_, rows_, settings_.correlation.resolved, settings_sha256_},
        result_.pairs);
  }

  SequenceSettings const& settings_;
  Backend device_;
  bool shown_;
  SequenceResult result_;
  int columns_ = 0, rows_ = 0;
  std::string sized_;                              ///< name of the frame that determines the size
  std::optional<SequenceImage> common_reference_;  ///< frame A of every pair, for Pairing::reference
  SourceFiles sources_;                            ///< hashes that all pairs have in common
  std::string settings_sha256_;
  SequenceStatistics statistics_;
};

}  // namespace

std::size_t SequenceResult::count(PairState state) const {
  return static_cast<std::size_t>(
      std::count_if(pairs.begin(), pairs.end(), [state](PairRecord const& record) { return record.state == state; }));
}

std::size_t SequenceResult::count_resumed() const {
  return static_cast<std::size_t>(
      std::count_if(pairs.begin(), pairs.end(), [](PairRecord const& record) { return record.resumed; }));
}

SequenceSettings read_sequence_settings(Pairing pairing, std::string const& path,
                                        std::vector<std::string> const& overrides) {
  SequencePreparation const preparation;
  SequenceSettings settings;
  settings.pairing = pairing;
  settings.correlation = path.empty() ? default_correlation(overrides) : read_correlation_file(path, overrides);
  settings.backgrounds = preparation.backgrounds();
  if (settings.correlation.settings.gives_scattered_vectors())
    throw DataError(
        "correlate.tracking.output",
        "\"scattered\" gives vectors at other points for each pair (the statistics of a sequence require one "
        "grid); choose \"grid\"");
  return settings;
}

SequenceResult correlate_sequence(std::vector<SequencePair> const& pairs, SequenceSettings const& settings,
                                  std::string const& folder, Backend device, bool show_progress) {
  return SequenceRun(pairs, settings, std::move(device), show_progress).run(folder);
}

}  // namespace gladstone
