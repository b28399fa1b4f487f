// Sequences of image pairs: gladstone correlate 'A_*.tif' 'B_*.tif' -o DIR/.
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <tiffio.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <set>

#include "render/base/vec.h"
#include "tests/end_to_end/support/program_fixture.h"
#include "tests/support/documented_tables.h"

namespace gladstone::end_to_end {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int side = 64;

/// Image of Gaussian dots of e^-2 diameter 3 px at the positions of a seed, displaced by a uniform shift, on a level.
Image<std::uint16_t> dots_at(Vec2d shift, unsigned seed = 1, int columns = side, double level = 1000) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> place(-8, side + 8);
  Image<double> light(columns, side, level);
  for (int n = 0; n < 160; ++n) {
    double const x = place(bits) + shift.x, y = place(bits) + shift.y;
    for (int j = std::max(0, static_cast<int>(y) - 5); j < std::min(side, static_cast<int>(y) + 6); ++j)
      for (int i = std::max(0, static_cast<int>(x) - 5); i < std::min(columns, static_cast<int>(x) + 6); ++i)
        light(i, j) += 20000 * std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / (2 * 0.75 * 0.75));
  }
  Image<std::uint16_t> image(columns, side);
  for (std::size_t i = 0; i < image.size(); ++i)
    image.data()[i] = static_cast<std::uint16_t>(std::min(65535.0, std::round(light.data()[i])));
  return image;
}

class Sequences : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("config.toml", "[correlate]\nwindow_px = [32, 16]\noverlap = 0.5\n");
  }
  void write_image(std::string const& name, Image<std::uint16_t> const& image) const {
    write_tiff(in(name).string(), image, {});
  }
  /// Writes A_1.tif, B_1.tif, ... whose displacements are `shifts`, in a numbering of two widths.
  void write_pairs(std::vector<Vec2d> const& shifts) const {
    for (std::size_t k = 0; k < shifts.size(); ++k) {
      auto const seed = static_cast<unsigned>(k + 1);
      write_image("A_" + std::to_string(8 + k) + ".tif", dots_at({}, seed));
      write_image("B_" + std::to_string(8 + k) + ".tif", dots_at(shifts[k], seed));
    }
  }
  /// Expects that valid vectors in out/dots/img_1.h5 to img_4.h5 with one track are those of one particle: each starts
  /// where the previous one ends, and nearly all particles in the middle have a track through all pairs.
  void expect_tracks(Vec2d shift) const {
    std::map<std::int64_t, Vec2d> ends;
    std::size_t complete = 0;
    for (int k = 1; k <= 4; ++k) {
      Hdf5Reader const file(in(fmt::format("out/dots/img_{}.h5", k)).string());
      auto const tracks = file.read_integers("/track"), status = file.read_integers("/status");
      auto const x = file.read("/x_px"), y = file.read("/y_px"), u = file.read("/u_px"), v = file.read("/v_px");
      std::map<std::int64_t, Vec2d> next;
      complete = 0;
      for (std::size_t i = 0; i < tracks.size(); ++i) {
        if (status[i] != 0) continue;
        Vec2d const middle{x[i], y[i]}, half{0.5 * u[i], 0.5 * v[i]};
        EXPECT_TRUE(next.emplace(tracks[i], middle + half).second) << "two vectors of one track";
        EXPECT_LT(length(2 * half - shift), 1) << k;
        auto const before = ends.find(tracks[i]);
        if (k > 1 && before != ends.end()) {
          EXPECT_LT(length(before->second - (middle - half)), 1e-6);
          ++complete;
        }
      }
      EXPECT_GT(next.size(), 60u);
      ends = std::move(next);
    }
    EXPECT_GT(complete, 50u);
  }
  /// Writes a TIFF of several pages.
  void write_stack(std::string const& name, std::vector<Image<std::uint16_t>> const& pages) const {
    TIFF* const file = TIFFOpen(in(name).c_str(), "w");
    ASSERT_NE(file, nullptr);
    for (Image<std::uint16_t> const& page : pages) {
      TIFFSetField(file, TIFFTAG_IMAGEWIDTH, page.columns());
      TIFFSetField(file, TIFFTAG_IMAGELENGTH, page.rows());
      TIFFSetField(file, TIFFTAG_BITSPERSAMPLE, 16);
      TIFFSetField(file, TIFFTAG_SAMPLESPERPIXEL, 1);
      TIFFSetField(file, TIFFTAG_ROWSPERSTRIP, page.rows());
      TIFFSetField(file, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
      TIFFSetField(file, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
      auto copy = page;
      EXPECT_GT(TIFFWriteEncodedStrip(file, 0, copy.data(), static_cast<tmsize_t>(copy.size() * 2)), 0);
      EXPECT_TRUE(TIFFWriteDirectory(file));
    }
    TIFFClose(file);
  }
  std::vector<std::string> arguments(std::vector<std::string> inputs, std::string const& output,
                                     std::vector<std::string> const& more = {}) const {
    std::vector<std::string> all{"correlate"};
    all.insert(all.end(), inputs.begin(), inputs.end());
    for (std::string const& one : {std::string("-o"), output, std::string("--config"), std::string("config.toml")})
      all.push_back(one);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  nlohmann::json read_state(std::string const& folder) const {
    return nlohmann::json::parse(read(folder + "/sequence.json"));
  }
  /// Mean displacement of the inner vectors of a file, whose windows are within both frames.
  Vec2d mean_of(std::string const& name) const {
    Hdf5Reader const file(in(name).string());
    auto const x = file.read("/x_px"), y = file.read("/y_px"), u = file.read("/u_px"), v = file.read("/v_px");
    Vec2d sum;
    double n = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (std::min(x[i], y[i]) < 16 || std::max(x[i], y[i]) > side - 16) continue;
      sum += Vec2d{u[i], v[i]};
      n += 1;
    }
    return sum / n;
  }
  void expect_shift(std::string const& name, Vec2d shift) const {
    Vec2d const mean = mean_of(name);
    EXPECT_NEAR(mean.x, shift.x, 0.05) << name;
    EXPECT_NEAR(mean.y, shift.y, 0.05) << name;
  }
};

// Frames are matched by their numbers (8, 9, 10), as quoted patterns and as expanded by the shell; each file is bit by
// bit that of a single correlation.
TEST_F(Sequences, OfPairsAreTheSingleCorrelations) {
  std::vector<Vec2d> const shifts{{1.5, 0.5}, {-0.75, 1}, {2.25, -1.5}};
  write_pairs(shifts);
  auto const json = json_of(arguments({"A_*.tif", "B_*.tif"}, "out/"));
  EXPECT_EQ(json["pairs"], 3);
  EXPECT_EQ(json["done"], 3);
  EXPECT_EQ(json["resumed"], 0);
  EXPECT_THAT(json["failed"], testing::IsEmpty());
  EXPECT_THAT(names("out"),
              ElementsAre("A_10.h5", "A_8.h5", "A_9.h5", "sequence.json", "statistics.h5", "statistics.png"));
  for (std::size_t k = 0; k < 3; ++k) {
    std::string const number = std::to_string(8 + k);
    expect_shift("out/A_" + number + ".h5", shifts[k]);
    // the default of a single pair estimates the uncertainty, that of a sequence does not
    succeed(arguments({"A_" + number + ".tif", "B_" + number + ".tif"}, "single.h5",
                      {"--set", "correlate.uncertainty=none"}));
    expect_same_datasets("out/A_" + number + ".h5", "single.h5");
  }
  auto const state = read_state("out");
  EXPECT_EQ(state["complete"], true);
  EXPECT_EQ(state["pairs"][2]["flow"]["file"], "B_10.tif");
  EXPECT_EQ(state["pairs"][0]["reference"]["sha256"],
            Hdf5Reader(in("out/A_8.h5").string()).attribute("reference_sha256"));

  succeed(arguments({"A_8.tif", "A_9.tif", "A_10.tif", "B_8.tif", "B_9.tif", "B_10.tif"}, "expanded"));
  for (char const* name : {"/A_8.h5", "/A_10.h5", "/statistics.h5"})
    expect_same_datasets(std::string("out") + name, std::string("expanded") + name);
}

// One image file or two patterns that match one pair, with a file as output, remain a single correlation.
TEST_F(Sequences, OfOnePairMayBeAFile) {
  write_pairs({{1.5, 0.5}});
  succeed(arguments({"A_*.tif", "B_*.tif"}, "v.h5"));
  succeed(arguments({"A_8.tif", "B_8.tif"}, "single.h5"));
  expect_same_datasets("v.h5", "single.h5");
  write_pairs({{1.5, 0.5}, {1, 1}});
  expect_error(arguments({"A_*.tif", "B_*.tif"}, "w.h5"), 2, "output at w.h5");
  expect_error(arguments({"C_*.tif", "B_*.tif"}, "out/"), 2, "missing_file at C_*.tif");
}

// BOS: every image is measured against the first one.
TEST_F(Sequences, HaveOneReference) {
  write_image("ref.tif", dots_at({}));
  for (int k = 1; k <= 3; ++k) write_image(fmt::format("flow{}.tif", k), dots_at({0.5 * k, -0.25 * k}));
  succeed(arguments({"ref.tif", "flow*.tif"}, "out/", {"--pairing", "reference"}));
  for (int k = 1; k <= 3; ++k) expect_shift(fmt::format("out/flow{}.h5", k), {0.5 * k, -0.25 * k});
}

// Consecutive images of a folder: displacements are the differences of the shifts.
TEST_F(Sequences, HaveConsecutiveImages) {
  std::filesystem::create_directory(in("images"));
  std::vector<double> const at{0, 0.5, 1.75, 1};
  for (std::size_t k = 0; k < at.size(); ++k)
    write_image(fmt::format("images/t{}.tif", k + 8), dots_at({at[k], -at[k]}));
  succeed(arguments({"images"}, "out/", {"--pairing", "consecutive"}));
  for (std::size_t k = 0; k + 1 < at.size(); ++k)
    expect_shift(fmt::format("out/t{}.h5", k + 8), {at[k + 1] - at[k], at[k] - at[k + 1]});
}

// Images that move by 0.5 px each, without number 4: a pair across the gap would have twice the displacement. In pairs
// of two, 3 has no partner and 5 is paired with 6.
TEST_F(Sequences, AMissingImageIsNamed) {
  std::filesystem::create_directory(in("images"));
  for (int const k : {1, 2, 3, 5, 6, 7}) write_image(fmt::format("images/t{}.tif", k), dots_at({0.5 * k, 0}));
  Outcome const consecutive = gladstone(arguments({"images"}, "out/", {"--pairing", "consecutive", "--json"}));
  EXPECT_NE(consecutive.exit_code, 0);
  expect_warning_in(nlohmann::json::parse(consecutive.out), "failed at t3.h5", {"t3.tif", " 4"});
  for (int const k : {1, 2, 5, 6}) expect_shift(fmt::format("out/t{}.h5", k), {0.5, 0});
  EXPECT_FALSE(std::filesystem::exists(in("out/t3.h5")));

  Outcome const pairs = gladstone(arguments({"images"}, "pairs/", {"--pairing", "pairs", "--json"}));
  EXPECT_NE(pairs.exit_code, 0);
  expect_warning_in(nlohmann::json::parse(pairs.out), "failed at t3.h5", {"t3.tif", " 4"});
  for (int const k : {1, 5}) expect_shift(fmt::format("pairs/t{}.h5", k), {0.5, 0});
}

// Pairs with numbers 0 and 1, 10 and 11, ...: the first image of the second pair is missing.
TEST_F(Sequences, AMissingImageOfSpacedPairsIsNamed) {
  std::filesystem::create_directory(in("images"));
  for (int const k : {0, 1, 11, 20, 21, 30, 31})
    write_image(fmt::format("images/t{}.tif", k), dots_at({0.5 * (k % 2), 0}, static_cast<unsigned>(k / 10 + 1)));
  Outcome const pairs = gladstone(arguments({"images"}, "out/", {"--pairing", "pairs", "--json"}));
  expect_warning_in(nlohmann::json::parse(pairs.out), "failed at t11.h5", {"t11.tif"});
  for (int const k : {0, 20, 30}) expect_shift(fmt::format("out/t{}.h5", k), {0.5, 0});
}

// If the numbers are times with irregular intervals, a longer interval is not a missing image.
TEST_F(Sequences, IrregularNumbersAreNoGaps) {
  std::filesystem::create_directory(in("images"));
  for (int const k : {100, 107, 113, 121, 130}) write_image(fmt::format("images/t{}.tif", k), dots_at({0.1 * k, 0}));
  EXPECT_EQ(json_of(arguments({"images"}, "out/", {"--pairing", "consecutive"}))["done"], 4);
}

// The pages of one file, for each pairing.
TEST_F(Sequences, AreThePagesOfOneFile) {
  std::vector<double> const at{0, 1, 0.25, 1.75};
  std::vector<Image<std::uint16_t>> pages;
  for (double const u : at) pages.push_back(dots_at({u, 0}));
  write_stack("stack.tif", pages);
  succeed(arguments({"stack.tif"}, "pairs/"));
  EXPECT_THAT(names("pairs"),
              ElementsAre("sequence.json", "stack_p0001.h5", "stack_p0003.h5", "statistics.h5", "statistics.png"));
  expect_shift("pairs/stack_p0001.h5", {1, 0});
  expect_shift("pairs/stack_p0003.h5", {1.5, 0});
  succeed(arguments({"stack.tif"}, "reference/", {"--pairing", "reference"}));
  expect_shift("reference/stack_p0003.h5", {0.25, 0});
  succeed(arguments({"stack.tif"}, "consecutive/", {"--pairing", "consecutive"}));
  expect_shift("consecutive/stack_p0002.h5", {-0.75, 0});
  EXPECT_EQ(read_state("consecutive")["pairs"][1]["flow"]["page"], 3);
}

// A stack that was not copied to its end declares a page that cannot be read: its pair is named, the others are done.
TEST_F(Sequences, NameTheMissingPageOfAStackThatIsCutShort) {
  write_stack("stack.tif", {dots_at({}), dots_at({1, 0}), dots_at({2, 0})});
  std::filesystem::resize_file(in("stack.tif"), std::filesystem::file_size(in("stack.tif")) - 60);
  Outcome const outcome = gladstone(arguments({"stack.tif"}, "out/", {"--pairing", "consecutive", "--json"}));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  expect_warning_in(nlohmann::json::parse(outcome.out), "failed at stack_p0002.h5", {"stack.tif", "page 3"});
  EXPECT_EQ(read_state("out")["pairs"][0]["state"], "done");
  EXPECT_EQ(read_state("out")["pairs"][1]["state"], "failed");
}

// With one reference, the dots retain their numbers; pairs without common frames have scattered vectors without tracks.
TEST_F(Sequences, StoreTheDotsOfEveryPair) {
  write_pairs({{1, 0}, {1, 0.5}});
  std::vector<std::string> const more{"--set", "correlate.method=tracking"};
  succeed(arguments({"A_*.tif", "B_*.tif"}, "pairs/", more));
  EXPECT_FALSE(Hdf5Reader(in("pairs/dots/A_8.h5").string()).has("/track"));
  EXPECT_TRUE(std::filesystem::exists(in("pairs/statistics.png")));
  for (int k = 0; k < 3; ++k) write_image(fmt::format("flow_{}.tif", k), dots_at({0.5 * k, 0.25}));
  succeed(arguments({"flow_0.tif", "flow_1.tif", "flow_2.tif"}, "bos/",
                    {"--pairing", "reference", "--no-figures", "--set", "correlate.method=tracking"}));
  EXPECT_FALSE(std::filesystem::exists(in("bos/statistics.png")));
  Hdf5Reader const first(in("bos/dots/flow_1.h5").string()), second(in("bos/dots/flow_2.h5").string());
  auto const tracks = first.read_integers("/track");
  EXPECT_GT(tracks.size(), 50u);
  EXPECT_EQ(tracks, second.read_integers("/track"));
  EXPECT_EQ(tracks.back(), static_cast<std::int64_t>(tracks.size()) - 1);
}

// Tracking of consecutive images also uses the frames before and after a pair: its file records their hashes, so that
// it is computed anew if one of them changes. The first and the last pair have three frames. The order in which threads
// serve the pairs does not matter.
TEST_F(Sequences, OfTracksUseFourFrames) {
  for (int k = 1; k <= 5; ++k) write_image(fmt::format("img_{}.tif", k), dots_at(k * Vec2d{2.5, 1}));
  std::vector<std::string> const more{"--pairing", "consecutive", "--set", "correlate.method=tracking", "--threads"};
  auto const command = [&](std::string const& folder, char const* threads) {
    auto all = arguments({"img_*.tif"}, folder, more);
    all.emplace_back(threads);
    return all;
  };
  EXPECT_EQ(json_of(command("out/", "3"))["done"], 4);
  auto const hash = [&](int pair, char const* frame) {
    return Hdf5Reader(in(fmt::format("out/img_{}.h5", pair)).string()).attribute(frame + std::string("_sha256"));
  };
  EXPECT_EQ(hash(1, "before"), "");
  EXPECT_EQ(hash(1, "after"), hash(3, "reference"));
  EXPECT_EQ(hash(2, "before"), hash(1, "reference"));
  EXPECT_EQ(hash(4, "before"), hash(3, "reference"));
  EXPECT_EQ(hash(4, "after"), "");
  succeed(command("other/", "1"));
  for (int k = 1; k <= 4; ++k) {
    expect_shift(fmt::format("out/img_{}.h5", k), {2.5, 1});
    expect_same_datasets(fmt::format("out/img_{}.h5", k), fmt::format("other/img_{}.h5", k));
    expect_same_datasets(fmt::format("out/dots/img_{}.h5", k), fmt::format("other/dots/img_{}.h5", k));
  }
  expect_tracks({2.5, 1});
  EXPECT_EQ(json_of(command("out/", "1"))["resumed"], 4);
  write_image("img_5.tif", dots_at(5 * Vec2d{2.5, 1}, 1, side, 1100));
  EXPECT_EQ(json_of(command("out/", "1"))["resumed"], 2);  // not 3-4, whose frame after it is, and 4-5
  std::filesystem::remove(in("out/dots/img_2.h5"));
  EXPECT_EQ(json_of(command("out/", "1"))["resumed"], 3);

  // A frame that cannot be used fails its own pairs alone.
  write_image("img_5.tif", dots_at({}, 1, 80));
  Outcome const outcome = gladstone(command("out/", "1"));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  auto const pairs = read_state("out")["pairs"];
  EXPECT_EQ(pairs[2]["state"], "done");
  EXPECT_EQ(pairs[3]["state"], "failed");
  EXPECT_EQ(hash(3, "after"), "");
  EXPECT_THAT(Hdf5Reader(in("out/img_3.h5").string()).attribute("warnings"), HasSubstr("img_5.tif"));
}

// A damaged image, one of another size, a missing partner, and frames without signal are named; the other pairs are
// correlated. Exit code 2 remains for sequences without any valid vector.
TEST_F(Sequences, NameBadPairsAndDoTheOthers) {
  write_pairs({{1, 0}, {1, 0}, {1, 0}, {1, 0}, {1, 0}});
  write("B_9.tif", "not an image");
  write_image("B_10.tif", dots_at({1, 0}, 3, 80));
  std::filesystem::remove(in("B_11.tif"));
  write_image("A_12.tif", Image<std::uint16_t>(side, side, 7));
  write_image("B_12.tif", Image<std::uint16_t>(side, side, 7));
  Outcome const outcome = gladstone(arguments({"A_*.tif", "B_*.tif"}, "out/", {"--json"}));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  auto const json = nlohmann::json::parse(outcome.out);
  expect_warning_in(json, "failed at A_9.h5", {"B_9.tif"});
  expect_warning_in(json, "failed at A_10.h5", {"B_10.tif", "80 x 64 px", "A_8.tif", "64 x 64 px"});
  expect_warning_in(json, "failed at A_11.h5", {"A_11.tif"});
  expect_warning_in(json, "failed at A_12.h5");
  EXPECT_EQ(json["done"], 1);
  EXPECT_EQ(json["failed"].size(), 4u);
  auto const pairs = read_state("out")["pairs"];
  std::vector<std::string> states;
  for (auto const& pair : pairs) states.push_back(pair["state"]);
  EXPECT_THAT(states, ElementsAre("done", "failed", "failed", "failed", "no valid vector"));
  EXPECT_TRUE(pairs[1]["vectors"].is_null());
  EXPECT_THAT(pairs[1]["error"].get<std::string>(), HasSubstr("B_9.tif"));
  expect_shift("out/A_8.h5", {1, 0});

  // The remedy and the same command complete the sequence.
  write_pairs({{1, 0}, {1, 0}, {1, 0}, {1, 0}, {1, 0}});
  auto const again = json_of(arguments({"A_*.tif", "B_*.tif"}, "out/"));
  EXPECT_EQ(again["done"], 5);
  EXPECT_EQ(again["resumed"], 1);

  for (int k = 8; k <= 12; ++k) write_image("B_" + std::to_string(k) + ".tif", dots_at({1, 0}, 3, 80));
  Outcome const nothing = gladstone(arguments({"A_*.tif", "B_*.tif"}, "none/", {"--json"}));
  EXPECT_EQ(nothing.exit_code, 2) << nothing.err;
  expect_error_in(nothing, "undetermined at none", {"5 pairs"});
}

// The first image has another size than the others: it alone is named, and its pair fails.
TEST_F(Sequences, HaveTheCommonestSize) {
  write_pairs({{1, 0}, {1, 0}, {1, 0}});
  write_image("A_8.tif", dots_at({}, 1, 80));
  Outcome const outcome = gladstone(arguments({"A_*.tif", "B_*.tif"}, "out/", {"--json"}));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  auto const json = nlohmann::json::parse(outcome.out);
  expect_warning_in(json, "failed at A_8.h5", {"A_8.tif", "80 x 64 px", "B_8.tif", "64 x 64 px"});
  EXPECT_EQ(json["done"], 2);
  EXPECT_EQ(read_state("out")["pixels"], (std::vector<int>{side, side}));
}

// Without any valid vector the exit code is 2, as without any correlated pair.
TEST_F(Sequences, FailIfNoPairHasAValidVector) {
  for (char const* name : {"A_1.tif", "A_2.tif", "B_1.tif", "B_2.tif"})
    write_image(name, Image<std::uint16_t>(side, side, 7));
  Outcome const outcome = gladstone(arguments({"A_*.tif", "B_*.tif"}, "out/", {"--json"}));
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  expect_error_in(outcome, "undetermined at out", {"2 pairs"});
}

// An input that is missing or no image is named as such, not as a sequence that is too short.
TEST_F(Sequences, NameAnUnreadableFile) {
  expect_error(arguments({"none.tif"}, "out/", {"--pairing", "consecutive"}), 2, "missing_file at none.tif");
  write("text.tif", "not an image");
  expect_error(arguments({"text.tif"}, "out/", {"--pairing", "consecutive"}), 2, "wrong_format at text.tif");
  write_stack("one.tif", {dots_at({})});
  expect_error(arguments({"one.tif"}, "out/", {"--pairing", "consecutive"}), 2, "arguments at one.tif");
}

// Files of an earlier run that were cut short are named, and computed again.
TEST_F(Sequences, ReplaceDamagedResults) {
  write_pairs({{1.5, 0.5}, {-0.75, 1}, {1, 1}});
  auto const command = arguments({"A_*.tif", "B_*.tif"}, "out/");
  succeed(command);
  for (char const* name : {"out/A_9.h5", "out/statistics.h5"}) std::filesystem::resize_file(in(name), 1000);
  auto json = command;
  json.emplace_back("--json");
  Outcome const outcome = gladstone(json);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  auto const result = nlohmann::json::parse(outcome.out);
  expect_warning_in(result, "incomplete at A_9.h5");
  EXPECT_THAT(outcome.err, HasSubstr("out/statistics.h5: ")) << "found after the result has been composed";
  EXPECT_EQ(result["done"], 3);
  EXPECT_EQ(result["resumed"], 2);
  succeed(arguments({"A_*.tif", "B_*.tif"}, "whole/"));
  for (char const* name : {"/A_9.h5", "/statistics.h5"})
    expect_same_datasets(std::string("out") + name, std::string("whole") + name);
}

// Killed after its second pair, the run continues with the third; the result is that of an uninterrupted run. Other
// settings or other frames are computed anew.
TEST_F(Sequences, ContinueAfterAKill) {
  std::vector<Vec2d> const shifts{{1.5, 0.5}, {-0.75, 1}, {2.25, -1.5}, {0.5, 0}};
  write_pairs(shifts);
  auto const command = arguments({"A_*.tif", "B_*.tif"}, "out/", {"--threads", "1"});
  {
    Program program(command, folder_, stopping_at("pair-finished:2"));
    ASSERT_TRUE(program.wait_until_stopped());
    expect_error(command, 2, "output at out");
    EXPECT_EQ(read_state("out")["complete"], false);
    program.send(SIGKILL);
    EXPECT_EQ(program.finish(hang_limit).signal, SIGKILL);
  }
  EXPECT_THAT(names("out"), testing::Contains("A_9.h5"));
  EXPECT_THAT(names("out"), testing::Not(testing::Contains("A_10.h5")));
  auto const json = json_of(command);
  EXPECT_EQ(json["done"], 4);
  EXPECT_EQ(json["resumed"], 2);
  succeed(arguments({"A_*.tif", "B_*.tif"}, "whole/", {"--threads", "3"}));
  for (char const* name : {"/A_8.h5", "/A_9.h5", "/A_10.h5", "/A_11.h5", "/statistics.h5"})
    expect_same_datasets(std::string("out") + name, std::string("whole") + name);
  EXPECT_EQ(Hdf5Reader(in("out/statistics.h5").string()).attribute("sequence_sha256"),
            Hdf5Reader(in("whole/statistics.h5").string()).attribute("sequence_sha256"));

  write_image("B_9.tif", dots_at({3, 0}, 2));
  EXPECT_EQ(json_of(command)["resumed"], 3);
  expect_shift("out/A_9.h5", {3, 0});
  auto changed = command;
  changed.insert(changed.end(), {"--set", "correlate.overlap=0.25"});
  EXPECT_EQ(json_of(changed)["resumed"], 0);
}

// Killed while a file is incomplete, a run leaves nothing that the next one takes for a result.
TEST_F(Sequences, NeverStoreIncompleteVectors) {
  write_pairs({{1.5, 0.5}, {-0.75, 1}});
  auto const command = arguments({"A_*.tif", "B_*.tif"}, "out/", {"--threads", "1"});
  {
    Program program(command, folder_, stopping_at("file-written:2"));  // the first is sequence.json
    ASSERT_TRUE(program.wait_until_stopped());
    program.send(SIGKILL);
    program.finish(hang_limit);
  }
  EXPECT_THAT(names("out"), testing::Not(testing::Contains("A_8.h5")));
  EXPECT_EQ(json_of(command)["resumed"], 0);
  EXPECT_THAT(names("out"), ElementsAre("A_8.h5", "A_9.h5", "sequence.json", "statistics.h5", "statistics.png"));
}

// Ctrl-C ends the run with exit code 130 and retains the finished pairs.
TEST_F(Sequences, EndOnInterrupt) {
  write_pairs({{1.5, 0.5}, {-0.75, 1}, {1, 1}});
  auto const command = arguments({"A_*.tif", "B_*.tif"}, "out/", {"--threads", "1", "--quiet"});
  auto json = command;
  json.emplace_back("--json");
  Program program(json, folder_, stopping_at("pair-finished"));
  ASSERT_TRUE(program.wait_until_stopped());
  program.send(SIGINT);
  program.send(SIGCONT);
  Outcome const outcome = program.finish(hang_limit);
  EXPECT_EQ(outcome.exit_code, 130);
  expect_error_in(outcome, "interrupted at ", {"1 of 3 pairs"});
  EXPECT_EQ(json_of(command)["resumed"], 1);
}

// On a full disk the run ends with the file that could not be written. Once there is room, the same command continues
// with the pairs that are missing.
TEST_F(Sequences, ContinueAfterAFullDisk) {
  write_pairs({{1.5, 0.5}, {-0.75, 1}, {1, 1}, {0.5, 0}});
  succeed(arguments({"A_*.tif", "B_*.tif"}, "whole/"));
  auto const bytes = static_cast<std::size_t>(std::filesystem::file_size(in("whole/A_8.h5")));
  pid_t const child = ::fork();
  if (child == 0) {
    std::filesystem::create_directory(in("disk"));
    bool const mounted = ::unshare(CLONE_NEWNS) == 0 &&
                         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         ::mount("none", in("disk").c_str(), "tmpfs", 0, "size=4m") == 0;
    if (!mounted) ::_exit(77);
    std::error_code error;
    // Room for two files of vectors, twice sequence.json (as it is replaced) and a part of the third file.
    write("disk/filler",
          std::string(std::filesystem::space(in("disk"), error).available - 2 * bytes - bytes / 2 - 32768, 'x'));
    std::filesystem::create_directory(in("disk/out"));
    auto const command = arguments({"A_*.tif", "B_*.tif"}, "disk/out/", {"--threads", "1"});
    Outcome const full = gladstone(command);
    write("full", full.err);
    std::filesystem::remove(in("disk/filler"));
    write("again", succeed(command));
    ::_exit(full.exit_code == 2 ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "no mount namespace here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_THAT(read("full"), AllOf(HasSubstr("disk/out/A_"), HasSubstr("No space left on device")));
  EXPECT_THAT(read("again"), testing::ContainsRegex(R"(4 of 4 pairs correlated \([1-3] by an earlier run\))"));
}

// Statistics of the stored vectors, computed here by their definitions; and their truth: uniform shifts, whose mean and
// standard deviation the measurement reproduces within its own error.
TEST_F(Sequences, HaveTheStatisticsOfTheirVectors) {
  std::vector<Vec2d> const shifts{{1.5, 0.5}, {0.75, 1}, {2.25, -0.5}, {1, 0}, {2, 0.25}, {1.25, -1}};
  write_pairs(shifts);
  succeed(arguments({"A_*.tif", "B_*.tif"}, "out/"));
  Hdf5Reader const file(in("out/statistics.h5").string());
  std::size_t const points = file.read("/x_px").size();
  std::vector<std::vector<Vec2d>> series(points);
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    Hdf5Reader const one(in("out/A_" + std::to_string(8 + k) + ".h5").string());
    auto const u = one.read("/u_px"), v = one.read("/v_px"), reason = one.read("/reason");
    ASSERT_EQ(u.size(), points);
    EXPECT_EQ(one.read("/x_px"), file.read("/x_px"));
    for (std::size_t i = 0; i < points; ++i)
      if (reason[i] <= 1) series[i].push_back({u[i], v[i]});
  }
  auto const count = file.read("/count"), mean = file.read("/u_mean_px"), rms = file.read("/v_rms_px"),
             uv = file.read("/uv_px2"), error = file.read("/u_mean_error_px"), number = file.read("/u_independent");
  for (std::size_t i = 0; i < points; ++i) {
    auto const n = static_cast<double>(series[i].size());
    ASSERT_EQ(count[i], n);
    if (n < 2) continue;
    Vec2d m;
    for (Vec2d const& d : series[i]) m += (1 / n) * d;
    double uu = 0, vv = 0, both = 0;
    for (Vec2d const& d : series[i]) {
      uu += (d.x - m.x) * (d.x - m.x);
      vv += (d.y - m.y) * (d.y - m.y);
      both += (d.x - m.x) * (d.y - m.y);
    }
    EXPECT_NEAR(mean[i], m.x, 1e-12);
    EXPECT_NEAR(rms[i], std::sqrt(vv / (n - 1)), 1e-12);
    EXPECT_NEAR(uv[i], both / (n - 1), 1e-12);
    EXPECT_NEAR(error[i], std::sqrt(uu / n / (number[i] - 1)), 1e-12);
    EXPECT_TRUE(number[i] >= 1 && number[i] <= n);
  }
  Vec2d truth;
  for (Vec2d const& d : shifts) truth += (1.0 / 6) * d;
  double variance = 0;
  for (Vec2d const& d : shifts) variance += (d.y - truth.y) * (d.y - truth.y) / 5;
  auto const x = file.read("/x_px"), y = file.read("/y_px");
  for (std::size_t i = 0; i < points; ++i) {
    if (std::min(x[i], y[i]) < 16 || std::max(x[i], y[i]) > side - 16 || count[i] < 6) continue;
    EXPECT_NEAR(mean[i], truth.x, 0.1);
    EXPECT_NEAR(rms[i], std::sqrt(variance), 0.1);
  }
}

// Dots move over a bright pattern at rest. Without subtraction the windows find the pattern; the background of the
// sequence, which no `frame` lists, removes it.
TEST_F(Sequences, SubtractTheirOwnBackground) {
  Image<std::uint16_t> const still = dots_at({}, 99);
  for (int k = 0; k < 7; ++k)
    for (auto const& [letter, shift] : {std::pair('A', 0.0), std::pair('B', 2.0)}) {
      Image<std::uint16_t> image = dots_at({shift, 0}, static_cast<unsigned>(k + 1));
      for (std::size_t i = 0; i < image.size(); ++i)
        image.data()[i] = static_cast<std::uint16_t>(image.data()[i] / 8 + still.data()[i] / 2);
      write_image(fmt::format("{}_{}.tif", letter, k), image);
    }
  succeed(arguments({"A_*.tif", "B_*.tif"}, "raw/"));
  EXPECT_NEAR(mean_of("raw/A_3.h5").x, 0, 0.3);
  for (std::string const statistic : {"minimum", "mean", "median"}) {
    write("config.toml",
          "[correlate]\nwindow_px = [32, 16]\noverlap = 0.5\n[[correlate.preprocess]]\nkind = \"background\"\n"
          "subtract = \"" +
              statistic + "\"\n");
    succeed(arguments({"A_*.tif", "B_*.tif"}, statistic + "/"));
    Vec2d const mean = mean_of(statistic + "/A_3.h5");
    EXPECT_NEAR(mean.x, 2, 0.2) << statistic;
    EXPECT_NEAR(mean.y, 0, 0.2) << statistic;
    EXPECT_NE(Hdf5Reader(in(statistic + "/A_3.h5").string()).attribute("background_1_flow_sha256"), "");
  }
  expect_error(arguments({"A_0.tif", "B_0.tif"}, "v.h5"), 2, "missing_key at config.toml:4:1");
}

TEST_F(Sequences, RefuseForeignFoldersAndUnsuitableSettings) {
  write_pairs({{1, 0}, {1, 0}});
  std::filesystem::create_directory(in("mine"));
  write("mine/notes.txt", "important");
  expect_error(arguments({"A_*.tif", "B_*.tif"}, "mine"), 2, "output at mine");
  expect_error(arguments({"A_*.tif", "B_*.tif"}, "."), 2, "output at .");
  expect_error(arguments({"A_*.tif", "B_*.tif"}, "out/", {"--pairing", "all"}), 2, "arguments at --pairing");
  write("config.toml", "[correlate]\nwindow_px = [128]\n");
  expect_error(arguments({"A_*.tif", "B_*.tif"}, "out/"), 2, "wrong_shape at A_8.tif");
  // Scattered vectors are at other points for each pair, so that there are no statistics.
  write("config.toml", "[correlate]\nmethod = \"tracking\"\n[correlate.tracking]\noutput = \"scattered\"\n");
  expect_error(arguments({"A_*.tif", "B_*.tif"}, "out/"), 2, "unsupported at correlate.tracking.output");
}

// docs/file-formats.md names the datasets of statistics.h5 and the keys of sequence.json.
TEST_F(Sequences, AreDocumented) {
  write_pairs({{1, 0}, {0, 1}});
  std::filesystem::remove(in("B_9.tif"));
  Outcome const outcome = gladstone(arguments({"A_*.tif", "B_*.tif"}, "out/"));
  EXPECT_EQ(outcome.exit_code, 1);
  Hdf5Reader const file(in("out/statistics.h5").string());
  std::set<std::string> documented;
  for (auto const& cells : test::documented_table("The folder of a sequence", "dataset"))
    for (std::string const& name : test::names_of(cells[0])) documented.insert(name);
  auto const datasets = file.number_datasets();
  EXPECT_EQ(std::set<std::string>(datasets.begin(), datasets.end()), documented);
  for (char const* attribute : {"samples", "lags", "grid_columns", "grid_rows", "settings_sha256", "sequence_sha256"})
    EXPECT_NE(file.attribute(attribute), "") << attribute;
  std::set<std::string> keys;
  for (auto const& cells : test::documented_table("The folder of a sequence", "key"))
    for (std::string const& name : test::names_of(cells[0])) keys.insert(name);
  auto const state = read_state("out");
  for (auto const& item : state.items()) {
    if (item.key() != "pairs") {
      EXPECT_TRUE(keys.contains(item.key())) << item.key();
    }
  }
  for (auto const& pair : state["pairs"])
    for (auto const& item : pair.items()) EXPECT_TRUE(keys.contains("pairs[]." + item.key())) << item.key();
}

}  // namespace
}  // namespace gladstone::end_to_end
