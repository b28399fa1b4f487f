#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/design/verification.h"

namespace gladstone::inline design {

/// Formats a comparison of predicted and simulated quantities with explanations of the differences, and lists
/// requirements that are not met.
std::string verification_text(Verification const& verification, DesignQuestion const& question);

/// Returns JSON: simulated {bias_px, random_px, resolution_mm, ...} of the recommended design, and verification [..] of
/// all designs.
nlohmann::ordered_json verification_json(Verification const& verification);

}  // namespace gladstone::inline design
