#pragma once

#include <string>

namespace gladstone::inline cases {

/// Returns version and commit of this build, "0.1.0 (a5503eb9ee49)".
std::string build_text();
/// Returns the text of --version: version, commit and backends.
std::string version_text();
/// Returns version, commit and backends as a JSON object.
std::string version_json();

}  // namespace gladstone::inline cases
