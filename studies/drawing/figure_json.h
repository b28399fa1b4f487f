#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/drawing/figure.h"

namespace gladstone::inline drawing {

/// Returns a figure as JSON for figure.js, which draws it in a browser. Texts have their place, size and colour of the
/// templates, and maps the colours of their palette. Numbers are rounded to seven significant digits; null: not finite,
/// or automatic. Members that have their default value may be omitted.
nlohmann::json figure_json(Figure const& figure);

}  // namespace gladstone::inline drawing
