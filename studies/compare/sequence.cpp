#include "studies/compare/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <utility>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/tracking/track_numbers.h"
#include "analysis/vectors/sequence_statistics.h"
#include "analysis/vectors/track_vectors.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/version.h"
#include "render/files/hdf5_file.h"
#include "render/files/sha256.h"
#include "render/files/source_files.h"
#include "render/files/stop_point.h"
#include "studies/case/pair_progress.h"
#include "studies/case/warning_kinds.h"
#include "studies/case/warning_log.h"
#include "studies/compare/ordered_fields.h"
#include "studies/compare/pair_correlation.h"
#include "studies/compare/sequence_folder.h"
#include "studies/compare/sequence_images.h"

namespace gladstone::inline compare {
namespace {

/// Pairs per thread whose vectors may wait for those of an earlier pair, before they are added to the statistics.
constexpr std::size_t waiting_per_thread = 2;

/// Summarises warnings of the same code and place, where all frames are one place.
Warnings summarise_warnings(std::vector<PairRecord> const& pairs) {
  WarningKinds kinds;
  for (PairRecord const& record : pairs) {
    for (Warning const& warning : record.warnings) {
      bool const of_frame = !warning.place.empty() &&
                            (warning.place == record.pair.reference.name() || warning.place == record.pair.flow.name());
      kinds.add(record.pair.vectors, warning, of_frame ? "frame" : warning.place);
    }
  }
  return kinds.summary();
}

/// Returns in which frame the tracks of a pair continue in the next one.
tracking::TrackNumbers::Continues continuation(Pairing pairing) {
  using Continues = tracking::TrackNumbers::Continues;
  return pairing == Pairing::reference ? Continues::in_frame_a : Continues::in_frame_b;
}

/// Implementation of correlate_sequence().
class SequenceRun {
 public:
  SequenceRun(std::vector<SequencePair> const& pairs, SequenceSettings const& settings, bool shown)
      : settings_(settings), shown_(shown), track_numbers_(continuation(settings.pairing)) {
    for (SequencePair const& pair : pairs) {
      PairRecord record;
      record.pair = pair;
      if (!pair.problem.empty()) {
        record.state = PairState::failed;
        record.error = pair.problem;
      }
      result_.pairs.push_back(std::move(record));
    }
  }

  SequenceResult run(std::string const& path, Backend device) {
    auto const start = std::chrono::steady_clock::now();
    result_.device = device.correlates_on(correlation());
    std::vector<SequencePair> const pairs = complete_pairs();
    if (pairs.empty())
      throw DataError(ErrorCode::undetermined, "correlate",
                      "no pair is complete (" + result_.pairs.front().error + ")");
    size_ = find_commonest_size(pairs);
    if (std::string const problem = window_problem(correlation(), size_.columns, size_.rows); !problem.empty())
      throw DataError(ErrorCode::wrong_shape, size_.frame, problem);
    std::optional<SequenceImage> common_reference;
    if (settings_.pairing == Pairing::reference) common_reference = read_sequence_image(pairs.front().reference);
    SequenceFolder const folder(path);
    hash_settings();
    write_state(folder, false);  // first, since a folder without it is foreign
    if (tracks_dots()) folder.make_folder(sequence_file::dots);
    stop_point("correlating");
    PairCorrelation const correlate(settings_.correlation, size_, std::move(common_reference), sources_,
                                    std::move(device));
    try {
      correlate_all(correlate, folder);
    } catch (Interrupted const&) {
      try {
        write_state(folder, false);
      } catch (Interrupted const&) {  // ignored, since the stored vectors suffice to continue later
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
  bool tracks_dots() const { return correlation_method(correlation().method).tracks_dots; }

  static std::string dots_file(PairRecord const& record) { return sequence_file::dots + ('/' + record.pair.vectors); }

  std::size_t count_with_vectors() const {
    return static_cast<std::size_t>(std::count_if(result_.pairs.begin(), result_.pairs.end(),
                                                  [](PairRecord const& record) { return record.has_vectors(); }));
  }

  /// Computes the backgrounds of the sequence, and the hash of everything that affects the vectors besides the frames.
  void hash_settings() {
    Sha256 hash;
    hash.add(fmt::format("gladstone {}\n{}\n", version, settings_.correlation.resolved));
    auto const add = [&](std::string const& name, std::string const& sha256) {
      sources_.add_known(name, sha256);
      hash.add(name + ' ' + sha256 + '\n');
    };
    FramePreparation const& preparation = correlation().preparation;
    std::size_t number = 0;
    for (std::string const& file : preparation.files) add(fmt::format("preparation_{}", ++number), pixel_sha256(file));
    number = 0;
    for (auto const& background : preparation.backgrounds) {
      compute_background_images(*background, complete_pairs(), settings_.pairing, size_, shown_);
      ++number;
      add(fmt::format("background_{}_reference", number), pixel_sha256(background->reference, 64));
      add(fmt::format("background_{}_flow", number), pixel_sha256(background->flow, 64));
    }
    sources_.add_known("settings", hash.finish());
  }

  std::vector<SequencePair> complete_pairs() const {
    std::vector<SequencePair> pairs;
    for (PairRecord const& record : result_.pairs)
      if (record.pair.problem.empty()) pairs.push_back(record.pair);
    return pairs;
  }

  /// Correlates the pairs, thread_count() of them at a time. Their vectors are added to the statistics in the order of
  /// the pairs, so that the sums do not depend on the number of threads.
  void correlate_all(PairCorrelation const& correlation, SequenceFolder const& folder) {
    PairProgress progress("correlate pairs", result_.pairs.size(), shown_);
    auto const threads = static_cast<std::size_t>(thread_count());
    std::vector<PairDots> dots(result_.pairs.size());  // dots of the pairs whose fields wait for that of an earlier
                                                       // pair
    OrderedFields fields(waiting_per_thread * threads, [&](std::size_t k, DisplacementField const& field) {
      result_.pairs[k].has_vectors() ? statistics_.add(field) : statistics_.skip();
      if (tracks_dots()) store_dots(folder, result_.pairs[k], std::exchange(dots[k], {}));
    });
    std::atomic<std::size_t> next{0};
    // Bodies do not throw: an exception would cancel the parallel loops within the other bodies.
    parallel_for(std::min(threads, result_.pairs.size()), [&](std::size_t) {
      for (std::size_t k = next++; k < result_.pairs.size() && fields.wait_for(k); k = next++) {
        PairRecord& record = result_.pairs[k];
        try {
          PairVectors vectors =
              correlation.run(record, folder.file(record.pair.vectors), folder.file(dots_file(record)), neighbours(k));
          dots[k] = std::move(vectors.dots);
          fields.add(k, std::move(vectors.field));
        } catch (...) {
          fields.stop(std::current_exception());
        }
        progress.advance();
      }
    });
    fields.throw_if_stopped();
  }

  /// Numbers the tracks of a pair's dots and stores its scattered vectors.
  void store_dots(SequenceFolder const& folder, PairRecord const& record, PairDots const& dots) {
    if (!record.has_vectors()) {
      track_numbers_.end_tracks();
      return;
    }
    std::vector<std::int64_t> tracks;
    if (settings_.pairing != Pairing::pairs) tracks = track_numbers_.number(dots.vectors);
    if (dots.stored_tracks != tracks)
      write_track_vectors(folder.file(dots_file(record)), dots.vectors, tracks, dots.origin);
  }

  /// Returns the frames next to a pair over which particles are tracked: with consecutive frames, whose intervals are
  /// equal.
  PairNeighbours neighbours(std::size_t k) const {
    if (settings_.pairing != Pairing::consecutive || !tracks_dots()) return {};
    std::vector<PairRecord> const& pairs = result_.pairs;
    auto const complete = [&pairs](std::size_t i) { return i < pairs.size() && pairs[i].pair.problem.empty(); };
    return {k > 0 && complete(k - 1) ? &pairs[k - 1].pair.reference : nullptr,
            complete(k + 1) ? &pairs[k + 1].pair.flow : nullptr};
  }

  void finish(SequenceFolder const& folder) {
    result_.warnings = summarise_warnings(result_.pairs);
    if (count_with_vectors() > 0) {
      SequenceMoments const& moments = result_.statistics = statistics_.moments();
      if (moments.unresolved * 10 > result_.vectors())
        result_.warnings.push_back(
            {WarningCode::low_accuracy, "",
             fmt::format("at {} of {} vectors the fluctuations are still correlated after {} frames, the longest lag "
                         "that was evaluated, so that the standard errors of the statistics are too small; record a "
                         "longer sequence, or fewer frames per second",
                         moments.unresolved, result_.vectors(), moments.lags)});
      SourceFiles sources;
      sources.add_known("settings", sources_.sha256("settings"));
      sources.add_known("sequence", hash_pairs());
      remove_damaged_result(folder.file(sequence_file::statistics));
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
    write_sequence_state(folder.file(sequence_file::state),
                         {settings_.pairing, complete, size_.columns, size_.rows, settings_.correlation.resolved,
                          sources_.sha256("settings")},
                         result_.pairs);
  }

  SequenceSettings const& settings_;
  bool shown_;
  SequenceResult result_;
  SequenceSize size_;
  SourceFiles sources_;  ///< hashes that all pairs have in common
  SequenceStatistics statistics_;
  tracking::TrackNumbers track_numbers_;
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
  SequenceSettings settings;
  settings.pairing = pairing;
  settings.correlation = path.empty() ? default_correlation(overrides, PreparedSet::sequence)
                                      : read_correlation_file(path, overrides, PreparedSet::sequence);
  if (settings.correlation.settings.gives_scattered_vectors())
    throw DataError(
        ErrorCode::unsupported, KeyPath{"correlate.tracking.output"},
        "\"scattered\" gives vectors at other points for each pair (the statistics of a sequence require one "
        "grid); choose \"grid\", which stores the scattered vectors as well");
  return settings;
}

SequenceResult correlate_sequence(std::vector<SequencePair> const& pairs, SequenceSettings const& settings,
                                  std::string const& folder, Backend device, bool show_progress) {
  return SequenceRun(pairs, settings, show_progress).run(folder, std::move(device));
}

void report_sequence(SequenceResult const& result, std::string const& folder) {
  constexpr std::size_t most_named = 20;
  std::size_t failed = 0;
  for (PairRecord const& record : result.pairs) {
    if (record.error.empty() || ++failed > most_named) continue;
    log_warning({WarningCode::failed, record.pair.vectors, record.error});
  }
  if (failed > most_named)
    log_warning({WarningCode::failed, "",
                 fmt::format("{} further pairs failed; sequence.json lists them", failed - most_named)});
  if (result.count(PairState::done) == 0)
    throw DataError(ErrorCode::undetermined, folder,
                    fmt::format("all {} pairs failed; the first: {}", result.pairs.size(), result.pairs.front().error));
  log_warnings(result.warnings);
}

}  // namespace gladstone::inline compare
