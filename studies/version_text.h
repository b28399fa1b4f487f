#pragma once

#include <string>

namespace gladstone {

/// What --version prints: version, commit, backends.
std::string version_text();

}  // namespace gladstone
