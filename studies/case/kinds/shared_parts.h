#pragma once

#include "render/base/warning.h"
#include "studies/case/case_kind.h"
#include "studies/case/write_case.h"

/// Parts that several kinds of cases share.
namespace gladstone::inline cases {

/// Reports interrogation windows larger than the image.
void cross_check_windows(CaseSetup& loaded);

/// Renders a case with two frames.
CaseWriter render_pair(CaseSetup& loaded, Renderer& renderer, ReusableParts const& known,
                       SharedParts::OfCamera const& shared, RenderedCamera& entry, BuiltMedium& medium);

// Members of CaseKind for dots of a target:
ImageDiameters images_of_dots(Setup const& setup);
double number_of_dots(Scene const& scene);
void warn_of_dots_out_of_view(Scene const& scene, Warnings& warnings);
void write_dot_truth(std::string const& path, Scene const& scene, Rendering const& rendering,
                     CaseOutcome const& outcome, FileOrigin const& origin);
nlohmann::json no_own_summary(Scene const& scene, GroundTruth const& truth, double exposure_e);

}  // namespace gladstone::inline cases
