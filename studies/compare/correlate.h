#pragma once

#include <string>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/frame_pair.h"
#include "render/base/image.h"
#include "render/base/image_samples.h"
#include "render/files/source_files.h"
#include "studies/case/backend.h"
#include "studies/case/correlation_setup.h"

namespace gladstone::inline compare {

/// Result of correlating one or several image pairs.
struct Measurement {
  DisplacementField field;  ///< vectors after validation by assess_pair() or assess_ensemble()
  double seconds = 0;       ///< wall time [s]
  std::string device;       ///< device of the correlation: "cpu" or "cuda"
};

/// Correlates two images, and estimates the uncertainty of the vectors by the method of choose_uncertainty().
/// @throws DataError if they differ in size or are smaller than an interrogation window
Measurement correlate_frames(std::string const& reference_name, std::string const& flow_name,
                             StoredFrames const& frames, CorrelationSettings const& settings, Backend const& device);
/// Like correlate_frames(), for images that another library stores in the memory of the first GPU; they are not copied
/// to the host unless the settings require the CPU.
Measurement correlate_gpu_arrays(std::string const& reference_name, ImageSamples const& reference,
                                 std::string const& flow_name, ImageSamples const& flow,
                                 CorrelationSettings const& settings, Backend const& device);
/// Correlates two frames that may be stored on a device; estimates no uncertainty if its method is "auto".
/// @pre the frames are at least as large as the largest interrogation window
Measurement correlate_frames(StoredFrames const& frames, CorrelationSettings const& settings, Backend const& device);

/// Settings of a [correlate] table.
struct CorrelationFile {
  CorrelationSettings settings;
  std::string resolved;  ///< the table as text with all defaults
};
/// Reads the [correlate] table of a complete setup, whose other tables are ignored, or of a file with nothing else.
/// @param set  frames to which the settings apply
/// @throws SetupError if the table is invalid
CorrelationFile read_correlation_file(std::string const& path, std::vector<std::string> const& overrides,
                                      PreparedSet set = PreparedSet::pair);
/// Returns the default settings, changed by `overrides` ("correlate.key=value").
CorrelationFile default_correlation(std::vector<std::string> const& overrides, PreparedSet set = PreparedSet::pair);

/// Reads a frame and adds the hash of its pixels to `sources`. Warns if the image is in colour.
/// @param name  "reference" or "flow"
Image<double> read_frame(std::string const& path, std::string const& name, SourceFiles& sources);

/// Reads both frames of a two-page file and adds their hashes to `sources`.
FramePair<double> read_frames(std::string const& pair, SourceFiles& sources);

/// Correlates many pairs for one common displacement field by correlate_ensemble(). Frames are read one pair at a time,
/// in every pass, and added to `sources` as reference_1, flow_1, reference_2, ...
/// @param files  frames A and B of each pair in turn
/// @throws DataError if frames differ in size or are smaller than an interrogation window
Measurement correlate_ensemble_files(std::vector<std::string> const& files, CorrelationSettings const& settings,
                                     SourceFiles& sources);

/// Adds the images of masks and preprocessing steps to `sources` as preparation_1, preparation_2, ...
void add_preparation(CorrelationSettings const& settings, SourceFiles& sources);

/// Correlates the frames of a CASE and writes `output` (.h5 or .csv) with the frames' hashes.
/// @param output  path; empty: CASE/vectors.h5
/// @param other   settings that replace those of the case; null: those of the case
/// @throws DataError if frames or setup changed meanwhile; nothing is written then
Measurement correlate_case(std::string const& folder, std::string const& output, CorrelationFile const* other,
                           Backend const& device);

}  // namespace gladstone::inline compare
