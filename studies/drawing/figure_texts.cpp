#include "studies/drawing/figure_texts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "render/base/contracts.h"
#include "studies/drawing/templates.h"

namespace gladstone::inline drawing {
namespace {

using plot::Align;
using plot::Box;
using plot::Label;
using plot::TextRole;

constexpr double edge_px = 8;  ///< least distance of texts from the edges of the page

/// Advance widths of the characters from blank to tilde in DejaVu Sans 2.37 [em/1000].
constexpr std::array<short, 95> widths{318,  401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337,
                                       636,  636, 636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531,
                                       1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787,
                                       603,  787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500,
                                       500,  613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612,
                                       635,  635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838};
constexpr double other_width = 640;  ///< width of other characters, about that of a Greek letter

PlacedText place(Label label, FigureFont font) {
  label.x += label.right_px;
  label.y += label.down_px;
  label.right_px = label.down_px = 0;
  double const width = text_width(label.text, font), height = font.size * 96 / 72;
  double const left = label.x - (label.align == Align::left ? 0.0 : label.align == Align::right ? width : width / 2);
  Box const box{left, left + width, label.y - height / 2, label.y + height / 2};
  return {std::move(label), std::move(font), box};
}

void move(PlacedText& text, double right, double down) {
  text.label.x += right;
  text.label.y += down;
  text.box.left += right;
  text.box.right += right;
  text.box.top += down;
  text.box.bottom += down;
}

void move_into_page(PlacedText& text, double width_px) {
  if (text.box.right > width_px - edge_px) move(text, width_px - edge_px - text.box.right, 0);
  if (text.box.left < edge_px) move(text, edge_px - text.box.left, 0);
}

bool overlap(Box const& a, Box const& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

/// Returns where a value is between the ends of an axis, 0 at the lower one.
double fraction(plot::Axis const& axis, double value) {
  if (axis.logarithmic) return std::log(value / axis.low) / std::log(axis.high / axis.low);
  return (value - axis.low) / (axis.high - axis.low);
}

}  // namespace

std::string_view to_string(TextRole role) {
  constexpr std::array<std::string_view, 9> names{"title", "subtitle",  "caption",       "heading",        "label",
                                                  "note",  "fine_note", "value_on_dark", "value_on_bright"};
  return names[static_cast<std::size_t>(role)];
}

FigureFont font_of(Figure::Kind kind, std::string_view name) {
  std::string const start = '\n' + std::string(name) + "_font = '";
  for (std::string_view const text : {kind == Figure::Kind::map       ? embedded::figure_map
                                      : kind == Figure::Kind::drawing ? embedded::figure_drawing
                                                                      : std::string_view{},
                                      embedded::figure_look}) {
    auto const found = text.find(start);
    if (found == std::string_view::npos) continue;
    auto const from = found + start.size();
    std::string const font(text.substr(from, text.find('\'', from) - from));
    auto const comma = font.find(',');
    return {font.substr(0, comma), std::strtod(font.c_str() + comma + 1, nullptr)};
  }
  GLADSTONE_EXPECTS(!"the templates have no such font");
  return {};
}

std::string colour_of(TextRole role) {
  std::string const start = ' ' + std::string(to_string(role)) + "_colour = '";
  auto const found = embedded::figure_look.find(start);
  GLADSTONE_ENSURES(found != std::string_view::npos);
  return std::string(embedded::figure_look.substr(found + start.size(), 7));
}

std::vector<std::string> colours_of(plot::Palette palette) {
  constexpr std::array<std::string_view, 3> starts{"\ndiverging = ", "\nsequential = ", "\ngrey = "};
  auto const found = embedded::figure_look.find(starts[static_cast<std::size_t>(palette)]);
  GLADSTONE_ENSURES(found != std::string_view::npos);
  std::string_view const line =
      embedded::figure_look.substr(found + 1, embedded::figure_look.find('\n', found + 1) - found);
  std::vector<std::string> colours;
  for (auto at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1))
    colours.emplace_back(line.substr(at, 7));
  return colours;
}

double text_width(std::string_view text, FigureFont const& font) {
  double sum = 0;
  for (char const c : text) {
    auto const code = static_cast<unsigned char>(c);
    if (code >= 32 && code < 127) sum += widths[code - 32u];
    if (code >= 192) sum += other_width;  // first byte of a character
  }
  double const bold = font.family.ends_with("Bold") ? 1.12 : 1;
  return bold * sum / 1000 * font.size * 96 / 72;
}

std::vector<PlacedText> place_texts(Figure const& figure) {
  std::vector<PlacedText> placed;
  for (Label const& label : figure.labels) {
    FigureFont font = font_of(figure.kind, to_string(label.role));
    double const room = figure.width_px - 2 * edge_px, width = text_width(label.text, font);
    if (width > room) font.size *= room / width;
    placed.push_back(place(label, std::move(font)));
    move_into_page(placed.back(), figure.width_px);
  }
  return placed;
}

std::vector<PlacedText> place_labels(Figure const& figure, plot::Panel const& panel) {
  std::vector<PlacedText> placed;
  if (!std::isfinite(panel.x.low + panel.x.high + panel.y.low + panel.y.high)) return placed;
  constexpr double step = 4, furthest = 100;  // [px]
  for (Label label : panel.labels) {
    label.x = panel.box.left + fraction(panel.x, label.x) * (panel.box.right - panel.box.left);
    label.y = panel.box.bottom + fraction(panel.y, label.y) * (panel.box.top - panel.box.bottom);
    bool const fixed = label.role == TextRole::value_on_dark || label.role == TextRole::value_on_bright;
    FigureFont font = font_of(figure.kind, to_string(label.role));
    PlacedText text = place(std::move(label), std::move(font));
    move_into_page(text, figure.width_px);
    PlacedText const first = text;
    for (double shift = 0; !fixed && shift <= furthest; shift = shift > 0 ? -shift : step - shift) {
      text = first;
      move(text, 0, shift);
      if (std::none_of(placed.begin(), placed.end(), [&](auto const& other) { return overlap(other.box, text.box); }))
        break;
    }
    placed.push_back(std::move(text));
  }
  return placed;
}

double legend_width(plot::Panel const& panel, Figure::Kind kind) {
  constexpr double sample = 52;  // width of the sample line and of the gaps on both sides of it [px]
  double longest = 0;
  for (plot::Layer const& layer : panel.layers) {
    longest = std::max(longest, text_width(layer.name, font_of(kind, "legend")));
  }
  return legend_gap + sample + longest;
}

}  // namespace gladstone::inline drawing
