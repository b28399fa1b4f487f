#include "studies/figures/study_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "render/files/image_file.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/study_cells.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

StudyAxis numbers(std::string key, std::vector<double> values) {
  StudyAxis axis{std::move(key), true, {}, values};
  for (double const value : values) {
    std::ostringstream text;
    text << value;
    axis.labels.push_back(text.str());
  }
  return axis;
}

StudyAxis words(std::string key, std::vector<std::string> labels) {
  std::vector<double> const none(labels.size(), std::numeric_limits<double>::quiet_NaN());
  return {std::move(key), false, std::move(labels), none};
}

/// All combinations of the axes, the last axis fastest, repeats outermost; the error is 0.01 (1 + case) px, of which
/// 0.03 px is common to all repeats and 0.01 px varies.
StudyTable grid(std::vector<StudyAxis> axes, std::size_t repeats) {
  StudyTable table;
  table.name = "some_study";
  table.axes = std::move(axes);
  table.measures = {"ray_truth.rms_px", "eq9.rms_px", "signal_px", "budget.terms.cone.rms_px", "budget.total.rms_px"};
  std::size_t points = 1;
  for (StudyAxis const& axis : table.axes) points *= axis.labels.size();
  for (std::size_t i = 0; i < points * repeats; ++i) {
    StudyRow row;
    row.index = i;
    row.repeat = i / points;
    row.status = CaseStatus::ok;
    row.value.resize(table.axes.size());
    std::size_t rest = i % points;
    for (std::size_t k = table.axes.size(); k-- > 0; rest /= table.axes[k].labels.size()) {
      row.value[k] = rest % table.axes[k].labels.size();
    }
    if (row.repeat == 0) {
      table.points.push_back({{}, std::vector<RepeatSplit>(vector_error_names().size(), RepeatSplit{9, 0.03, 0.01})});
    }
    table.points[i % points].rows.push_back(i);
    double const error = 0.01 * (1.0 + static_cast<double>(i));
    row.measures = {error, 2 * error, 0.5, error, 1.5 * error};
    table.rows.push_back(row);
  }
  return table;
}

/// A study with the given number of points: f-number 4 + i and a Z_D by step i mod count for the i-th one.
StudyTable one_value_a_point(std::size_t count, std::size_t step) {
  std::vector<double> stops, distances;
  for (std::size_t i = 0; i < count; ++i) {
    stops.push_back(4.0 + static_cast<double>(i));
    distances.push_back(100.0 + static_cast<double>(i));
  }
  StudyTable table = grid({numbers("lens.f_number", stops)}, 1);
  table.axes.push_back(numbers("geometry.z_d_mm", distances));
  for (StudyRow& row : table.rows) row.value.push_back(step * row.index % count);
  return table;
}

class StudyFigures : public FolderFixture {
 protected:
  /// Names of the drawn figures.
  std::vector<std::string> draw(StudyTable const& table) const {
    std::vector<std::string> names;
    for (std::string const& path : draw_study(folder_.string(), table)) {
      EXPECT_TRUE(std::filesystem::exists(path)) << path;
      names.push_back(std::filesystem::path(path).filename().string());
    }
    return names;
  }
};

TEST(AxisTitle, ComesFromTheKeyWithItsUnit) {
  EXPECT_EQ(axis_title("lens.focal_length_mm"), "focal length [mm]");
  EXPECT_EQ(axis_title("lens.f_number"), "f-number");
  EXPECT_EQ(axis_title("geometry.z_d_mm"), "Z_D [mm]");
  EXPECT_EQ(axis_value_text("Z_D [mm]", "200"), "Z_D = 200 mm");
  EXPECT_EQ(axis_value_text("f-number", "16"), "f-number = 16");
  EXPECT_EQ(axis_title("medium.field.amplitude_kg_m3"), "amplitude [kg/m³]");
  EXPECT_EQ(axis_title("camera.noise.read_noise_e"), "read noise [e⁻]");
  EXPECT_EQ(axis_title("camera.pixel_pitch_um"), "pixel pitch [µm]");
  EXPECT_EQ(axis_title("camera.offset_dn"), "offset [DN]");
  EXPECT_EQ(axis_title("medium.gladstone_dale"), "gladstone dale [m³/kg]");
  EXPECT_EQ(axis_title("correlate.overlap"), "overlap");
}

TEST(FigureAxis, IsLogarithmicWhereTheValuesAre) {
  EXPECT_TRUE(figure_axis(numbers("a", {4, 5.6, 8, 11, 16, 22, 32}), 12).logarithmic);
  EXPECT_TRUE(figure_axis(numbers("a", {100, 300, 500, 1100}), 12).logarithmic);  // more than a decade
  EXPECT_FALSE(figure_axis(numbers("a", {5, 10, 15, 20}), 12).logarithmic);
  EXPECT_FALSE(figure_axis(numbers("a", {0, 1, 10, 100}), 12).logarithmic);
  EXPECT_FALSE(figure_axis(numbers("a", {1, 100}), 12).logarithmic);
}

TEST(FigureAxis, SortsNumbersAndKeepsCategories) {
  FigureAxis const sorted = figure_axis(numbers("a", {30, 10, 20}), 12);
  EXPECT_THAT(sorted.position, ElementsAre(10, 20, 30));
  EXPECT_THAT(sorted.place_of, ElementsAre(2, 0, 1));
  FigureAxis const kept = figure_axis(words("a", {"z", "a", "m"}), 12);
  EXPECT_THAT(kept.label, ElementsAre("z", "a", "m"));
  EXPECT_THAT(figure_axis(words("a", {"z", "a", "m"}), 2).label, ElementsAre("z", "others"));
}

TEST(FigureAxis, TakesNumbersWithInfinityAsCategories) {
  FigureAxis const axis = figure_axis(numbers("a", {8, 16, HUGE_VAL}), 12);
  EXPECT_FALSE(axis.numeric);
  EXPECT_THAT(axis.label, ElementsAre("8", "16", "inf"));
  EXPECT_THAT(axis.position, ElementsAre(0, 1, 2));
}

TEST(FigureAxis, BinsManyNumbersByEqualCount) {
  FigureAxis const axis = figure_axis(numbers("a", {1, 2, 3, 5, 6, 7}), 2);
  EXPECT_THAT(axis.position, ElementsAre(2, 6));
  EXPECT_THAT(axis.place_of, ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_TRUE(axis.binned);
}

// sqrt((9 + 16) / 2)
TEST(Scatter, IsRootMeanSquareOfRepeatsAndMedianOfOthers) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  Scatter const repeats = compute_scatter({4, nan, 3}, true);
  EXPECT_DOUBLE_EQ(repeats.centre, std::sqrt(12.5));
  EXPECT_EQ(repeats.low, 3);
  EXPECT_EQ(repeats.high, 4);
  EXPECT_EQ(compute_scatter({1, 2, 90}, false).centre, 2);
  EXPECT_TRUE(std::isnan(compute_scatter({nan}, true).centre));
}

TEST(StudyCurves, AreCombinationsOfTheOtherAxesWhileColoursLast) {
  StudyTable const table = grid(
      {words("medium.field", {"a", "b"}), numbers("geometry.z_d_mm", {1, 2}), numbers("lens.f_number", {4, 8, 16})}, 2);
  StudyCells const cells(table);
  std::vector<CurveChoice> const four = curves_over(cells, 2, 7);
  ASSERT_EQ(four.size(), 4u);
  EXPECT_EQ(four[1].name, "a, Z_D = 2 mm");
  EXPECT_EQ(cells.rows_at({{2, 0}, {0, 0}, {1, 1}}).size(), 2u);
  EXPECT_TRUE(cells.only_repeats_differ(cells.rows_at({{2, 0}, {0, 0}, {1, 1}})));
  EXPECT_FALSE(cells.only_repeats_differ(cells.rows_at({{2, 0}, {0, 0}})));
  std::vector<CurveChoice> const by_field = curves_over(cells, 2, 3);
  ASSERT_EQ(by_field.size(), 2u);
  EXPECT_EQ(by_field[1].name, "b");
  EXPECT_EQ(curves_over(cells, 2, 1).size(), 1u);
}

TEST_F(StudyFigures, AreCurvesBudgetsAndMapsInTwoFormats) {
  std::vector<std::string> const names =
      draw(grid({numbers("lens.f_number", {4, 8, 16}), numbers("geometry.z_d_mm", {100, 200})}, 2));
  EXPECT_THAT(names,
              ElementsAre("error_against_lens_f_number.png", "error_against_lens_f_number.svg",
                          "budget_lens_f_number.png", "budget_lens_f_number.svg", "repeats_lens_f_number.png",
                          "repeats_lens_f_number.svg", "error_map_lens_f_number_geometry_z_d_mm.png",
                          "error_map_lens_f_number_geometry_z_d_mm.svg", "error_against_geometry_z_d_mm.png",
                          "error_against_geometry_z_d_mm.svg", "budget_geometry_z_d_mm.png",
                          "budget_geometry_z_d_mm.svg", "repeats_geometry_z_d_mm.png", "repeats_geometry_z_d_mm.svg"));
  EXPECT_GT(read_image((folder_ / names[0]).string()).columns(), 700);
  std::string const svg = content(folder_ / "error_against_lens_f_number.svg");
  for (char const* piece : {"Error against f-number", "Z_D = 200 mm", "measured − Eq. 9", "study some_study, 12 cases",
                            "root mean square over 2 repeats"}) {
    EXPECT_THAT(svg, HasSubstr(piece));
  }
  // Cell (f/4, 200 mm) has cases 1 and 7, errors 0.02 and 0.08: sqrt((4 + 64) / 2) / 100 = 0.058.
  EXPECT_THAT(content(folder_ / "error_map_lens_f_number_geometry_z_d_mm.svg"), HasSubstr("0.058"));
}

// A single case has no pattern term; with repeats the budget has one, and a figure shows both parts.
TEST_F(StudyFigures, TellEstimatorAndPatternApartWithRepeats) {
  for (std::size_t const repeats : {1, 2}) {
    StudyTable table = grid({numbers("lens.f_number", {4, 8, 16})}, repeats);
    for (char const* term : {"estimator", "pattern"}) {
      table.measures.push_back(std::string("budget.terms.") + term + ".rms_px");
      double const known = std::string(term) == "estimator" ? 0.04 : std::numeric_limits<double>::quiet_NaN();
      for (StudyRow& row : table.rows) row.measures.push_back(known);
    }
    std::vector<std::string> const names = draw(table);
    EXPECT_EQ(testing::Matches(testing::Contains("repeats_lens_f_number.svg"))(names), repeats > 1);
    EXPECT_EQ(testing::Matches(HasSubstr("below the axis: pattern"))(content(folder_ / "budget_lens_f_number.svg")),
              repeats == 1);
    std::filesystem::remove_all(folder_);
  }
}

// PIV has no Eq. 9: the errors are those against ray truth and the flow.
TEST_F(StudyFigures, OfParticlesShowTheErrorAgainstTheFlow) {
  StudyTable table = grid({numbers("lens.f_number", {4, 8, 16}), numbers("geometry.z_d_mm", {100, 200})}, 1);
  table.measures[1] = "flow.rms_px";
  draw(table);
  for (char const* figure : {"error_against_lens_f_number.svg", "error_map_lens_f_number_geometry_z_d_mm.svg"}) {
    EXPECT_THAT(content(folder_ / figure), HasSubstr("measured − flow")) << figure;
    EXPECT_THAT(content(folder_ / figure), Not(HasSubstr("Eq. 9"))) << figure;
  }
}

// Cases 0, 1 and 2 cover 50, 60 and 70 % of their errors.
TEST(StudyFigureMaker, ComparesTheCoverageWithThatOfNormalErrors) {
  StudyTable table = grid({numbers("lens.f_number", {4, 8, 16})}, 1);
  EXPECT_FALSE(StudyFigureMaker(table).make_coverage(0));
  table.measures.emplace_back(coverage_measure);
  for (StudyRow& row : table.rows) row.measures.push_back(0.5 + 0.1 * static_cast<double>(row.index));
  std::optional<Figure> const figure = StudyFigureMaker(table).make_coverage(0);
  ASSERT_TRUE(figure);
  std::vector<plot::Layer> const& layers = figure->panels.front().layers;
  ASSERT_EQ(layers.size(), 3u);  // line, its points, and the coverage of normal errors
  EXPECT_THAT(layers[1].columns[1], ElementsAre(0.5, 0.6, 0.7));
  EXPECT_THAT(layers[2].columns[1], testing::Each(0.6827));
  EXPECT_THAT(layers[2].name, HasSubstr("68 %"));
}

TEST(StudyFigureMaker, PlotsAPointForEveryFinishedCase) {
  StudyTable table = grid({numbers("lens.f_number", {4, 8, 16})}, 1);
  table.rows[0].status = CaseStatus::failed;
  for (StudyRow& row : table.rows) row.measures[2] = 0.25 * static_cast<double>(row.index);  // signal
  std::optional<Figure> const figure = StudyFigureMaker(table).make_case_points();
  ASSERT_TRUE(figure);
  plot::Layer const& points = figure->panels.front().layers.front();
  EXPECT_THAT(points.columns[0], ElementsAre(0.25, 0.5));
  EXPECT_THAT(points.columns[1], ElementsAre(0.04, 0.06));
  EXPECT_EQ(points.notes[1], "case 2\nf-number = 16\nsignal: 0.5 px\nmeasured − Eq. 9: 0.06 px");
  EXPECT_EQ(figure->panels.front().y.label, "measured − Eq. 9, rms per component [px]");
  table.measures[2] = "other_px";
  EXPECT_FALSE(StudyFigureMaker(table).make_case_points()) << "a study without signals";
}

TEST_F(StudyFigures, LeaveOutWhatIsNotThere) {
  StudyTable table = grid({numbers("lens.f_number", {4, 8}), words("medium.field", {"plume"})}, 1);
  EXPECT_EQ(draw(table).size(), 4u);  // an axis with one value is omitted
  for (StudyRow& row : table.rows) row.status = CaseStatus::failed;
  EXPECT_TRUE(draw(table).empty());
}

// In "zip" mode two axes vary together: three of nine cells of a map would be filled.
TEST_F(StudyFigures, AxesThatGoTogetherHaveNoMap) {
  StudyTable table = grid({numbers("lens.f_number", {4, 8, 16}), numbers("geometry.z_d_mm", {100, 200, 400})}, 1);
  std::erase_if(table.rows, [](StudyRow const& row) { return row.value[0] != row.value[1]; });
  for (std::string const& name : draw(table)) EXPECT_THAT(name, Not(HasSubstr("map")));
  // 8 points in 2 x 2 bins: two cells of four; 24 in 3 x 3 bins: three of nine
  for (std::size_t const count : {8, 24}) {
    for (std::string const& name : draw(one_value_a_point(count, 1))) EXPECT_THAT(name, Not(HasSubstr("map")));
  }
}

// 24 points in sqrt(24 / 2) = 3.5 bins per axis, that is 3, with 8 points each. Of the first eight, whose positions
// along the other axis are 0, 7, 14, 21, 4, 11, 18, 1, the lowest cell has points 0, 1, 4, 7 with errors 0.01, 0.02,
// 0.05, 0.08: median 0.035.
TEST_F(StudyFigures, SampledAxesHaveAMap) {
  draw(one_value_a_point(24, 7));
  EXPECT_THAT(content(folder_ / "error_map_lens_f_number_geometry_z_d_mm.svg"), HasSubstr(">0.035<"));
  EXPECT_EQ(StudyCells(one_value_a_point(24, 7)).axis(0).size(), 12u);  // along one axis
  EXPECT_EQ(sampled_places_in_maps(1000), 12u);
}

TEST_F(StudyFigures, AreDrawnOfAPinholeToo) {
  EXPECT_EQ(draw(grid({numbers("lens.f_number", {8, 16, HUGE_VAL}), numbers("geometry.z_d_mm", {100, 200})}, 2)).size(),
            14u);
  EXPECT_THAT(content(folder_ / "error_against_lens_f_number.svg"), HasSubstr(">inf<"));
}

TEST_F(StudyFigures, ShowTheLabelsOfNumbers) {
  StudyAxis axis = numbers("lens.f_number", {4, 8, 9});
  axis.labels = {"wide open", "the sharpest stop", "one a little smaller"};
  axis.labelled = true;
  draw(grid({axis}, 1));
  for (char const* label : {">wide open<", ">the sharpest stop<", ">one a little smaller<"}) {
    EXPECT_THAT(content(folder_ / "error_against_lens_f_number.svg"), HasSubstr(label));
  }
}

// gnuplot interprets tic labels, and no other texts, as number formats.
TEST_F(StudyFigures, ShowPercentSignsInLabels) {
  draw(grid({words("lens.psf", {"50 % stop", "100 %", "5 %% of it"}), words("medium.field", {"9 % up", "9 % down"})},
            1));
  for (char const* figure : {"error_against_lens_psf", "budget_lens_psf", "error_map_lens_psf_medium_field"}) {
    for (char const* label : {">50 % stop<", ">100 %<", ">5 %% of it<", ">9 % up<", ">9 % down<"}) {
      EXPECT_THAT(content(folder_ / (std::string(figure) + ".svg")), HasSubstr(label));
    }
  }
}

TEST_F(StudyFigures, ManyValuesAreBinned) {
  std::vector<double> many;
  for (int i = 0; i < 60; ++i) many.push_back(4.0 + i);
  EXPECT_EQ(draw(grid({numbers("lens.f_number", many)}, 1)).size(), 4u);
  EXPECT_THAT(content(folder_ / "error_against_lens_f_number.svg"), HasSubstr("medians of the cases"));
}

}  // namespace
}  // namespace gladstone
