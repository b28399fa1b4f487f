#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "render/base/warning.h"
#include "render/scene/field_map.h"
#include "render/scene/ray_budget.h"
#include "render/scene/renderer.h"
#include "render/scene/setup.h"
#include "render/setup/setup_table.h"
#include "studies/case/case_files.h"
#include "studies/case/light_exposure.h"
#include "studies/case/uncertain_inputs.h"

namespace gladstone::inline cases {

/// Tables that request a design, which a setup may contain. Rendering and correlation ignore them.
inline constexpr std::array design_tables{"requirements", "limits", "inventory", "free", "correlations"};

/// A setup that was read.
struct CaseSetup {
  SetupDocument document;
  Setup setup;
  CorrelationSettings correlate;
  Warnings warnings;
  std::vector<UncertainInput> uncertain = {};  ///< numbers given with an uncertainty, unless the caller extracted them
  /// SHA-256 of each file that the setup names, computed before the scene is built; empty: not computed yet.
  std::map<std::string, std::string> input_hashes = {};
  std::optional<PaperLight> light = {};  ///< table [light], from which check_case_setup() computes the exposure
  bool first_pair_only = false;          ///< true: the setup describes a sequence, of which this is the first pair

  /// Returns a copy, for functions that change the setup.
  CaseSetup copy() const {
    return {document.copy(), setup, correlate, warnings, uncertain, input_hashes, light, first_pair_only};
  }
};

/// Reads and checks a setup.
/// @throws SetupError with all problems
CaseSetup load_case_setup(std::string const& path, std::vector<std::string> const& overrides);
/// @param field  whether the check of available memory includes a medium that is yet to be built
CaseSetup load_case_setup(SetupDocument document, FieldMemory field = FieldMemory::needed);

/// Compares the keys of a setup with each other and with the files that they name. Determines its warnings, and the
/// exposure by its light. load_case_setup() includes it; it is required again only after a change of the setup.
/// @throws SetupError with all problems
void check_case_setup(CaseSetup& loaded, FieldMemory field = FieldMemory::needed);

/// Checks names, types and ranges of the keys of a setup with one camera, without comparing them with each other or
/// opening the files that they name.
/// @throws SetupError with all problems
void check_setup_keys(SetupDocument document);

/// A case ready to render: scene, plan of the rendering and strain map.
struct PreparedCase {
  Scene scene;
  CorrelationSettings correlate;
  RenderPlan plan;
  StrainMap strain;
  Warnings warnings;
};

/// Parts of a PreparedCase that can be reused from another case with the same values; null: to be computed.
struct ReusableParts {
  BuiltMedium const* medium = nullptr;
  IntegrationStep const* step = nullptr;
  RenderPlan const* plan = nullptr;  ///< with this step
  StrainMap const* strain = nullptr;
};

/// Builds the scene and plans its rendering. Resolves every "auto" value of the setup except the exposure and, if
/// rays are chosen per dot, render.rays_per_dot.
PreparedCase prepare_case(CaseSetup& loaded, ReusableParts const& known = {});

}  // namespace gladstone::inline cases
