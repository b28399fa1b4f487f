#include "render/base/source_files.h"

#include <fmt/format.h>

#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

/// Results say which files they are made from, and are refused where those are others.
class Sources : public Workplace {
 protected:
  std::string attribute(std::string const& file, std::string const& name) const {
    return Hdf5Reader(in(file).string()).attribute(name);
  }
  nlohmann::json errors() const { return nlohmann::json::parse(read("case/errors.json")); }
  /// Starts a command and waits until it has begun: it has tried its place.
  std::unique_ptr<Program> start(std::vector<std::string> arguments, std::string const& partial) const {
    auto program = std::make_unique<Program>(std::move(arguments), folder_);
    auto const begun = [&] {
      auto const all = names("case");
      return std::any_of(all.begin(), all.end(), [&](std::string const& name) { return name.starts_with(partial); });
    };
    for (int wait = 0; wait < 2000 && !begun(); ++wait) std::this_thread::sleep_for(1ms);
    EXPECT_TRUE(begun());
    return program;
  }
  /// A correlation or comparison of seconds, and while it goes on another rendering into the same case.
  /// @param seconds of computing after which everything has been read
  Outcome rendered_under(std::vector<std::string> arguments, std::string const& partial, double seconds) const {
    auto const program = start(std::move(arguments), partial);
    program->wait_until_computed(seconds);
    program->send(SIGSTOP);
    render("case", {"--set", "target.seed=8"}, "large.toml");
    program->send(SIGCONT);
    return program->finish(60s);
  }
  void write_large_setup() const {
    write("large.toml", with(with(small_setup, "[64, 64]", "[512, 512]"), "[32, 16]\noverlap = 0.5",
                             "[64, 32, 32]\noverlap = 0.75\nmethod = \"mqd\""));
  }
};

TEST_F(Sources, VectorsNameTheirFramesAndErrorsTheirVectorsAndTruth) {
  render("case");
  succeed({"correlate", "case"});
  Outcome const outcome = gladstone({"compare", "case", "--no-figures"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("warning"))) << "all is as it should be";
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
  write_large_setup();
  render("case", {}, "large.toml");
  Outcome const outcome = rendered_under({"correlate", "case", "--threads", "1"}, ".vectors.h5.partial-", 0.5);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("case/"), HasSubstr("has changed since it was read"),
                                 HasSubstr("run gladstone correlate case again")));
  EXPECT_FALSE(std::filesystem::exists(in("case/vectors.h5")));
  succeed({"correlate", "case"});
  succeed({"compare", "case", "--no-figures"});
}

TEST_F(Sources, ACaseThatIsReplacedWhileItIsComparedGivesNoErrors) {
  write_large_setup();
  render("case", {}, "large.toml");
  succeed({"correlate", "case"});
  Outcome const outcome =
      rendered_under({"compare", "case", "--no-figures", "--threads", "1"}, ".errors.json.partial-", 1.2);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("has changed since it was read"));
  EXPECT_FALSE(std::filesystem::exists(in("case/errors.json")));
}

TEST_F(Sources, VectorsOfOtherFramesAreRefusedByName) {
  render("case");
  succeed({"correlate", "case"});
  std::filesystem::copy(in("case/vectors.h5"), in("old.h5"));
  render("case", {"--set", "target.seed=8"});
  auto const refusal = {std::string("old.h5: was measured on other frames than case/truth.h5 belongs to"),
                        std::string("run gladstone correlate case again")};
  expect_refused({"compare", "case", "--vectors", "old.h5"}, 2, refusal);
  succeed({"correlate", "case"});
  // the same frames of another case are the same frames
  render("other", {"--set", "target.seed=8"});
  succeed({"compare", "other", "--vectors", "case/vectors.h5", "--no-figures"});
}

TEST_F(Sources, VectorsThatTellNoFramesReadUnverified) {
  render("case");
  succeed({"correlate", "case", "-o", "v.csv"});
  Outcome const outcome = gladstone({"compare", "case", "--vectors", "v.csv", "--no-figures"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("unverified: v.csv carries no SHA-256 of its frames")));
  EXPECT_EQ(outcome.err.find("warning"), outcome.err.rfind("warning")) << outcome.err;
  EXPECT_EQ(errors()["made_from"]["frames"], "unverified");
  EXPECT_EQ(errors()["made_from"]["vectors_sha256"], byte_sha256(in("v.csv").string()));
}

TEST_F(Sources, RaysThatAreReplacedWhileTheyAreTracedGiveNoTable) {
  std::filesystem::create_directory(in("case"));
  std::string rays = "x_mm,y_mm,z_mm,dx,dy,dz\n";
  for (int i = 0; i < 200000; ++i) rays += fmt::format("{},0,-250,0,0,1\n", i * 1e-5);
  write("rays.csv", rays);
  auto const program =
      start({"trace", "setup.toml", "--rays", "rays.csv", "-o", "case/ends.csv"}, ".ends.csv.partial-");
  program->send(SIGSTOP);
  write("rays.csv", rays + "0,0,-250,0,0,1\n");
  program->send(SIGCONT);
  Outcome const outcome = program->finish(60s);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("rays.csv: has changed since it was read"));
  EXPECT_TRUE(names("case").empty());
}

// What the truth was traced through is traced through again for the vectors' own places.
TEST_F(Sources, AnInputThatHasChangedSinceTheCaseWasRenderedIsRefusedByName) {
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n-0.5,0.75\n0.5,-0.5\n-1,-1\n");
  write("points.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  render("case", {}, "points.toml");
  succeed({"correlate", "case"});
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n");
  expect_refused({"compare", "case"}, 2,
                 {"dots.csv: has changed since case was rendered from it", "render the case again"});
}

TEST_F(Sources, AnInputThatIsReplacedWhileItIsRenderedGivesNoCase) {
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n");
  write("points.toml", with(with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""),
                            "[64, 64]", "[64, 64]\nexposure = 1e4"));
  Program program({"render", "points.toml", "-o", "case", "--set", "render.rays_per_dot=1000000"}, folder_);
  program.wait_until_computed(0.8);  // the dots have been read by then
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,-0.25\n");
  Outcome const outcome = program.finish(60s);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("dots.csv: has changed since it was read"), HasSubstr("nothing was written")));
  EXPECT_FALSE(std::filesystem::exists(in("case")));
}

TEST_F(Sources, TwoRenderingsIntoOneCaseAtATimeLeaveOneOfThemWhole) {
  render("a", {"--set", "target.seed=8"});
  render("b", {"--set", "target.seed=9"});
  for (int round = 0; round < 5; ++round) {
    Program one({"render", "setup.toml", "-o", "case", "--set", "target.seed=8"}, folder_);
    Program other({"render", "setup.toml", "-o", "case", "--set", "target.seed=9"}, folder_);
    EXPECT_EQ(one.finish(60s).exit_code, 0);
    EXPECT_EQ(other.finish(60s).exit_code, 0);
    std::string const winner = read("case/setup.toml") == read("a/setup.toml") ? "a" : "b";
    expect_same_case(winner, "case");
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
