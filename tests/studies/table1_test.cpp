#include <gtest/gtest.h>

#include "render/focused_dots/table_error.h"
#include "render/planning.h"
#include "render/render.h"
#include "studies/case/case.h"
#include "studies/case/shared_folder.h"

namespace gladstone {
namespace {

// Bounds from the comment in table1.toml: residual errors of the deflection table in truth and images with 1024 rays
// per dot. An error below the detection limit is bounded by that limit: two standard errors of the truth over both
// components at 16 positions, 6e-5 px with 8192 traced rays per scrambling. The bound 1e-4 px is the one in
// table1.toml.
TEST(Table1, HasTheResidualErrorsStatedInItsFile) {
  CaseSetup const loaded = load_case_setup(shared_folder() + "/studies/cases/table1.toml", {});
  Scene const scene = build_scene(loaded.setup);
  RenderPlan const plan = plan_rendering(scene);
  ASSERT_EQ(plan.rays, 1024u);
  TableError const error = measure_table_error(build_focused_dots(scene, plan).value());
  EXPECT_LT(error.truth_px, 1e-4);
  EXPECT_LT(error.truth_resolution_px, 1e-4);
  EXPECT_LT(error.image_levels, 0.5);
  EXPECT_LT(error.image_resolution_levels, 0.5);
}

}  // namespace
}  // namespace gladstone
