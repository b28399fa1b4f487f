#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/design/verification.h"

namespace gladstone {

/// What was predicted beside what was simulated, and why they differ; what is not kept of what was required.
std::string verification_text(Verification const& verification, DesignQuestion const& question);

/// simulated {bias_px, random_px, resolution_mm, ...} of the recommended bench, and verification [..] of all.
nlohmann::ordered_json verification_json(Verification const& verification);

}  // namespace gladstone
