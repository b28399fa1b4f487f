#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "studies/drawing/figure.h"

namespace gladstone::inline drawing {

/// Font of a role in the template of a figure.
struct FigureFont {
  std::string family;
  double size;  ///< [pt], 96/72 px each
};

/// Name of a role in the templates.
std::string_view to_string(plot::TextRole role);

/// Reads the font NAME_font of a template.
FigureFont font_of(Figure::Kind kind, std::string_view name);

/// Returns the colour of a role in the templates, as "#rrggbb".
std::string colour_of(plot::TextRole role);

/// Returns the colours of a palette in the templates from its lower to its upper end, equally spaced.
std::vector<std::string> colours_of(plot::Palette palette);

/// Returns the width of a UTF-8 text of one line in DejaVu Sans [px].
double text_width(std::string_view text, FigureFont const& font);

/// Text with its position on the page.
struct PlacedText {
  plot::Label label;  ///< position x, y on the page [px]; the shifts are applied
  FigureFont font;
  plot::Box box;
};

/// Places texts of the page: those that are longer than the page is wide are made smaller, others moved into it.
std::vector<PlacedText> place_texts(Figure const& figure);

/// Places the labels of a panel: they are moved into the page, and upwards or downwards until they overlap no other.
/// Numbers in the cells of a map are not moved.
/// @return empty if a range of an axis is automatic
std::vector<PlacedText> place_labels(Figure const& figure, plot::Panel const& panel);

inline constexpr double legend_gap = 14;  ///< distance from a panel to the legend at its side [px]

/// Returns the width of the legend to the right of a panel, with the gap [px].
double legend_width(plot::Panel const& panel, Figure::Kind kind);

}  // namespace gladstone::inline drawing
