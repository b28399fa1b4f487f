#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

namespace fs = std::filesystem;

/// No output replaces an input of the command, nor another part of a case or a study.
class OverwrittenInputs : public ProgramFixture {
 protected:
  /// Expects the command to end with exit code 2 and the name of the file, which is unchanged.
  /// @param code  of the error: "overwrites_input", or "output" for other files that are not to be replaced
  void expect_kept(std::string const& file, std::vector<std::string> arguments,
                   std::string const& code = "output") const {
    std::string const before = read(file);
    ASSERT_NE(before, "") << file;
    arguments.insert(arguments.end(), {"--quiet", "--json"});
    Outcome const outcome = gladstone(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(arguments) << outcome.err;
    auto const error = nlohmann::json::parse(outcome.out)["errors"][0];
    EXPECT_EQ(error["code"], code) << testing::PrintToString(arguments) << outcome.err;
    EXPECT_THAT(error["place"].get<std::string>(), testing::HasSubstr(file)) << "the file, or a figure inside it";
    EXPECT_TRUE(read(file) == before) << file << " is destroyed by " << testing::PrintToString(arguments);
  }
  /// Expects the command to be rejected because `output` is its input `file`, which is unchanged.
  void expect_input_kept(std::string const& file, std::vector<std::string> arguments, std::string const& output) const {
    std::string const before = read(file);
    ASSERT_NE(before, "") << file;
    arguments.emplace_back("--json");
    Outcome const outcome = gladstone(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(arguments) << outcome.err;
    expect_error_in(outcome, "overwrites_input at " + fs::path(output).filename().string());
    EXPECT_TRUE(read(file) == before) << file << " is destroyed by " << testing::PrintToString(arguments);
  }
};

TEST_F(OverwrittenInputs, OfACase) {
  render("case");
  succeed({"correlate", "case"});
  succeed({"compare", "case", "--no-figures"});
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-250,0,0,1\n");
  for (std::string const name :
       {"setup.toml", "truth.h5", "reference.tif", "flow.tif", "vectors.h5", "summary.json", "errors.json"}) {
    expect_kept("case/" + name, {"report", "case", "-o", "case/" + name});
    expect_kept("case/" + name, {"report", "case", "--format", "md", "-o", "case/" + name});
    expect_kept("case/" + name, {"trace", "setup.toml", "--rays", "rays.csv", "-o", "case/" + name});
  }
  for (std::string const name : {"truth.h5", "reference.tif"}) {
    expect_kept("case/" + name, {"report", "case", "--figures", "case/" + name});
    expect_kept("case/" + name, {"info", "mie", "--x", "5", "--m", "1.5", "--figure", "case/" + name});
  }
  expect_kept("case/truth.h5", {"correlate", "case", "-o", "case/truth.h5"}, "overwrites_input");
  expect_kept("case/truth.h5", {"correlate", "case/reference.tif", "case/flow.tif", "-o", "case/truth.h5"});
  // files of the same kind are still replaced
  succeed({"report", "case", "-o", "case/report.html"});
  succeed({"report", "case", "-o", "case/report.html"});
  succeed({"correlate", "case"});
  succeed({"compare", "case", "--no-figures"});
}

TEST_F(OverwrittenInputs, OfAStudy) {
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  succeed({"sweep", "run", "run", "--keep-images"});
  succeed({"sweep", "collect", "run", "--no-figures"});
  for (std::string const name :
       {"manifest.jsonl", "cases/0.json", "cases/0/truth.h5", "base.toml", "study.toml", "study.h5", "study.csv"}) {
    expect_kept("run/" + name, {"report", "run", "-o", "run/" + name});
  }
  std::vector<std::string> const collected{
      "manifest.jsonl", "cases/0.json", "cases/0/truth.h5", "cases/0/reference.tif",
      "study.toml",     "study.h5",     "study.csv"};
  auto const expect_kept_by_collect = [&](std::string const& folder, std::string const& name) {
    bool const is_input = std::count(collected.begin(), collected.end(), name) > 0;
    expect_kept(folder + name, {"sweep", "collect", "run", "--no-figures", "--dataset", folder + name},
                is_input ? "overwrites_input" : "output");
  };
  for (std::string const& name : collected) expect_kept_by_collect("run/", name);
  for (char const* const name : {"cases/0/vectors.h5", "cases/0/setup.toml", "base.toml"})
    expect_kept_by_collect("run/", name);
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-250,0,0,1\n");
  render("case");
  // also files without a signature, and under other names
  std::string const around = "../" + folder_.filename().string() + "/run/";
  fs::create_directory_symlink("run", in("link"));
  write("run/claims", "not empty, so that its loss is seen");
  for (std::string const name : {"claims", "study.csv"}) {
    for (std::string const& folder :
         {std::string("run/"), std::string("link/"), around, std::string("run/cases/../")}) {
      expect_kept(folder + name, {"report", "run", "-o", folder + name});
      expect_kept(folder + name, {"report", "run", "--format", "md", "-o", folder + name});
      expect_kept(folder + name, {"trace", "setup.toml", "--rays", "rays.csv", "-o", folder + name});
      expect_kept_by_collect(folder, name);
    }
  }
  expect_kept("run/study.csv", {"correlate", "case", "-o", "run/study.csv"});
  // also a file that does not exist yet
  expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", "run/study_points.csv"}, 2,
               "output at study_points.csv");
  EXPECT_FALSE(fs::exists(in("run/study_points.csv")));
  // files with other names in the same folder are written
  succeed({"trace", "setup.toml", "--rays", "rays.csv", "-o", "run/traced.csv"});
  // files of the same kind are still replaced
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16, 32]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  succeed({"sweep", "run", "run", "--keep-images"});
  for (int round = 0; round < 2; ++round) {
    succeed({"sweep", "collect", "run", "--no-figures", "--dataset", "run/set.h5"});
    succeed({"report", "run"});
  }
}

TEST_F(OverwrittenInputs, OfALensADesignAndAMeasurement) {
  write("lens.toml",
        "schema = 1\nf_number = 10.0\nfield_deg = [0.0]\n[[surface]]\nradius_mm = 51.5\nthickness_mm = 3.6\n"
        "index = 1.5168\nstop = true\n[[surface]]\nsemi_diameter_mm = 12.7\n");
  expect_kept("lens.toml", {"info", "lens", "lens.toml", "--figure", "lens.toml"}, "overwrites_input");
  std::string const question = with(small_setup, "[correlate]", R"([requirements]
objective = "gradient_min"
resolution_mm = 20.0
[limits]
z_total_max_mm = 2000.0
z_a_mm = [300.0, 1500.0]
z_d_mm = [100.0, 1200.0]
[free]
keys = ["geometry.z_a_mm", "geometry.z_d_mm"]
[correlate])");
  write("design.toml", question);
  expect_kept("design.toml", {"design", "design.toml", "--verify", "0", "--apply", "design.toml"}, "overwrites_input");
  render("case");
  expect_kept("case/setup.toml", {"design", "design.toml", "--verify", "0", "--apply", "case/setup.toml"});
  succeed({"design", "design.toml", "--verify", "0", "--apply", "best.toml"});
  succeed({"design", "design.toml", "--verify", "0", "--apply", "best.toml"});

  fs::create_directory(in("measured"));
  for (std::string const name : {"setup.toml", "reference.tif", "flow.tif"})
    fs::copy(in("case/" + name), in("measured/" + name));
  succeed({"correlate", "measured/reference.tif", "measured/flow.tif", "-o", "measured/vectors.h5"});
  expect_kept("measured/vectors.h5", {"report", "measured", "-o", "measured/vectors.h5"});
  expect_kept("measured/setup.toml", {"report", "measured", "-o", "measured/setup.toml"});
}

TEST_F(OverwrittenInputs, UnderOtherNames) {
  render("case");
  succeed({"correlate", "case"});
  // compare -o
  std::string const around = "../" + folder_.filename().string() + "/case/vectors.h5";
  for (std::string const name : {"soft", "hard", "around"}) fs::create_directory(in(name));
  fs::create_symlink("../case/vectors.h5", in("soft/errors.json"));
  fs::create_hard_link(in("case/vectors.h5"), in("hard/errors.json"));
  fs::create_symlink("../" + around, in("around/errors.json"));
  for (std::string const folder : {"soft", "hard", "around"}) {
    expect_input_kept("case/vectors.h5", {"compare", "case", "--no-figures", "-o", folder}, folder + "/errors.json");
  }
  // calibrate -o
  fs::copy(in("case/reference.tif"), in("plane.tif"));
  fs::create_symlink("../plane.tif", in("soft/calibration.h5"));
  fs::create_hard_link(in("plane.tif"), in("hard/calibration.h5"));
  for (std::string const folder : {"soft", "hard"}) {
    expect_input_kept("plane.tif", {"calibrate", "setup.toml", "--images", "plane.tif", "-o", folder},
                      folder + "/calibration.h5");
  }
}

// The case's own truth, given as vectors of another code, would be overwritten after it is read.
TEST_F(OverwrittenInputs, OfABenchmark) {
  fs::create_directories(in("bench/vortex"));
  for (std::string const name : {"soft", "hard"}) fs::create_directory(in(name));
  write("bench/vortex/truth.csv", "x_px,y_px,u_px,v_px\n0,0,1,1\n8,0,1,1\n");
  fs::create_symlink("../bench/vortex/truth.csv", in("soft/vortex.csv"));
  fs::create_hard_link(in("bench/vortex/truth.csv"), in("hard/vortex.csv"));
  std::string const around = "../" + folder_.filename().string() + "/soft";
  for (std::string const& folder : {std::string("soft"), std::string("hard"), around}) {
    expect_input_kept("bench/vortex/truth.csv",
                      {"benchmark", "-o", "bench", "--cases", "vortex", "--estimators", "none", "--no-figures",
                       "--vectors", "mine=" + folder},
                      "bench/vortex/truth.csv");
  }
  write("bench/vortex/reference.tif", "II*");
  write("bench/vortex/flow.tif", "II*");
  render("case");
  expect_kept("bench/vortex/truth.csv", {"correlate", "case", "-o", "bench/vortex/truth.csv"});
}

}  // namespace
}  // namespace gladstone::end_to_end
