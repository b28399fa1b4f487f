#include <nlohmann/json.hpp>

#include "studies/case/calibration_case.h"
#include "studies/case/kinds/shared_parts.h"
#include "studies/case/shared_target.h"
#include "studies/case/write_case.h"

namespace gladstone::inline cases {
namespace {

void no_cross_check(CaseSetup& /*loaded*/) {}

CaseWriter render_calibration(CaseSetup& loaded, Renderer& renderer, ReusableParts const& /*known*/,
                              SharedParts::OfCamera const& /*shared*/, RenderedCamera& entry, BuiltMedium& /*medium*/) {
  hash_inputs(loaded);
  auto const rendered = std::make_shared<RenderedCalibration const>(render_planes(loaded, renderer));
  entry.planes = rendered->planes.size();
  for (RenderedPlane const& plane : rendered->planes) entry.sources += plane.truth.size();
  entry.rays = entry.most_rays = rendered->rays;
  entry.seconds = rendered->seconds;
  entry.device = rendered->device;
  return [&loaded, rendered](std::string const& folder) { return write_calibration(loaded, *rendered, folder); };
}

}  // namespace

constinit CaseKind const calibration_case_kind{.experiment = calibration_experiment,
                                               .cross_check = no_cross_check,
                                               .expected_images = images_of_dots,
                                               .expected_sources = number_of_dots,
                                               .expected_rays = nullptr,
                                               .share_sources = share_target,
                                               .render = render_calibration,
                                               .warn_of_view = warn_of_dots_out_of_view,
                                               .write_truth = write_dot_truth,
                                               .own_summary = no_own_summary};

}  // namespace gladstone::inline cases
