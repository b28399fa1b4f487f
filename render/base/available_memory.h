#pragma once

#include <string>

namespace gladstone::inline base {

/// Returns the memory that can be allocated without swapping [bytes]: MemAvailable of the system, or the remaining
/// memory of the control group (cgroup v2) if that is smaller. Infinite if neither is reported.
double available_memory();

/// Throws unless `bytes` of memory are available; requests up to 64 MB always pass. To be called before an allocation
/// whose size comes from a file header, since a damaged header can declare any size.
/// @param what  object that needs the memory, for the message: "dataset \"density\" of 2000 x 1000 x 1000 values"
/// @throws DataError (code `memory`) if fewer than `bytes` are available
void require_memory(std::string const& path, std::string const& what, double bytes);

}  // namespace gladstone::inline base
