#include "studies/case/kinds/shared_parts.h"
#include "studies/case/shared_target.h"

namespace gladstone::inline cases {
namespace {

void cross_check_bos(CaseSetup& loaded) {
  cross_check_windows(loaded);
  if (auto const advice = locking_advice(loaded.setup)) loaded.warnings.push_back(*advice);
}

}  // namespace

constinit CaseKind const bos_case_kind{.experiment = bos_experiment,
                                       .cross_check = cross_check_bos,
                                       .expected_images = images_of_dots,
                                       .expected_sources = number_of_dots,
                                       .expected_rays = nullptr,
                                       .share_sources = share_target,
                                       .render = render_pair,
                                       .warn_of_view = warn_of_dots_out_of_view,
                                       .write_truth = write_dot_truth,
                                       .own_summary = no_own_summary};

}  // namespace gladstone::inline cases
