#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gladstone::inline optics {

/// Returns the form in which names of glasses and catalogues are compared: upper case, without hyphens. NBK7 equals
/// N-BK7.
std::string glass_key(std::string_view name);

/// Returns true if a catalogue has the given name or is an edition of it, such as SCHOTT_2017 or SCHOTT-NEW. HIKARI is
/// also found as NIKON, who sells its glasses. Both names are keys.
bool is_catalogue(std::string_view catalogue, std::string_view asked);

/// Returns the position of a catalogue in the order in which catalogues are searched: SCHOTT, OHARA, HOYA, HIKARI,
/// NIKON, CDGM, SUMITA, CORNING, then all others, which share the last position.
std::size_t maker_rank(std::string_view catalogue);

}  // namespace gladstone::inline optics
