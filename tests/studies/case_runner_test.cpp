#include "studies/sweep/case_runner.h"

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "studies/sweep/case_locks.h"
#include "studies/sweep/case_measures.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/lru_cache.h"
#include "studies/sweep/run.h"
#include "tests/studies/support/same_results.h"
#include "tests/studies/support/study_folder.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

class CaseRunners : public StudyFolder {
 protected:
  static CaseRunner runner(Sharing sharing = Sharing::identical) { return CaseRunner(open_device("cpu"), sharing); }
};

// Every axis affects another part of the shared results: field, geometry, rays, camera electronics and correlation.
TEST_F(CaseRunners, SharedPartsGiveTheSameBitsAsNoneInAnyOrder) {
  write("base.toml", std::string(small_base) + "[camera.noise]\nread_noise_e = 5.0\n");
  auto const cases = plan(R"(base = "base.toml"
[axes]
"medium.field" = [
  { label = "gradient", kind = "uniform_gradient", gradient_kg_m4 = [30.0, 0.0, 0.0] },
  { label = "wave", kind = "sinusoid", amplitude_kg_m3 = 0.02, wavelength_mm = 5.0 },
]
"render.rays_per_dot" = [16, 32]
"camera.bit_depth" = [8, 12]
"camera.exposure" = ["auto", 20000.0]
"camera.noise.read_noise_e" = [0.0, 10.0]
"correlate.window_px" = [[32, 16], [16]]
)");
  ASSERT_EQ(cases.size(), 64u);
  CaseRunner sharing = runner(), backwards = runner();
  std::vector<CaseResult> shared, reversed(cases.size());
  for (ManifestCase const& one : cases) shared.push_back(sharing.run(one));
  for (std::size_t i = cases.size(); i-- > 0;) reversed[i] = backwards.run(cases[i]);
  for (std::size_t i = 0; i < cases.size(); i += 3) expect_same(shared[i], runner().run(cases[i]));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    expect_same(shared[i], reversed[i]);
    EXPECT_EQ(shared[i].status, CaseStatus::ok) << shared[i].error;
  }
  // every axis has an effect: neighbouring cases differ
  for (std::size_t step : {1, 2, 4, 8, 16, 32}) EXPECT_NE(shared[0].measures, shared[step].measures) << step;
}

// The stored numbers of a case in memory are those from which its measures were computed.
TEST_F(CaseRunners, ObserverSeesCaseBeforeRelease) {
  auto const cases = plan("base = \"base.toml\"\n[axes]\n\"camera.bit_depth\" = [12]\n");
  std::size_t told = 0;
  double rms = 0;
  CaseResult const result = runner().run(cases[0], "", [&](ObservedCase const& seen) {
    ++told;
    rms = summarize_errors(seen.comparison.measured.displacement_px, seen.comparison.point.eq9_px,
                           seen.comparison.mask)["rms_px"];
    EXPECT_EQ(seen.frames.levels->reference().columns(), 64);
  });
  EXPECT_EQ(told, 1u);
  for (auto const& [name, value] : result.measures) {
    if (name == "eq9.rms_px") {
      EXPECT_EQ(value, rms);
    }
  }
}

// A truth from few rays and a saturated image: the warnings are those of `render` for the same case.
TEST_F(CaseRunners, WarnOfTruthAndFramesAsRenderDoes) {
  auto const cases = plan(R"(base = "base.toml"
[axes]
"medium.field" = [{ label = "wave", kind = "sinusoid", amplitude_kg_m3 = 0.02, wavelength_mm = 2.0 }]
"render.method" = ["rays"]
"camera.exposure" = [2000.0, 60000.0]
)");
  ASSERT_EQ(cases.size(), 2u);
  CaseRunner one = runner();
  CaseResult const first = one.run(cases[0]), second = one.run(cases[1]);
  ASSERT_EQ(first.error + second.error, "");
  Warnings const &dim = first.warnings, &bright = second.warnings;
  for (auto const& warnings : {dim, bright}) EXPECT_THAT(warnings, testing::Contains(Warns("low_accuracy at truth")));
  EXPECT_THAT(dim, testing::Not(testing::Contains(Warns("exposure at camera.exposure"))));
  EXPECT_THAT(bright, testing::Contains(Warns("exposure at camera.exposure")));
}

// The values of "auto" depend on the grey levels of the camera, and the images on these values.
TEST_F(CaseRunners, PlannedRaysAreSharedWhereTheyAreTheSame) {
  auto const cases = plan(R"(base = "base.toml"
[axes]
"render.rays_per_dot" = ["auto"]
"camera.bit_depth" = [2, 8]
"correlate.overlap" = [0.5, 0.75]
)");
  CaseRunner sharing = runner();
  for (ManifestCase const& one : cases) expect_same(sharing.run(one), runner().run(one));
}

// Windows of 16 px that overlap by half are 8 px apart: every second row and column of them is compared, and all values
// of each remain unchanged.
TEST_F(CaseRunners, CompareNoVectorsThatAreCloserThanIsAsked) {
  auto const cases = plan("base = \"base.toml\"\n[axes]\n\"camera.bit_depth\" = [12]\n");
  CaseRunner all(open_device("cpu")), some(open_device("cpu"), Sharing::identical, 16);
  std::optional<Comparison> whole, thinned;
  all.run(cases[0], "", [&](ObservedCase const& seen) { whole = seen.comparison; });
  some.run(cases[0], "", [&](ObservedCase const& seen) { thinned = seen.comparison; });
  ASSERT_TRUE(whole && thinned);
  int const n = thinned->measured.columns;
  EXPECT_EQ(n, (whole->measured.columns + 1) / 2);
  ASSERT_EQ(thinned->measured.size(), static_cast<std::size_t>(n * thinned->measured.rows));
  EXPECT_EQ(thinned->measured.position_px[1].x - thinned->measured.position_px[0].x, 16);
  EXPECT_EQ(thinned->measured.position_px[static_cast<std::size_t>(n)].y - thinned->measured.position_px[0].y, 16);
  ASSERT_EQ(thinned->noise_free.size(), thinned->measured.size());
  for (std::size_t i = 0; i < thinned->measured.size(); ++i) {
    std::size_t k = 0;
    while (k < whole->measured.size() && !(whole->measured.position_px[k] == thinned->measured.position_px[i])) ++k;
    ASSERT_LT(k, whole->measured.size());
    EXPECT_EQ(thinned->measured.displacement_px[i], whole->measured.displacement_px[k]);
    EXPECT_EQ(thinned->noise_free[i], whole->noise_free[k]);
    EXPECT_EQ(thinned->point.displacement_px[i], whole->point.displacement_px[k]);
  }
}

// Another dot pattern has other images in the same field: its measurement is its own, bit by bit, and the truth and
// theory at the vectors are shared, to within the accuracy of the ray budget.
TEST_F(CaseRunners, MayTakeTruthOverFromRepeats) {
  write("base.toml", std::string(small_base).replace(std::string(small_base).find("rays_per_dot = 32"), 17, ""));
  auto const cases = plan("base = \"base.toml\"\n[study]\nrepeats = 2\n[axes]\n\"camera.bit_depth\" = [12]\n");
  ASSERT_EQ(cases.size(), 2u);
  CaseRunner over_repeats = runner(Sharing::over_repeats);
  std::optional<Comparison> first, second, own;
  over_repeats.run(cases[0], "", [&](ObservedCase const& seen) { first = seen.comparison; });
  over_repeats.run(cases[1], "", [&](ObservedCase const& seen) { second = seen.comparison; });
  runner().run(cases[1], "", [&](ObservedCase const& seen) { own = seen.comparison; });
  ASSERT_TRUE(first && second && own);
  EXPECT_NE(first->measured.displacement_px, second->measured.displacement_px);
  EXPECT_EQ(second->measured.displacement_px, own->measured.displacement_px);
  EXPECT_EQ(second->point.displacement_px, first->point.displacement_px);
  EXPECT_NE(second->point.displacement_px, own->point.displacement_px);  // with other rays
  for (std::size_t i = 0; i < own->measured.size(); ++i) {
    EXPECT_LT(length(second->point.displacement_px[i] - own->point.displacement_px[i]), 2 * truth_tolerance_px);
  }
}

// The setup of a planned case and its text in the manifest describe the same case.
TEST_F(CaseRunners, APlannedSetupIsThatOfTheManifest) {
  for (ManifestCase const& planned : plan("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [8, 11]\n")) {
    ASSERT_TRUE(planned.document);
    EXPECT_EQ(planned.document->written(), planned.setup);
    ManifestCase read = planned;
    read.document.reset();
    expect_same(runner().run(planned), runner().run(read));
  }
}

TEST_F(CaseRunners, ACaseThatCannotBeIsAResultAndAChangedInputIsNot) {
  write("dots.csv", "x_mm,y_mm\n0,0\n0.1,0.1\n");
  CaseRunner one = runner();
  write("base.toml", std::string(small_base)
                         .replace(std::string(small_base).find("dots_per_32px_window = 10.0"), 27,
                                  "kind = \"points\"\nfile = \"dots.csv\""));
  auto const with_file = plan("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  CaseResult const blank = one.run(with_file[0]);  // two dots in total: no window has three
  EXPECT_EQ(blank.status, CaseStatus::failed);
  EXPECT_THAT(blank.error, testing::StartsWith("case 0: "));
  write("dots.csv", "x_mm,y_mm\n0,0\n0.2,0.2\n1,1\n");
  EXPECT_THROW(one.run(with_file[0]), DataError);
  std::filesystem::remove(in("dots.csv"));
  EXPECT_EQ(error_of([&] { one.run(with_file[0]); }), "changed at dots.csv");
}

// An evicted entry no longer counts: 50 + 10 of 100 bytes are in use, so that another 40 fit.
TEST(RecentValues, AreCountedWhileTheyAreKept) {
  LruCache<int> recent(2);
  recent.keep("a", 1, 50);
  recent.keep("b", 2, 30);
  ASSERT_NE(recent.find("a"), nullptr);
  recent.keep("c", 3, 10);  // "b" is the least recently used one
  EXPECT_EQ(recent.find("b"), nullptr);
  recent.make_room(40, 100);
  EXPECT_NE(recent.find("c"), nullptr);
  EXPECT_NE(recent.find("a"), nullptr);
  recent.make_room(50, 100);
  EXPECT_EQ(recent.find("c"), nullptr);
  EXPECT_NE(recent.find("a"), nullptr);
  recent.make_room(200, 100);
  EXPECT_EQ(recent.find("a"), nullptr);
}

// An exception of a library makes the case fail; an error that would affect the next case, too, stops the run.
TEST_F(CaseRunners, AnyErrorOfACaseIsItsResultButNotThatOfADevice) {
  auto const cases = plan("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  std::function<void()> fail;
  Backend device = open_device("cpu");
  device.correlator = [&fail](CorrelationSettings const&) -> std::unique_ptr<Correlator> {
    fail();
    return nullptr;
  };
  CaseRunner one(std::move(device));
  fail = [] { throw std::runtime_error("something odd"); };
  CaseResult const odd = one.run(cases[0]);
  EXPECT_EQ(odd.status, CaseStatus::failed);
  EXPECT_THAT(odd.error, testing::HasSubstr("something odd"));
  EXPECT_FALSE(odd.again);
  ManifestCase elsewhere = cases[0];
  elsewhere.device = "cuda";
  EXPECT_THROW(one.run(elsewhere), DeviceError);
  fail = [] { throw DeviceError("the device is gone"); };
  EXPECT_THROW(one.run(cases[0]), DeviceError);
  fail = [] { throw Interrupted(); };
  EXPECT_THROW(one.run(cases[0]), Interrupted);
  fail = [] { throw OutputError("case", "cannot be written"); };
  EXPECT_THROW(one.run(cases[0]), OutputError);
}

TEST_F(CaseRunners, FlatMeasuresAreTheNumbersByTheirPath) {
  nlohmann::ordered_json const errors{{"a", {{"b", 1.5}, {"c", nullptr}, {"d", {1, 2, 3}}, {"e", "text"}}}, {"f", 3}};
  auto const measures = flat_measures(errors);
  ASSERT_EQ(measures.size(), 3u);
  EXPECT_EQ(measures[0].first, "a.b");
  EXPECT_TRUE(measures[1].second != measures[1].second);
  EXPECT_EQ(measures[2], (std::pair<std::string, double>{"f", 3}));
}

TEST_F(CaseRunners, ShardsArePiecesOfTheWhole) {
  auto const cases = plan("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [8, 17, 10] }\n");
  std::vector<std::size_t> together;
  for (std::size_t shard = 0; shard < 3; ++shard) {
    auto const piece = selected_cases(cases.size(), {{}, shard, 3, false, false});
    EXPECT_GE(piece.size(), 3u);
    together.insert(together.end(), piece.begin(), piece.end());
  }
  EXPECT_EQ(together, selected_cases(cases.size(), {}));
}

// Claim, check again, write, read: the overhead of the engine per case, besides the physics, is at most 5 ms. Measured:
// 1.3 ms.
TEST_F(CaseRunners, BookkeepingTakesFarLessThanFiveMillisecondsACase) {
  StudyFile const file = study("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [8, 16, 200] }\n");
  std::clock_t const start = std::clock();  // processor time, which other programs do not affect
  write_plan(in("run"), plan_study(file, "cpu"));
  CaseLocks claims(in("run"), CaseLocks::Use::take);
  CaseResult result;
  for (int i = 0; i < 98; ++i)
    result.measures.emplace_back("budget.terms.refraction.rms_px" + std::to_string(i), 1e-3 / 7);
  for (std::string const& name : vector_error_names()) {
    result.vectors.push_back({name, std::vector<Vec2d>(most_kept_vectors, {0.012345, -0.054321})});
  }
  Manifest const manifest = read_manifest(in("run"));
  for (std::size_t index = 0; index < manifest.size(); ++index) {
    ManifestCase const one = manifest[index];
    ASSERT_FALSE(read_result(in("run"), index, one.line_hash).has_value());
    ASSERT_TRUE(claims.take(one.index));
    ASSERT_FALSE(read_result(in("run"), index, one.line_hash).has_value());
    result.index = one.index;
    result.line_hash = one.line_hash;
    write_result(in("run"), result);
    claims.release(one.index);
  }
  EXPECT_TRUE(determine_run_state(in("run"), manifest, selected_cases(manifest.size(), {})).complete());
  EXPECT_EQ(collect_study(in("run")).rows.size(), 200u);
  double const ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / 200;
  RecordProperty("milliseconds_a_case", std::to_string(ms));
  EXPECT_LT(ms, 5);
}

}  // namespace
}  // namespace gladstone
