#include "studies/drawing/figure_json.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "studies/drawing/figure_texts.h"

namespace gladstone::inline drawing {
namespace {

using namespace plot;
using Json = nlohmann::json;

/// Returns the word of an enumerator.
template <std::size_t count, class Enumeration>
char const* word(std::array<char const*, count> const& words, Enumeration value) {
  return words[static_cast<std::size_t>(value)];
}

Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr);
}

template <class Values>
Json rounded_all(Values const& values) {
  Json all = Json::array();
  for (double const value : values) all.push_back(rounded(value));
  return all;
}

Json ticks_json(std::vector<Tick> const& ticks) {
  Json all = Json::array();
  for (Tick const& tick : ticks) all.push_back({rounded(tick.at), tick.text});
  return all;
}

Json axis_json(Axis const& axis) {
  return {{"label", axis.label},
          {"low", rounded(axis.low)},
          {"high", rounded(axis.high)},
          {"logarithmic", axis.logarithmic},
          {"ticks", ticks_json(axis.ticks)},
          {"marks", word(std::array{"texts", "ticks", "bare", "none"}, axis.marks)},
          {"slanted", axis.slanted}};
}

/// @param x,y  place, on the page [px] or in units of the axes
Json text_json(Label const& label, FigureFont const& font, double x, double y) {
  bool const on_map = label.role == TextRole::value_on_dark || label.role == TextRole::value_on_bright;
  return {{"text", label.text},
          {"x", rounded(x)},
          {"y", rounded(y)},
          {"right", label.right_px},
          {"down", label.down_px},
          {"align", word(std::array{"left", "centre", "right"}, label.align)},
          {"boxed", label.boxed},
          {"on_map", on_map},
          {"colour", label.colour.empty() ? colour_of(label.role) : label.colour},
          {"size", rounded(font.size * 96 / 72)},
          {"bold", font.family.ends_with("Bold")}};
}

/// Returns the value at a fraction of the length of an axis.
double value_at(Axis const& axis, double fraction) {
  return axis.logarithmic ? axis.low * std::pow(axis.high / axis.low, fraction)
                          : axis.low + fraction * (axis.high - axis.low);
}

/// Returns the labels of a panel in units of its axes, so that they follow a change of the ranges.
Json panel_texts(Figure const& figure, Panel const& panel) {
  Json texts = Json::array();
  Box const& box = panel.box;
  std::vector<PlacedText> const placed = place_labels(figure, panel);
  for (PlacedText const& text : placed) {
    texts.push_back(text_json(text.label, text.font,
                              value_at(panel.x, (text.label.x - box.left) / (box.right - box.left)),
                              value_at(panel.y, (text.label.y - box.bottom) / (box.top - box.bottom))));
  }
  if (!placed.empty()) return texts;
  for (Label const& label : panel.labels)
    texts.push_back(text_json(label, font_of(figure.kind, to_string(label.role)), label.x, label.y));
  return texts;
}

Json map_json(Map const& map) {
  return {{"columns", map.values.columns()},
          {"rows", map.values.rows()},
          {"values", rounded_all(map.values)},
          {"x", {rounded(map.x_first), rounded(map.x_step)}},
          {"y", {rounded(map.y_first), rounded(map.y_step)}},
          {"colours", colours_of(map.palette)},
          {"low", rounded(map.low)},
          {"high", rounded(map.high)},
          {"logarithmic", map.logarithmic},
          {"bar", map.has_bar},
          {"ticks", ticks_json(map.ticks)}};
}

Json layer_json(Layer const& layer) {
  constexpr std::array kinds{"line",   "points", "errors", "band",  "bars",
                             "levels", "boxes",  "arrows", "spans", "guides"};
  Json json{{"kind", word(kinds, layer.kind)},
            {"colour", layer.colour},
            {"width", layer.width},
            {"dash", word(std::array{"solid", "dashed", "dotted"}, layer.dash)},
            {"columns", Json::array()}};
  for (std::vector<double> const& column : layer.columns) json["columns"].push_back(rounded_all(column));
  if (!layer.name.empty()) json["name"] = layer.name;
  if (layer.marker != 0) json.update({{"marker", layer.marker}, {"size", layer.size}});
  if (layer.opacity < 1) json["opacity"] = layer.opacity;
  if (!layer.notes.empty()) json["notes"] = layer.notes;
  return json;
}

Json panel_json(Figure const& figure, Panel const& panel) {
  constexpr std::array places{"none",  "top_left",    "top_right", "bottom_left", "bottom_right",
                              "above", "above_right", "right",     "below"};
  Json json{
      {"box",
       {{"left", panel.box.left}, {"right", panel.box.right}, {"top", panel.box.top}, {"bottom", panel.box.bottom}}},
      {"title", panel.title},
      {"x", axis_json(panel.x)},
      {"y", axis_json(panel.y)},
      {"layers", Json::array()},
      {"texts", panel_texts(figure, panel)},
      {"legend",
       {{"place", word(places, panel.legend.place)},
        {"top", panel.legend.top_px},
        {"horizontal", panel.legend.horizontal}}},
      {"border", word(std::array{"full", "bottom", "none"}, panel.border)},
      {"grid", word(std::array{"none", "horizontal", "both"}, panel.grid)},
      {"equal", panel.equal_scales}};
  if (panel.map) json["map"] = map_json(*panel.map);
  for (Layer const& layer : panel.layers) json["layers"].push_back(layer_json(layer));
  return json;
}

}  // namespace

Json figure_json(Figure const& figure) {
  Json json{{"width", figure.width_px},
            {"height", figure.height_px},
            {"kind", word(std::array{"chart", "map", "drawing"}, figure.kind)},
            {"texts", Json::array()},
            {"panels", Json::array()}};
  for (PlacedText const& text : place_texts(figure))
    json["texts"].push_back(text_json(text.label, text.font, text.label.x, text.label.y));
  for (Panel const& panel : figure.panels) json["panels"].push_back(panel_json(figure, panel));
  return json;
}

}  // namespace gladstone::inline drawing
