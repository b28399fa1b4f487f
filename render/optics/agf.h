#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/optics/glass.h"

namespace gladstone::inline optics {

/// Error in a line of a glass catalogue.
struct AgfFault {
  int line;
  std::string text;
};

/// Content of a catalogue in AGF format. An error invalidates the glass that contains it, not the catalogue.
struct AgfContent {
  struct LeftOut {
    std::string name;
    AgfFault fault;
  };
  std::vector<Glass> glasses;  ///< usable glasses; `where` is the line number
  std::vector<LeftOut> left_out;
  std::vector<AgfFault> skipped_lines;  ///< skipped lines of glasses that are used without them
};

/// Reads the lines NM, CD, LD and IT of a catalogue.
/// @param text        content in UTF-8
/// @param catalogue   name of the catalogue
/// @param first_line  number of the first line
AgfContent read_agf(std::string_view text, std::string const& catalogue, int first_line = 1);

/// Returns true if a refractive index is plausible: from air relative to air up to infrared crystals.
inline bool is_index(double n) { return n > 0.99 && n < 7; }

}  // namespace gladstone::inline optics
