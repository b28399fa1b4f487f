#pragma once

#include <string>

#include "studies/drawing/figure.h"
#include "studies/report/report_page.h"

namespace gladstone {

/// Returns a figure embedded in the page; without gnuplot, its description.
/// @param words  description in numbers
ReportBlock drawn_block(std::string title, std::string words, Figure const& figure);

}  // namespace gladstone
