#include <cmath>

#include "cuda/backend.h"
#include "studies/case/backend.h"
#include "studies/sweep/case_runner.h"
#include "tests/studies/support/same_results.h"
#include "tests/studies/support/study_folder.h"

namespace gladstone {
namespace {

/// Sweeps on the GPU; skipped without one.
class CudaSweep : public StudyFolder {
 protected:
  void SetUp() override {
    StudyFolder::SetUp();
    if (cuda::DeviceState const state = cuda::device_state(); !state.usable) GTEST_SKIP() << state.text;
  }

  /// The later instant of the turbulence. Neighbours share frames (two correlations), rays (two noises) and the medium.
  std::vector<ManifestCase> turbulence(std::string const& device) const {
    write("base.toml", R"(schema = 1
[camera]
pixels = [128, 128]
[camera.noise]
full_well_e = 30000
[lens]
f_number = 11.0
[medium]
thickness_mm = 10.0
[medium.field]
kind = "file"
file = ")" GLADSTONE_DATA_DIR R"(/fields/hbdt512_late_slice.h5"
dataset = "Density_0001"
quantity = "density"
scale = 1.225
spacing_mm = [0.0625, 0.0625, 0.0625]
extrude = true
periodic = [true, true, false]
[target]
dots_per_32px_window = 20.0
[render]
rays_per_dot = 128
)");
    return all_cases(plan_study(study(R"(base = "base.toml"
[axes]
"lens.f_number" = [8, 16]
"camera.noise.read_noise_e" = [0.0, 10.0]
"correlate.window_px" = [[32, 16], [32]]
)"),
                                device));
  }
};

TEST_F(CudaSweep, SharedPartsGiveTheSameBitsAsNoneInAnyOrder) {
  auto const cases = turbulence("cuda");
  ASSERT_EQ(cases.size(), 8u);
  CaseRunner sharing(open_device("cuda")), backwards(open_device("cuda"));
  std::vector<CaseResult> shared, reversed(cases.size());
  for (ManifestCase const& one : cases) shared.push_back(sharing.run(one));
  for (std::size_t i = cases.size(); i-- > 0;) reversed[i] = backwards.run(cases[i]);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_EQ(shared[i].status, CaseStatus::ok) << shared[i].error;
    expect_same(shared[i], CaseRunner(open_device("cuda")).run(cases[i]));
    expect_same(shared[i], reversed[i]);
  }
  // every axis has an effect: neighbouring cases differ
  for (std::size_t const step : {1, 2, 4}) EXPECT_NE(shared[0].measures, shared[step].measures) << step;
}

// Truth agrees to 1e-9 px, light to a hundredth of a grey level of 16 bits: an occasional pixel is rounded, or its
// noise drawn, to the next of at least 4000 levels of contrast, which moves the peak of its window of 256 px by 1e-5
// px.
TEST_F(CudaSweep, MeasuresAreThoseOfTheCpu) {
  auto const on_gpu = turbulence("cuda"), on_cpu = turbulence("cpu");
  CaseRunner gpu(open_device("cuda")), cpu(open_device("cpu"));
  for (std::size_t i = 0; i < on_cpu.size(); ++i) {
    CaseResult const one = gpu.run(on_gpu[i]), other = cpu.run(on_cpu[i]);
    EXPECT_EQ(one.device, "cuda");
    ASSERT_EQ(one.status, CaseStatus::ok) << one.error;
    ASSERT_EQ(one.measures.size(), other.measures.size());
    std::size_t compared = 0;
    for (std::size_t k = 0; k < one.measures.size(); ++k) {
      auto const& [name, value] = one.measures[k];
      ASSERT_EQ(name, other.measures[k].first);
      if (!name.ends_with("_px")) continue;
      ASSERT_EQ(std::isnan(value), std::isnan(other.measures[k].second)) << name;
      if (std::isnan(value)) continue;
      EXPECT_NEAR(value, other.measures[k].second, 1e-4) << name << " of case " << i;
      ++compared;
    }
    EXPECT_GT(compared, 30u);
  }
}

}  // namespace
}  // namespace gladstone
