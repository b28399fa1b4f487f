#include "studies/sweep/manifest.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <sstream>

#include "render/files/content_hash.h"
#include "render/files/hdf5_file.h"
#include "render/files/partial.h"
#include "studies/sweep/case_locks.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/results.h"
#include "studies/sweep/run.h"
#include "studies/sweep/study_table.h"
#include "tests/studies/support/study_folder.h"

namespace gladstone {
namespace {

constexpr char const* two_axes = R"(base = "base.toml"
[axes]
"lens.f_number" = [8, inf]
"lens.psf" = ["airy", "none"]
)";

/// Creates the partial file of a killed writer. @return its path
std::string leave_partial(std::string const& folder, std::string const& stem) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  pid_t const child = fork();
  if (child == 0) {
    Partial const partial(folder, stem, Partial::Kind::file);
    _exit(::write(ends[1], partial.path().data(), partial.path().size()) > 0 ? 0 : 1);
  }
  waitpid(child, nullptr, 0);
  char path[4096];
  ssize_t const size = ::read(ends[0], path, sizeof path);
  close(ends[0]);
  close(ends[1]);
  return {path, static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
}

class Runs : public StudyFolder {
 protected:
  /// Plans into "run".
  std::vector<ManifestCase> planned(std::string const& text = two_axes) const {
    StudyPlan const plan = plan_study(study(text), "cpu");
    write_plan(in("run"), plan);
    return all_cases(plan);
  }
  CaseResult result_of(ManifestCase const& one, double rms) const {
    CaseResult result;
    result.index = one.index;
    result.line_hash = one.line_hash;
    result.measures = {{"ray_truth.rms_px", rms}, {"eq9.rms_px", std::nan("")}};
    result.device = "cpu";
    return result;
  }
  std::string reading_fails() const {
    return error_of([&] { read_manifest(in("run")); });
  }
};

TEST_F(Runs, AManifestReadsBackAsItWasWritten) {
  auto const written = planned();
  auto const read = read_manifest(in("run"));
  ASSERT_EQ(read.size(), 4u);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(manifest_line(read[i]), manifest_line(written[i]));
    EXPECT_EQ(read[i].line_hash, written[i].line_hash);
    EXPECT_EQ(read.line_hash(i), written[i].line_hash);
    EXPECT_EQ(read[i].index, i);
  }
  EXPECT_TRUE(std::isinf(read[2].parameters[0].second.number.value()));
  EXPECT_FALSE(read[2].parameters[1].second.number.has_value());
}

TEST_F(Runs, LabelsOfNumbersStandInTheManifestAndInTheTables) {
  auto const written = planned(
      "base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [{ label = \"open\", value = 8 }, 16, { "
      "label = \"pinhole\", value = inf }]\n");
  auto const read = read_manifest(in("run"));
  ASSERT_EQ(read.size(), 3u);
  for (std::size_t i = 0; i < read.size(); ++i) EXPECT_EQ(manifest_line(read[i]), manifest_line(written[i]));
  EXPECT_EQ(read[0].parameters[0].second.label, "open");
  EXPECT_EQ(read[0].parameters[0].second.number, 8.0);
  EXPECT_EQ(read[1].parameters[0].second.label, "16");
  EXPECT_EQ(read[2].parameters[0].second.label, "pinhole");
  EXPECT_EQ(read[2].parameters[0].second.number, HUGE_VAL);
  StudyTable const table = read_study_table(in("run"));
  EXPECT_TRUE(table.axes[0].labelled);
  EXPECT_EQ(table.axes[0].labels, (std::vector<std::string>{"open", "16", "pinhole"}));
  std::ostringstream text;
  write_csv(text, table, table_columns(table));
  std::string const csv = text.str();
  EXPECT_THAT(csv, testing::StartsWith("lens.f_number,lens.f_number.label,case,"));
  EXPECT_THAT(csv, testing::HasSubstr("\n8,open,0,"));
  EXPECT_THAT(csv, testing::HasSubstr("\n16,16,1,"));
  EXPECT_THAT(csv, testing::HasSubstr("\ninf,pinhole,2,"));
  planned();
  EXPECT_FALSE(read_study_table(in("run")).axes[0].labelled);
}

TEST_F(Runs, ManifestsThatAreNotWholeAreRefusedByLine) {
  EXPECT_EQ(reading_fails(), "wrong_format at run");
  planned();
  std::string const whole = content(folder_ / "run/manifest.jsonl");
  write("run/manifest.jsonl", whole.substr(0, whole.size() - 40));
  EXPECT_EQ(reading_fails(), "damaged at manifest.jsonl:4");
  std::size_t const second = whole.find('\n') + 1;
  write("run/manifest.jsonl", whole.substr(second));
  EXPECT_EQ(reading_fails(), "damaged at manifest.jsonl:1");
  write("run/manifest.jsonl", "{\"manifest\":1,\"index\":0}\n");
  EXPECT_EQ(reading_fails(), "unsupported at manifest.jsonl:1");
  write("run/manifest.jsonl", "{\"manifest\":2,\"index\":\"one\"}\n");
  EXPECT_EQ(reading_fails(), "damaged at manifest.jsonl:1");
  for (char const* foreign :
       {"{\"name\":\"a package\"}\n", "{\"manifest\":\"yes\",\"index\":0}\n", "{\"manifest\":1}\n"}) {
    write("run/manifest.jsonl", foreign);
    EXPECT_EQ(reading_fails(), "wrong_format at manifest.jsonl:1");
  }
  write("run/manifest.jsonl", "");
  EXPECT_EQ(reading_fails(), "missing_content at manifest.jsonl");

  // damage within a line is detected when its case is requested, and not before
  std::string damaged = whole;
  damaged[damaged.find("\"seed\"", second)] = ' ';
  write("run/manifest.jsonl", damaged);
  Manifest const manifest = read_manifest(in("run"));
  EXPECT_EQ(manifest[0].index, 0u);
  EXPECT_EQ(error_of([&] { manifest[1]; }), "damaged at manifest.jsonl:2");
}

// Any changed digit is detected, in a parameter as in the text of the setup, although the line is still JSON.
TEST_F(Runs, AChangedLineIsRefusedWhereItsCaseIsAskedFor) {
  auto const cases = planned();
  std::string const whole = content(folder_ / "run/manifest.jsonl");
  std::size_t const second = whole.find('\n') + 1;
  auto const complaint_about = [&](std::string const& text, std::size_t index) {
    write("run/manifest.jsonl", text);
    return error_of([&] { read_manifest(in("run"))[index]; });
  };
  EXPECT_EQ(complaint_about(whole, 1), "");
  for (std::string const piece : {"\"repeat\":0", "f_number = 8", "\"lens.f_number\":8"}) {
    std::string changed = whole;
    changed[changed.find(piece, second) + piece.size() - 1] = '9';
    EXPECT_EQ(complaint_about(changed, 0), "");
    EXPECT_EQ(complaint_about(changed, 1), "changed at manifest.jsonl:2") << piece;
    EXPECT_NE(read_manifest(in("run")).line_hash(1), cases[1].line_hash);
  }
  // a line of an older version without a hash: after planning again, computed results are kept
  std::string older = whole;
  for (std::size_t at; (at = older.find(",\"hash\":")) != std::string::npos;) older.erase(at, 26);
  EXPECT_EQ(complaint_about(older, 0), "unsupported at manifest.jsonl:1");
  write_result(in("run"), result_of(cases[1], 0.5));
  StudyPlan const again = plan_study(study(two_axes), "cpu");
  EXPECT_EQ(write_plan(in("run"), again), PlanOutcome::replaced);
  EXPECT_EQ(content(folder_ / "run/manifest.jsonl"), whole);
  EXPECT_TRUE(read_result(in("run"), 1, again[1].line_hash).has_value());
}

TEST_F(Runs, PlanningAgainKeepsWhatIsThere) {
  auto cases = planned();
  write_result(in("run"), result_of(cases[1], 0.5));
  EXPECT_EQ(write_plan(in("run"), plan_study(study(two_axes), "cpu")), PlanOutcome::unchanged);

  // more repeats are appended to the existing cases
  StudyPlan const more = plan_study(study(std::string(two_axes) + "[study]\nrepeats = 2\n"), "cpu");
  EXPECT_EQ(write_plan(in("run"), more), PlanOutcome::replaced);
  EXPECT_EQ(read_manifest(in("run")).size(), 8u);
  EXPECT_TRUE(read_result(in("run"), 1, more[1].line_hash).has_value());

  // planning another study would lose the result
  StudyPlan const other = plan_study(study("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [8, 16]\n"), "cpu");
  EXPECT_THROW(write_plan(in("run"), other), OutputError);
  EXPECT_EQ(read_manifest(in("run")).size(), 8u);

  // a manifest of another version is not replaced either
  write("run/manifest.jsonl", "{\"manifest\":1,\"index\":0}\n");
  EXPECT_EQ(error_of([&] { write_plan(in("run"), other); }), "output at run");
  std::filesystem::remove(result_path(in("run"), 1));
  EXPECT_EQ(write_plan(in("run"), other), PlanOutcome::replaced);
}

TEST_F(Runs, ForeignFolderIsPreserved) {
  std::filesystem::create_directory(in("thesis"));
  write("thesis/chapter1.tex", "precious");
  StudyPlan const plan = plan_study(study(two_axes), "cpu");
  EXPECT_THROW(write_plan(in("thesis"), plan), OutputError);
  EXPECT_FALSE(std::filesystem::exists(in("thesis/manifest.jsonl")));
}

TEST_F(Runs, InterruptedPlanIsReplaced) {
  StudyPlan const plan = plan_study(study(two_axes), "cpu");
  std::filesystem::create_directories(in("cut"));
  std::string const partial = leave_partial(in("cut"), sibling_stem(run_file::manifest));
  write("cut/study.toml", "of somebody else");
  EXPECT_THROW(write_plan(in("cut"), plan), OutputError);
  EXPECT_EQ(content(folder_ / "cut/study.toml"), "of somebody else");

  std::filesystem::create_directories(in("cut/cases"));
  write("cut/claims", "");
  write("cut/cases/notes.txt", "precious");
  EXPECT_THROW(write_plan(in("cut"), plan), OutputError);

  std::filesystem::remove(in("cut/cases/notes.txt"));
  EXPECT_EQ(write_plan(in("cut"), plan), PlanOutcome::fresh);
  EXPECT_EQ(read_manifest(in("cut")).size(), 4u);
  EXPECT_FALSE(std::filesystem::exists(partial));
}

// The base is stored next to the manifest as in the study, without the values of the axes, and loads from any folder.
TEST_F(Runs, TheBaseIsKeptBesideTheManifest) {
  StudyPlan const plan = plan_study(study(two_axes), "cpu");
  EXPECT_EQ(write_plan(in("run"), plan), PlanOutcome::fresh);
  SetupDocument base = SetupDocument::from_text(content(folder_ / "run/base.toml"), "base");
  ASSERT_NE(base.find({"lens", "f_number"}), nullptr);
  EXPECT_EQ(base.find({"lens", "f_number"})->as_double(), 11);
  EXPECT_EQ(load_case_setup(std::move(base)).setup.camera.columns, 64);
}

TEST_F(Runs, AManifestOfSomethingElseIsLeftAlone) {
  std::filesystem::create_directory(in("package"));
  StudyPlan const plan = plan_study(study(two_axes), "cpu");
  for (std::string const foreign : {"{\"name\":\"a package\",\"version\":3}\n", "first line\nsecond line\n", ""}) {
    write("package/manifest.jsonl", foreign);
    EXPECT_EQ(error_of([&] { write_plan(in("package"), plan); }), "output at manifest.jsonl") << foreign;
    EXPECT_EQ(content(folder_ / "package/manifest.jsonl"), foreign);
  }
  // planned by another gladstone, and nothing computed: planned again
  write("package/manifest.jsonl", "{\"manifest\":1,\"index\":0}\n");
  EXPECT_EQ(write_plan(in("package"), plan), PlanOutcome::replaced);
}

// Nested brackets use no stack, whatever their number.
TEST_F(Runs, DeeplyNestedTextIsRefused) {
  auto const cases = planned();
  std::size_t const many = 200000;
  std::string const deep = std::string(many, '[') + std::string(many, ']');
  write("run/manifest.jsonl", deep + '\n');
  EXPECT_EQ(reading_fails(), "damaged at manifest.jsonl:1");
  write("run/manifest.jsonl", "{\"manifest\":2,\"index\":0,\"setup\":" + deep + "}\n");
  EXPECT_THROW(read_manifest(in("run"))[0], DataError);
  std::string const rest = "\"result\":2,\"index\":1,\"measures\":" + deep + "}\n";
  write("run/cases/1.json", "{\"hash\":\"" + content_hash(rest) + "\"," + rest);
  EXPECT_FALSE(read_result(in("run"), 1, cases[1].line_hash).has_value());
}

TEST_F(Runs, AResultIsWholeOrNone) {
  auto const cases = planned();
  CaseResult written = result_of(cases[2], 0.1 + 0.2);
  written.warnings = {{WarningCode::low_accuracy, "truth", "a \"quoted\" warning"}};
  write_result(in("run"), written);
  auto const read = read_result(in("run"), 2, cases[2].line_hash);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->measures[0].second, 0.1 + 0.2);
  EXPECT_TRUE(std::isnan(read->measures[1].second));
  EXPECT_EQ(read->warnings, written.warnings);
  auto const head = read_result(in("run"), 2, cases[2].line_hash, ResultPart::head);
  ASSERT_TRUE(head.has_value());
  EXPECT_EQ(head->warnings, written.warnings);
  EXPECT_TRUE(head->measures.empty());

  written.warnings = {{WarningCode::other, "", "one that quotes \",\"measures\":{ itself"}};
  std::string const text = result_text(written);
  ASSERT_TRUE(parse_result(text, "0.json").has_value());
  EXPECT_EQ(parse_result(text, "0.json", ResultPart::head).value().warnings, written.warnings);
  for (std::size_t size = 0; size < text.size(); ++size)
    EXPECT_FALSE(parse_result(text.substr(0, size), "0.json").has_value());
  for (std::size_t at = 0; at < text.size(); ++at) {  // any single damaged byte
    std::string damaged = text;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_FALSE(parse_result(damaged, "0.json").has_value()) << at;
    EXPECT_FALSE(parse_result(damaged, "0.json", ResultPart::head).has_value()) << at;
  }
  EXPECT_FALSE(read_result(in("run"), 2, cases[1].line_hash).has_value());
}

TEST_F(Runs, ResultOfOtherVersionIsPreserved) {
  auto cases = planned();
  std::string rest = result_text(result_of(cases[2], 0.5));
  rest = rest.substr(rest.find("\"result\":"));
  rest.replace(0, rest.find(','), "\"result\":1");
  std::string const older = "{\"hash\":\"" + content_hash(rest) + "\"," + rest;
  write("run/cases/2.json", older);
  StudyPlan const plan = plan_study(study(two_axes), "cpu");
  std::vector<std::function<void()>> const uses{
      [&] { read_result(in("run"), 2, cases[2].line_hash); },
      [&] {
        determine_run_state(in("run"), read_manifest(in("run")), {0, 1, 2, 3});
      },
      [&] { read_study_table(in("run")); }, [&] { write_plan(in("run"), plan); }};
  for (std::function<void()> const& use : uses) {
    EXPECT_EQ(error_of(use), "unsupported at 2.json");
  }
  EXPECT_EQ(content(folder_ / "run/cases/2.json"), older);
}

// Linux opens a folder like a file and fails when reading it, as for the memory of a process at address 0.
TEST_F(Runs, AResultThatCannotBeReadIsMissingAndAFolderInItsPlaceIsNamed) {
  auto const cases = planned();
  std::filesystem::create_symlink("/proc/self/mem", in("run/cases/2.json"));
  EXPECT_EQ(determine_run_state(in("run"), read_manifest(in("run")), {2}).missing, std::vector<std::size_t>{2});
  write_result(in("run"), result_of(cases[2], 0.5));
  EXPECT_TRUE(read_result(in("run"), 2, cases[2].line_hash).has_value());

  std::filesystem::create_directory(in("run/cases/3.json"));
  EXPECT_EQ(error_of([&] { determine_run_state(in("run"), read_manifest(in("run")), {3}); }),
            "unreadable_file at 3.json");
}

TEST_F(Runs, ATableHasARowForEveryCaseDoneOrNot) {
  auto const cases = planned();
  write_result(in("run"), result_of(cases[0], 0.25));
  CaseResult failed = result_of(cases[3], 0);
  failed.status = CaseStatus::failed;
  failed.error = "no such thing";
  failed.measures.clear();
  write_result(in("run"), failed);
  StudyTable const table = read_study_table(in("run"));
  ASSERT_EQ(table.rows.size(), 4u);
  EXPECT_EQ(table.name, "run");
  EXPECT_EQ(table.axes[1].labels, (std::vector<std::string>{"airy", "none"}));
  EXPECT_TRUE(table.axes[0].numeric);
  EXPECT_FALSE(table.axes[1].numeric);
  EXPECT_EQ(table.rows[2].value, (std::vector<std::size_t>{1, 0}));
  EXPECT_EQ(table.rows[0].measures.at(table.find_measure("ray_truth.rms_px").value()), 0.25);
  EXPECT_TRUE(std::isnan(table.rows[1].measures.at(0)));
  EXPECT_EQ(table.rows[1].status, CaseStatus::missing);
  EXPECT_EQ(table.rows[3].error, "no such thing");
  EXPECT_EQ(table.unfinished(), (std::vector<std::size_t>{1, 2, 3}));
}

TEST_F(Runs, ATableSaysWhichBuildsComputedIt) {
  auto const cases = planned();
  for (std::size_t const index : {3, 1, 0}) {
    CaseResult result = result_of(cases[index], 0.25);
    result.build = index == 1 ? "0.2.0 (beef)" : "0.1.0 (cafe)";
    write_result(in("run"), result);
  }
  StudyTable const table = collect_study(in("run"));
  EXPECT_EQ(table.builds, (std::vector<std::string>{"0.1.0 (cafe)", "0.2.0 (beef)"}));
  Hdf5Reader const file(in("run/study.h5"));
  EXPECT_EQ(file.attribute("computed_by"), "[\"0.1.0 (cafe)\",\"0.2.0 (beef)\"]");
}

TEST_F(Runs, RemovesOnlyFailuresToBeRepeated) {
  auto const cases = planned();
  for (std::size_t index = 0; index < 4; ++index) {
    CaseResult result = result_of(cases[index], 0.5);
    if (index > 0) result.status = CaseStatus::failed;
    result.again = index >= 2;  // failed for lack of memory
    write_result(in("run"), result);
  }
  auto const there = [&](std::size_t index) {
    return read_result(in("run"), index, cases[index].line_hash).has_value();
  };
  std::vector<std::size_t> const all{0, 1, 2, 3};
  {
    CaseLocks other(in("run"), CaseLocks::Use::take);
    ASSERT_TRUE(other.take(3));
    remove_failed_results(in("run"), read_manifest(in("run")), all, {});
  }
  EXPECT_TRUE(there(0) && there(1) && !there(2) && there(3));
  remove_failed_results(in("run"), read_manifest(in("run")), all, {});
  EXPECT_TRUE(there(0) && there(1) && !there(3));
  RunSelection retry;
  retry.retry_failed = true;
  remove_failed_results(in("run"), read_manifest(in("run")), all, retry);
  EXPECT_TRUE(there(0) && !there(1));
}

TEST_F(Runs, LockExcludesOthersUntilProcessEnds) {
  planned();
  CaseLocks mine(in("run"), CaseLocks::Use::take);
  ASSERT_TRUE(mine.take(7));
  EXPECT_FALSE(mine.held(7));  // not held by another process
  {
    CaseLocks other(in("run"), CaseLocks::Use::take);
    EXPECT_TRUE(other.held(7));
    EXPECT_FALSE(other.take(7));
    EXPECT_TRUE(other.take(8));
    EXPECT_TRUE(mine.held(8));
  }
  EXPECT_FALSE(mine.held(8));
  mine.release(7);

  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  pid_t const child = ::fork();
  if (child == 0) {
    CaseLocks theirs(in("run"), CaseLocks::Use::take);
    bool const taken = theirs.take(3);
    if (::write(ready[1], &taken, 1) != 1) ::_exit(1);
    ::pause();
  }
  bool taken = false;
  ASSERT_EQ(::read(ready[0], &taken, 1), 1);
  EXPECT_TRUE(taken);
  EXPECT_TRUE(mine.held(3));
  EXPECT_TRUE(mine.any_held());
  EXPECT_FALSE(mine.take(3));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_FALSE(mine.any_held());
  EXPECT_TRUE(mine.take(3));
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_F(Runs, ReplacedLockFileIsReopened) {
  planned();
  CaseLocks mine(in("run"), CaseLocks::Use::take);
  ASSERT_TRUE(mine.take(1));
  std::filesystem::remove(in("run/claims"));
  CaseLocks other(in("run"), CaseLocks::Use::take);
  ASSERT_TRUE(other.take(2));
  EXPECT_FALSE(mine.take(2));
  EXPECT_TRUE(mine.take(3));
  EXPECT_FALSE(other.take(3));
}

TEST_F(Runs, PartialResultsOfKilledWritersAreRemovedAndOthersAreLeftAlone) {
  auto const cases = planned();
  std::string const elsewhere = "run/cases/.1.json.partial-elsewhere-0123456789abcdef-1-17-1";
  write(elsewhere, "{\"hash\":\"half");
  Partial const mine(in("run/cases"), ".1.json.", Partial::Kind::file);
  std::string const killed = leave_partial(in("run/cases"), ".1.json.");
  write_result(in("run"), result_of(cases[1], 0.5));
  remove_abandoned_results(in("run"));
  EXPECT_FALSE(std::filesystem::exists(killed));
  EXPECT_TRUE(std::filesystem::exists(mine.path()));
  EXPECT_EQ(content(folder_ / elsewhere), "{\"hash\":\"half");
  EXPECT_EQ(collect_study(in("run")).unfinished(), (std::vector<std::size_t>{0, 2, 3}));
  EXPECT_TRUE(read_result(in("run"), 1, cases[1].line_hash).has_value());
}

TEST_F(Runs, ReadingLocksWritesNothing) {
  auto const cases = planned();
  std::filesystem::remove(in("run/claims"));
  RunState const state = determine_run_state(in("run"), read_manifest(in("run")), {0, 1});
  EXPECT_EQ(state.missing.size(), 2u);
  EXPECT_TRUE(state.running.empty());
  EXPECT_FALSE(std::filesystem::exists(in("run/claims")));
}

TEST_F(Runs, AReadOnlyRunSaysThatItIsReadOnly) {
  planned();
  std::filesystem::permissions(in("run/claims"), std::filesystem::perms::owner_read);
  uid_t const me = ::geteuid();
  if (me == 0) {
    ASSERT_EQ(::seteuid(65534), 0);  // root may write anything
  }
  std::string const error = error_of([&] { CaseLocks(in("run"), CaseLocks::Use::take); });
  if (me == 0) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  EXPECT_EQ(error, "output at claims");
}

}  // namespace
}  // namespace gladstone
