#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "python/src/setup_text.h"
#include "studies/case/backend.h"
#include "studies/case/calibration_case.h"
#include "studies/case/case.h"
#include "studies/case/uncertain_inputs.h"

namespace gladstone::python {

/// Image pair of one camera with its truth: rendered in this process, or loaded from a CASE folder.
class PairCase {
 public:
  /// Renders the case of one camera.
  PairCase(std::string camera, SetupDocument document, Backend const& device, ReusableParts const& known);
  /// Loads a CASE folder.
  explicit PairCase(std::string folder);

  std::string const& camera() const { return camera_; }
  CaseSetup const& loaded() const { return loaded_; }
  GroundTruth const& truth() const { return rendered_ ? rendered_->rendering->truth : stored_truth_; }
  /// Grey levels [2, rows, columns] of reference and measurement image.
  std::vector<std::uint16_t> const& images() const { return images_; }
  TruthAccuracy const& accuracy() const { return accuracy_; }
  std::string const& reference_sha256() const { return reference_sha256_; }
  std::string const& flow_sha256() const { return flow_sha256_; }

  /// Contents of summary.json.
  std::string summary();
  std::string resolved() const { return loaded_.document.resolved(); }
  /// Writes the CASE folder. @throws OutputError; DataError for a case that was loaded
  void save(std::string const& folder);

  /// Scene with step and rays. @throws SetupError
  PreparedCase const& prepared();
  /// Light of the images, rendered again if the case was loaded.
  RenderedCase const& rendered(Backend const& device);

 private:
  void take_images(Image<std::uint16_t> const& reference, Image<std::uint16_t> const& flow);

  std::string camera_;
  std::vector<UncertainInput> uncertain_;
  CaseSetup loaded_;
  std::optional<PreparedCase> prepared_;
  std::optional<RenderedCase> rendered_;        ///< with truth and theory
  std::optional<RenderedCase> rendered_again_;  ///< of a loaded case, whose truth is stored_truth_
  std::optional<RecordedFrames> frames_;
  std::optional<CaseOutcome> outcome_;
  GroundTruth stored_truth_;
  TruthAccuracy accuracy_;
  std::vector<std::uint16_t> images_;
  std::string folder_, reference_sha256_, flow_sha256_, summary_;
  std::mutex mutex_;  ///< protects what is computed on demand
};

/// Images of a calibration target in several planes, taken by one camera.
struct PlanesCase {
  std::string camera;
  std::vector<UncertainInput> uncertain;
  CaseSetup loaded;
  RenderedCalibration rendered;
  std::vector<std::uint16_t> images;  ///< grey levels [planes, rows, columns]

  PlanesCase(std::string name, SetupDocument document, Backend const& device);
  void save(std::string const& folder);
};

}  // namespace gladstone::python
