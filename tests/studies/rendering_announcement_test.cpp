#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "studies/case/case.h"
#include "studies/case/write_case.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

TEST(RenderingAnnouncement, NamesSourcesAndSecondsOfLongRenderingsOnly) {
  PlannedScene const scene = scene_with_dots(table1_setup(96), lattice(96, 8, 11), 32);
  std::string const dots = std::to_string(scene.dots.centre.size());
  EXPECT_THAT(rendering_announcement(scene, scene.plan, 45.2),
              testing::AllOf(testing::HasSubstr(dots + " dots"), testing::HasSubstr("45 s"),
                             testing::HasSubstr("render.rays_per_dot")));
  EXPECT_EQ(rendering_announcement(scene, scene.plan, 20), "");
  EXPECT_EQ(rendering_announcement(scene, scene.plan, std::nan("")), "");
}

}  // namespace
}  // namespace gladstone
