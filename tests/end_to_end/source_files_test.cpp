#include "render/files/source_files.h"

#include <fmt/format.h>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// Results record their source files, and are rejected if these have changed.
class Sources : public ProgramFixture {
 protected:
  std::string attribute(std::string const& file, std::string const& name) const {
    return Hdf5Reader(in(file).string()).attribute(name);
  }
  nlohmann::json errors() const { return nlohmann::json::parse(read("case/errors.json")); }
  /// Runs a command, and at a point at which everything has been read, renders another case into the same folder.
  Outcome rendered_under(std::vector<std::string> arguments, std::string const& point) const {
    Program program(std::move(arguments), folder_, stopping_at(point));
    EXPECT_TRUE(program.wait_until_stopped());
    render("case", {"--set", "target.seed=8"});
    program.send(SIGCONT);
    return program.finish(hang_limit);
  }
};

TEST_F(Sources, VectorsNameTheirFramesAndErrorsTheirVectorsAndTruth) {
  render("case");
  succeed({"correlate", "case"});
  Outcome const outcome = gladstone({"compare", "case", "--no-figures"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("warning"))) << "the case is consistent";
  auto const summary = nlohmann::json::parse(read("case/summary.json"));
  for (std::string const frame : {"reference", "flow"}) {
    std::string const hash = pixel_sha256(in("case/" + frame + ".tif").string());
    EXPECT_EQ(attribute("case/truth.h5", frame + "_sha256"), hash);
    EXPECT_EQ(attribute("case/vectors.h5", frame + "_sha256"), hash);
    EXPECT_EQ(summary[frame + "_sha256"], hash);
    EXPECT_EQ(errors()["made_from"][frame + "_sha256"], hash);
  }
  EXPECT_EQ(errors()["made_from"]["vectors_sha256"], dataset_sha256(in("case/vectors.h5").string()));
  EXPECT_EQ(errors()["made_from"]["truth_sha256"], dataset_sha256(in("case/truth.h5").string()));
  EXPECT_EQ(errors()["made_from"]["frames"], "verified");
}

TEST_F(Sources, EqualContentGivesEqualHashes) {
  for (std::string const name : {"a", "b"}) {
    render(name);
    succeed({"correlate", name});
    succeed({"compare", name, "--no-figures"});
  }
  EXPECT_EQ(read("a/errors.json"), read("b/errors.json"));
}

TEST_F(Sources, FramesThatAreReplacedWhileTheyAreCorrelatedGiveNoVectors) {
  render("case");
  Outcome const outcome = rendered_under({"correlate", "case", "--json"}, "correlating");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  expect_error_in(outcome, "changed at setup.toml", {"gladstone correlate case"});
  EXPECT_FALSE(std::filesystem::exists(in("case/vectors.h5")));
  succeed({"correlate", "case"});
  succeed({"compare", "case", "--no-figures"});
}

TEST_F(Sources, ACaseThatIsReplacedWhileItIsComparedGivesNoErrors) {
  render("case");
  succeed({"correlate", "case"});
  Outcome const outcome = rendered_under({"compare", "case", "--no-figures", "--json"}, "comparing");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(errors_in(outcome.out), testing::ElementsAre(testing::StartsWith("changed at "))) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(in("case/errors.json")));
}

TEST_F(Sources, VectorsOfOtherFramesAreRefusedByName) {
  render("case");
  succeed({"correlate", "case"});
  std::filesystem::copy(in("case/vectors.h5"), in("old.h5"));
  render("case", {"--set", "target.seed=8"});
  expect_error({"compare", "case", "--vectors", "old.h5"}, 2, "inconsistent at old.h5",
               {"case/truth.h5", "gladstone correlate case"});
  succeed({"correlate", "case"});
  // identical frames of another case are accepted
  render("other", {"--set", "target.seed=8"});
  succeed({"compare", "other", "--vectors", "case/vectors.h5", "--no-figures"});
}

TEST_F(Sources, VectorsThatTellNoFramesReadUnverified) {
  render("case");
  succeed({"correlate", "case", "-o", "v.csv"});
  EXPECT_THAT(warnings_in(json_of({"compare", "case", "--vectors", "v.csv", "--no-figures"})),
              testing::ElementsAre("assumed at v.csv"));
  EXPECT_EQ(errors()["made_from"]["frames"], "unverified");
  EXPECT_EQ(errors()["made_from"]["vectors_sha256"], byte_sha256(in("v.csv").string()));
}

TEST_F(Sources, RaysThatAreReplacedWhileTheyAreTracedGiveNoTable) {
  std::filesystem::create_directory(in("case"));
  std::string rays = "x_mm,y_mm,z_mm,dx,dy,dz\n";
  for (int i = 0; i < 20; ++i) rays += fmt::format("{},0,-250,0,0,1\n", i * 0.1);
  write("rays.csv", rays);
  Program program({"trace", "setup.toml", "--rays", "rays.csv", "-o", "case/ends.csv", "--json"}, folder_,
                  stopping_at("tracing-rays"));
  ASSERT_TRUE(program.wait_until_stopped());
  write("rays.csv", rays + "0,0,-250,0,0,1\n");
  program.send(SIGCONT);
  Outcome const outcome = program.finish(hang_limit);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  expect_error_in(outcome, "changed at rays.csv");
  EXPECT_TRUE(names("case").empty());
}

// The medium of the truth is traced again for the positions of the vectors.
TEST_F(Sources, AnInputThatHasChangedSinceTheCaseWasRenderedIsRefusedByName) {
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n-0.5,0.75\n0.5,-0.5\n-1,-1\n");
  write("points.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  render("case", {}, "points.toml");
  succeed({"correlate", "case"});
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n");
  expect_error({"compare", "case"}, 2, "changed at dots.csv");
}

TEST_F(Sources, AnInputThatIsReplacedWhileItIsRenderedGivesNoCase) {
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n");
  write("points.toml", with(with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""),
                            "[64, 64]", "[64, 64]\nexposure = 1e4"));
  Program program({"render", "points.toml", "-o", "case", "--json"}, folder_, stopping_at("rendering"));
  ASSERT_TRUE(program.wait_until_stopped());  // the dots have been read by then
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,-0.25\n");
  program.send(SIGCONT);
  Outcome const outcome = program.finish(hang_limit);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  expect_error_in(outcome, "changed at dots.csv");
  EXPECT_FALSE(std::filesystem::exists(in("case")));
}

// The second writer starts while the first one renders (into no case, then over one), or while it replaces the files.
TEST_F(Sources, TwoRenderingsIntoOneCaseAtATimeLeaveOneOfThemWhole) {
  render("a", {"--set", "target.seed=8"});
  render("b", {"--set", "target.seed=9"});
  for (std::string const point : {"rendering", "rendering", "replacement-begun", "replacement-retired"}) {
    Program second({"render", "setup.toml", "-o", "case", "--set", "target.seed=9"}, folder_, stopping_at("rendering"));
    ASSERT_TRUE(second.wait_until_stopped());
    Program first({"render", "setup.toml", "-o", "case", "--set", "target.seed=8"}, folder_, stopping_at(point));
    ASSERT_TRUE(first.wait_until_stopped()) << point;
    bool const one_by_one = point == "rendering";
    second.send(SIGCONT);
    if (one_by_one) {
      EXPECT_EQ(second.finish(hang_limit).exit_code, 0);
    }
    first.send(SIGCONT);
    EXPECT_EQ(first.finish(hang_limit).exit_code, 0);
    if (!one_by_one) {
      EXPECT_EQ(second.finish(hang_limit).exit_code, 0);
    }
    expect_same_case(one_by_one ? "a" : "b", "case");  // the writer that replaces the files last
    EXPECT_EQ(names("case").size(), 5u) << testing::PrintToString(names("case"));
    EXPECT_EQ(names(), (std::vector<std::string>{"a", "b", "case", "setup.toml"}));
    succeed({"correlate", "case"});
    succeed({"compare", "case", "--no-figures"});
  }
}

TEST_F(Sources, TablesOfAStudyNameItsManifest) {
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 11]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  succeed({"sweep", "run", "run"});
  succeed({"sweep", "collect", "run", "--no-figures"});
  EXPECT_EQ(attribute("run/study.h5", "manifest_sha256"), byte_sha256(in("run/manifest.jsonl").string()));
}

TEST_F(Sources, KeptCasesOfAStudyAreVerifiedLikeOthers) {
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  succeed({"sweep", "run", "run", "--keep-images"});
  auto const kept = nlohmann::json::parse(read("run/cases/0/errors.json"));
  EXPECT_EQ(kept["made_from"]["frames"], "verified");
  succeed({"compare", "run/cases/0", "--no-figures"});
  EXPECT_EQ(nlohmann::json::parse(read("run/cases/0/errors.json"))["made_from"], kept["made_from"]);
}

}  // namespace
}  // namespace gladstone::end_to_end
