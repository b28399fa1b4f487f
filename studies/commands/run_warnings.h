#pragma once

#include <string>
#include <vector>

namespace spdlog {
class logger;
}

namespace gladstone {

/// Makes a log keep every warning that passes through it, for `warnings` of --json.
void record_warnings(spdlog::logger& log);

/// The texts of all warnings so far, in their order, each once.
std::vector<std::string> recorded_warnings();

}  // namespace gladstone
