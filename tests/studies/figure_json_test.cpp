#include "studies/drawing/figure_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace gladstone {
namespace {

using namespace plot;

/// A figure with a map, a line with a gap, and labels in an axis with and without a range.
Figure sample() {
  Figure figure{400, 300, Figure::Kind::map};
  figure.add_title("title");
  Panel panel{.box = {50, 350, 40, 240}, .title = "p"};
  panel.x = {"x [mm]", 1, 100, true, {{10, "ten"}}};
  panel.y = {"y [px]", 5, -5};
  panel.map = Map{Image<double>(2, 1, 0.123456789), 1, 99, 0, 1};
  panel.map->values(1, 0) = std::nan("");
  panel.layers = {{.columns = {{1, 10, 100}, {0, std::nan(""), 2}}, .colour = "#0072b2", .name = "line"}};
  panel.labels = {{"label", 10, 0}};
  Panel automatic{.labels = {{"free", 3, 4, TextRole::note, Align::left, 5, 6}}};
  figure.panels = {panel, automatic};
  return figure;
}

TEST(FigureJson, HoldsSizesAxesAndLayers) {
  nlohmann::json const json = figure_json(sample());
  EXPECT_EQ(json["width"], 400);
  EXPECT_EQ(json["kind"], "map");
  EXPECT_EQ(json["texts"][0]["text"], "title");
  nlohmann::json const& panel = json["panels"][0];
  EXPECT_EQ(panel["x"]["logarithmic"], true);
  EXPECT_EQ(panel["x"]["ticks"], nlohmann::json::parse("[[10.0, \"ten\"]]"));
  EXPECT_EQ(panel["y"]["low"], 5.0);
  EXPECT_EQ(panel["layers"][0]["columns"], nlohmann::json::parse("[[1.0, 10.0, 100.0], [0.0, null, 2.0]]"));
  EXPECT_EQ(panel["layers"][0]["kind"], "line");
  EXPECT_TRUE(json["panels"][1]["x"]["low"].is_null()) << "automatic";
}

TEST(FigureJson, RoundsToSevenDigitsAndHoldsThePaletteOfTheTemplate) {
  nlohmann::json const map = figure_json(sample())["panels"][0]["map"];
  EXPECT_EQ(map["values"], nlohmann::json::parse("[0.1234568, null]"));
  EXPECT_EQ(map["colours"].size(), 9u);  // viridis at nine points
  EXPECT_EQ(map["colours"][0], "#440154");
  EXPECT_EQ(map["colours"][8], "#fde725");
}

// Labels are placed once, on the page, and return to the units of the axes: 10 is the middle of a logarithmic axis from
// 1 to 100, and nothing moves this label.
TEST(FigureJson, HoldsLabelsInUnitsOfTheAxes) {
  nlohmann::json const json = figure_json(sample());
  nlohmann::json const& label = json["panels"][0]["texts"][0];
  EXPECT_NEAR(label["x"], 10, 1e-5);  // seven digits
  EXPECT_NEAR(label["y"], 0, 1e-6);
  nlohmann::json const& free = json["panels"][1]["texts"][0];
  EXPECT_EQ(free["x"], 3.0);
  EXPECT_EQ(free["right"], 5.0);
  EXPECT_EQ(free["colour"], "#606060");
  EXPECT_EQ(free["align"], "left");
}

}  // namespace
}  // namespace gladstone
