#pragma once

#include <string>

namespace gladstone {

/// A whole file as it is. @throws DataError where it cannot be read
std::string read_text_file(std::string const& path);

}  // namespace gladstone
