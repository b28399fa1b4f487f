#pragma once

#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "render/base/setup_table.h"
#include "render/scene/field_map.h"
#include "render/scene/ray_plan.h"
#include "render/scene/renderer.h"
#include "render/scene/setup.h"
#include "render/sensor/detector.h"
#include "studies/case_files.h"

namespace gladstone {

/// A setup file read by every room, cross-checked, with nothing left unread.
struct CaseSetup {
  SetupDocument document;
  Setup setup;
  CorrelationSettings correlate;
  std::vector<std::string> warnings;
  /// SHA-256 of the files that it names, as they were before the scene was built from them; empty: not hashed yet.
  std::map<std::string, std::string> input_hashes = {};
};

/// Reads and checks a setup. @throws SetupError with all problems together
CaseSetup load_case_setup(std::string const& path, std::vector<std::string> const& overrides);
/// @param field whether the medium is still to be built, for the check of this machine's memory
CaseSetup load_case_setup(SetupDocument document, FieldMemory field = FieldMemory::needed);

/// A case ready to render: scene built, step and rays planned, the resolved setup as text.
struct PreparedCase {
  Scene scene;
  CorrelationSettings correlate;
  StepPlan step;
  RaysPlan rays;
  StrainMap strain;
  std::vector<std::string> warnings;
};

/// What is known of a case already, from another that agrees with it there; null: to be computed.
struct KnownParts {
  BuiltMedium const* medium = nullptr;
  StepPlan const* step = nullptr;
  RaysPlan const* rays = nullptr;
  StrainMap const* strain = nullptr;
};

/// Builds and plans; every "auto" becomes a number here but the exposure and, where dots at side faces have rays of
/// their own, the rays.
PreparedCase prepare_case(CaseSetup& loaded, KnownParts const& known = {});

/// A rendered case in memory.
struct RenderedCase {
  std::shared_ptr<Rendering const> rendering;
  double pupil_margin = 0;  ///< that the rendering took [m]
  double exposure_e = 0;    ///< electrons in a fully lit pixel on the axis
  double seconds = 0;
};

RenderedCase render_case(PreparedCase const& prepared, Renderer& renderer, RenderTheory theory);

/// The exposure that a camera takes of this light: its own, or by its brightest pixel, but no more electrons than the
/// particles' photons set free (photon_limited_exposure) [e].
double exposure_of(Scene const& scene, RenderedLight const& light);

/// What the camera records of a rendering.
RecordedFrames record_frames(PreparedCase const& prepared, RenderedCase const& rendered);

/// A case from its setup to its frames.
struct FinishedCase {
  PreparedCase prepared;
  RenderedCase rendered;
  RecordedFrames frames;
};

/// Hashes the files that a setup names, before anything is made of them; those of [correlate] belong to the vectors.
void hash_inputs(CaseSetup& loaded);

/// Renders a case as far as memory.
FinishedCase finish_case(CaseSetup& loaded, Renderer& renderer, KnownParts const& known = {});

/// Renders a setup into a CASE folder: reference.tif, flow.tif, truth.h5, setup.toml, summary.json.
FinishedCase render_to_folder(CaseSetup& loaded, Renderer& renderer, std::string const& folder);

/// Writes these files for a case that is rendered already. @return what summary.json holds
/// @throws DataError where a file that the setup names no longer holds what was hashed
nlohmann::json write_case(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                          RecordedFrames const& frames, Renderer const& renderer, std::string const& folder);

}  // namespace gladstone
