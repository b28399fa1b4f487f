#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <vector>

#include "cuda/backend.h"
#include "render/rays/rays_renderer.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {

using BosSetup = Setup;  // testing::Test has a member named Setup

/// Returns the light of one grey level of 16 bits, if the brightest pixel of a frame is at 90 % of full scale.
inline double grey_level(Image<double> const& frame) {
  return *std::max_element(frame.begin(), frame.end()) / (0.9 * 65535);
}

inline double largest_difference(Image<double> const& a, Image<double> const& b) {
  double most = 0;
  if (a.size() != b.size()) return 1e300;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double const here = std::abs(a.data()[i] - b.data()[i]);
    most = here >= 0 ? std::max(most, here) : 1e300;
  }
  return most;
}

inline double largest_difference(std::vector<Vec2d> const& a, std::vector<Vec2d> const& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i].x) && std::isnan(b[i].x)) continue;
    double const here = length(a[i] - b[i]);
    most = here >= 0 ? std::max(most, here) : 1e300;
  }
  return most;
}

inline bool same_bits(Image<double> const& a, Image<double> const& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

/// Returns a volume of 12 x 14 x 10 nodes, 1.5 mm apart.
inline FieldSetup volume_file() {
  FieldSetup field;
  field.kind = FieldKind::file;
  field.file = testing::TempDir() + "gladstone_cuda_volume.nrrd";
  field.where = "test";
  field.spacing = Vec3d{1.5e-3, 1.5e-3, 1.5e-3};
  std::ofstream file(field.file, std::ios::binary);
  file << "NRRD0004\ntype: float\ndimension: 3\nsizes: 12 14 10\nendian: little\nencoding: raw\n\n";
  for (int i = 0; i < 12 * 14 * 10; ++i) {
    auto const number =
        static_cast<float>(1.2 + 0.05 * std::sin(0.7 * (i % 12) + 0.4 * (i / 12 % 14) + 0.5 * (i / 168)));
    file.write(reinterpret_cast<char const*>(&number), sizeof number);
  }
  return field;
}

/// The renderers of a method on both devices, and the tolerance of their images [levels of 16 bits].
struct FocusedDotsMethod {
  static FocusedDotsRenderer on_cpu() { return {}; }
  static std::unique_ptr<Renderer> on_device() { return cuda::make_renderer(); }
  static constexpr double levels = 0.01;
};
struct RaysMethod {
  static RaysRenderer on_cpu() { return {}; }
  static std::unique_ptr<Renderer> on_device() { return cuda::make_rays_renderer(); }
  /// Tolerance of the images [levels of 16 bits]; not zero, since the device accumulates hits in integers.
  static constexpr double levels = 1;
};

/// Renders on the device and on the CPU; skipped if there is no device.
template <class Method>
class OnBothDevices : public testing::Test {
 protected:
  void SetUp() override {
    if (!cuda::device_state().usable) GTEST_SKIP() << cuda::device_state().text;
    renderer_ = Method::on_device();
  }
  Rendering on_device(PlannedScene const& scene) {
    return renderer_->render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::yes);
  }

  /// The results of the device must equal those of the CPU: truth and theory to 1e-9 px, images to a fraction of a grey
  /// level, counts exactly. Scenes that the fast renderer does not support are compared by the test of the general
  /// renderer.
  void expect_as_on_cpu(PlannedScene scene) {
    if (std::is_same_v<Method, FocusedDotsMethod> && !build_focused_dots(scene, scene.plan)) {
      GTEST_SKIP() << "the fast renderer does not support this scene; the test of the general renderer compares it";
    }
    Rendering const cpu = on_cpu_.render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::yes),
                    gpu = on_device(scene);
    EXPECT_LT(largest_difference(cpu.truth.displacement_px, gpu.truth.displacement_px), 1e-9);
    EXPECT_LT(largest_difference(cpu.truth.reference_px, gpu.truth.reference_px), 1e-9);
    EXPECT_LT(largest_difference(cpu.truth.displacement_error_px, gpu.truth.displacement_error_px), 1e-9);
    EXPECT_EQ(cpu.truth.path, gpu.truth.path);
    EXPECT_EQ(cpu.table, gpu.table);
    EXPECT_LT(largest_difference(cpu.truth.displacement_std_px, gpu.truth.displacement_std_px), 1e-6);
    EXPECT_LT(largest_difference(cpu.truth.eq9_px, gpu.truth.eq9_px), 1e-9);
    EXPECT_LT(largest_difference(cpu.truth.chief_px, gpu.truth.chief_px), 1e-9);
    EXPECT_LT(largest_difference(cpu.truth.eq9_cone_px, gpu.truth.eq9_cone_px), 1e-9);
    EXPECT_EQ(cpu.truth.rays, gpu.truth.rays);
    EXPECT_EQ(cpu.truth.rays_planned, gpu.truth.rays_planned);
    EXPECT_EQ(cpu.left, gpu.left);
    EXPECT_EQ(cpu.statuses, gpu.statuses);
    EXPECT_EQ(cpu.rays, gpu.rays);
    // A displacement of one pixel is a shift of about 0.3 mm on the lens plane: 1e-12 m corresponds to 4e-9 px.
    EXPECT_NEAR(cpu.pupil_margin, gpu.pupil_margin, 1e-12);
    double const level = grey_level(cpu.light.reference);
    EXPECT_LT(largest_difference(cpu.light.reference, gpu.light.reference), Method::levels * level);
    EXPECT_LT(largest_difference(cpu.light.flow, gpu.light.flow), Method::levels * level);
  }

  PlannedScene scene_of(FieldSetup const& field, std::uint64_t rays,
                        std::function<void(BosSetup&)> const& change = {}) {
    BosSetup setup = table1_setup(96);
    setup.medium.field = field;
    if (change) change(setup);
    std::vector<Vec2d> places = lattice(96, 6, 14);
    // Move the dots away from pixel edges, where rounding changes the footprint of a PSF.
    for (Vec2d& place : places) place += {0.0173, 0.0091};
    return scene_with_dots(setup, places, rays);
  }

  std::unique_ptr<Renderer> renderer_;
  decltype(Method::on_cpu()) on_cpu_ = Method::on_cpu();
};

using CudaRendererTest = OnBothDevices<FocusedDotsMethod>;
using CudaRaysTest = OnBothDevices<RaysMethod>;

}  // namespace gladstone
