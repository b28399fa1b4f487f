#include "studies/sweep/case_keys.h"

#include <cstring>

#include "studies/sweep/case_runner.h"
#include "tests/studies/support/study_folder.h"

namespace gladstone {
namespace {

/// A key of the setup, two of its values, and what cases with these values may share.
struct Change {
  char const* key;
  char const* values;
  bool medium, scene, rays;
};

/// The light of a reference image depends on the ambient medium (n0), on the field (its rays are those of the
/// measurement image, whose pupil is enlarged by the deflection), on the lens, the positions and the dots. It depends
/// on the sensor's electronics only through "auto" rays, whose number is fixed in small_base.
constexpr Change changes[] = {
    {"medium.ambient_density_kg_m3", "[1.225, 0.6]", false, false, false},
    {"medium.gladstone_dale", "[2.26e-4, 3e-4]", false, false, false},
    {"medium.wavelength_nm", "[532, 633]", false, false, false},
    {"medium.thickness_mm", "[10, 20]", false, false, false},
    {"medium.field.gradient_kg_m4", "[[20, 10, 0], [20, 10, 1e-9]]", false, false, false},
    {"medium.step_mm", "[1, 0.5]", true, false, false},
    {"medium.integrator", "[\"rk4\", \"euler\"]", true, false, false},
    {"medium.faces", "[\"matched\", \"refract\"]", true, false, false},
    {"lens.f_number", "[11, 11.000000000000002]", true, false, false},  // adjacent doubles
    {"lens.focal_length_mm", "[105, 100]", true, false, false},
    {"lens.focus", "[\"target\", \"medium\"]", true, false, false},
    {"lens.psf", "[\"gaussian\", \"airy\"]", true, false, false},
    {"geometry.z_a_mm", "[750, 700]", true, false, false},
    {"geometry.z_d_mm", "[250, 300]", true, false, false},
    {"target.seed", "[1, 2]", true, false, false},
    {"target.dot_diameter_px", "[3, 2]", true, false, false},
    {"target.dots_per_32px_window", "[10, 11]", true, false, false},
    {"render.seed", "[1, 2]", true, false, false},
    {"render.sampling", "[\"sobol\", \"random\"]", true, false, false},
    {"camera.pixel_pitch_um", "[10, 8]", true, false, false},
    {"camera.pixels", "[[64, 64], [64, 66]]", true, false, false},
    {"correlate.window_px", "[[32, 16], [16]]", true, false, false},  // the target extends by one first window
    {"render.rays_per_dot", "[32, 48]", true, true, false},
    {"correlate.window_px", "[[32, 16], [32]]", true, true, true},
    {"correlate.overlap", "[0.5, 0.75]", true, true, true},
    {"camera.bit_depth", "[8, 12]", true, true, true},
    {"camera.exposure", "[\"auto\", 20000]", true, true, true},
    {"camera.offset_dn", "[0, 100]", true, true, true},
    {"camera.noise.read_noise_e", "[0, 20]", true, true, true},
    {"camera.noise.seed", "[1, 2]", true, true, true},
};

class CaseKeysOf : public StudyFolder {
 protected:
  static CaseKeys keys_of(ManifestCase const& one) {
    CaseSetup const loaded = load_case_setup(SetupDocument::from_text(one.setup, "case"));
    return case_keys(loaded, one.inputs);
  }
  std::vector<ManifestCase> pair(Change const& change) const {
    return plan(std::string("base = \"base.toml\"\n[axes]\n\"") + change.key + "\" = " + change.values + '\n');
  }
};

TEST_F(CaseKeysOf, AreEqualWhereTheLightIsAndNowhereElse) {
  for (Change const& change : changes) {
    auto const cases = pair(change);
    ASSERT_EQ(cases.size(), 2u);
    CaseKeys const one = keys_of(cases[0]), other = keys_of(cases[1]);
    std::string const name = std::string(change.key) + ' ' + change.values;
    EXPECT_EQ(one.medium == other.medium, change.medium) << name;
    EXPECT_EQ(one.scene == other.scene, change.scene) << name;
    EXPECT_EQ(one.rays == other.rays, change.rays) << name;
  }
}

TEST_F(CaseKeysOf, LeaveOutTheSeedsOfRepeats) {
  auto const cases = plan("base = \"base.toml\"\n[study]\nrepeats = 2\n[axes]\n\"lens.f_number\" = [8, 11]\n");
  ASSERT_EQ(cases.size(), 4u);
  auto const seedless = [](ManifestCase const& one) {
    return case_keys(load_case_setup(SetupDocument::from_text(one.setup, "case")), one.inputs, RepeatSeeds::left_out);
  };
  EXPECT_NE(keys_of(cases[0]).scene, keys_of(cases[2]).scene);
  EXPECT_EQ(seedless(cases[0]).scene, seedless(cases[2]).scene);
  EXPECT_EQ(seedless(cases[0]).rays, seedless(cases[2]).rays);
  EXPECT_NE(seedless(cases[0]).scene, seedless(cases[1]).scene);
}

// Whatever the difference between two cases, the second one has the same bits as if it were computed alone.
TEST_F(CaseKeysOf, SharedPartsDoNotChangeResults) {
  auto const same = [](CaseResult const& a, CaseResult const& b) {
    bool equal = a.status == b.status && a.error == b.error && a.measures.size() == b.measures.size();
    for (std::size_t i = 0; equal && i < a.measures.size(); ++i) {
      auto const& [name, value] = a.measures[i];
      equal = name == b.measures[i].first && std::memcmp(&value, &b.measures[i].second, sizeof value) == 0;
    }
    return equal;
  };
  for (Change const& change : changes) {
    auto const cases = pair(change);
    std::string const name = std::string(change.key) + ' ' + change.values;
    CaseRunner sharing(open_device("cpu"));
    CaseResult const first = sharing.run(cases[0]), second = sharing.run(cases[1]);
    EXPECT_EQ(second.status, CaseStatus::ok) << name << second.error;
    EXPECT_TRUE(same(second, CaseRunner(open_device("cpu")).run(cases[1]))) << name;
    EXPECT_TRUE(same(first, sharing.run(cases[0]))) << name;
  }
}

TEST_F(CaseKeysOf, FilesCountByTheirContent) {
  std::string points = "x_mm,y_mm\n";
  for (int i = 0; i < 100; ++i) points += std::to_string(0.4 * (i % 10)) + ',' + std::to_string(0.4 * (i / 10)) + '\n';
  write("a.csv", points);
  write("b.csv", points + "4,4\n");
  std::string const base(small_base);
  std::string const dots = "dots_per_32px_window = 10.0";
  write("base.toml", std::string(base).replace(base.find(dots), dots.size(), "kind = \"points\"\nfile = \"a.csv\""));
  auto cases = plan("base = \"base.toml\"\n[axes]\n\"target.file\" = [\"a.csv\", \"b.csv\"]\n");
  EXPECT_NE(keys_of(cases[0]).scene, keys_of(cases[1]).scene);
  CaseKeys const before = keys_of(cases[0]);
  ASSERT_EQ(cases[0].inputs.size(), 1u);
  cases[0].inputs.begin()->second = "another content";
  EXPECT_NE(keys_of(cases[0]).scene, before.scene);
}

// A large volume is not built again for other dots in front of it.
TEST_F(CaseKeysOf, AMediumCountsByItsOwnFile) {
  std::string volume =
      "NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nendian: little\nencoding: raw\nspacings: 8 8 2\n\n";
  write("volume.nrrd", volume + std::string(64 * sizeof(float), '\0'));
  write("a.csv", "x_mm,y_mm\n0,0\n");
  write("b.csv", "x_mm,y_mm\n1,1\n");
  write("base.toml", R"(schema = 1
[medium.field]
kind = "file"
file = "volume.nrrd"
[target]
kind = "points"
file = "a.csv"
)");
  auto cases = plan("base = \"base.toml\"\n[axes]\n\"target.file\" = [\"a.csv\", \"b.csv\"]\n");
  CaseKeys const one = keys_of(cases[0]), other = keys_of(cases[1]);
  EXPECT_EQ(one.medium, other.medium);
  EXPECT_NE(one.scene, other.scene);
  ASSERT_EQ(cases[0].inputs.count(in("volume.nrrd")), 1u);
  cases[0].inputs[in("volume.nrrd")] = "another content";
  EXPECT_NE(keys_of(cases[0]).medium, one.medium);
}

}  // namespace
}  // namespace gladstone
