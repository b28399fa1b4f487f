#include "render/files/fields/readers/array_order.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/base/error.h"
#include "render/base/nearest_name.h"

namespace gladstone::inline files {
namespace {

/// Returns the orders of some axes in which each coordinate dataset has the length of its axis plus `more`.
/// @param more  0: coordinates of nodes; 1: coordinates of the edges of cells
std::vector<std::string> fitting_orders(std::string letters,
                                        std::array<std::optional<ArrayCoordinates>, 3> const& of_letter,
                                        ArrayAxes const& axes, std::size_t more) {
  std::vector<std::string> fitting;
  do {
    bool fits = true;
    for (std::size_t i = 0; i < axes.rank(); ++i) {
      auto const& own = of_letter[static_cast<std::size_t>(letters[axes.rank() - 1 - i] - 'x')];
      if (!own) {
        fits = fits && (more == 0 || axes.length(i) == 1);
        continue;
      }
      bool const single = axes.length(i) == 1 && own->places.size() == 1;
      fits = fits && (own->places.size() == axes.length(i) + more || single) && own->axis.value_or(i) == i;
    }
    if (fits) fitting.push_back(letters);
  } while (std::next_permutation(letters.begin(), letters.end()));
  return fitting;
}

}  // namespace

ArrayOrder order_by_lengths(std::array<std::optional<ArrayCoordinates>, 3> const& of_letter, ArrayAxes const& axes,
                            std::string const& path, std::string const& name) {
  auto const wide = [&of_letter](char letter) {
    auto const& own = of_letter[static_cast<std::size_t>(letter - 'x')];
    return own && own->places.size() > 1;
  };
  std::string letters = "xyz";
  if (axes.rank() == 2) letters = !wide('z') || (wide('x') && wide('y')) ? "xy" : wide('y') ? "yz" : "xz";
  std::string const usual(letters.rbegin(), letters.rend());
  std::vector<std::string> fitting = fitting_orders(letters, of_letter, axes, 0);
  // n + 1 coordinates are the edges of n cells
  if (fitting.empty()) fitting = fitting_orders(letters, of_letter, axes, 1);
  bool some = false, meshes = false;
  for (auto const& own : of_letter) {
    some = some || own;
    meshes = meshes || (own && own->axis);
  }
  std::string const by = !some || fitting.size() != 1 ? "the default order"
                         : meshes                     ? "by its coordinates"
                                                      : "by the lengths of its coordinates";
  if (fitting.empty() || std::find(fitting.begin(), fitting.end(), usual) != fitting.end()) {
    return {usual, by, fitting.size() > 1};
  }
  if (fitting.size() > 1) {
    throw DataError(ErrorCode::undetermined, path,
                    fmt::format("the coordinates of \"{}\" of shape {} allow several orders of its axes; name "
                                "the right one: axes = {}",
                                name, shape_text(axes.shape), quoted_list(fitting)));
  }
  return {fitting.front(), by};
}

}  // namespace gladstone::inline files
