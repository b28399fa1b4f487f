#include "studies/drawing/figure_texts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "render/files/image_file.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/design_map.h"
#include "studies/figures/layout_figure.h"
#include "tests/studies/support/table1_design.h"

namespace gladstone {
namespace {

using plot::Box;

/// Expects that the labels of a panel are in the page and do not overlap.
void expect_readable(Figure const& figure, plot::Panel const& panel, std::string const& what) {
  std::vector<PlacedText> const texts = place_labels(figure, panel);
  ASSERT_EQ(texts.size(), panel.labels.size()) << what;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    Box const& a = texts[i].box;
    EXPECT_TRUE(a.left >= 0 && a.right <= figure.width_px && a.top >= 0 && a.bottom <= figure.height_px)
        << what << ": \"" << texts[i].label.text << "\" leaves the page";
    for (std::size_t k = 0; k < i; ++k) {
      Box const& b = texts[k].box;
      EXPECT_FALSE(a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom)
          << what << ": \"" << texts[i].label.text << "\" overlaps \"" << texts[k].label.text << '"';
    }
  }
}

// From dots close behind the medium to far ones, and from a short to a long lens: all parts of the layout come close to
// one another somewhere.
TEST(FigureTexts, OfLayoutsAndMapsNeitherOverlapNorLeaveThePage) {
  FixedDesignParameters given = table1_given();
  for (double const thickness : {0.001, 0.1}) {
    given.thickness = thickness;
    for (double const z_d : {0.01, 0.25, 5.0}) {
      for (double const focal_length : {0.025, 0.105, 0.3}) {
        DesignPoint<double> bench = table1_design(given);
        bench.z_d = z_d;
        bench.focal_length = focal_length;
        std::string const what = "Z_D " + std::to_string(z_d) + ", f " + std::to_string(focal_length);
        Figure const layout = make_layout_figure(bench), map = make_design_map(bench, nullptr);
        expect_readable(layout, layout.panels.back(), "layout of " + what);
        expect_readable(map, map.panels.front(), "map of " + what);
      }
    }
  }
}

TEST(FigureTexts, LongTitlesFitThePage) {
  Figure figure{400, 300};
  figure.add_title("short");
  figure.add_title(std::string(200, 'm'));
  std::vector<PlacedText> const texts = place_texts(figure);
  EXPECT_DOUBLE_EQ(texts[0].font.size, font_of(Figure::Kind::chart, "title").size);
  EXPECT_LT(texts[1].font.size, texts[0].font.size);
  EXPECT_GE(texts[1].box.left, 0);
  EXPECT_LE(texts[1].box.right, 400);
}

// The template of maps has smaller ticks than that of all figures, and the same titles.
TEST(FigureTexts, HaveTheFontsOfTheTemplates) {
  EXPECT_LT(font_of(Figure::Kind::map, "tick").size, font_of(Figure::Kind::chart, "tick").size);
  EXPECT_EQ(font_of(Figure::Kind::map, "title").size, font_of(Figure::Kind::chart, "title").size);
  EXPECT_EQ(font_of(Figure::Kind::chart, "heading").family, "DejaVu Sans Bold");
}

// The first and the last dark column of a drawn text are those of its computed box. Glyphs do not fill their advance
// width: up to 0.1 em, 2 px at 14 pt, are blank on either side, and antialiasing blurs the edge by 1 px.
TEST(FigureTexts, AreAsWideAsTheyAreDrawn) {
  Figure figure{600, 80};
  figure.add_title("Hamburgefonts: f = 105 mm, Z_D = 250 mm");
  figure.panels.push_back({.box = {10, 590, 70, 76}, .border = plot::Border::none});
  figure.panels.front().x.marks = figure.panels.front().y.marks = plot::Axis::Marks::none;
  std::string const path = (std::filesystem::path(testing::TempDir()) / "gladstone_figure_texts.png").string();
  try {
    draw_figure(figure, path);
  } catch (GnuplotMissing const&) {
    GTEST_SKIP() << "no gnuplot here";
  }
  Image<double> const picture = read_image(path);
  int first = picture.columns(), last = 0;
  for (int row = 0; row < picture.rows(); ++row) {
    for (int column = 0; column < picture.columns(); ++column) {
      if (picture(column, row) > 128) continue;
      first = std::min(first, column);
      last = std::max(last, column);
    }
  }
  Box const box = place_texts(figure).front().box;
  EXPECT_NEAR(first, box.left, 3);
  EXPECT_NEAR(last, box.right, 3);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace gladstone
