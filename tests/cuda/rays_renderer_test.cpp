#include <algorithm>
#include <cmath>

#include "render/optics/glass_catalogue.h"
#include "render/optics/lens.h"
#include "render/optics/paraxial.h"
#include "render/optics/prescription.h"
#include "render/rays/ray_planning.h"
#include "tests/cuda/cuda_renderer_fixture.h"
#include "tests/cuda/memory_limits.h"
#include "tests/optics/prescription_texts.h"

namespace gladstone {
namespace {

/// Returns the set-up of Table 1 with another lens, given by the name of its file.
void put_lens_of(BosSetup& setup, std::string const& path) {
  LensOptions options;
  options.f_number = setup.lens.f_number = 8;
  setup.lens.prescription = std::make_shared<Lens const>(
      build_lens(read_prescription(path), GlassCatalogue::shipped(), setup.medium.wavelength, options));
  setup.lens.focal_length = paraxial_lens(*setup.lens.prescription).effective_focal_length;
}
/// Like above, with a lens of data/lenses.
void put_lens(BosSetup& setup, std::string const& name) {
  put_lens_of(setup, std::string(GLADSTONE_DATA_DIR) + "/lenses/" + name + ".toml");
}

/// Returns a scene of any camera, with 36 dots around the centre of the image.
PlannedScene seen_through(std::uint64_t rays, std::function<void(BosSetup&)> const& change) {
  BosSetup setup = table1_setup(96);
  setup.medium.field = sinusoid(0.1, 6e-3);
  setup.target.dots_per_32px_window = 1;
  change(setup);
  PlannedScene scene(build_scene(setup));
  scene.dots.centre.clear();
  for (Vec2d const place : lattice(96, 6, 14)) {
    Vec2d const at = scene.to_target(place);
    if (std::isfinite(at.x)) scene.dots.centre.push_back(at);
  }
  plan_step(scene);
  scene.plan.rays = rays;
  return scene;
}

TEST_F(CudaRaysTest, LensesOfManySurfaces) {
  for (std::string const name : {"double_gauss", "achromat", "wide_angle"}) {
    SCOPED_TRACE(name);
    expect_as_on_cpu(seen_through(400, [&](BosSetup& setup) { put_lens(setup, name); }));
  }
}

// Every point uses the number of rays that it needs: those behind the blob more than others. The numbers equal those of
// the CPU.
TEST_F(CudaRaysTest, TakeTheRaysThatEachNeeds) {
  PlannedScene scene = seen_through(1, [](BosSetup& setup) {
    setup.medium.field = GaussianBlob<double>{{{1e-3, 0, 0}, -0.4, 0.8e-3}};
    setup.target.dot_diameter_px = 0;
    setup.camera.bit_depth = 8;
    setup.lens.f_number = 8;
    setup.camera.tilt = {0.01, 0};
  });
  scene.dots.half_size = 0;
  scene.plan = plan_rays_by_tracing(scene, scene.plan);
  ASSERT_TRUE(scene.plan.adaptive_criteria);
  expect_as_on_cpu(scene);
  PlannedScene again = scene;
  std::vector<std::int64_t> const rays =
      renderer_->render(again, again.plan, again.dots, RenderImages::yes, RenderTheory::no).truth.rays_planned;
  auto const [least, most] = std::minmax_element(rays.begin(), rays.end());
  EXPECT_LT(*least, *most);
}

TEST_F(CudaRaysTest, WindowsPosesAndTiltedSensors) {
  auto const window = [](ElementSide side) {
    OpticalWindow setup;
    setup.side = side;
    setup.index = 1.5168;
    setup.thickness = 10e-3;
    setup.position = {0, 0, side == ElementSide::camera ? 0.1 : -0.1};
    setup.tilt = {0.05, -0.02};
    return setup;
  };
  expect_as_on_cpu(seen_through(300, [&](BosSetup& setup) {
    setup.elements = {window(ElementSide::target), window(ElementSide::camera)};
  }));
  expect_as_on_cpu(seen_through(300, [&](BosSetup& setup) {
    setup.camera.tilt = {0.03, -0.05};
    setup.camera.distortion = {-0.1, 0.02, 1e-3, -2e-3};
  }));
}

// A lens with a conic, an even asphere, a weak cylinder, an obscured plate and two flat mirrors, and Fresnel
// reflection.
TEST_F(CudaRaysTest, SurfacesOfEveryShape) {
  std::string const path = file_of("every_shape.toml", R"(schema = 1
f_number = 8.0
[[surface]]
radius_mm = 80.0
conic = -0.6
thickness_mm = 6.0
glass = "N-BK7"
stop = true
[[surface]]
radius_mm = -120.0
asphere_mm = [0.0, 1e-7, -1e-11]
thickness_mm = 5.0
[[surface]]
radius_mm = 3000.0
shape = "cylinder"
thickness_mm = 3.0
glass = "N-SF5"
[[surface]]
thickness_mm = 30.0
[[surface]]
glass = "mirror"
thickness_mm = -10.0
[[surface]]
glass = "mirror"
thickness_mm = 10.0
)");
  expect_as_on_cpu(seen_through(300, [&](BosSetup& setup) {
    put_lens_of(setup, path);
    setup.lens.transmittance = Transmittance::surfaces;
  }));
}

TEST_F(CudaRaysTest, CamerasThatLookFromAside) {
  expect_as_on_cpu(seen_through(300, [](BosSetup& setup) {
    // 0.2 rad about y through the origin: the camera is off the Z axis and looks at the origin
    Pose<double> const turned = Pose<double>{}.turned({0, 0.2, 0});
    setup.pose = turned.moved({0, 0, setup.z_a});
    setup.camera.tilt = {0.01, 0.02};
  }));
}

TEST_F(CudaRaysTest, LensletsBeforeTheSensor) {
  for (LensletLayout const layout : {LensletLayout::square, LensletLayout::hexagonal}) {
    expect_as_on_cpu(seen_through(300, [&](BosSetup& setup) {
      setup.elements = {LensletSetup{83e-6, 900e-6, 900e-6, layout}};
    }));
  }
}

// A source that is blurred over more than the largest window, and one with more rays than a block traces: light outside
// of the window is added ray by ray.
TEST_F(CudaRaysTest, WideBlursAndManyRays) {
  PlannedScene blurred = scene_of(sinusoid(0.1, 6e-3), 2000, [](BosSetup& setup) {
    setup.lens.focus = Focus::distance;
    setup.lens.focus_distance = 0.6;
    setup.lens.f_number = 4;
  });
  blurred.dots.centre.resize(3);
  expect_as_on_cpu(blurred);
  PlannedScene many = scene_of(uniform_gradient(20, 5), 40000);
  many.dots.centre.resize(2);
  expect_as_on_cpu(many);
}

// For a fine wave in front of a wide pupil, the first estimate of the deflection is too small: the light of the rays is
// removed, to the last unit, and they are sent again with a larger margin.
TEST_F(CudaRaysTest, TakesLightBackWhereRaysAreBentBeyondTheirMargin) {
  expect_as_on_cpu(scene_of(sinusoid(0.6, 1.1e-3), 1500, [](BosSetup& setup) { setup.lens.f_number = 2.8; }));
}

// Dots whose image centres are on the edges and corners of pixels.
TEST_F(CudaRaysTest, DotsOnEdgesOfPixels) {
  for (SpotModel const spot : {SpotModel::gaussian, SpotModel::airy}) {
    BosSetup setup = table1_setup(64);
    setup.lens.spot = spot;
    setup.target.dot_diameter_px = 0;
    expect_as_on_cpu(scene_with_dots(setup, {{20.5, 20}, {40, 20.5}, {20.5, 40.5}, {40, 40}}, 512));
  }
}

// The results of a source are bitwise independent of the number of other sources.
TEST_F(CudaRaysTest, ASourceAloneIsTheSourceAmongMany) {
  PlannedScene many = scene_of(dns_plane("late"), 700), alone = many;
  alone.dots.centre.resize(1);
  Rendering const of_many = on_device(many), of_one = on_device(alone);
  EXPECT_EQ(of_many.truth.displacement_px[0], of_one.truth.displacement_px[0]);
  EXPECT_EQ(of_many.truth.displacement_error_px[0], of_one.truth.displacement_error_px[0]);
  // its light as well: no neighbour is closer than 5 px
  Vec2d const at = of_one.truth.reference_px[0];
  for (int row = static_cast<int>(at.y) - 5; row <= static_cast<int>(at.y) + 5; ++row) {
    for (int column = static_cast<int>(at.x) - 5; column <= static_cast<int>(at.x) + 5; ++column) {
      EXPECT_EQ(of_many.light.flow(column, row), of_one.light.flow(column, row));
    }
  }
}

// A block without the memory for windows adds every ray individually, with the same images.
TEST_F(CudaRaysTest, LittleSharedMemoryGivesTheSameImages) {
  cuda::SharedMemoryLimit const limit(20000);
  expect_as_on_cpu(scene_of(sinusoid(0.1, 6e-3), 300));
}

}  // namespace
}  // namespace gladstone
