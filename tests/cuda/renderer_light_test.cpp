#include <algorithm>
#include <cmath>
#include <string>

#include "render/files/image_file.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/owned_dot_model.h"
#include "tests/cuda/cuda_renderer_fixture.h"

/// Every method by which a dot's light is rendered, on the device compared with the CPU.
namespace gladstone {
namespace {

class CudaLightTest : public CudaRendererTest {
 protected:
  /// Returns 400 dots on 96 x 96 px behind a DNS plane. @param times  factor of its density
  static PlannedScene dense_scene(std::string const& instant, double times, std::uint64_t rays) {
    BosSetup setup = table1_setup(96);
    setup.medium.field = dns_plane(instant);
    setup.medium.field.scale = times * setup.medium.field.scale.value_or(1);
    std::vector<Vec2d> places = lattice(96, 20, 4.3);
    for (Vec2d& place : places) place += {0.0173, 0.0091};
    return scene_with_dots(setup, places, rays);
  }
};

/// Returns the number of dots in caustics: the edge of the stop, as seen through the table, is crossed more than once
/// in some direction.
int dots_in_caustics(PlannedScene const& scene) {
  FocusedDots const dots = build_focused_dots(scene, scene.plan).value();
  DeflectionMap const map(dots, DeflectionTableLayout(dots, scene.dots, scene.imaging.entrance_pupil));
  OwnedDotModel const owned(dots, scene.dots, map.table(), false);
  DotModel const& model = owned.model;
  return static_cast<int>(std::count_if(scene.dots.centre.begin(), scene.dots.centre.end(), [&](Vec2d centre) {
    DotAim const aim = aim_dot(model, centre);
    if (aim.kind == DotKind::left) return false;
    CorrectedCone const cone(model.table, model.stop_radius, model.distance(), centre, aim.pupil, {});
    return std::any_of(model.cone.directions, model.cone.directions + model.cone.direction_count,
                       [&](Vec2d direction) { return std::isnan(cone.rim({}, direction)); });
  }));
}

/// Returns the largest standard deviation of the landing positions of a dot's light [px]; about half a pixel is due to
/// the dot's size.
double widest_dot(GroundTruth const& truth) {
  double widest = 0;
  for (Vec2d const s : truth.displacement_std_px) widest = std::max(widest, length(s));
  return widest;
}

// For all cones of the late plane, the edge of the stop is a simple curve; for some of the early plane, it is not.
TEST_F(CudaLightTest, TablesOnPlanes) {
  for (std::string const instant : {"late", "kepeak"}) {
    SCOPED_TRACE(instant);
    PlannedScene scene = dense_scene(instant, 1, 32);
    EXPECT_EQ(dots_in_caustics(scene) > 0, instant == "kepeak");
    expect_as_on_cpu(scene);
  }
}

// With four times its density, the early plane focuses: cones are so wide that their displacements are sorted into
// squares, and hardly any cone has a simple edge. A standard deviation of 3 px is six times that of the dot's size.
TEST_F(CudaLightTest, TablesInCaustics) {
  for (std::uint64_t const rays : {64, 1100}) {
    SCOPED_TRACE(rays);
    PlannedScene scene = dense_scene("kepeak", 4, rays);
    EXPECT_GT(dots_in_caustics(scene), 300);
    EXPECT_GT(
        widest_dot(
            FocusedDotsRenderer().render(scene, scene.plan, scene.dots, RenderImages::no, RenderTheory::no).truth),
        3);
    expect_as_on_cpu(scene);
  }
}

TEST_F(CudaLightTest, SquareSources) {
  for (double const side : {2.0, 9.0}) {
    PlannedScene scene =
        scene_of(sinusoid(0.1, 6e-3), 96, [&](BosSetup& setup) { setup.target.dot_diameter_px = side; });
    scene.dots.shape = SourceShape::square;
    expect_as_on_cpu(scene);
  }
}

// Grey values from black, which emits no rays, to white, over a part of the view.
TEST_F(CudaLightTest, PictureAsSources) {
  Image<std::uint16_t> picture(9, 7);
  for (std::size_t i = 0; i < picture.size(); ++i) picture.data()[i] = static_cast<std::uint16_t>(i % 4 * 15000);
  BosSetup setup = table1_setup(96);
  setup.medium.field = sinusoid(0.1, 6e-3);
  setup.target.kind = TargetKind::image;
  setup.target.file = testing::TempDir() + "gladstone_cuda_picture.tif";
  setup.target.extent_m = Vec2d{45, 35} * (setup.camera.pixel_pitch / setup.imaging().magnification);
  write_tiff(setup.target.file, picture, {});
  PlannedScene scene(build_scene(setup));
  ASSERT_EQ(scene.dots.centre.size(), 47u);  // 16 of 63 are black
  ASSERT_EQ(scene.dots.radiance.size(), 47u);
  plan_step(scene);
  scene.plan.rays = 100;
  expect_as_on_cpu(scene);
}

// A source without light is traced like any other, and has no truth.
TEST_F(CudaLightTest, SourcesWithoutRadiance) {
  for (FieldSetup const& field : {FieldSetup{}, sinusoid(0.1, 6e-3)}) {
    PlannedScene scene = scene_of(field, 64);
    for (std::size_t i = 0; i < scene.dots.centre.size(); ++i) {
      scene.dots.radiance.push_back(0.5 * static_cast<double>(i % 3));
    }
    expect_as_on_cpu(scene);
    for (double& radiance : scene.dots.radiance) radiance = 0;
    Rendering const dark = on_device(scene);
    EXPECT_EQ(*std::max_element(dark.light.reference.begin(), dark.light.reference.end()), 0);
    EXPECT_EQ(*std::max_element(dark.light.flow.begin(), dark.light.flow.end()), 0);
  }
}

// PSFs of 23 and 43 px, the latter the widest that is rendered by moments.
TEST_F(CudaLightTest, WideSpots) {
  struct Case {
    double f_number;
    int width;
  };
  for (Case const& one : {Case{16, 23}, Case{32, 43}}) {
    SCOPED_TRACE(one.width);
    PlannedScene scene = scene_of(sinusoid(0.1, 6e-3), 16, [&](BosSetup& setup) {
      setup.lens.spot = SpotModel::seed_eq8;
      setup.lens.f_number = one.f_number;
    });
    std::optional<AiryTable> airy;
    ASSERT_EQ(2 * make_spot(scene, airy).half_width() + 1, one.width);
    expect_as_on_cpu(scene);
  }
}

// 144 dots inside, across and outside the image's border, undisplaced ones and ones with cones by tables.
TEST_F(CudaLightTest, DotsAtTheBorder) {
  std::vector<Vec2d> const few{{0.3, 0.4},   {-1.2, 47.3},  {95.4, 20.1},  {31.7, 96.6}, {98.2, 98.1},
                               {-4.3, -3.6}, {48.2, -30.1}, {-60.3, 50.2}, {150.1, 47.8}};
  for (FieldSetup const& field : {FieldSetup{}, sinusoid(0.2, 4e-3), dns_plane("kepeak")}) {
    BosSetup setup = table1_setup(96);
    setup.medium.field = field;
    expect_as_on_cpu(scene_with_dots(setup, few, 200));
    PlannedScene const many = scene_with_dots(setup, lattice(96, 12, 10.71), 64);
    expect_as_on_cpu(many);
  }
}

}  // namespace
}  // namespace gladstone
