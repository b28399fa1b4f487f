#include "studies/compare/correlate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/correlator.h"
#include "analysis/correlation/pair_assessment.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/tracking/track_frames.h"
#include "analysis/uncertainty/uncertainty.h"
#include "analysis/vectors/vector_file.h"
#include "render/base/contracts.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "render/files/stop_point.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/case.h"
#include "studies/case/peak_locking.h"
#include "studies/case/truth_file.h"
#include "studies/case/warning_log.h"
#include "studies/compare/exchanged_frames.h"
#include "studies/compare/tracked_dots.h"

namespace gladstone::inline compare {
namespace {

CorrelationFile read_document(SetupDocument document, std::vector<std::string> const& overrides, PreparedSet set) {
  SetupTable root = document.root();
  // The file may be a complete setup, including the tables that request a design.
  for (char const* other : {"schema", "experiment", "camera", "lens", "geometry", "window", "element", "medium",
                            "target", "light", "particles", "laser", "flow", "calibration", "sequence", "render"})
    root.mark_as_read(other);
  for (char const* other : design_tables) root.mark_as_read(other);
  for (auto const& assignment : overrides) {
    if (assignment.starts_with("correlate.") || assignment.starts_with("correlate=")) {
      document.override_key(assignment);
    } else {
      document.add_problem({"--set " + assignment,
                            "does not begin with \"correlate.\", the only table used here; write --set "
                            "correlate.KEY=VALUE, or remove it",
                            assignment.substr(0, assignment.find('=')), ErrorCode::unknown_key});
    }
  }
  CorrelationFile file;
  file.settings = read_correlation_settings(document.root().table("correlate"), set);
  document.finish();
  file.resolved = document.resolved();
  return file;
}

/// Adds the known dots of a BOS case to settings of dot tracking, if its truth belongs to the reference image.
CorrelationSettings with_dots_of_case(CorrelationSettings const& settings, Setup const& setup,
                                      std::string const& folder, SourceFiles& sources) {
  std::string const truth = in_case(folder, case_file::truth);
  std::error_code error;
  bool const known = correlation_method(settings.method).tracks_dots && setup.experiment().sources.on_target;
  if (!known || !std::filesystem::exists(truth, error)) return settings;
  if (Hdf5Reader(truth).attribute("reference_sha256") != sources.sha256("reference")) return settings;
  sources.add("", truth, SourceFiles::Holds::bytes);
  return with_known_dots(settings, setup, read_truth(truth).reference_px);
}

/// Warns of conversions applied to an image on reading.
void warn_of_reading(std::string const& path, ImageMetadata const& metadata) {
  if (metadata.channels >= 3) {
    log_warning(
        {WarningCode::assumed, path,
         "is a colour image: its luminance (Rec. 709) is correlated; raw grey images of the camera are better"});
  }
  if (metadata.orientation != 1) {
    log_warning({WarningCode::assumed, path,
                 fmt::format("is stored rotated or mirrored (Orientation {}), and was rotated upright; if that entry "
                             "is wrong, write the image without it",
                             metadata.orientation)});
  }
}

/// Applies masks and preprocessing steps to a pair. The frames before and after it are prepared as in the pairs that
/// they form with it.
std::unique_ptr<StoredFrames> prepare_pair(StoredFrames const& frames, FramePreparation const& preparation) {
  HostFrames pair = prepare_frames(frames, preparation);
  auto const* const tracks = dynamic_cast<tracking::TrackFrames const*>(&frames);
  if (!tracks) return std::make_unique<HostFrames>(std::move(pair));
  std::optional<Image<double>> before, after;
  if (tracks->before())
    before = prepare_frames(HostFrames(*tracks->before(), frames.reference()), preparation).reference();
  if (tracks->after()) after = prepare_frames(HostFrames(frames.flow(), *tracks->after()), preparation).flow();
  return std::make_unique<tracking::TrackFrames>(std::move(pair), std::move(before), std::move(after), tracks->dots());
}

/// Applies masks and preprocessing steps to the frames and correlates the result.
Measurement correlate_prepared(StoredFrames const& frames, CorrelationSettings settings, Backend const& device) {
  auto const start = std::chrono::steady_clock::now();
  std::unique_ptr<StoredFrames> const prepared = prepare_pair(frames, settings.preparation);
  settings.preparation = {};
  Measurement measurement = correlate_frames(*prepared, settings, device);
  if (valid_pixel_fraction(*prepared) == 0.0)
    measurement.field.warnings.push_back(
        {WarningCode::excluded, "",
         "the masks cover every pixel of the frames (so that every vector is masked); reduce correlate.mask"});
  measurement.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return measurement;
}

/// Frame of a pair: its name in messages and its size [px].
struct NamedFrame {
  std::string const& name;
  std::int64_t columns, rows;
};

/// @throws DataError if the frames differ in size or are smaller than an interrogation window
void check_sizes(NamedFrame const& reference, NamedFrame const& flow, CorrelationSettings const& settings) {
  if (reference.columns != flow.columns || reference.rows != flow.rows) {
    throw DataError(ErrorCode::wrong_shape, flow.name,
                    fmt::format("is {} x {} px but {} is {} x {} (both frames must have one size)", flow.columns,
                                flow.rows, reference.name, reference.columns, reference.rows));
  }
  int const largest = *std::max_element(settings.window_px.begin(), settings.window_px.end());
  if (largest > std::min(reference.columns, reference.rows)) {
    throw DataError(ErrorCode::wrong_shape, reference.name,
                    fmt::format("is {} x {} px, smaller than a window of {} px; set correlate.window_px smaller",
                                reference.columns, reference.rows, largest));
  }
}

/// Warns of pixels that are NaN or infinite, which the correlator excludes from every window; throws if there are no
/// others.
void check_finite(NamedFrame const& frame, std::size_t not_finite) {
  auto const size = static_cast<std::size_t>(frame.columns * frame.rows);
  if (not_finite == size) {
    throw DataError(ErrorCode::invalid_value, frame.name,
                    fmt::format("all of its {} pixels are nan or infinite; export it again", not_finite));
  }
  if (not_finite > 0) {
    log_warning(
        {WarningCode::excluded, frame.name,
         fmt::format("{} of {} pixels are nan or infinite, and are excluded from their windows", not_finite, size)});
  }
}

/// Correlates frames of suitable sizes, and estimates the uncertainty of the vectors.
Measurement correlate_checked(StoredFrames const& frames, CorrelationSettings const& settings, Backend const& device) {
  stop_point("correlating");
  bool const on_cpu = device.correlates_on(settings) == "cpu";
  Measurement measurement = correlate_frames(frames, choose_uncertainty(settings, on_cpu), device);
  record_uncertainty(measurement.field, settings,
                     on_cpu ? CorrelatedFrames::pair_on_cpu : CorrelatedFrames::pair_on_gpu);
  return measurement;
}

}  // namespace

Measurement correlate_frames(std::string const& reference_name, std::string const& flow_name,
                             StoredFrames const& frames, CorrelationSettings const& settings, Backend const& device) {
  Image<double> const &reference = frames.reference(), &flow = frames.flow();
  NamedFrame const a{reference_name, reference.columns(), reference.rows()}, b{flow_name, flow.columns(), flow.rows()};
  check_sizes(a, b, settings);
  check_finite(a, count_not_finite(reference));
  check_finite(b, count_not_finite(flow));
  return correlate_checked(frames, settings, device);
}

Measurement correlate_gpu_arrays(std::string const& reference_name, ImageSamples const& reference,
                                 std::string const& flow_name, ImageSamples const& flow,
                                 CorrelationSettings const& settings, Backend const& device) {
  NamedFrame const a{reference_name, reference.columns, reference.rows}, b{flow_name, flow.columns, flow.rows};
  check_sizes(a, b, settings);
  CopiedFrames const copied = copy_frames_on_gpu(reference, flow);
  check_finite(a, copied.not_finite[0]);
  check_finite(b, copied.not_finite[1]);
  return correlate_checked(*copied.frames, settings, device);
}

Measurement correlate_frames(StoredFrames const& frames, CorrelationSettings const& settings, Backend const& device) {
  if (!settings.preparation.empty()) return correlate_prepared(frames, settings, device);
  auto const start = std::chrono::steady_clock::now();
  std::unique_ptr<Correlator> const correlator = device.correlator(settings);
  Measurement measurement{correlator->correlate_pair(frames), 0, device.correlates_on(settings)};
  assess_pair(measurement.field, frames, *correlator, settings);
  complete_uncertainty(measurement.field, frames, settings);
  auto const counts = [](VectorStatus status) { return status <= VectorStatus::replaced; };
  bool const any = std::any_of(measurement.field.status.begin(), measurement.field.status.end(), counts);
  if (std::string caveat = uncertainty_caveat(settings); any && !caveat.empty())
    measurement.field.warnings.push_back({WarningCode::low_accuracy, "correlate.uncertainty", std::move(caveat)});
  measurement.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return measurement;
}

CorrelationFile read_correlation_file(std::string const& path, std::vector<std::string> const& overrides,
                                      PreparedSet set) {
  return read_document(read_setup_document(path), overrides, set);
}

CorrelationFile default_correlation(std::vector<std::string> const& overrides, PreparedSet set) {
  return read_document(SetupDocument::from_text("", "defaults"), overrides, set);
}

Image<double> read_frame(std::string const& path, std::string const& name, SourceFiles& sources) {
  ImageMetadata metadata;
  Image<double> frame = read_image(path, &metadata);
  warn_of_reading(path, metadata);
  sources.add(name, path, SourceFiles::Holds::pixels, pixel_sha256(frame, metadata.sample_bits));
  return frame;
}

void add_preparation(CorrelationSettings const& settings, SourceFiles& sources) {
  std::size_t number = 0;
  for (std::string const& file : settings.preparation.files)
    sources.add(fmt::format("preparation_{}", ++number), file, SourceFiles::Holds::pixels);
}

FramePair<double> read_frames(std::string const& pair, SourceFiles& sources) {
  ImageMetadata metadata;
  sources.add("", pair, SourceFiles::Holds::bytes);
  FramePair<double> frames = read_frame_pair(pair, &metadata);
  warn_of_reading(pair, metadata);
  sources.add_known("reference", pixel_sha256(frames.reference, metadata.sample_bits));
  sources.add_known("flow", pixel_sha256(frames.flow, metadata.sample_bits));
  return frames;
}

Measurement correlate_ensemble_files(std::vector<std::string> const& files, CorrelationSettings const& settings,
                                     SourceFiles& sources) {
  GLADSTONE_EXPECTS(!files.empty() && files.size() % 2 == 0);
  auto const start = std::chrono::steady_clock::now();
  int columns = 0, rows = 0;
  Image<double> reference;
  std::vector<std::string> twice;  // flow frames of pairs whose images are identical
  for (std::size_t k = 0; k < files.size(); ++k) {
    bool const is_flow = k % 2 == 1;
    Image<double> frame =
        read_frame(files[k], fmt::format("{}_{}", is_flow ? "flow" : "reference", k / 2 + 1), sources);
    if (is_flow && are_identical_frames(reference, frame)) twice.push_back(files[k]);
    if (k == 0) {
      columns = frame.columns();
      rows = frame.rows();
    }
    if (frame.columns() != columns || frame.rows() != rows)
      throw DataError(ErrorCode::wrong_shape, files[k],
                      fmt::format("is {} x {} px but {} is {} x {} (all frames must have one size)", frame.columns(),
                                  frame.rows(), files[0], columns, rows));
    if (!is_flow) reference = std::move(frame);
  }
  if (std::string const problem = window_problem(settings, columns, rows); !problem.empty())
    throw DataError(ErrorCode::wrong_shape, files[0], problem);
  PairSequence const pairs{files.size() / 2, [&](std::size_t k) {
                             HostFrames const frames(read_image(files[2 * k]), read_image(files[2 * k + 1]));
                             return prepare_frames(frames, settings.preparation);
                           }};
  Measurement measurement{correlate_ensemble(pairs, settings), 0, "cpu"};
  assess_ensemble(measurement.field, pairs, settings);
  record_uncertainty(measurement.field, settings, CorrelatedFrames::ensemble);
  if (!twice.empty() && twice.size() < pairs.size)
    measurement.field.warnings.push_back(
        {WarningCode::unreliable, twice.front(),
         fmt::format(
             "is both images of a pair (which biases the displacement towards 0), as in {} of {} pairs; remove them",
             twice.size(), pairs.size)});
  measurement.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return measurement;
}

Measurement correlate_case(std::string const& folder, std::string const& output, CorrelationFile const* other,
                           Backend const& device) {
  std::string const reference = in_case(folder, case_file::reference), flow = in_case(folder, case_file::flow);
  std::string const setup = in_case(folder, case_file::setup);
  SourceFiles sources;
  sources.on_change("run gladstone correlate " + folder + " again");
  sources.add("", setup, SourceFiles::Holds::bytes);
  CaseSetup loaded = load_case_setup(setup, {});
  CorrelationSettings const& settings = other ? other->settings : loaded.correlate;
  Image<double> reference_frame = read_frame(reference, "reference", sources);
  HostFrames const frames(std::move(reference_frame), read_frame(flow, "flow", sources));
  add_preparation(settings, sources);
  Measurement measurement =
      correlate_frames(reference, flow, frames, with_dots_of_case(settings, loaded.setup, folder, sources), device);
  warn_of_exchanged_frames(measurement.field, sources);
  FileOrigin origin{
      "gladstone vectors", 1,      other ? other->resolved : loaded.document.resolved(), loaded.setup.render.seed,
      measurement.device,  sources};
  write_vectors(output.empty() ? in_case(folder, case_file::vectors) : output, measurement.field, origin);
  if (auto const advice = locking_advice(loaded.setup); advice && frames_correlate(measurement.field))
    measurement.field.warnings.push_back(*advice);
  return measurement;
}

}  // namespace gladstone::inline compare
