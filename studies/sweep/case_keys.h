#pragma once

#include <map>
#include <string>

#include "studies/case.h"

namespace gladstone {

/// What parts of a case depend on, as text: equal texts, equal parts to the last bit.
struct CaseKeys {
  std::string medium;  ///< the field, built
  std::string scene;   ///< dots, medium, lens, rays but for their number: step, strain and, with that number, frames
  std::string rays;    ///< the number of rays
};

/// Whether the seeds of dots and of rays count: without them repeats of a case have equal keys.
enum class RepeatSeeds { count, left_out };

/// @param inputs of the manifest: names of files and their hashes
CaseKeys case_keys(CaseSetup const& loaded, std::map<std::string, std::string> const& inputs,
                   RepeatSeeds seeds = RepeatSeeds::count);

}  // namespace gladstone
