#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "render/base/units.h"
#include "render/rays/ray_planning.h"
#include "tests/cuda/cuda_renderer_fixture.h"
#include "tests/cuda/memory_limits.h"
#include "tests/scene/real_lens_setups.h"

namespace gladstone {
namespace {

/// PIV with the lens of Table 1 at f/8, 750 mm in front of a Gaussian sheet, with 40 droplets inside and outside of the
/// view that move along all three axes.
BosSetup droplets_setup() {
  BosSetup setup;
  setup.camera.columns = setup.camera.rows = 96;
  setup.lens.f_number = 8;
  setup.z_d = 0;
  setup.medium.field = {};
  PivSetup piv;
  piv.laser.thickness = 4e-3;
  piv.laser.divergence = 5 * unit::degree;
  piv.laser.tilt = {0.02, -0.01};
  piv.laser.polarization = 0.4;
  piv.particles.amount = 40;
  piv.particles.volume = Vec3d{5e-3, 5e-3, 5e-3};
  piv.particles.diameter.spread = DiameterSpread::lognormal;
  piv.particles.diameter.width = 0.4;
  piv.flow.flow.uniform = {20, 10, 60};
  setup.piv = piv;
  return setup;
}

class CudaParticlesTest : public OnBothDevices<RaysMethod> {
 protected:
  Rendering on_device(PlannedScene const& scene, ParticleLight light = ParticleLight::scattered,
                      RenderImages images = RenderImages::yes) {
    return renderer_->render_particles(scene, scene.plan, scene.particles, light, images);
  }

  /// Like expect_as_on_cpu() for dots: positions to 1e-9 px, photons to a relative 1e-9, counts exactly, images to a
  /// level of 16 bits.
  /// @return largest margin by which a particle was aimed beyond the stop [m]
  double expect_particles_as_on_cpu(PlannedScene scene, ParticleLight light = ParticleLight::scattered,
                                    RenderImages images = RenderImages::yes) {
    Rendering const cpu = on_cpu_.render_particles(scene, scene.plan, scene.particles, light, images),
                    gpu = on_device(scene, light, images);
    GroundTruth const &a = cpu.truth, &b = gpu.truth;
    EXPECT_EQ(a.size(), b.size());
    if (a.size() != b.size()) return 0;
    EXPECT_LT(largest_difference(a.reference_px, b.reference_px), 1e-9);
    EXPECT_LT(largest_difference(a.displacement_px, b.displacement_px), 1e-9);
    EXPECT_LT(largest_difference(a.displacement_error_px, b.displacement_error_px), 1e-9);
    EXPECT_LT(largest_difference(a.displacement_std_px, b.displacement_std_px), 1e-6);
    EXPECT_LT(largest_difference(a.particles.reference_ambient_px, b.particles.reference_ambient_px), 1e-9);
    EXPECT_LT(largest_difference(a.particles.displacement_ambient_px, b.particles.displacement_ambient_px), 1e-9);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_LE(length(a.flux[i] - b.flux[i]), 1e-9 * length(a.flux[i])) << i;
      EXPECT_EQ(std::isnan(a.displacement_px[i].x), std::isnan(b.displacement_px[i].x)) << i;
      seen += std::isnan(a.displacement_px[i].x) ? 0 : 1;
    }
    EXPECT_GT(seen, 0u);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_EQ(a.rays_planned, b.rays_planned);
    EXPECT_EQ(cpu.statuses, gpu.statuses);
    EXPECT_EQ(cpu.rays, gpu.rays);
    // A displacement of one pixel is a shift of about 0.3 mm on the lens plane: 1e-12 m corresponds to 4e-9 px.
    EXPECT_NEAR(cpu.pupil_margin, gpu.pupil_margin, 1e-12);
    if (images != RenderImages::no) {
      double const level = grey_level(cpu.light.reference);
      EXPECT_LT(largest_difference(cpu.light.reference, gpu.light.reference), level);
      EXPECT_LT(largest_difference(cpu.light.flow, gpu.light.flow), level);
    }
    return gpu.pupil_margin;
  }

  PlannedScene droplets(std::uint64_t rays, std::function<void(BosSetup&)> const& change = {}) {
    BosSetup setup = droplets_setup();
    if (change) change(setup);
    PlannedScene scene(build_scene(setup));
    plan_step(scene);
    scene.plan.rays = rays;
    return scene;
  }
};

FieldSetup blob() { return GaussianBlob<double>{{{}, -0.8, 5e-3}}; }

// A warp accumulates the PSFs of few rays, a block the hits of many; for more than 16384 rays, several blocks do.
TEST_F(CudaParticlesTest, FewRaysAndMany) {
  for (std::uint64_t const rays : {1u, 6u, 32u, 100u, 300u, 40000u}) {
    SCOPED_TRACE(rays);
    expect_particles_as_on_cpu(droplets(rays));
  }
}

TEST_F(CudaParticlesTest, EveryScattering) {
  auto const lambert = [](BosSetup& setup) { setup.piv->particles.scattering = ParticleScattering::lambert; };
  expect_particles_as_on_cpu(droplets(64, lambert));
  expect_particles_as_on_cpu(droplets(64), ParticleLight::equal);
  // drops of 30 um, whose scattered light has 170 lobes over the half circle
  expect_particles_as_on_cpu(droplets(400, [](BosSetup& setup) { setup.piv->particles.diameter.middle = 30e-6; }));
}

// Every particle uses the number of rays that it needs: few in focus, many out of focus, through ideal and real lenses,
// in a medium, and if rays do not fill the stop. The numbers equal those of the CPU.
TEST_F(CudaParticlesTest, TakesTheRaysThatEachNeeds) {
  auto const deep = [](BosSetup& setup) {
    setup.piv->laser.profile = SheetProfile::top_hat;
    setup.piv->laser.thickness = 20e-3;
    setup.piv->particles.volume = Vec3d{5e-3, 5e-3, 20e-3};
  };
  std::function<void(BosSetup&)> const kinds[] = {
      deep, [](BosSetup& setup) { setup.lens = real_lens_setup("double_gauss", 96, 4).lens; },
      [](BosSetup& setup) {
        setup.medium.field = blob();
        setup.medium.thickness = 20e-3;
      },
      [](BosSetup& setup) {
        setup.medium.field = dns_plane("late");
        setup.medium.thickness = 20e-3;
      }};
  for (auto const& kind : kinds) {
    PlannedScene scene = droplets(1, kind);
    scene.plan = plan_rays_by_tracing(scene, scene.plan);
    ASSERT_TRUE(scene.plan.adaptive_criteria);
    expect_particles_as_on_cpu(scene);
    expect_particles_as_on_cpu(scene, ParticleLight::scattered, RenderImages::no);
    std::vector<std::int64_t> const rays = on_device(scene).truth.rays_planned;
    auto const [least, most] = std::minmax_element(rays.begin(), rays.end());
    EXPECT_LT(*least, *most);
  }
}

TEST_F(CudaParticlesTest, InsideEveryMedium) {
  for (FieldSetup const& field :
       {blob(), uniform_gradient(30, 10, 5), sinusoid(0.1, 6e-3), dns_plane("late"), volume_file()}) {
    for (std::uint64_t const rays : {48u, 300u}) {
      expect_particles_as_on_cpu(droplets(rays, [&](BosSetup& setup) {
        setup.medium.field = field;
        setup.medium.thickness = 20e-3;
        setup.medium.faces = Faces::refract;
      }));
    }
  }
}

TEST_F(CudaParticlesTest, ThroughLensesOfManySurfaces) {
  for (std::string const name : {"double_gauss", "achromat"}) {
    SCOPED_TRACE(name);
    auto const change = [&](BosSetup& setup) { setup.lens = real_lens_setup(name, 96, setup.lens.f_number).lens; };
    expect_particles_as_on_cpu(droplets(64, change));
    expect_particles_as_on_cpu(droplets(400, change));
  }
}

TEST_F(CudaParticlesTest, ThroughWindowsAndLensletsOnATiltedSensor) {
  expect_particles_as_on_cpu(droplets(64, [](BosSetup& setup) {
    OpticalWindow window;
    window.side = ElementSide::camera;
    window.index = 1.5168;
    window.thickness = 10e-3;
    window.position = {0, 0, 0.1};
    window.tilt = {0.05, -0.02};
    setup.elements = {window};
    setup.camera.tilt = {0.03, -0.05};
  }));
  expect_particles_as_on_cpu(droplets(300, [](BosSetup& setup) {
    setup.elements = {LensletSetup{83e-6, 900e-6, 900e-6, LensletLayout::square}};
  }));
}

// In a fine wave, the rays that fill the stop have no smooth edge: the host sends rays to a larger disc, and if they
// are deflected beyond it, they are removed and sent again.
TEST_F(CudaParticlesTest, ThatDoNotFillTheStop) {
  for (std::uint64_t const rays : {48u, 1500u}) {
    double const margin = expect_particles_as_on_cpu(droplets(rays, [](BosSetup& setup) {
      setup.medium.field = sinusoid(0.6, 1.1e-3);
      setup.medium.thickness = 20e-3;
      setup.lens.f_number = 2.8;
    }));
    EXPECT_GT(margin, 0);
  }
}

TEST_F(CudaParticlesTest, ThroughAPinhole) {
  expect_particles_as_on_cpu(droplets(1, [](BosSetup& setup) {
    setup.lens.f_number = std::numeric_limits<double>::infinity();
    setup.lens.spot = SpotModel::none;
    setup.medium.field = blob();
    setup.medium.thickness = 20e-3;
  }));
}

TEST_F(CudaParticlesTest, EverySpot) {
  // PSFs with a standard deviation of a pixel, so that squares and windows contain many pixels
  for (std::uint64_t const rays : {48u, 300u}) {
    expect_particles_as_on_cpu(droplets(rays, [](BosSetup& setup) {
      setup.camera.pixel_pitch = 4e-6;
      setup.lens.f_number = 16;
    }));
  }
  for (SpotModel const spot : {SpotModel::none, SpotModel::airy, SpotModel::gaussian}) {
    for (std::uint64_t const rays : {48u, 300u}) {
      expect_particles_as_on_cpu(droplets(rays, [&](BosSetup& setup) { setup.lens.spot = spot; }));
    }
  }
}

// Particles in front of and behind the plane in focus, whose images exceed the largest square and window: the light
// outside of these is added ray by ray.
TEST_F(CudaParticlesTest, FarOutOfFocus) {
  for (std::uint64_t const rays : {100u, 2000u}) {
    expect_particles_as_on_cpu(droplets(rays, [](BosSetup& setup) {
      setup.lens.f_number = 2.8;
      setup.piv->particles.volume = Vec3d{5e-3, 5e-3, 60e-3};
      setup.piv->laser.thickness = 80e-3;
    }));
  }
}

TEST_F(CudaParticlesTest, TruthAlone) {
  for (std::uint64_t const rays : {32u, 300u}) {
    expect_particles_as_on_cpu(droplets(rays), ParticleLight::scattered, RenderImages::no);
  }
}

// The results of a particle are bitwise independent of other particles and equal in two runs.
TEST_F(CudaParticlesTest, GiveTheSameBits) {
  auto const change = [](BosSetup& setup) { setup.medium.field = blob(); };
  PlannedScene one = droplets(100, change), other = one, alone = one;
  Rendering const first = on_device(one), second = on_device(other);
  EXPECT_TRUE(same_bits(first.light.reference, second.light.reference));
  EXPECT_TRUE(same_bits(first.light.flow, second.light.flow));
  alone.particles.resize(1);
  Rendering const of_one = on_device(alone);
  for (std::size_t i = 0; i < first.truth.size(); ++i) {
    EXPECT_EQ(first.truth.flux[i], second.truth.flux[i]);
  }
  EXPECT_EQ(first.truth.flux[0], of_one.truth.flux[0]);
  EXPECT_EQ(first.truth.reference_px[0], of_one.truth.reference_px[0]);
}

// Many particles are processed in batches of 256 MB. In addition, there are two images of 96 x 96 px in fixed point and
// as light, and the scattering table, 3 kB per droplet diameter.
TEST_F(CudaParticlesTest, ManyPassInBatches) {
  PlannedScene scene = droplets(32, [](BosSetup& setup) {
    setup.piv->particles.amount = 250000;
    setup.piv->particles.diameter.spread = DiameterSpread::one;
  });
  cuda::DeviceMemoryLimit const limit(cuda::DeviceMemoryLimit::none);
  expect_particles_as_on_cpu(scene);
  EXPECT_LT(limit.most_held(), std::size_t{270} << 20);
}

// A block without the memory for windows adds every ray individually, with the same images.
TEST_F(CudaParticlesTest, LittleSharedMemoryGivesTheSame) {
  cuda::SharedMemoryLimit const limit(20000);
  expect_particles_as_on_cpu(droplets(300));
}

}  // namespace
}  // namespace gladstone
