#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/case/case.h"
#include "studies/case/render_cost.h"
#include "studies/design/sheet.h"

namespace gladstone::inline design {

/// Quantities that follow from a setup of one camera, before anything is rendered.
struct SetupOverview {
  std::string experiment;          ///< "bos", "piv" or "calibration"
  std::vector<ResultRow> rows;     ///< quantities; the rows of the design sheet where it applies
  std::vector<std::string> notes;  ///< quantities that are not given, and the reason
  RenderCost cost;
};

/// Collects the rows of the design sheet that describe image scale, view, blur, images of dots or particles,
/// sensitivity and depth, the number of dots or particles, and the cost of rendering. No field is read and no ray is
/// traced through it. If a field is not given by a closed form, the sheet's default gradient is used. Cameras that the
/// sheet does not describe have paraxial values.
/// @throws DataError if a file of the setup cannot be read
SetupOverview make_setup_overview(CaseSetup loaded);

/// Formats the overview, one line per quantity.
std::string overview_text(SetupOverview const& overview);
/// Returns the overview as JSON: the rows by their keys, and `render`.
nlohmann::ordered_json overview_json(SetupOverview const& overview);

}  // namespace gladstone::inline design
