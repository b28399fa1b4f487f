#pragma once

#include <functional>
#include <string>

#include "studies/report/report_page.h"

namespace gladstone {

/// Returns a figure embedded in the page; without gnuplot, its description.
/// @param words  description in numbers
/// @param write  writes the figure to a path that ends in .png
ReportBlock drawn_block(std::string title, std::string words,
                        std::function<void(std::string const& path)> const& write);

}  // namespace gladstone
