#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "analysis/correlation_settings.h"
#include "render/base/setup_table.h"
#include "render/scene/field_map.h"
#include "render/scene/ray_plan.h"
#include "render/scene/renderer.h"
#include "render/scene/setup.h"

namespace gladstone {

/// A setup file read by every room, cross-checked, with nothing left unread.
struct CaseSetup {
  SetupDocument document;
  Setup setup;
  CorrelationSettings correlate;
  std::vector<std::string> warnings;
};

/// Reads and checks a setup. @throws SetupError with all problems together
CaseSetup load_case_setup(std::string const& path, std::vector<std::string> const& overrides);

/// A case ready to render: scene built, step and rays planned, the resolved setup as text.
struct PreparedCase {
  Scene scene;
  CorrelationSettings correlate;
  StepPlan step;
  RaysPlan rays;
  StrainMap strain;
  std::vector<std::string> warnings;
};

/// Builds and plans; every "auto" but the exposure becomes a number here.
PreparedCase prepare_case(CaseSetup& loaded);

/// A rendered case in memory.
struct RenderedCase {
  Rendering rendering;
  double exposure_e = 0;  ///< electrons in a fully lit pixel on the axis
  double seconds = 0;
};

RenderedCase render_case(PreparedCase& prepared, Renderer& renderer, RenderTheory theory);

/// Renders a setup into a CASE folder: reference.tif, flow.tif, truth.h5, setup.toml, summary.json.
/// @return the text of summary.json
std::string render_to_folder(CaseSetup& loaded, Renderer& renderer, std::string const& folder);

/// The name of every file in a CASE.
namespace case_file {
inline constexpr char const* reference = "reference.tif";
inline constexpr char const* flow = "flow.tif";
inline constexpr char const* truth = "truth.h5";
inline constexpr char const* setup = "setup.toml";
inline constexpr char const* summary = "summary.json";
inline constexpr char const* vectors = "vectors.h5";
inline constexpr char const* vectors_text = "vectors.csv";
inline constexpr char const* errors = "errors.json";
/// What correlate and compare make of a rendering: it goes when the case is rendered again.
inline constexpr std::array derived{vectors,
                                    vectors_text,
                                    errors,
                                    "displacement_maps.png",
                                    "error_histograms.png",
                                    "error_against_gradient.png",
                                    "error_budget.png"};
}  // namespace case_file

/// "folder/name"; @throws DataError where the folder is no CASE (has no setup.toml)
std::string in_case(std::string const& folder, std::string const& name);

}  // namespace gladstone
