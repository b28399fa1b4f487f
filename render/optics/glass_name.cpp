#include "render/optics/glass_name.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace gladstone::inline optics {
namespace {

constexpr std::array makers{"SCHOTT", "OHARA", "HOYA", "HIKARI", "NIKON", "CDGM", "SUMITA", "CORNING"};

/// Returns true if a catalogue has the given name, or continues it with a year or another word.
bool is_edition(std::string_view catalogue, std::string_view asked) {
  if (!catalogue.starts_with(asked)) return false;
  return catalogue.size() == asked.size() || std::isalpha(static_cast<unsigned char>(catalogue[asked.size()])) == 0;
}

}  // namespace

std::string glass_key(std::string_view name) {
  std::string key;
  for (char const c : name) {
    if (c != '-') key.push_back(static_cast<char>(std::toupper(static_cast<unsigned char>(c))));
  }
  return key;
}

bool is_catalogue(std::string_view catalogue, std::string_view asked) {
  return is_edition(catalogue, asked) || (asked == "NIKON" && is_edition(catalogue, "HIKARI"));
}

std::size_t maker_rank(std::string_view catalogue) {
  auto const maker =
      std::find_if(makers.begin(), makers.end(), [catalogue](char const* name) { return is_edition(catalogue, name); });
  return static_cast<std::size_t>(maker - makers.begin());
}

}  // namespace gladstone::inline optics
