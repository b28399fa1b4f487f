#pragma once

#include <string>

namespace gladstone {

/// What this executable was built from: version and commit, "0.1.0 (a5503eb9ee49)".
std::string build_text();
/// What --version prints: version, commit, backends.
std::string version_text();
/// The same as one JSON object.
std::string version_json();

}  // namespace gladstone
