#include "studies/report/report.h"
#include "studies/sweep/case_runner.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/results.h"
#include "tests/studies/support/study_folder.h"

namespace gladstone {
namespace {

class RunReports : public StudyFolder {
 protected:
  /// A finished study with the given number of cases: one is computed, the others have its measures with small changes,
  /// so that no two numbers are equal.
  void finish(std::size_t cases) const {
    StudyFile const file = study("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [8, 16, " +
                                 std::to_string(cases) + "] }\n");
    write_plan(in("run"), plan_study(file, "cpu"));
    Manifest const manifest = read_manifest(in("run"));
    ASSERT_EQ(manifest.size(), cases);
    CaseResult result = CaseRunner(open_device("cpu")).run(manifest[0]);
    ASSERT_EQ(result.status, CaseStatus::ok) << result.error;
    for (std::size_t index = 0; index < cases; ++index) {
      ManifestCase const one = manifest[index];
      for (auto& [name, value] : result.measures) value *= 1.0001;
      result.index = one.index;
      result.line_hash = one.line_hash;
      write_result(in("run"), result);
    }
  }
};

// A case has one row of the table, 16 cells of at most 80 bytes, and one point of a figure with at most 200 bytes: 1.5
// MB for 1000 cases. The other figures have 12 positions per axis, so that they and the scripts remain below 0.5 MB.
TEST_F(RunReports, OfAThousandCasesAreSmall) {
  finish(1000);
  ReportOptions options;
  options.source = in("run");
  options.output = in("run/report.html");
  std::string const html = html_page(run_report(options));
  RecordProperty("bytes", std::to_string(html.size()));
  EXPECT_THAT(html, testing::HasSubstr("1000 of 1000 cases are finished"));
  EXPECT_LT(html.size(), 2e6);
  EXPECT_THAT(html, testing::HasSubstr("case 999\\n"));  // a point of the last case
}

}  // namespace
}  // namespace gladstone
