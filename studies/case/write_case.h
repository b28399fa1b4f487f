#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "render/base/warning.h"
#include "render/scene/ground_truth.h"
#include "render/scene/renderer.h"
#include "studies/case/case.h"

namespace gladstone::inline cases {

/// A rendered case in memory.
struct RenderedCase {
  std::shared_ptr<Rendering const> rendering;
  double exposure_e = 0;  ///< electrons in a fully lit pixel on the axis [e]
  double seconds = 0;     ///< wall time [s]
};

/// Returns the announcement of a long rendering: its sources, the expected time and how to shorten it. Empty if it
/// takes at most 20 s.
/// @param expected_s  estimate of the wall time [s]; for adaptive ray numbers of dots, of the largest number
std::string rendering_announcement(Scene const& scene, RenderPlan const& plan, double expected_s);

RenderedCase render_case(PreparedCase const& prepared, Renderer& renderer, RenderTheory theory);

/// Records both frames of a rendering with the camera's noise and quantization.
RecordedFrames record_frames(PreparedCase const& prepared, RenderedCase const& rendered);

/// All stages of a case, from the scene to the recorded frames.
struct RecordedCase {
  PreparedCase prepared;
  RenderedCase rendered;
  RecordedFrames frames;
};

/// Computes the SHA-256 of the files that a setup names, before the scene is built from them. Files of [correlate] are
/// excluded: they are recorded with the vectors.
void hash_inputs(CaseSetup& loaded);

/// Renders a case in memory.
RecordedCase render_case_in_memory(CaseSetup& loaded, Renderer& renderer, ReusableParts const& known = {});

/// Truth of dots at side faces of the medium (side_faces.h) in a rendering by the fast renderer.
struct SideFaceAccuracy {
  std::size_t dots = 0;                  ///< number of dots at side faces
  std::int64_t most_rays = 0;            ///< largest number of rays of one of these dots
  double truth_error_px = not_measured;  ///< rms of the standard errors of the truth of these dots [px]
};

/// Accuracy of the truth of a rendered case.
struct RenderedOutcome {
  std::size_t unseen = 0;  ///< number of dots or particles without truth in one of the frames
  TruthAccuracy accuracy;
  /// Dots at side faces, which the fast renderer leaves to the general one; nullopt: none in view.
  std::optional<SideFaceAccuracy> side_faces;
};

/// Accuracy, warnings and grey levels of a rendered case, as written to its files.
struct CaseOutcome : RenderedOutcome {
  /// Standard error of the images due to rays [levels at error_bit_depth()]; NaN: not measured, or no pixel is lit.
  double image_error_levels = not_measured;
  std::optional<TableError> table_error;  ///< error of the deflection table, if the truth was computed with one
  std::string device, reference_sha256, flow_sha256;
  Warnings warnings;                ///< all warnings of the case, those of its preparation first
  FramePair<std::uint16_t> levels;  ///< grey levels of the frames
};

/// Determines accuracy, grey levels and warnings of a rendered case, logs its warnings, and stores the values used for
/// "auto" in the setup.
CaseOutcome judge_case(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                       RecordedFrames const& frames);

/// Writes the files of a rendered case: reference.tif, flow.tif, truth.h5, setup.toml and summary.json.
/// @return the contents of summary.json
/// @throws DataError if a file that the setup names has changed since it was hashed
nlohmann::json write_case(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                          RecordedFrames const& frames, CaseOutcome const& outcome, std::string const& folder);

/// A rendered case with the outcome that its files contain.
struct WrittenCase : RecordedCase {
  CaseOutcome outcome;
};

/// Renders a setup into a CASE folder by write_case().
WrittenCase render_to_folder(CaseSetup& loaded, Renderer& renderer, std::string const& folder);

}  // namespace gladstone::inline cases
