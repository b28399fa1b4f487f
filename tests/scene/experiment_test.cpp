#include "render/scene/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/scene/calibration_planes.h"
#include "render/scene/read_setup.h"
#include "render/scene/scene.h"
#include "tests/scene/read_setup_text.h"

namespace gladstone {
namespace {

gladstone::Setup read_alone(std::string const& text) {
  SetupDocument document = SetupDocument::from_text(text, "case.toml");
  return read_setup(document.root());
}

TEST(Experiment, IsSelectedByItsNameInASetup) {
  for (Experiment const* one : all_experiments) {
    std::string const name = one->name;
    EXPECT_EQ(&find_experiment(name), one);
    EXPECT_EQ(&read_alone("experiment = \"" + name + "\"\n").experiment(), one) << name;
  }
  EXPECT_EQ(&read_alone("").experiment(), all_experiments.front());
  EXPECT_EQ(&find_experiment("schlieren"), all_experiments.front());
}

TEST(Experiment, IsNamedByASetupThatIsNotYetRead) {
  auto const find = [](std::string const& text) {
    return &find_experiment(SetupDocument::from_text(text, "case.toml"));
  };
  for (Experiment const* one : all_experiments) {
    EXPECT_EQ(find("experiment = \"" + std::string(one->name) + "\"\n"), one);
  }
  EXPECT_EQ(find(""), all_experiments.front());
  EXPECT_EQ(find("experiment = 2\n"), all_experiments.front());
}

// Without the key `pair`, a sequence describes its first pair: frames 0 and 1 for PIV, the reference and frame 1 for
// BOS.
TEST(Experiment, TheFirstPairOfASequenceConsistsOfTheFirstTwoFrames) {
  EXPECT_EQ(bos_experiment.first_pair(), 1U);
  EXPECT_EQ(piv_experiment.first_pair(), 0U);
  for (Experiment const* one : all_experiments) {
    SequenceSetup const sequence{.consecutive = one->consecutive_frames, .pair = one->first_pair()};
    EXPECT_EQ(sequence.frames_of(sequence.pair), (std::array<std::uint64_t, 2>{0, 1})) << one->name;
  }
}

// The light of a plane's dots passes no medium, and no deflection table applies to several planes.
TEST(Experiment, APlaneOfACalibrationIsRenderedRayByRay) {
  gladstone::Setup const plane = plane_setup(read_alone("experiment = \"calibration\"\n"), 1e-3);
  EXPECT_EQ(&plane.experiment(), &calibration_experiment);
  EXPECT_EQ(plane.render.method, RenderMethod::rays);
}

// A particle in a uniform flow moves by u dt between the frames, 10 m/s times 10 us; the dots of a target rest.
TEST(SourceKind, PlacesSourcesInBothFrames) {
  std::string const camera = "[camera]\npixels = [32, 32]\n";
  Scene const dots = build_scene(read_alone(camera));
  Scene const particles = build_scene(read_alone("experiment = \"piv\"\n" + camera +
                                                 "[particles]\nnumber = 20\n"
                                                 "[flow]\nvelocity_m_s = [10.0, 0.0, 0.0]\ndt_us = 10.0\n"));
  ASSERT_GT(dots.source_count(), 0U);
  ASSERT_EQ(particles.source_count(), particles.particles.size());
  for (std::size_t i = 0; i < dots.source_count(); ++i) {
    EXPECT_EQ(dots.source_place(i, 1), dots.source_place(i)) << i;
  }
  for (std::size_t i = 0; i < particles.source_count(); ++i) {
    Vec3d const moved = particles.source_place(i, 1) - particles.source_place(i);
    // positions of up to 0.1 m are rounded to 1e-17 m, and so is each of a few integration steps
    EXPECT_NEAR(moved.x, 1e-4, 1e-15) << i;
    EXPECT_NEAR(length(moved), 1e-4, 1e-15) << i;
  }
}

// Only sources whose image meets a condition are retained: all, none, those in the left half of the image.
TEST(SourceKind, RetainsSourcesByTheirImages) {
  for (std::string const experiment : {"bos", "piv"}) {
    Scene const scene = build_scene(read_alone("experiment = \"" + experiment + "\"\n[camera]\npixels = [32, 32]\n"));
    SourceKind const& sources = scene.setup.experiment().sources;
    auto const retained = [&](auto const& near) {
      Scene some = scene;
      return sources.retain(some, near);
    };
    std::size_t const all = retained([](Vec2d) { return true; });
    std::size_t const left = retained([](Vec2d pixel) { return pixel.x < 15.5; });
    std::size_t const right = retained([](Vec2d pixel) { return !(pixel.x < 15.5); });
    EXPECT_EQ(retained([](Vec2d) { return false; }), 0U) << experiment;
    EXPECT_GT(left, 0U) << experiment;
    EXPECT_GT(right, 0U) << experiment;
    EXPECT_EQ(left + right, all) << experiment;
  }
}

}  // namespace
}  // namespace gladstone
