#pragma once

#include <array>
#include <string>

#include "analysis/correlation/correlation_settings.h"
#include "render/base/displacement_field.h"
#include "render/base/image.h"
#include "render/base/source_files.h"
#include "studies/device.h"

namespace gladstone {

/// What a measurement gives.
struct Measurement {
  DisplacementField field;  ///< as judge_pair() leaves it
  double seconds = 0;
  std::string device;  ///< that correlated: "cpu" or "cuda"
};

/// Correlates two frames. @throws DataError where they differ in size or are smaller than a window
Measurement correlate_frames(std::string const& reference_name, Image<double> const& reference,
                             std::string const& flow_name, Image<double> const& flow,
                             CorrelationSettings const& settings, Device const& device);
/// The same for frames that a device may keep. @pre no window is larger than they are
Measurement correlate_frames(FramePair const& frames, CorrelationSettings const& settings, Device const& device);

/// Reads the [correlate] table of a whole setup, whose other tables are not looked at, or of a file with nothing else.
/// @throws SetupError
struct CorrelationFile {
  CorrelationSettings settings;
  std::string resolved;  ///< text of the table with all defaults
};
CorrelationFile read_correlation_file(std::string const& path, std::vector<std::string> const& overrides);
CorrelationFile default_correlation(std::vector<std::string> const& overrides);

/// Reads a frame and enters it, by what it holds, among the sources of the vectors. A colour picture is warned of.
/// @param name "reference" or "flow"
Image<double> read_frame(std::string const& path, std::string const& name, SourceFiles& sources);

/// The same for a file of two pages, reference and flow.
std::array<Image<double>, 2> read_frames(std::string const& pair, SourceFiles& sources);

/// The one displacement of many pairs, `files` being reference and flow of each in turn: correlate_ensemble(). Frames
/// are read in every pass, one pair at a time, and entered among the sources as reference_1, flow_1, reference_2, ...
/// @throws DataError
Measurement correlate_ensemble_files(std::vector<std::string> const& files, CorrelationSettings const& settings,
                                     SourceFiles& sources);

/// Enters the pictures that masks and steps read among the sources, as preparation_1, preparation_2, ...
void add_preparation(CorrelationSettings const& settings, SourceFiles& sources);

/// Adds a warning where the frames named "reference" and "flow" are a case's flow frame and its reference, by what the
/// truth.h5 beside them or their names say.
void warn_of_exchanged_frames(DisplacementField& field, SourceFiles const& sources);

/// Correlates the frames of a CASE by its own settings and writes `output` (.h5 or .csv), which names the frames by
/// what they hold. @throws DataError where frames or setup were replaced meanwhile: nothing is written then
Measurement correlate_case(std::string const& folder, std::string const& output, CorrelationFile const* other,
                           Device const& device);

}  // namespace gladstone
