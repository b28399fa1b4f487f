#pragma once

#include <string>

namespace gladstone {

/// Memory that can be had without swapping [bytes]: what the system has left, or the control group's limit where that
/// is less.
double available_memory();

/// Refuses what would not fit: what a header says of a file is no proof that its data are there.
/// @param what needs them, "dataset \"density\" of 2000 x 1000 x 1000 values"
/// @throws MemoryError where `bytes` are not available
void require_memory(std::string const& path, std::string const& what, double bytes);

}  // namespace gladstone
