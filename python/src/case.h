#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "python/src/setup_text.h"
#include "studies/case/backend.h"
#include "studies/case/calibration_case.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"
#include "studies/case/write_case.h"

namespace gladstone::python {

/// Image pair of one camera with its truth: rendered in this process, or loaded from a CASE folder.
class PairCase {
 public:
  /// Renders the case of one camera.
  PairCase(CameraCase camera, Backend const& device, ReusableParts const& known);
  /// Loads a CASE folder.
  explicit PairCase(std::string folder);

  std::string const& camera() const { return camera_; }
  std::string const& folder() const { return folder_; }  ///< CASE folder that was loaded; empty: rendered
  CaseSetup const& loaded() const { return loaded_; }
  GroundTruth const& truth() const { return frames_ ? rendered_->rendering->truth : stored_truth_; }
  /// Returns the grey levels [2, rows, columns] of frame A and frame B.
  std::vector<std::uint16_t> const& images() const { return images_; }
  TruthAccuracy const& accuracy() const { return outcome_.accuracy; }
  double image_error_levels() const { return outcome_.image_error_levels; }
  std::string const& reference_sha256() const { return outcome_.reference_sha256; }
  std::string const& flow_sha256() const { return outcome_.flow_sha256; }

  /// Returns the contents of summary.json.
  std::string summary();
  std::string resolved() const { return loaded_.document.resolved(); }
  /// Writes the CASE folder. @throws OutputError; DataError for a case that was loaded
  void save(std::string const& folder);

  /// Returns the scene with its step size and ray budget. @throws SetupError
  PreparedCase const& prepared();
  /// Returns the light of the images, which is rendered again if the case was loaded.
  RenderedCase const& rendered(Backend const& device);

 private:
  void store_images(FramePair<std::uint16_t> const& levels);

  std::string camera_;
  CaseSetup loaded_;
  std::optional<PreparedCase> prepared_;
  std::optional<RenderedCase> rendered_;  ///< rendering of a loaded case without theory, computed on demand
  std::optional<RecordedFrames> frames_;  ///< frames of a rendered case; nullopt: the case was loaded
  /// Outcome of the rendering; for a loaded case, only accuracy, image error and hashes.
  CaseOutcome outcome_;
  GroundTruth stored_truth_;  ///< truth of a loaded case
  std::vector<std::uint16_t> images_;
  std::string folder_, summary_;
  std::mutex mutex_;  ///< protects members that are computed on demand
};

/// Images of a calibration target in several planes, taken by one camera.
struct PlanesCase {
  std::string camera;
  CaseSetup loaded;
  RenderedCalibration rendered;
  std::vector<std::uint16_t> images;  ///< grey levels [planes, rows, columns]

  PlanesCase(CameraCase one, Backend const& device);
  void save(std::string const& folder);
};

}  // namespace gladstone::python
