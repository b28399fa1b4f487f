#include "studies/device.h"

#include <gtest/gtest.h>

#include "studies/benchmark/particle_pair.h"
#include "studies/correlate.h"

namespace gladstone {
namespace {

/// A renderer that calls itself a GPU's.
class NominalGpu final : public Renderer {
 public:
  std::string device() const override { return "cuda"; }
  Rendering render(Scene&, DotPattern const&, RenderImages, RenderTheory) override { return {}; }
};

// What the GPU's correlator does not have, --device auto gives to the CPU: the result is to name what measured it.
TEST(Measurement, NamesTheDeviceThatCorrelated) {
  Device const device{std::make_unique<NominalGpu>(), make_correlator};
  ParticlePair const pair = render_particle_pair({.columns = 64, .rows = 64}, [](Vec2d) { return Vec2d{0.5, 0.0}; });
  CorrelationSettings settings;
  settings.window_px = {32};
  auto const device_of = [&] {
    return correlate_frames("a.tif", pair.reference, "b.tif", pair.flow, settings, device).device;
  };
  EXPECT_EQ(device_of(), "cuda");
  settings.method = "spc";
  EXPECT_EQ(device_of(), "cpu");
  settings.method = "scc";
  settings.subpixel = "parabola";
  EXPECT_EQ(device_of(), "cpu");
}

}  // namespace
}  // namespace gladstone
