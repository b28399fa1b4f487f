#pragma once

#include <cstddef>
#include <vector>

#include "render/scene/scene.h"

namespace gladstone::inline scene {

/// Returns the indices of all sources of a scene.
std::vector<std::size_t> all_sources(Scene const& scene);

/// Returns those of the given sources that are in view; if none is in view, the first of them.
std::vector<std::size_t> sources_in_view(Scene const& scene, std::vector<std::size_t> const& sources);

/// Selects `count` sources spread evenly over the list. Random dots are in random order, regular ones row by row.
std::vector<std::size_t> choose_sample(std::vector<std::size_t> const& sources, std::size_t count);

/// Returns the dots of a pattern that have the given indices.
DotPattern select_dots(DotPattern const& all, std::vector<std::size_t> const& indices);

}  // namespace gladstone::inline scene
