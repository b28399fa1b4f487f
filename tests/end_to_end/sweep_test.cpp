#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "render/files/content_hash.h"
#include "render/files/image_file.h"
#include "studies/sweep/case_locks.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// Twelve cases that take a few milliseconds each.
constexpr char const* small_study = R"(base = "setup.toml"
[axes]
"lens.f_number" = [8, 16, 32]
"correlate.window_px" = [[32, 16], [16]]
[study]
repeats = 2
seed = 3
)";

/// Six cases long enough for several processes to share.
constexpr char const* slow_study = R"(base = "setup.toml"
[axes]
"lens.f_number" = [8, 16]
"render.rays_per_dot" = [1000, 1200, 1400]
)";

class Sweeps : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("study.toml", small_study);
  }
  void plan(std::string const& run, std::string const& study = "study.toml") const {
    succeed({"sweep", "plan", study, "-o", run, "--quiet", "--device", "cpu"});
  }
  /// Plans, runs and collects without disturbance.
  void finish(std::string const& run, std::string const& study = "study.toml") const {
    plan(run, study);
    succeed({"sweep", "run", run, "--quiet"});
    succeed({"sweep", "collect", run, "--no-figures", "--quiet"});
  }
  /// Replaces the first `old` of every line, and updates the hash: as if it had been planned.
  void plan_otherwise(std::string const& run, std::string const& old, std::string const& replacement) const {
    std::istringstream lines(read(run + "/manifest.jsonl"));
    std::string text;
    for (std::string line; std::getline(lines, line);) {
      line = line.substr(0, line.size() - std::string_view(",\"hash\":\"0123456789abcdef\"}").size()) + '}';
      if (std::size_t const at = line.find(old); at != std::string::npos) line.replace(at, old.size(), replacement);
      text += line.substr(0, line.size() - 1) + ",\"hash\":\"" + content_hash(line) + "\"}\n";
    }
    write(run + "/manifest.jsonl", text);
  }
  nlohmann::json status(std::string const& run) const { return json_of({"sweep", "status", run}); }

  /// Expects both study.h5 to contain identical data, except for times.
  void expect_same_study(std::string const& a, std::string const& b) const {
    Hdf5Reader const one(in(a + "/study.h5").string()), other(in(b + "/study.h5").string());
    auto const names = one.dataset_names();
    ASSERT_EQ(names, other.dataset_names());
    ASSERT_GT(names.size(), 90u);
    for (auto const& name : names) {
      if (name.starts_with("seconds_")) continue;
      auto const x = one.read(name), y = other.read(name);
      ASSERT_EQ(x.size(), y.size());
      EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0) << name;
    }
  }
  /// Files that show when each case was finished.
  std::map<std::string, std::filesystem::file_time_type> results(std::string const& run) const {
    std::map<std::string, std::filesystem::file_time_type> found;
    for (auto const& entry : std::filesystem::directory_iterator(in(run + "/cases"))) {
      if (entry.path().extension() == ".json") found[entry.path().filename().string()] = entry.last_write_time();
    }
    return found;
  }
};

// Half of the cases have saturated pixels.
TEST_F(Sweeps, CollectTellsThatCasesGaveWarnings) {
  write("bright.toml", "base = \"setup.toml\"\n[axes]\n\"camera.exposure\" = [2000.0, 60000.0]\n");
  finish("run", "bright.toml");
  auto const json = json_of({"sweep", "collect", "run", "--no-figures"});
  EXPECT_THAT(warnings_in(json), testing::ElementsAre("exposure at run"));
  EXPECT_EQ(json["warned"], 1);
}

// A setup with [sequence] is that of its first pair, unless an axis selects others.
TEST_F(Sweeps, OfASequenceNameItsPair) {
  succeed({"init", "piv", "-o", "piv.toml"});
  std::string const piv = with(read("piv.toml"), "\ndt_us", "\n# dt_us");
  write("piv.toml", with(piv, "[flow]", "[sequence]\nframes = 4\ndt_us = 10.0\n\n[flow]"));
  write("one.toml", "base = \"piv.toml\"\n[axes]\n\"lens.f_number\" = [8, 16]\n");
  write("pairs.toml", "base = \"piv.toml\"\n[axes]\n\"sequence.pair\" = { linear = [0, 2, 3] }\n");
  EXPECT_THAT(warnings_in(json_of({"sweep", "plan", "one.toml", "-o", "one"})),
              testing::Contains("ignored at one.toml"));
  Outcome const pairs = gladstone({"sweep", "plan", "pairs.toml", "-o", "pairs"});
  EXPECT_EQ(pairs.exit_code, 0) << pairs.err;
  EXPECT_THAT(pairs.err, testing::Not(testing::HasSubstr("warning")));
}

TEST_F(Sweeps, FromStudyToTable) {
  auto const planned = json_of({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"});
  EXPECT_EQ(planned["cases"], 12);
  EXPECT_EQ(planned["planned"], "fresh");
  EXPECT_EQ(status("run")["missing"], 12);
  auto const ran = json_of({"sweep", "run", "run"});
  EXPECT_EQ(ran["computed"], 12);
  EXPECT_EQ(ran["done"], 12);
  EXPECT_EQ(json_of({"sweep", "run", "run"})["computed"], 0);
  EXPECT_EQ(status("run")["done"], 12);
  auto const collected = json_of({"sweep", "collect", "run"});
  ASSERT_EQ(collected["figures"].size(), 14u);  // curves, a budget and repeats for two axes, a map of both; PNG and SVG
  EXPECT_EQ(collected["figures"][0], "run/figures/error_against_lens_f_number.png");
  EXPECT_GT(read_image(in("run/figures/error_against_lens_f_number.png").string()).columns(), 700);

  std::istringstream table(read("run/study.csv"));
  std::string header, first;
  std::getline(table, header);
  std::getline(table, first);
  EXPECT_TRUE(header.starts_with("lens.f_number,correlate.window_px,case,seed,status,")) << header;
  EXPECT_TRUE(header.ends_with(",seconds_render,seconds_correlate,device")) << header;
  for (std::string const name :
       {"ray_truth.rms_px", "eq9.bias_u_px", "eq9_cone.p95_px", "window_truth.gross_fraction",
        "budget.terms.noise.rms_px", "budget.total.rms_px", "budget.peak_locking_px", "magnification", "rays_per_dot",
        "step_mm", "exposure", "caustic_fraction", "warnings", "error_over_signal", "gradient_error_kg_m4"})
    EXPECT_THAT(header, HasSubstr(',' + name + ','));
  EXPECT_EQ(collected["ranking"].size(), 3u);
  EXPECT_TRUE(first.starts_with("8,\"[32, 16]\",0,3,ok,")) << first;
  std::string const all = read("run/study.csv");
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 13);

  Hdf5Reader const file(in("run/study.h5").string());
  EXPECT_EQ(file.read("lens.f_number")[11], 32);
  EXPECT_EQ(file.attribute("filetype"), "gladstone study");
  EXPECT_EQ(file.attribute("setup"), small_study);
  EXPECT_EQ(file.attribute("seed"), "3");
  auto const version = json_of({"--version"});
  std::string const build = version["version"].get<std::string>() + " (" + version["commit"].get<std::string>() + ')';
  EXPECT_EQ(file.attribute("computed_by"), nlohmann::json({build}).dump());
}

// A case of a sweep is identical to that of render, correlate and compare.
TEST_F(Sweeps, ACaseIsWhatTheSingleCommandsMake) {
  plan("run");
  succeed({"sweep", "run", "run", "--quiet", "--case", "7", "--keep-images"});
  EXPECT_EQ(status("run")["done"], 1);
  std::istringstream lines(read("run/manifest.jsonl"));
  std::string line;
  for (int i = 0; i <= 7; ++i) std::getline(lines, line);
  write("case7.toml", nlohmann::json::parse(line)["setup"].get<std::string>());
  render("by_hand", {}, "case7.toml");
  succeed({"correlate", "by_hand"});
  succeed({"compare", "by_hand", "--no-figures"});
  expect_same_case("by_hand", "run/cases/7");
  expect_same_datasets("by_hand/vectors.h5", "run/cases/7/vectors.h5");
  EXPECT_EQ(read("by_hand/errors.json"), read("run/cases/7/errors.json"));
  EXPECT_EQ(nlohmann::json::parse(read("run/cases/7.json"))["measures"]["ray_truth.rms_px"],
            nlohmann::json::parse(read("by_hand/errors.json"))["ray_truth"]["rms_px"]);
}

// M Z_D K L_z / (n0 p) px per kg/m^4 for M = 105/895, Z_D = 250 mm, K = 2.26e-4 m^3/kg, L_z = 10 mm and p = 10 um.
TEST_F(Sweeps, ErrorsAreAlsoRelativeToTheSignalAndOfTheGradient) {
  plan("run");
  succeed({"sweep", "run", "run", "--quiet", "--case", "7"});
  auto const measures = nlohmann::json::parse(read("run/cases/7.json"))["measures"];
  double const error = measures["eq9.rms_px"], signal = measures["signal_px"];
  double const sensitivity = 105.0 / 895 * 0.25 * 2.26e-4 * 0.01 / (1 + 2.26e-4 * 1.225) / 1e-5;
  EXPECT_NEAR(measures["error_over_signal"], error / signal, 1e-12 * error / signal);
  EXPECT_NEAR(measures["gradient_error_kg_m4"], error / sensitivity, 1e-9 * error / sensitivity);
}

// The result computed with the images is identical to the previous one, except for times.
TEST_F(Sweeps, ImagesOfAFinishedCaseAreMadeWhenTheyAreWanted) {
  plan("run");
  auto const numbers = [this] {
    auto const result = nlohmann::json::parse(read("run/cases/7.json"));
    return result["measures"].dump() + result["vectors"].dump();
  };
  succeed({"sweep", "run", "run", "--quiet", "--case", "7"});
  std::string const before = numbers();
  EXPECT_EQ(json_of({"sweep", "run", "run", "--case", "7", "--keep-images"})["computed"], 1);
  EXPECT_TRUE(std::filesystem::exists(in("run/cases/7/flow.tif")));
  EXPECT_EQ(numbers(), before);
  EXPECT_EQ(json_of({"sweep", "run", "run", "--case", "7", "--keep-images"})["computed"], 0);
}

// The images are equal to those of a complete run, and a later run measures them. A complete case retains all of its
// numbers.
TEST_F(Sweeps, PairsOnlyRendersAndALaterRunMeasures) {
  plan("run");
  auto const first = json_of({"sweep", "run", "run", "--case", "7", "--pairs-only"});
  EXPECT_EQ(first["computed"], 1);
  EXPECT_EQ(first["pairs_only"], 1);
  EXPECT_TRUE(std::filesystem::exists(in("run/cases/7/flow.tif")));
  EXPECT_FALSE(std::filesystem::exists(in("run/cases/7/vectors.h5")));
  EXPECT_FALSE(std::filesystem::exists(in("run/cases/7/errors.json")));
  std::string const image = read("run/cases/7/flow.tif");
  EXPECT_EQ(json_of({"sweep", "run", "run", "--case", "7", "--pairs-only"})["computed"], 0);
  EXPECT_THAT(succeed({"sweep", "status", "run"}), HasSubstr("have images only"));
  Outcome const report = gladstone({"report", "run", "--json"});
  EXPECT_EQ(report.exit_code, 2);
  expect_error_in(report, "missing_content at run");
  auto const then = json_of({"sweep", "run", "run", "--case", "7", "--keep-images"});
  EXPECT_EQ(then["computed"], 1);
  EXPECT_EQ(then["pairs_only"], 0);
  EXPECT_TRUE(read("run/cases/7/flow.tif") == image);
  auto const measures = nlohmann::json::parse(read("run/cases/7.json"))["measures"];
  EXPECT_TRUE(measures.contains("ray_truth.rms_px"));
  std::filesystem::remove_all(in("run/cases/7"));
  EXPECT_EQ(json_of({"sweep", "run", "run", "--case", "7", "--pairs-only"})["computed"], 1);
  EXPECT_EQ(nlohmann::json::parse(read("run/cases/7.json"))["measures"], measures);
  EXPECT_TRUE(std::filesystem::exists(in("run/cases/7/flow.tif")));
}

TEST_F(Sweeps, ResultsThatWereRemovedWithTheirFolderAreComputedAgain) {
  plan("run");
  std::filesystem::remove_all(in("run/cases"));
  EXPECT_EQ(json_of({"sweep", "run", "run", "--case", "0"})["done"], 1);
}

TEST_F(Sweeps, JobsAndShardsInAnyOrderGiveTheSameStudy) {
  finish("whole");
  plan("jobs");
  auto const ran = json_of({"sweep", "run", "jobs", "--jobs", "3"});
  EXPECT_EQ(ran["computed"], 12);  // each once
  succeed({"sweep", "collect", "jobs", "--no-figures"});
  expect_same_study("whole", "jobs");

  plan("shards");
  for (std::string const shard : {"2/3", "0/3", "1/3"}) {
    EXPECT_EQ(json_of({"sweep", "run", "shards", "--shard", shard})["computed"], 4);
  }
  succeed({"sweep", "collect", "shards", "--no-figures"});
  expect_same_study("whole", "shards");

  // on machines without a common file system: their results are combined by copying
  plan("apart");
  for (std::string const i : {"0", "1", "2"}) {
    plan("machine" + i);
    succeed({"sweep", "run", "machine" + i, "--shard", i + "/3", "--quiet"});
    for (auto const& [name, time] : results("machine" + i)) {
      std::filesystem::copy(in("machine" + i + "/cases/" + name), in("apart/cases/" + name));
    }
  }
  succeed({"sweep", "collect", "apart", "--no-figures"});
  expect_same_study("whole", "apart");
}

// A process that has finished one case is killed at each of these points and loses its work on the second one; then the
// first of three processes, whose workers end with it.
TEST_F(Sweeps, KilledRunIsCompletedByNextRun) {
  finish("whole");
  plan("run");
  CaseLocks const claims(in("run").string(), CaseLocks::Use::look);
  auto const kill_at = [&](std::string const& point, std::string const& jobs) {
    Program program({"sweep", "run", "run", "--quiet", "--jobs", jobs}, folder_, stopping_at(point));
    ASSERT_TRUE(program.wait_until_stopped()) << point;
    EXPECT_TRUE(jobs != "1" || claims.any_held());
    program.send(SIGKILL);
    EXPECT_EQ(program.finish(hang_limit).signal, SIGKILL);
    while (claims.any_held()) std::this_thread::yield();  // no claim persists after its process
  };
  int done = 0;
  for (std::string const point : {"case-begun:2", "case-computed:2", "result-written:2", "case-finished"}) {
    kill_at(point, "1");
    EXPECT_EQ(status("run")["done"], ++done) << point;
  }
  kill_at("case-finished:2", "2");
  EXPECT_GE(status("run")["done"], done + 2);
  succeed({"sweep", "run", "run", "--quiet"});
  succeed({"sweep", "collect", "run", "--no-figures", "--quiet"});
  expect_same_study("whole", "run");
}

TEST_F(Sweeps, RecomputesIncompleteResultsOnly) {
  finish("run");
  finish("whole");
  auto const before = results("run");
  std::string const text = read("run/cases/4.json");
  write("run/cases/4.json", text.substr(0, text.size() / 2));
  write("run/cases/5.json", with(read("run/cases/5.json"), "\"status\":\"ok\"", "\"status\":\"OK\""));
  write("run/cases/6.json", "");
  std::filesystem::remove(in("run/cases/7.json"));
  EXPECT_EQ(status("run")["missing_cases"], nlohmann::json({4, 5, 6, 7}));
  EXPECT_EQ(gladstone({"sweep", "collect", "run", "--no-figures"}).exit_code, 3);
  EXPECT_EQ(json_of({"sweep", "run", "run"})["computed"], 4);
  auto const after = results("run");
  for (auto const& [name, time] : before) {
    bool const again = name == "4.json" || name == "5.json" || name == "6.json" || name == "7.json";
    EXPECT_EQ(after.at(name) == time, !again) << name;
  }
  succeed({"sweep", "collect", "run", "--no-figures"});
  expect_same_study("whole", "run");
}

TEST_F(Sweeps, TwoRunnersShareTheWorkAndBothEndWithAllOfIt) {
  write("slow.toml", slow_study);
  plan("run", "slow.toml");
  Program one({"sweep", "run", "run", "--json", "--threads", "1"}, folder_);
  Program other({"sweep", "run", "run", "--json", "--threads", "1"}, folder_);
  Outcome const a = one.finish(hang_limit), b = other.finish(hang_limit);
  ASSERT_EQ(a.exit_code, 0) << a.err;
  ASSERT_EQ(b.exit_code, 0) << b.err;
  int const first = nlohmann::json::parse(a.out)["computed"], second = nlohmann::json::parse(b.out)["computed"];
  EXPECT_EQ(first + second, 6);
  EXPECT_GT(first, 0);
  EXPECT_GT(second, 0);
  succeed({"sweep", "collect", "run", "--no-figures"});
}

// A window of 64 px fits into one of two images.
TEST_F(Sweeps, AFailingCaseIsRecordedAndDoesNotStopTheOthers) {
  write("study.toml", R"(base = "setup.toml"
[axes]
"camera.pixels" = [[64, 64], [48, 48]]
"correlate.window_px" = [[32, 16], [64, 16]]
)");
  plan("run");
  Outcome const ran = gladstone({"sweep", "run", "run"});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.out, testing::AllOf(ContainsWhole("3 done"), ContainsWhole("1 failed"), ContainsWhole("case 3"),
                                      HasSubstr("camera.pixels = [48, 48]"), HasSubstr("correlate.window_px")));
  EXPECT_EQ(status("run")["done"], 3);
  EXPECT_EQ(status("run")["failed"], 1);
  EXPECT_EQ(status("run")["failures"][0]["case"], 3);
  Outcome const collected = gladstone({"sweep", "collect", "run", "--no-figures"});
  EXPECT_EQ(collected.exit_code, 3);
  EXPECT_THAT(collected.out, ContainsWhole("case 3"));
  EXPECT_THAT(read("run/study.csv"), HasSubstr("\n\"[48, 48]\",\"[64, 16]\",3,1,failed,0,nan,"));

  auto const before = results("run");
  EXPECT_EQ(gladstone({"sweep", "run", "run"}).exit_code, 3);
  EXPECT_EQ(results("run"), before);  // not tried again
  Outcome const retried = gladstone({"sweep", "run", "run", "--retry-failed", "--json"});
  EXPECT_EQ(retried.exit_code, 3);
  EXPECT_EQ(nlohmann::json::parse(retried.out)["computed"], 1);
}

TEST_F(Sweeps, FailedCasesAreRetriedOnceARunWhateverItsJobs) {
  write("study.toml", R"(base = "setup.toml"
[axes]
"camera.pixels" = [[64, 64], [48, 48]]
"correlate.window_px" = [[16], [64, 16]]
"lens.f_number" = [8, 11, 16]
)");
  plan("run");
  auto const again = [this](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"sweep", "run", "run", "--json"});
    Outcome const outcome = gladstone(arguments);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    auto const ran = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(ran["failed"], 3);
    EXPECT_EQ(ran["failures"][0]["again"], false);
    return ran["computed"].get<int>();
  };
  EXPECT_EQ(again({}), 12);
  EXPECT_EQ(again({"--jobs", "3"}), 0);
  EXPECT_EQ(again({"--jobs", "3", "--retry-failed"}), 3);
  EXPECT_EQ(again({"--retry-failed"}), 3);
}

// A limit of one second of processor time ends a process by SIGXCPU, as a crash would by SIGSEGV; the other cases take
// some milliseconds, a million rays for each of 40 dots many seconds.
TEST_F(Sweeps, ACaseThatKillsItsProcessIsRecordedAndDoesNotStopTheOthers) {
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"render.rays_per_dot\" = [16, 1000000, 32, 64]\n");
  plan("run");
  auto const limited = [] {
    rlimit const time{1, 10}, core{0, 0};
    return ::setrlimit(RLIMIT_CPU, &time) == 0 && ::setrlimit(RLIMIT_CORE, &core) == 0;
  };
  Outcome const outcome = run({"sweep", "run", "run", "--json", "--threads", "2", "--jobs", "2"}, folder_, limited);
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  auto const ran = nlohmann::json::parse(outcome.out, nullptr, false);
  ASSERT_TRUE(ran.is_object()) << outcome.out;
  auto const& warnings = ran["warning_records"];
  EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                          [](nlohmann::json const& one) {
                            return one["code"] == "failed" &&
                                   one["text"].get<std::string>().find("case 1") != std::string::npos;
                          }),
            2)
      << "a second worker tries it once more: " << warnings;
  EXPECT_EQ(ran["computed"], 4);
  EXPECT_EQ(ran["done"], 3);
  ASSERT_EQ(ran["failed"], 1);
  EXPECT_EQ(ran["failures"][0]["case"], 1);
  EXPECT_THAT(ran["failures"][0]["error"].get<std::string>(), HasSubstr("signal " + std::to_string(SIGXCPU)));
  EXPECT_EQ(json_of({"sweep", "status", "run"})["failed"], 1);
}

// A memory limit of the process simulates a machine with insufficient memory: the program takes some 130 MB, an image
// of 2048 x 2048 px alone more than 36 bytes x 4 Mpx = 150 MB.
TEST_F(Sweeps, ACaseThatLackedMemoryIsTriedOnceByEveryRunUntilThereIsEnough) {
  write("setup.toml",
        with(with(small_setup, "dots_per_32px_window = 10.0", "dots_per_32px_window = 0.1"), "[32, 16]", "[256]"));
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"camera.pixels\" = [[256, 256], [2048, 2048]]\n");
  plan("run");
  auto const limited = [] {
    rlimit const limit{200'000'000, 200'000'000};
    return ::setrlimit(RLIMIT_DATA, &limit) == 0;
  };
  for (int attempt = 0; attempt < 2; ++attempt) {
    std::string const jobs = attempt == 0 ? "2" : "1";
    Outcome const outcome = run({"sweep", "run", "run", "--json", "--threads", jobs, "--jobs", jobs}, folder_, limited);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    auto const ran = nlohmann::json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(ran.is_object()) << outcome.out;
    EXPECT_EQ(ran["computed"], attempt == 0 ? 2 : 1);
    EXPECT_EQ(ran["done"], 1);
    ASSERT_EQ(ran["failed"], 1);
    EXPECT_EQ(ran["failures"][0]["case"], 1);
    EXPECT_EQ(ran["failures"][0]["again"], true);
  }
  Outcome const collected = gladstone({"sweep", "collect", "run", "--no-figures"});
  EXPECT_EQ(collected.exit_code, 3);
  EXPECT_THAT(collected.out, testing::AllOf(ContainsWhole("case 1"), HasSubstr("camera.pixels = [2048, 2048]")));
  EXPECT_EQ(json_of({"sweep", "run", "run"})["computed"], 1);
  EXPECT_EQ(json_of({"sweep", "run", "run"})["computed"], 0);
}

// A rejection by check_memory before the allocation counts as a lack of memory, too: 10^11 px require 3.6 TB.
TEST_F(Sweeps, OversizedImageFailsOnlyItsCase) {
  write("setup.toml", with(read("setup.toml"), "pixel_pitch_um = 10.0", "pixel_pitch_um = 1.0"));
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"camera.pixels\" = [[64, 64], [48, 48]]\n");
  plan("run");
  // planning would have rejected it on this machine
  plan_otherwise("run", "pixels = [64, 64]", "pixels = [400000, 250000]");
  for (int attempt = 0; attempt < 2; ++attempt) {
    Outcome const outcome = gladstone({"sweep", "run", "run", "--json"});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    auto const ran = nlohmann::json::parse(outcome.out, nullptr, false);
    EXPECT_EQ(ran["computed"], attempt == 0 ? 2 : 1);
    EXPECT_EQ(ran["done"], 1);
    EXPECT_THAT(ran["failures"][0]["error"].get<std::string>(), HasSubstr(" GB"));
    EXPECT_EQ(ran["failures"][0]["again"], true);
  }
}

// A name in Latin-1, as on old disks. JSON and TOML support UTF-8 only, so that a manifest cannot contain such a name;
// the folders of a study, of its base and of a RUN may have any name.
TEST_F(Sweeps, FoldersWhoseNamesAreNoUtf8Work) {
  std::string const folder = "caf\xe9";
  std::filesystem::create_directory(in(folder));
  write(folder + "/setup.toml", small_setup);
  write(folder + "/study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16]\n");
  std::string const run = folder + "/run", shown = "caf\xef\xbf\xbd/run";
  EXPECT_EQ(json_of({"sweep", "plan", folder + "/study.toml", "-o", run, "--device", "cpu"})["run"], shown);
  EXPECT_EQ(json_of({"sweep", "run", run, "--jobs", "2"})["done"], 2);
  EXPECT_EQ(json_of({"sweep", "status", run})["run"], shown);
  EXPECT_EQ(json_of({"sweep", "collect", run})["figures"].size(), 4u);
  EXPECT_THAT(succeed({"sweep", "status", run}), HasSubstr(run + ": 2 cases, 2 done"));
  Hdf5Reader const table(in(run + "/study.h5").string());
  EXPECT_EQ(table.read("lens.f_number")[1], 16);

  write(folder + "/dots.csv", "x_mm,y_mm\n0,0\n");
  write(folder + "/setup.toml",
        with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  expect_error({"sweep", "plan", folder + "/study.toml", "-o", "other", "--device", "cpu"}, 2,
               "invalid_value at dots.csv");
}

TEST_F(Sweeps, AnInputThatHasChangedStopsTheRun) {
  std::string dots = "x_mm,y_mm\n";
  for (int i = 0; i < 100; ++i)
    dots += std::to_string(i % 10 * 0.5 - 2.3) + ',' + std::to_string(i / 10 * 0.5 - 2.2) + '\n';
  write("dots.csv", dots);
  write("setup.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  plan("run");
  succeed({"sweep", "run", "run", "--case", "0", "--quiet"});
  write("dots.csv", dots + "3,3\n");
  Outcome const outcome = gladstone({"sweep", "run", "run", "--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  expect_error_in(outcome, "changed at dots.csv", {"case 1"});
  write("dots.csv", dots);
  succeed({"sweep", "run", "run", "--quiet"});
}

TEST_F(Sweeps, ControlCKeepsWhatIsFinished) {
  for (std::string const jobs : {"1", "2"}) {
    plan("run" + jobs);
    Program program({"sweep", "run", "run" + jobs, "--jobs", jobs}, folder_, stopping_at("case-finished"));
    ASSERT_TRUE(program.wait_until_stopped());
    program.send(SIGINT);
    program.send(SIGCONT);
    Outcome const outcome = program.finish(hang_limit);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err << outcome.signal;
    EXPECT_EQ(outcome.out, "");
    EXPECT_GE(status("run" + jobs)["done"], 1);
    EXPECT_EQ(status("run" + jobs)["running"], 0);
  }
}

TEST_F(Sweeps, AFullDiskStopsTheRunAndTheNextOneGoesOn) {
  finish("whole");
  plan("run");
  // a result takes some 5 kB; a limit on the size of files acts like a full disk
  auto const limited = [] {
    rlimit const limit{2048, 2048};
    return ::setrlimit(RLIMIT_FSIZE, &limit) == 0;
  };
  Outcome const refused = run({"sweep", "run", "run", "--quiet", "--json"}, folder_, limited);
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  expect_error_in(refused, "output at 0.json");
  EXPECT_TRUE(names("run/cases").empty());

  // a disk with space for some results, in a separate mount namespace
  pid_t const child = ::fork();
  if (child == 0) {
    bool const mounted = ::unshare(CLONE_NEWNS) == 0 &&
                         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         ::mount("none", in("run/cases").c_str(), "tmpfs", 0, "size=40k") == 0;
    if (!mounted) ::_exit(77);
    Outcome const full = run({"sweep", "run", "run", "--quiet"}, folder_);
    bool const some = results("run").size() > 0 && results("run").size() < 12;
    std::error_code error;
    std::filesystem::create_directory(in("kept"), error);
    for (auto const& [name, time] : results("run")) {
      std::filesystem::copy(in("run/cases/" + name), in("kept/" + name), error);
    }
    write("stderr", full.err);
    ::_exit(full.exit_code == 2 && some && !error ? 0 : 1);
  }
  int ended = 0;
  ::waitpid(child, &ended, 0);
  ASSERT_TRUE(WIFEXITED(ended));
  if (WEXITSTATUS(ended) != 77) {
    EXPECT_EQ(WEXITSTATUS(ended), 0) << read("stderr");
    EXPECT_THAT(read("stderr"), HasSubstr("No space left on device"));
    for (auto const& name : names("kept")) std::filesystem::copy(in("kept/" + name), in("run/cases/" + name));
    EXPECT_GT(status("run")["done"], 0);
  }
  succeed({"sweep", "run", "run", "--quiet"});
  succeed({"sweep", "collect", "run", "--no-figures", "--quiet"});
  expect_same_study("whole", "run");
}

TEST_F(Sweeps, AnotherKindOfDeviceIsRefused) {
  plan("run");
  expect_error({"sweep", "run", "run", "--device", "cuda"}, 5, "device at ", {"--device cuda", "cpu"});
  plan_otherwise("run", "\"device\":\"cpu\"", "\"device\":\"cuda\"");
  auto const without_gpu = [] { return ::setenv("CUDA_VISIBLE_DEVICES", "", 1) == 0; };
  for (std::string const jobs : {"1", "2"}) {
    Outcome const outcome = run({"sweep", "run", "run", "--jobs", jobs}, folder_, without_gpu);
    EXPECT_EQ(outcome.exit_code, 5) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("--device cuda"));
  }
}

TEST_F(Sweeps, DevicesAreGpusOfThisHost) {
  plan("run");
  expect_error({"sweep", "run", "run", "--devices", "all"}, 5, "device at ", {"--devices all", "cpu"});
  expect_error({"sweep", "run", "run", "--devices", "some"}, 2, "arguments at --devices",
               {"\"all\"", "1 to 4096", "\"some\""});
  expect_error({"sweep", "run", "run", "--devices", "0"}, 2, "arguments at --devices", {"\"all\""});
  plan_otherwise("run", "\"device\":\"cpu\"", "\"device\":\"cuda\"");
  auto const without_gpu = [] { return ::setenv("CUDA_VISIBLE_DEVICES", "", 1) == 0; };
  for (std::string const devices : {"all", "1", "2"}) {
    Outcome const outcome = run({"sweep", "run", "run", "--devices", devices, "--json"}, folder_, without_gpu);
    EXPECT_EQ(outcome.exit_code, 5) << outcome.err;
    expect_error_in(outcome, "device at ", {"--devices " + devices});
  }
  EXPECT_EQ(status("run")["missing"], 12);
}

// The file contains the data of the kept cases, bit by bit, one case after the other.
TEST_F(Sweeps, ADatasetHoldsImagesAndTruthOfTheKeptCases) {
  plan("run");
  succeed({"sweep", "run", "run", "--quiet", "--case", "0"});
  Outcome const without = gladstone({"sweep", "collect", "run", "--no-figures", "--dataset", "none.h5", "--json"});
  EXPECT_EQ(without.exit_code, 2);
  expect_error_in(without, "missing_content at run", {"--keep-images"});
  EXPECT_FALSE(std::filesystem::exists(in("none.h5")));
  succeed({"sweep", "run", "run", "--quiet", "--case", "0,7", "--keep-images"});
  EXPECT_EQ(gladstone({"sweep", "collect", "run", "--no-figures", "--dataset", "set.h5"}).exit_code,
            3);  // ten are missing
  Hdf5Reader const set(in("set.h5").string());
  auto const begin = set.read_integers("/truth/begin");
  ASSERT_EQ(begin.size(), 3u);
  EXPECT_EQ(set.read_integers("/parameters/case"), (std::vector<std::int64_t>{0, 7}));
  auto const images = set.read("/images"), place = set.read("/truth/reference_px"),
             displacement = set.read("/truth/displacement_px"), flux = set.read("/truth/flux"),
             map = set.read("/displacement_px");
  std::size_t next = 0;
  for (int i = 0; i < 2; ++i) {
    std::string const folder = i == 0 ? "run/cases/0" : "run/cases/7";
    for (char const* name : {"/reference.tif", "/flow.tif"}) {
      for (double const level : read_image(in(folder + name).string())) ASSERT_EQ(images.at(next++), level);
    }
    Hdf5Reader const truth(in(folder + "/truth.h5").string());
    auto const from = 2 * begin[static_cast<std::size_t>(i)], to = 2 * begin[static_cast<std::size_t>(i) + 1];
    EXPECT_TRUE(std::equal(place.begin() + from, place.begin() + to, truth.read("/dots/reference_px").begin()));
    EXPECT_TRUE(std::equal(displacement.begin() + from, displacement.begin() + to,
                           truth.read("/dots/displacement_px").begin()));
    EXPECT_TRUE(std::equal(flux.begin() + from, flux.begin() + to, truth.read("/dots/flux").begin()));
  }
  EXPECT_EQ(next, images.size());
  EXPECT_EQ(set.shape("/displacement_px"),
            (std::vector<std::size_t>{2, set.shape("/images")[2] / 4, set.shape("/images")[3] / 4, 2}));
  // both sample the same field, one uniformly, the other at some hundred random positions, whose rms scatters by some
  // percent
  auto const rms = [](std::vector<double> const& values) {
    double sum = 0, count = 0;
    for (double const value : values) {
      if (std::isfinite(value)) sum += value * value, ++count;
    }
    return std::sqrt(sum / count);
  };
  EXPECT_NEAR(rms(map) / rms(displacement), 1, 0.2);
}

TEST_F(Sweeps, BadCommandLinesAreRefused) {
  plan("run");
  Outcome const bare = gladstone({"sweep"});
  EXPECT_EQ(bare.exit_code, 2);
  for (char const* command : {"plan", "run", "status", "collect"}) EXPECT_THAT(bare.err, HasSubstr(command));
  expect_error({"sweep", "runn", "other"}, 2, "arguments at runn", {"\"run\""});
  expect_error({"sweep", "run", "run", "--shard", "3/3"}, 2, "arguments at --shard", {"3/3"});
  expect_error({"sweep", "run", "run", "--case", "12"}, 2, "arguments at --case", {"12", "0 to 11"});
  expect_error({"sweep", "run", "run", "--case", ""}, 2, "arguments at --case");
  expect_error({"sweep", "run", "run", "--retry-faild"}, 2, "arguments at --retry-faild", {"--retry-failed"});
  expect_error({"sweep", "status", "."}, 2, "wrong_format at .");
  expect_error({"sweep", "run", "setup.toml"}, 2, "wrong_format at setup.toml");
  expect_error({"sweep", "plan", "nothing.toml", "-o", "other"}, 2, "missing_file at nothing.toml");
  expect_error({"sweep", "plan", "setup.toml", "-o", "other"}, 2, "invalid_value at setup.toml");
  write("other.toml", with(small_study, "[8, 16, 32]", "[8, 16, 64]"));
  succeed({"sweep", "run", "run", "--quiet"});
  expect_error({"sweep", "plan", "other.toml", "-o", "run", "--device", "cpu"}, 2, "output at run");
  EXPECT_EQ(json_of({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu"})["planned"], "unchanged");
}

}  // namespace
}  // namespace gladstone::end_to_end
