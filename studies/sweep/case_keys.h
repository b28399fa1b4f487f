#pragma once

#include <map>
#include <string>

#include "studies/case/case.h"

namespace gladstone::inline sweep {

/// Texts that identify the parts of a case that can be shared: equal texts imply bitwise equal parts.
struct CaseKeys {
  std::string medium;  ///< key of the refractive medium
  /// Key of dots, medium, lens and rays except their number: determines step and strain and, with that number, the
  /// frames.
  std::string scene;
  std::string rays;  ///< key of the number of rays
};

/// Treatment of the random seeds of dots and rays; if left out, all repeats of a case have equal keys.
enum class RepeatSeeds { count, left_out };

/// Computes the keys of a case.
/// @param inputs  hash of each input file in the manifest, by its name
CaseKeys case_keys(CaseSetup const& loaded, std::map<std::string, std::string> const& inputs,
                   RepeatSeeds seeds = RepeatSeeds::count);

}  // namespace gladstone::inline sweep
