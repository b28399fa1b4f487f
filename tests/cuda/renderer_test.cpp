#include <algorithm>
#include <limits>

#include "tests/cuda/cuda_renderer_fixture.h"

namespace gladstone {
namespace {

/// Every kind of medium, source and PSF of the thin-lens camera, rendered by the fast and by the general renderer.
template <class Method>
class ByBothMethods : public OnBothDevices<Method> {};
using Methods = testing::Types<FocusedDotsMethod, RaysMethod>;
TYPED_TEST_SUITE(ByBothMethods, Methods);

TYPED_TEST(ByBothMethods, NoMedium) { this->expect_as_on_cpu(this->scene_of({}, 100)); }
TYPED_TEST(ByBothMethods, UniformGradient) { this->expect_as_on_cpu(this->scene_of(uniform_gradient(20, -8, 3), 128)); }
TYPED_TEST(ByBothMethods, Sinusoid) { this->expect_as_on_cpu(this->scene_of(sinusoid(0.2, 4e-3), 333)); }
TYPED_TEST(ByBothMethods, DnsPlane) { this->expect_as_on_cpu(this->scene_of(dns_plane("kepeak"), 257)); }
TYPED_TEST(ByBothMethods, FewRays) { this->expect_as_on_cpu(this->scene_of(dns_plane("late"), 7)); }

TYPED_TEST(ByBothMethods, PlumeBlobAndShock) {
  this->expect_as_on_cpu(this->scene_of(GaussianPlume<double>{{{}, -0.2, 5e-3}}, 64));
  this->expect_as_on_cpu(this->scene_of(GaussianBlob<double>{{{}, -0.2, 5e-3}}, 64));
  this->expect_as_on_cpu(this->scene_of(NormalShock<double>::front(1.2, 1.225, 1e-3), 64));
}

TYPED_TEST(ByBothMethods, VolumesSplineAndLinear) {
  FieldSetup field = volume_file();
  for (bool const tiled : {false, true}) {
    field.periodic = {tiled, tiled, tiled};
    for (bool const spline : {true, false}) {
      this->expect_as_on_cpu(this->scene_of(field, 200, [&](BosSetup& setup) {
        if (!spline) setup.medium.interpolation = FieldInterpolation::trilinear;
      }));
    }
  }
}

TEST_F(CudaRendererTest, ManyRaysOfFewDots) {
  PlannedScene scene = scene_of(volume_file(), 20000);
  scene.dots.centre.resize(2);
  expect_as_on_cpu(scene);
}

TYPED_TEST(ByBothMethods, EulerStraightAndRefractingFaces) {
  this->expect_as_on_cpu(
      this->scene_of(sinusoid(0.2, 4e-3), 64, [](BosSetup& s) { s.medium.integrator = Integrator::euler; }));
  this->expect_as_on_cpu(
      this->scene_of(sinusoid(0.2, 4e-3), 64, [](BosSetup& s) { s.medium.integrator = Integrator::straight; }));
  this->expect_as_on_cpu(
      this->scene_of(uniform_gradient(20, 5), 64, [](BosSetup& s) { s.medium.faces = Faces::refract; }));
}

TYPED_TEST(ByBothMethods, SpotsFocusAndPolarity) {
  for (SpotModel const spot : {SpotModel::airy, SpotModel::none, SpotModel::gaussian_first_zero}) {
    this->expect_as_on_cpu(this->scene_of(sinusoid(0.1, 6e-3), 96, [&](BosSetup& s) { s.lens.spot = spot; }));
  }
  this->expect_as_on_cpu(this->scene_of(sinusoid(0.1, 6e-3), 96, [](BosSetup& s) { s.lens.focus = Focus::medium; }));
  this->expect_as_on_cpu(
      this->scene_of(sinusoid(0.1, 6e-3), 96, [](BosSetup& s) { s.target.polarity = Polarity::dark; }));
}

TYPED_TEST(ByBothMethods, ChiefRaysPointsAndRandomPupil) {
  double const pinhole = std::numeric_limits<double>::infinity();
  this->expect_as_on_cpu(this->scene_of(sinusoid(0.1, 6e-3), 64, [&](BosSetup& s) { s.lens.f_number = pinhole; }));
  this->expect_as_on_cpu(this->scene_of(sinusoid(0.1, 6e-3), 64, [](BosSetup& s) { s.target.dot_diameter_px = 0; }));
  this->expect_as_on_cpu(
      this->scene_of(sinusoid(0.1, 6e-3), 64, [](BosSetup& s) { s.render.sampling = PupilSampling::random; }));
}

TYPED_TEST(ByBothMethods, TwoRunsGiveTheSameBits) {
  PlannedScene scene = this->scene_of(dns_plane("kepeak"), 500);
  Rendering const one = this->on_device(scene), two = this->on_device(scene);
  EXPECT_TRUE(same_bits(one.light.reference, two.light.reference));
  EXPECT_TRUE(same_bits(one.light.flow, two.light.flow));
  EXPECT_EQ(one.truth.displacement_px, two.truth.displacement_px);
  EXPECT_EQ(one.truth.eq9_cone_px, two.truth.eq9_cone_px);
}

// Data that remain on the device equal those copied to the host: light, grey levels of the camera including noise, and
// the brightest pixel. Logarithms differ in their last digits, so that a noisy pixel in 10,000 may be rounded to the
// next level, or drawn again if a rejection differs.
TEST_F(CudaRendererTest, RecordsWhereTheLightIsAsTheHostDoes) {
  for (bool const noisy : {false, true}) {
    PlannedScene scene = scene_of(dns_plane("late"), 64, [&](BosSetup& setup) {
      setup.camera.bit_depth = 12;
      setup.camera.offset_dn = 20;
      setup.camera.noise.enabled = noisy;
      setup.camera.noise.dark_current_e = 30;
    });
    for (Polarity const polarity : {Polarity::bright, Polarity::dark}) {
      scene.plan.polarity = polarity;
      Rendering const moved = on_device(scene);
      Rendering const kept = renderer_->render(scene, scene.plan, scene.dots, RenderImages::in_place, RenderTheory::no);
      ASSERT_TRUE(kept.in_place);
      EXPECT_TRUE(kept.light.reference.empty());
      HostLight const host(moved.light);
      EXPECT_EQ(kept.in_place->brightest(), host.brightest());
      Detector const detector(scene.setup.camera, Detector::auto_exposure(scene.setup.camera, 0.8 * host.brightest()));
      auto const ideal = kept.in_place->ideal(detector), ideal_on_host = host.ideal(detector);
      EXPECT_LT(largest_difference(ideal->reference(), ideal_on_host->reference()), 1e-9);
      EXPECT_LT(largest_difference(ideal->flow(), ideal_on_host->flow()), 1e-9);
      RecordedFrames const recorded = kept.in_place->record(detector), on_host = host.record(detector);
      EXPECT_EQ(recorded.saturated_reference, on_host.saturated_reference);
      EXPECT_EQ(recorded.saturated_flow, on_host.saturated_flow);
      std::size_t differ = 0;
      for (std::size_t i = 0; i < recorded.levels->flow().size(); ++i) {
        differ += recorded.levels->reference().data()[i] != on_host.levels->reference().data()[i];
        differ += recorded.levels->flow().data()[i] != on_host.levels->flow().data()[i];
      }
      EXPECT_LE(differ, 2 * recorded.levels->flow().size() / 10000);
      // light that differs in its last bits may be rounded, or counted as electrons, differently
      EXPECT_LE(largest_difference(recorded.levels->reference(), on_host.levels->reference()), 1);
      EXPECT_LE(largest_difference(recorded.levels->flow(), on_host.levels->flow()), 1);
      EXPECT_TRUE(same_bits(recorded.levels->flow(), kept.in_place->record(detector).levels->flow()));

      // correlated on the device, with the same result as after copies to the host and back
      auto const correlator = cuda::make_correlator({});
      DisplacementField const here = correlator->correlate_pair(*recorded.levels);
      DisplacementField const there = correlator->correlate(recorded.levels->reference(), recorded.levels->flow());
      ASSERT_GT(here.size(), 0u);
      EXPECT_EQ(largest_difference(here.displacement_px, there.displacement_px), 0);
    }
  }
}

// Single precision was a preview with errors of 1e-3 px and a 12-bit level; it is now rendered in double precision,
// with bitwise identical truth, theory and light.
TEST_F(CudaRendererTest, SinglePrecisionIsRenderedInDouble) {
  for (FieldSetup const& field : {dns_plane("late"), volume_file()}) {
    PlannedScene scene = scene_of(field, 256), asked = scene;
    asked.setup.render.precision = Precision::single;
    Rendering const exact = on_device(scene), found = on_device(asked);
    EXPECT_EQ(exact.truth.displacement_px, found.truth.displacement_px);
    EXPECT_EQ(exact.truth.eq9_px, found.truth.eq9_px);
    EXPECT_TRUE(same_bits(exact.light.flow, found.light.flow));
  }
}

TEST_F(CudaRendererTest, NothingToTraceIsNoError) {
  PlannedScene scene = scene_of({}, 16);
  scene.dots.centre.clear();
  Rendering const empty = on_device(scene);
  EXPECT_EQ(empty.truth.size(), 0u);
  EXPECT_EQ(*std::max_element(empty.light.flow.begin(), empty.light.flow.end()), 0);
}

}  // namespace
}  // namespace gladstone
