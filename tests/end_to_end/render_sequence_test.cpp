// Rendered sequences: a setup with [sequence] becomes a folder of frames and pairs that correlate and compare take.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "render/base/vec.h"
#include "tests/end_to_end/support/program_fixture.h"
#include "tests/support/documented_tables.h"

namespace gladstone::end_to_end {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Ideal particle images with a displacement of 2.3 px per frame (M = 105 / 645), and noise.
constexpr char const* piv_sequence = R"(experiment = "piv"

[sequence]
frames = 4
dt_us = 10.0

[camera]
pixels = [96, 96]
pixel_pitch_um = 10.0
exposure = "auto"

[camera.noise]
read_noise_e = 5.0

[lens]
focal_length_mm = 105.0
f_number = 22.0

[geometry]
z_a_mm = 750.0

[particles]
per_pixel = 0.05
volume_mm = [9.0, 9.0, 1.0]
scattering = "gaussian"

[laser]
thickness_mm = 1.0

[flow]
velocity_m_s = [14.12857, 0.0, 0.0]

[correlate]
window_px = [32]
overlap = 0.0
)";

/// A density field of constant gradient along x, extruded, in a text file.
std::string plane_of_gradient(double gradient_kg_m4, int nodes = 5) {
  std::string text = fmt::format("NRRD0004\ntype: float\ndimension: 2\nsizes: {0} {0}\nencoding: ascii\n\n", nodes);
  for (int row = 0; row < nodes; ++row)
    for (int column = 0; column < nodes; ++column)
      text += fmt::format("{} ", 1.225 + gradient_kg_m4 * 20e-3 * (column - (nodes - 1) / 2.0) / (nodes - 1));
  return text + '\n';
}

/// A BOS sequence of the density files rho_8, rho_9 and rho_10.
std::string bos_sequence() {
  std::string const of_files = with(small_setup, "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]\n",
                                    "kind = \"file\"\nspacing_mm = [5.0, 5.0, 1.0]\nextrude = true\n");
  return with(of_files, "[camera]", "[sequence]\nfiles = [\"rho_*.nrrd\"]\n\n[camera]");
}

class RenderedSequences : public ProgramFixture {
 protected:
  void expect_same_pixels(std::string const& a, std::string const& b) const {
    Image<double> const first = read_image(in(a).string()), second = read_image(in(b).string());
    EXPECT_TRUE(std::equal(first.begin(), first.end(), second.begin(), second.end())) << a << ' ' << b;
  }
  /// Writes the BOS setup and its density files rho_8, rho_9 and rho_10.
  void write_fields() const {
    write("setup.toml", bos_sequence());
    for (int k = 0; k < 3; ++k) write(fmt::format("rho_{}.nrrd", 8 + k), plane_of_gradient(25.0 * (k + 1)));
  }
  double mean_of(std::string const& file, std::string const& dataset) const {
    auto const values = Hdf5Reader(in(file).string()).read(dataset);
    double sum = 0;
    for (double const value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
};

// Frames k and k + 1 are those of pair k. correlate takes the folder of frames, compare takes each pair; the statistics
// are those of a uniform flow: its shift, and a scatter that is only the error of measurement.
TEST_F(RenderedSequences, OfPivAreCorrelatedAndCompared) {
  write("setup.toml", piv_sequence);
  auto const json = json_of({"render", "setup.toml", "-o", "out"});
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["pairing"], "consecutive");
  EXPECT_EQ(json["pairs"].size(), 3u);
  EXPECT_EQ(json["frames"], 4);
  EXPECT_THAT(names("out"),
              ElementsAre("frames", "pair_0000", "pair_0001", "pair_0002", "sequence.toml", "summary.json"));
  EXPECT_THAT(names("out/frames"), ElementsAre("frame_0000.tif", "frame_0001.tif", "frame_0002.tif", "frame_0003.tif"));
  for (int k = 0; k < 3; ++k) {
    expect_same_pixels(fmt::format("out/frames/frame_{:04}.tif", k), fmt::format("out/pair_{:04}/reference.tif", k));
    expect_same_pixels(fmt::format("out/frames/frame_{:04}.tif", k + 1), fmt::format("out/pair_{:04}/flow.tif", k));
    EXPECT_EQ(json["pairs"][k]["exposure_e"], json["pairs"][0]["exposure_e"]);
  }
  auto const correlated = json_of(
      {"correlate", "out/frames", "--pairing", "consecutive", "-o", "vectors/", "--config", "setup.toml", "--quiet"});
  EXPECT_EQ(correlated["done"], 3);
  EXPECT_NEAR(mean_of("vectors/statistics.h5", "/u_mean_px"), 2.3, 0.05);
  EXPECT_NEAR(mean_of("vectors/statistics.h5", "/v_mean_px"), 0, 0.05);
  EXPECT_LT(mean_of("vectors/statistics.h5", "/u_rms_px"), 0.1);
  for (int k = 0; k < 3; ++k) {
    auto const errors = json_of({"compare", fmt::format("out/pair_{:04}", k), "--vectors",
                                 fmt::format("vectors/frame_{:04}.h5", k), "--no-figures", "--quiet"});
    EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.15);
    EXPECT_EQ(errors["made_from"]["frames"], "verified");
  }
}

// Particles do not jump between pairs: the true displacement continues from the place where the previous pair ended.
TEST_F(RenderedSequences, ContinueThePathsOfTheParticles) {
  write("setup.toml", piv_sequence);
  render("out");
  auto const first = Hdf5Reader(in("out/pair_0000/truth.h5").string()).read("/particles/position_m");
  auto const next = Hdf5Reader(in("out/pair_0001/truth.h5").string()).read("/particles/position_m");
  std::size_t continued = 0;
  for (std::size_t i = 0; i + 2 < first.size(); i += 3) {
    for (std::size_t j = 0; j + 2 < next.size(); j += 3) {
      Vec3d const off{next[j] - first[i] - 141.2857e-6, next[j + 1] - first[i + 1], next[j + 2] - first[i + 2]};
      if (length(off) < 1e-9) ++continued;
    }
  }
  EXPECT_GT(static_cast<double>(continued), 0.9 * static_cast<double>(first.size() / 3));
}

// A pair that is rendered alone, from its own setup, has the frames of the sequence.
TEST_F(RenderedSequences, HavePairsThatCanBeRenderedAlone) {
  write("setup.toml", piv_sequence);
  render("out");
  render("alone", {}, "out/pair_0002/setup.toml");
  expect_same_pixels("alone/reference.tif", "out/pair_0002/reference.tif");
  expect_same_pixels("alone/flow.tif", "out/pair_0002/flow.tif");
}

TEST_F(RenderedSequences, DoNotDependOnTheNumberOfThreads) {
  write("setup.toml", piv_sequence);
  render("one", {"--threads", "1"});
  render("three", {"--threads", "3"});
  for (int k = 0; k < 4; ++k)
    expect_same_pixels(fmt::format("one/frames/frame_{:04}.tif", k), fmt::format("three/frames/frame_{:04}.tif", k));
}

// Killed after the second pair, the same command continues with it; the frames are those of an uninterrupted run.
TEST_F(RenderedSequences, ContinueAfterAKill) {
  write("setup.toml", piv_sequence);
  {
    Program program({"render", "setup.toml", "-o", "out"}, folder_, stopping_at("pair-rendered:2"));
    ASSERT_TRUE(program.wait_until_stopped());
    program.send(SIGKILL);
    EXPECT_EQ(program.finish(hang_limit).signal, SIGKILL);
  }
  auto const state = nlohmann::json::parse(read("out/summary.json"));
  EXPECT_EQ(state["complete"], false);
  EXPECT_EQ(state["pairs"].size(), 1u);
  EXPECT_THAT(succeed({"render", "setup.toml", "-o", "out"}), ContainsWhole("3 pairs (1 by an earlier run)"));
  EXPECT_THAT(succeed({"render", "setup.toml", "-o", "out"}), ContainsWhole("3 pairs (3 by an earlier run)"));
  render("whole");
  for (int k = 0; k < 4; ++k)
    expect_same_pixels(fmt::format("out/frames/frame_{:04}.tif", k), fmt::format("whole/frames/frame_{:04}.tif", k));
}

// A changed frame does not belong to the truth of its pair: the pair is rendered again. A changed file among the frames
// is replaced by the image of its pair.
TEST_F(RenderedSequences, RestoreChangedFrames) {
  write("setup.toml", piv_sequence);
  render("whole");
  render("out");
  Image<std::uint16_t> const grey(96, 96, 7);
  write_tiff(in("out/pair_0001/flow.tif").string(), grey, {});
  EXPECT_THAT(succeed({"render", "setup.toml", "-o", "out"}), ContainsWhole("3 pairs (2 by an earlier run)"));
  write_tiff(in("out/frames/frame_0001.tif").string(), grey, {});
  write("out/pair_0002/truth.h5", "damaged");
  EXPECT_THAT(succeed({"render", "setup.toml", "-o", "out"}), ContainsWhole("3 pairs (2 by an earlier run)"));
  for (int k = 0; k < 4; ++k)
    expect_same_pixels(fmt::format("out/frames/frame_{:04}.tif", k), fmt::format("whole/frames/frame_{:04}.tif", k));
  expect_same_pixels("out/pair_0001/flow.tif", "whole/pair_0001/flow.tif");
}

// BOS: one reference, and a frame for each density file in natural order. The displacements are proportional to the
// gradients 25, 50 and 75 kg/m^4.
TEST_F(RenderedSequences, OfBosHaveOneReference) {
  write_fields();
  auto const json = json_of({"render", "setup.toml", "-o", "out"});
  EXPECT_EQ(json["pairing"], "reference");
  EXPECT_THAT(names("out/frames"), ElementsAre("frame_0000.tif", "frame_0001.tif", "frame_0002.tif", "frame_0003.tif"));
  for (int k = 1; k <= 3; ++k) {
    expect_same_pixels("out/frames/frame_0000.tif", fmt::format("out/pair_{:04}/reference.tif", k));
    expect_same_pixels(fmt::format("out/frames/frame_{:04}.tif", k), fmt::format("out/pair_{:04}/flow.tif", k));
  }
  EXPECT_THAT(read("out/pair_0003/setup.toml"), HasSubstr("rho_10.nrrd"));
  succeed({"correlate", "out/frames", "--pairing", "reference", "-o", "vectors/", "--config", "setup.toml", "--quiet"});
  double const shift = mean_of("vectors/frame_0001.h5", "/u_px");
  EXPECT_GT(std::abs(shift), 0.1);
  EXPECT_NEAR(mean_of("vectors/frame_0002.h5", "/u_px"), 2 * shift, 0.1);
  EXPECT_NEAR(mean_of("vectors/frame_0003.h5", "/u_px"), 3 * shift, 0.1);
  json_of({"compare", "out/pair_0003", "--vectors", "vectors/frame_0003.h5", "--no-figures", "--quiet"});
}

// Problems of the files are reported at sequence.files, and nothing is written.
TEST_F(RenderedSequences, OfBosRequireFilesOfOneSize) {
  write_fields();
  std::string const place = "setup.toml:" + place_of(bos_sequence(), "files");
  write("rho_9.nrrd", plane_of_gradient(50, 6));
  expect_error({"render", "setup.toml", "-o", "out"}, 2, "inconsistent at setup.toml:5:1");
  write("rho_9.nrrd", "no field");
  expect_error({"render", "setup.toml", "-o", "out"}, 2, "wrong_format at setup.toml:5:1", {"rho_9.nrrd"});
  write("setup.toml", with(bos_sequence(), "rho_*.nrrd", "rho_8.nrrd\", \"rho_7.nrrd"));
  expect_error({"render", "setup.toml", "-o", "out"}, 2, "missing_file at setup.toml:5:1");
  write("setup.toml", with(bos_sequence(), "rho_*.nrrd", "density_*.nrrd"));
  expect_error({"render", "setup.toml", "-o", "out"}, 2, "missing_file at setup.toml:5:1");
}

// One mistake in [sequence] is one problem: medium.field.file, which follows from it, is not reported as missing.
TEST_F(RenderedSequences, OfBosReportAMistakeOnce) {
  write_fields();
  std::vector<std::string> const texts{
      with(bos_sequence(), "[\"rho_*.nrrd\"]", "[]"), with(bos_sequence(), "[\"rho_*.nrrd\"]", "[\"none_*.nrrd\"]"),
      with(bos_sequence(), "[\"rho_*.nrrd\"]", "[\"rho_8.nrrd\", \"rho_7.nrrd\"]\npair = 2"),
      with(bos_sequence(), "[\"rho_*.nrrd\"]", "[\"rho_*.nrrd\"]\npair = 4"),
      with(bos_sequence(), "[\"rho_*.nrrd\"]", "[\"rho_*.nrrd\"]\npair = 0")};
  for (std::string const& text : texts) {
    write("setup.toml", text);
    Outcome const outcome = gladstone({"render", "setup.toml", "-o", "out", "--json"});
    EXPECT_EQ(outcome.exit_code, 2) << text;
    auto const errors = nlohmann::json::parse(outcome.out)["errors"];
    ASSERT_EQ(errors.size(), 1u) << outcome.err;
    EXPECT_THAT(errors[0]["key"].get<std::string>(), testing::StartsWith("sequence.")) << text;
  }
}

TEST_F(RenderedSequences, OfPivReportWrongKeys) {
  std::string const text = with(piv_sequence, "frames = 4", "frames = 1");
  write("setup.toml", text);
  expect_error({"render", "setup.toml", "-o", "out"}, 2, "out_of_range at setup.toml:" + place_of(text, "frames"));
  write("setup.toml", with(piv_sequence, "dt_us = 10.0\n", ""));
  expect_error({"render", "setup.toml", "-o", "out"}, 2, "missing_key at setup.toml:3:2");
}

// A folder with other files, or with another sequence, is not touched.
TEST_F(RenderedSequences, DoNotReplaceOtherFolders) {
  write("setup.toml", piv_sequence);
  fs::create_directory(in("other"));
  write("other/notes.txt", "notes");
  expect_error({"render", "setup.toml", "-o", "other"}, 2, "output at other");
  render("out", {"--set", "sequence.frames=2"});
  expect_error({"render", "setup.toml", "-o", "out"}, 2, "output at out");
}

// With the key `pair`, a setup describes one pair, an ordinary case.
TEST_F(RenderedSequences, CanBeRenderedPairByPair) {
  write("setup.toml", piv_sequence);
  render("one", {"--set", "sequence.pair=1"});
  EXPECT_TRUE(fs::exists(in("one/reference.tif")));
  EXPECT_THAT(read("one/setup.toml"), HasSubstr("pair = 1"));
}

// docs/file-formats.md names the keys of the summary.
TEST_F(RenderedSequences, HaveADocumentedSummary) {
  write("setup.toml", piv_sequence);
  auto json = json_of({"render", "setup.toml", "-o", "out", "--set", "sequence.frames=2"});
  for (char const* key : {"warnings", "warning_records"}) json.erase(key);  // warnings of the run
  EXPECT_EQ(nlohmann::json::parse(read("out/summary.json")), json);
  std::set<std::string> keys;
  auto const table =
      test::documented_table("The folder of a rendered sequence", "key of the sequence's `summary.json`");
  for (auto const& cells : table)
    for (std::string const& name : test::names_of(cells[0])) keys.insert(name);
  for (auto const& item : json.items()) {
    if (item.key() != "pairs") {
      EXPECT_TRUE(keys.contains(item.key())) << item.key();
    }
  }
  for (auto const& item : json["pairs"][0].items()) EXPECT_TRUE(keys.contains("pairs[]." + item.key())) << item.key();
}

}  // namespace
}  // namespace gladstone::end_to_end
