// `gladstone init` writes templates that run as they are.
#include <sstream>

#include "render/setup/setup_node.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

constexpr char const* template_kinds[] = {"bos", "piv", "stereo", "calibration", "study", "design"};

class Init : public ProgramFixture {
 protected:
  void write_template(std::string const& kind) const {
    succeed({"init", kind, "-o", kind + ".toml", "--quiet"});
    EXPECT_EQ(read(kind + ".toml"), succeed({"init", kind}));
  }
  /// Runs a command and expects no warning: a template should not begin with one.
  void run_well(std::vector<std::string> arguments) const {
    arguments.emplace_back("--quiet");
    Outcome const outcome = gladstone(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << arguments[0] << ": " << outcome.err;
    EXPECT_EQ(outcome.err, "") << arguments[0];
  }
  void render_and_compare(std::string const& setup, std::vector<std::string> const& cases) const {
    run_well({"render", setup, "-o", "case"});
    for (std::string const& folder : cases) {
      run_well({"correlate", folder});
      run_well({"compare", folder, "-o", folder + "-errors"});
      auto const truth = nlohmann::json::parse(read(folder + "-errors/errors.json")).at("ray_truth");
      EXPECT_GT(truth.at("valid_fraction"), 0.95) << folder;
      EXPECT_LT(truth.at("rms_px"), 0.1) << folder;
    }
  }
};

TEST_F(Init, BosTemplateIsRenderedCorrelatedAndCompared) {
  write_template("bos");
  render_and_compare("bos.toml", {"case"});
}

TEST_F(Init, PivTemplateIsRenderedCorrelatedAndCompared) {
  write_template("piv");
  render_and_compare("piv.toml", {"case"});
}

TEST_F(Init, StereoTemplateIsRenderedCorrelatedAndCompared) {
  write_template("stereo");
  render_and_compare("stereo.toml", {"case/left", "case/right"});
}

// The dots of every plane are detected and a camera is fitted, without a warning.
TEST_F(Init, CalibrationTemplateIsRenderedAndFitted) {
  write_template("calibration");
  run_well({"render", "calibration.toml", "-o", "case"});
  run_well({"calibrate", "case", "--no-figures"});
  EXPECT_TRUE(std::filesystem::exists(in("case/calibration.h5")));
}

// The next command is the one that writes the setup to be varied, unless that exists.
TEST_F(Init, StudyTemplateIsPlannedFromTheBosTemplate) {
  EXPECT_EQ(json_of({"init", "study", "-o", "first.toml"}).at("next"), "gladstone init bos -o bos.toml");
  write_template("bos");
  EXPECT_EQ(json_of({"init", "study", "-o", "second.toml"}).at("next"),
            "gladstone sweep plan second.toml -o out/study");
  write_template("study");
  run_well({"sweep", "plan", "study.toml", "-o", "run"});
  EXPECT_EQ(json_of({"sweep", "status", "run"}).at("missing"), 9) << "3 f-numbers, 3 distances";
}

TEST_F(Init, DesignTemplateIsAnswered) {
  write_template("design");
  auto const answer = json_of({"design", "design.toml", "--verify", "0"});
  EXPECT_EQ(answer.at("feasible"), true);
  EXPECT_EQ(answer.at("warnings").size(), 0u) << answer.at("warnings");
}

// Apart from schema, experiment and names a template of a setup has ten keys that matter, each with its reason.
TEST_F(Init, TemplatesOfSetupsAreShortAndExplainEachKey) {
  for (std::string const kind : {"bos", "piv", "calibration"}) {
    std::istringstream lines(succeed({"init", kind}));
    int keys = 0;
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), 120u) << line;
      auto const equals = line.find(" = ");
      if (line.starts_with("#") || equals == std::string::npos) continue;
      std::string const key = line.substr(0, equals);
      if (key == "schema" || key == "experiment" || key == "kind") continue;
      EXPECT_THAT(line, HasSubstr("  # [")) << kind << " lacks the unit of " << key;
      ++keys;
    }
    EXPECT_EQ(keys, 10) << kind;
  }
}

TEST_F(Init, DoesNotOverwriteAFile) {
  write("mine.toml", "precious = true\n");
  expect_error({"init", "bos", "-o", "mine.toml"}, 2, "output at mine.toml");
  expect_error({"init", "bos", "--all", "-o", "mine.toml"}, 2, "output at mine.toml");
  std::filesystem::create_symlink("nowhere.toml", in("link.toml"));
  EXPECT_EQ(gladstone({"init", "bos", "-o", "link.toml"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(in("nowhere.toml")));
}

TEST_F(Init, NamesTheFileInItsCommands) {
  std::string const next = json_of({"init", "piv", "-o", "tunnel.toml"}).at("next");
  EXPECT_EQ(next, "gladstone render tunnel.toml -o out/piv");
  EXPECT_THAT(read("tunnel.toml"), HasSubstr("#   " + next + '\n'));
}

TEST_F(Init, RefusesAnUnknownKind) { expect_error({"init", "bose"}, 2, "arguments at kind", {"bose", "\"bos\""}); }

// Without the comment signs the keys with a default form a valid TOML document of values, one table at a time.
TEST_F(Init, CompleteListsAreSetupsAndHoldTomlValues) {
  for (std::string const kind : template_kinds) {
    std::string const all = succeed({"init", kind, "--all"});
    EXPECT_FALSE(parse_toml(all, kind).members.empty());
    std::istringstream lines(all);
    int keys = 0;
    for (std::string line; std::getline(lines, line);) {
      auto const equals = line.find(" = "), comment = line.find("  # ");
      if (!line.starts_with("# ") || equals == std::string::npos || comment == std::string::npos || comment < equals)
        continue;
      std::string const value = line.substr(equals + 3, comment - equals - 3);
      EXPECT_TRUE(value == "..." || parse_toml_value(value)) << line;
      ++keys;
    }
    EXPECT_GE(keys, kind == "study" ? 4 : 60) << kind;
  }
  EXPECT_THAT(succeed({"init", "bos", "--all"}), HasSubstr("# f_number = 11.0  # [1] "));
}

// The complete lists of setups are read as they are, with every default.
TEST_F(Init, CompleteListsAreAccepted) {
  for (std::string const kind : {"bos", "piv", "calibration"}) {
    succeed({"init", kind, "--all", "-o", kind + "_all.toml"});
    render(kind, {"--set", "camera.pixels=[64, 64]", "--set", "render.rays_per_dot=16"}, kind + "_all.toml");
  }
}

// A key that another kind of experiment refuses is not offered.
TEST_F(Init, CompleteListsHaveNoKeyOfAnotherKind) {
  for (std::string const kind : {"bos", "design"})
    EXPECT_THAT(succeed({"init", kind, "--all"}), HasSubstr("\n# z_d_mm = 250.0  # [mm]")) << kind;
  for (std::string const kind : {"piv", "stereo", "calibration"})
    EXPECT_THAT(succeed({"init", kind, "--all"}), testing::Not(HasSubstr("z_d_mm"))) << kind;
  EXPECT_EQ(json_of({"keys", "geometry.z_d_mm"})["keys"][0]["kinds"], nlohmann::json::array({"bos", "design"}));
}

// The axes of the complete list show a list, both kinds of ranges and a label, and are a study.
TEST_F(Init, CompleteListOfAStudyIsPlanned) {
  succeed({"init", "bos", "-o", "bos.toml"});
  succeed({"init", "study", "--all", "-o", "study.toml"});
  for (std::string const word : {"= [5.6, 11, 22]", "{ linear = [", "{ log = [", "{ label = "})
    EXPECT_THAT(read("study.toml"), HasSubstr(word));
  succeed({"sweep", "plan", "study.toml", "-o", "run"});
  EXPECT_EQ(json_of({"sweep", "status", "run"}).at("missing"), 27);
}

// Both cameras of the stereoscopic template, and every key of a camera with the first one.
TEST_F(Init, CompleteListOfStereoHasBothCameras) {
  succeed({"init", "stereo", "-o", "stereo.toml"});
  succeed({"init", "stereo", "--all", "-o", "all.toml"});
  auto few = json_of({"info", "setup", "stereo.toml"}), all = json_of({"info", "setup", "all.toml"});
  EXPECT_EQ(all["cameras"].size(), 2u);
  EXPECT_EQ(all["cameras"], few["cameras"]) << "the keys that are given are those of the short template";
  std::string const text = read("all.toml");
  for (std::string const key : {"\n# noise.read_noise_e = ", "\n# pose.roll_deg = ", "\n# sensor.tilt_deg = ",
                                "\n[lens]\n", "\n# transmittance = ", "\n# background."})
    EXPECT_THAT(text, HasSubstr(key));
  EXPECT_EQ(text.find("# pose.look_at_mm"), std::string::npos) << "is given";
}

}  // namespace
}  // namespace gladstone::end_to_end
