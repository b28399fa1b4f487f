#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

class Reports : public Workplace {
 protected:
  /// Six cases of a few milliseconds each.
  void finish_study() const {
    write("study.toml",
          "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16, 32]\n\"render.rays_per_dot\" = [16, 32]\n");
    succeed({"sweep", "plan", "study.toml", "-o", "run", "--quiet", "--device", "cpu"});
    succeed({"sweep", "run", "run", "--quiet", "--keep-images"});
    succeed({"sweep", "collect", "run", "--no-figures", "--quiet"});
  }
  nlohmann::json data_of(std::string const& report) const {
    std::string const html = read(report), head = "id=\"data\">";
    auto const begin = html.find(head) + head.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
  }
};

TEST_F(Reports, OfAStudyHoldsItsNumbersAndPictures) {
  finish_study();
  nlohmann::json const result = json_of({"report", "run", "--quiet"});
  EXPECT_EQ(result["report"], "run/report.html");
  EXPECT_THAT(result["findings"].get<std::string>(), HasSubstr("The largest cause of error is "));
  std::string const html = read("run/report.html");
  EXPECT_THAT(html, HasSubstr("How wrong is the measured displacement against Eq. 9"));
  EXPECT_THAT(html, HasSubstr("6 of 6 cases are finished"));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,iVBOR"));
  nlohmann::json const data = data_of("run/report.html");
  ASSERT_EQ(data["rows"].size(), 6u);
  Hdf5Reader const table(in("run/study.h5").string());
  for (std::size_t m = 0; m < data["measures"].size(); ++m) {
    auto const column = table.read(data["measures"][m]["name"].get<std::string>());
    for (std::size_t i = 0; i < 6; ++i) {
      nlohmann::json const& value = data["rows"][i]["m"][m];
      if (value.is_null()) continue;
      EXPECT_EQ(value.get<double>(), column[i]) << data["measures"][m]["name"];
    }
  }
}

TEST_F(Reports, OfACaseAddUpTheirCauses) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--quiet"});
  nlohmann::json const data = data_of("case/report.html");
  auto const field = [&](std::string const& name) -> nlohmann::json const& {
    for (nlohmann::json const& one : data["fields"]) {
      if (one["name"] == name) return one["u"];
    }
    ADD_FAILURE() << name;
    return data;
  };
  std::size_t told = 0;
  for (std::size_t i = 0; i < field("error_truth").size(); ++i) {
    if (field("error_truth")[i].is_null()) continue;
    double sum = 0;
    for (char const* cause : {"window", "estimator", "noise"}) sum += field(cause)[i].get<double>();
    EXPECT_NEAR(sum, field("error_truth")[i].get<double>(), 2e-6);  // four numbers rounded to 1e-6 px
    ++told;
  }
  EXPECT_GT(told, 0u);
  EXPECT_THAT(read("case/report.html"), HasSubstr("expanded uncertainty"));
}

TEST_F(Reports, AreWrittenAsMarkdownWithFiguresBesideIt) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--format", "md", "-o", "text/report.md", "--figure-format", "svg", "--quiet"});
  EXPECT_THAT(read("text/report.md"), HasSubstr("![error\\_budget](<report_figures/error_budget.svg>)"));
  EXPECT_THAT(read("text/report_figures/error_budget.svg"), HasSubstr("</svg>"));
}

TEST_F(Reports, DrawFiguresAsPdf) {
  finish_study();
  succeed({"report", "run", "--figures", "paper", "--figure-format", "pdf", "--quiet"});
  EXPECT_TRUE(read("paper/budget_lens_f_number.pdf").starts_with("%PDF-"));
}

TEST_F(Reports, AreGoneWhenTheirCaseIsRenderedAgain) {
  render("case");
  succeed({"correlate", "case", "--quiet"});
  succeed({"report", "case", "--quiet"});
  render("case");
  EXPECT_THAT(names("case"), testing::Not(testing::Contains("report.html")));
}

TEST_F(Reports, SayWhatIsMissing) {
  expect_refused({"report", "nowhere"}, 2, {"nowhere", "neither a study", "manifest.jsonl"});
  render("case");
  expect_refused({"report", "case", "--quiet"}, 2, {"vectors.h5", "gladstone correlate"});
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 16]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--quiet", "--device", "cpu"});
  expect_refused({"report", "run"}, 2, {"holds no finished case", "gladstone sweep run run"});
  expect_refused({"report", "case", "--format", "pdf"}, 2, {"--format"});
}

}  // namespace
}  // namespace gladstone::end_to_end
