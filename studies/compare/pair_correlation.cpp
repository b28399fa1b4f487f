#include "studies/compare/pair_correlation.h"

#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/correlator.h"
#include "analysis/correlation/pair_assessment.h"
#include "analysis/tracking/track_frames.h"
#include "analysis/uncertainty/uncertainty.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/hdf5_file.h"
#include "render/files/input_guard.h"
#include "render/files/stop_point.h"
#include "studies/case/peak_locking.h"
#include "studies/compare/sequence_folder.h"

namespace gladstone::inline compare {
namespace {

/// Correlator that several owners share.
class SharedCorrelator final : public Correlator {
 public:
  explicit SharedCorrelator(std::shared_ptr<Correlator const> shared) : shared_(std::move(shared)) {}
  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    return shared_->correlate(reference, flow);
  }
  DisplacementField correlate_pair(StoredFrames const& frames) const override {
    return shared_->correlate_pair(frames);
  }

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

bool has_any_vector(DisplacementField const& field) {
  for (std::size_t i = 0; i < field.size(); ++i)
    if (field.counts(i)) return true;
  return false;
}

}  // namespace

PairCorrelation::PairCorrelation(CorrelationFile const& settings, SequenceSize size,
                                 std::optional<SequenceImage> common_reference, SourceFiles sources, Backend device)
    : settings_(settings),
      size_(std::move(size)),
      common_reference_(std::move(common_reference)),
      sources_(std::move(sources)),
      device_(share_correlator(std::move(device))) {}

PairVectors PairCorrelation::run(PairRecord& record, std::string const& path, std::string const& dots_path,
                                 PairNeighbours const& neighbours) const {
  if (record.state == PairState::failed) return {};
  try {
    throw_if_interrupted();
    Frames frames = read_frames(record, neighbours);
    record.reference_sha256 = frames.reference.sha256;
    record.flow_sha256 = frames.flow.sha256;
    std::optional<PairVectors> finished = read_finished(path, dots_path, hashes(frames), record);
    PairVectors vectors = finished ? std::move(*finished) : correlate(std::move(frames), record, path);
    bool const any = has_any_vector(vectors.field);
    record.state = any ? PairState::done : PairState::no_valid_vector;
    if (!any) record.error = "all of its vectors are invalid; check that both frames show the same scene";
    vectors.field = without_details(std::move(vectors.field));
    return vectors;
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

bool PairCorrelation::tracks_dots() const { return correlation_method(settings_.settings.method).tracks_dots; }

FileOrigin PairCorrelation::origin(SourceFiles sources, std::string const& device) const {
  return {"gladstone vectors", 1, settings_.resolved, 0, device, std::move(sources)};
}

PairCorrelation::Frames PairCorrelation::read_frames(PairRecord const& record, PairNeighbours const& neighbours) const {
  Frames frames;
  frames.reference = common_reference_ ? *common_reference_ : read_sequence_image(record.pair.reference);
  frames.flow = read_sequence_image(record.pair.flow);
  size_.require(frames.reference.levels, record.pair.reference.name());
  size_.require(frames.flow.levels, record.pair.flow.name());
  frames.warnings = frames.reference.warnings;
  frames.warnings.insert(frames.warnings.end(), frames.flow.warnings.begin(), frames.flow.warnings.end());
  frames.before = read_neighbour(neighbours.before, frames.warnings);
  frames.after = read_neighbour(neighbours.after, frames.warnings);
  return frames;
}

std::optional<SequenceImage> PairCorrelation::read_neighbour(SequenceFrame const* frame, Warnings& warnings) const {
  if (!frame) return std::nullopt;
  try {
    SequenceImage image = read_sequence_image(*frame);
    size_.require(image.levels, frame->name());
    return image;
  } catch (DataError const& error) {
    warnings.push_back({WarningCode::incomplete, error.place(), "tracks extend over fewer frames: " + error.message()});
    return std::nullopt;
  }
}

SourceFiles PairCorrelation::hashes(Frames const& frames) const {
  SourceFiles sources = sources_;
  sources.add_known("reference", frames.reference.sha256);
  sources.add_known("flow", frames.flow.sha256);
  if (frames.before) sources.add_known("before", frames.before->sha256);
  if (frames.after) sources.add_known("after", frames.after->sha256);
  return sources;
}

PairVectors PairCorrelation::correlate(Frames frames, PairRecord& record, std::string const& path) const {
  SourceFiles sources = hashes(frames);
  auto const levels = [](std::optional<SequenceImage>& image) {
    return image ? std::optional(std::move(image->levels)) : std::nullopt;
  };
  PairVectors vectors;
  tracking::TrackFrames const pair({std::move(frames.reference.levels), std::move(frames.flow.levels)},
                                   levels(frames.before), levels(frames.after), &vectors.dots.vectors);
  Measurement measurement = correlate_frames(pair, settings_.settings, device_);
  throw_if_interrupted();  // the measurement may be incomplete
  DisplacementField& field = measurement.field;
  field.warnings.insert(field.warnings.begin(), frames.warnings.begin(), frames.warnings.end());
  if (auto const advice = locking_advice(pair.reference()); advice && frames_correlate(field))
    field.warnings.push_back(*advice);
  record.warnings = field.warnings;
  record_uncertainty(field, settings_.settings, CorrelatedFrames::sequence);
  if (tracks_dots()) vectors.dots.origin = origin(sources, measurement.device);
  write_vectors(path, field, origin(std::move(sources), measurement.device));
  stop_point("pair-finished");
  vectors.field = std::move(field);
  return vectors;
}

std::optional<PairVectors> PairCorrelation::read_finished(std::string const& path, std::string const& dots_path,
                                                          SourceFiles const& hashes, PairRecord& record) const {
  std::vector<std::string> files{path};
  if (tracks_dots()) files.push_back(dots_path);
  UnrecordedReading const to_be_replaced;
  try {
    PairVectors vectors;
    for (std::string const& name : files) {
      if (std::error_code error; !std::filesystem::exists(name, error)) return std::nullopt;
      Hdf5Reader const file(name);
      for (char const* const frame : {"settings", "reference", "flow", "before", "after"})
        if (file.attribute(std::string(frame) + "_sha256") != hashes.sha256(frame)) return std::nullopt;
      if (name == path) record.warnings = read_warnings(file);
    }
    vectors.field = read_vectors(path).field;
    if (vectors.field.size() != final_grid(settings_.settings, size_.columns, size_.rows).size()) return std::nullopt;
    if (tracks_dots()) {
      TrackVectors dots = read_track_vectors(dots_path);
      vectors.dots = {std::move(dots.field), std::move(dots.tracks), origin(hashes, "cpu")};
    }
    record.resumed = true;
    return vectors;
  } catch (DataError const&) {
    for (std::string const& name : files) remove_damaged_result(name);
    return std::nullopt;
  }
}

}  // namespace gladstone::inline compare
