#include "studies/case/backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cuda/backend.h"
#include "render/base/error.h"
#include "studies/benchmark/particle_pair.h"
#include "studies/compare/correlate.h"

namespace gladstone {
namespace {

/// A renderer that pretends to be that of a GPU.
class NominalGpu final : public Renderer {
 public:
  std::string device() const override { return "cuda"; }
  Rendering render(Scene const&, RenderPlan const&, DotPattern const&, RenderImages, RenderTheory) override {
    return {};
  }
};

// With --device auto, the CPU correlates if the GPU does not support the settings; the result must name the device that
// was used.
TEST(Measurement, NamesTheDeviceThatCorrelated) {
  Backend const device{std::make_unique<NominalGpu>(), make_correlator};
  ParticlePair const pair = render_particle_pair({.columns = 64, .rows = 64}, [](Vec2d) { return Vec2d{0.5, 0.0}; });
  CorrelationSettings settings;
  settings.window_px = {32};
  auto const device_of = [&] {
    return correlate_frames("a.tif", "b.tif", HostFrames(pair.reference, pair.flow), settings, device).device;
  };
  EXPECT_EQ(device_of(), "cuda");
  settings.method = "spc";
  EXPECT_EQ(device_of(), "cpu");
  settings.method = "scc";
  settings.subpixel = "parabola";
  EXPECT_EQ(device_of(), "cpu");
}

// A GPU supports scc, rpc, both Gaussian fits and correlation statistics; otherwise the first unsupported setting is
// named.
TEST(LeftToCpu, NamesWhatAGpuDoesNotHave) {
  CorrelationSettings settings;
  EXPECT_EQ(settings_requiring_cpu(settings), "");
  settings.uncertainty = "correlation_statistics";
  EXPECT_EQ(settings_requiring_cpu(settings), "");
  for (char const* method : {"image_matching", "peak_ratio", "moment_of_correlation", "combination"}) {
    settings.uncertainty = method;
    EXPECT_EQ(settings_requiring_cpu(settings), std::string("uncertainty = \"") + method + "\"");
  }
  settings.method = "zncc";
  EXPECT_EQ(settings_requiring_cpu(settings), "method = \"zncc\"");
}

// Skipped without a GPU.
TEST(CudaDevice, RefusesWhatIsLeftToTheCpu) {
  if (cuda::DeviceState const state = cuda::device_state(); !state.usable) GTEST_SKIP() << state.text;
  Backend const only = open_device("cuda"), any = open_device("auto");
  CorrelationSettings settings;
  settings.uncertainty = "correlation_statistics";
  EXPECT_NE(only.correlator(settings), nullptr);
  settings.uncertainty = "combination";
  EXPECT_NE(any.correlator(settings), nullptr);
  EXPECT_THROW(only.correlator(settings), DeviceError);
}

/// A correlator that returns the uncertainty together with the vectors, like that of a GPU.
class WithSigma final : public Correlator {
 public:
  explicit WithSigma(CorrelationSettings const& settings) : correlator_(make_correlator(settings)) {}
  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    DisplacementField field = correlator_->correlate(reference, flow);
    field.sigma_px.assign(field.size(), {0.25, 0.5});
    return field;
  }

 private:
  std::unique_ptr<Correlator> correlator_;
};

// An uncertainty returned with the vectors is used and not estimated again. If half of the frames are unrelated and the
// decorrelation test rejects their vectors, the uncertainty of the others is estimated again without them.
TEST(Measurement, KeepsTheUncertaintyThatCameWithTheVectors) {
  Backend const device{std::make_unique<NominalGpu>(),
                       [](CorrelationSettings const& settings) { return std::make_unique<WithSigma>(settings); }};
  CorrelationSettings settings;
  settings.window_px = {32};
  settings.uncertainty = "correlation_statistics";
  auto const still = [](Vec2d) { return Vec2d{0.5, 0.0}; };
  ParticlePair pair = render_particle_pair({.columns = 256, .rows = 256, .noise = 0.02}, still);
  ParticlePair const other = render_particle_pair({.columns = 256, .rows = 256, .noise = 0.02, .seed = 2}, still);
  Backend const without{std::make_unique<NominalGpu>(), make_correlator};
  auto const measured = [&](Backend const& by) {
    return correlate_frames("a.tif", "b.tif", HostFrames(pair.reference, pair.flow), settings, by).field;
  };
  for (Vec2d const& sigma : measured(device).sigma_px) EXPECT_EQ(sigma, (Vec2d{0.25, 0.5}));
  for (int j = 0; j < 256; ++j)
    for (int i = 128; i < 256; ++i) pair.flow(i, j) = other.flow(i, j);
  DisplacementField const half = measured(device), expected = measured(without);
  ASSERT_EQ(half.sigma_px.size(), expected.size());
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < half.size(); ++i) {
    left_out += half.reason[i] == VectorReason::uncorrelated;
    for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
      double const sigma = half.sigma_px[i].*axis, right = expected.sigma_px[i].*axis;
      EXPECT_TRUE(sigma == right || (std::isnan(sigma) && std::isnan(right))) << i;
    }
  }
  EXPECT_GT(left_out, half.size() / 8);
  EXPECT_LT(left_out, half.size());
}

}  // namespace
}  // namespace gladstone
