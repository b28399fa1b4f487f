#pragma once

#include <string>

namespace gladstone {

/// What --version prints: version, commit, backends.
std::string version_text();
/// The same as one JSON object.
std::string version_json();

}  // namespace gladstone
