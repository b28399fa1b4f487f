#pragma once

namespace gladstone::inline base {

/// Makes the C library retain up to 512 MiB of freed memory instead of returning it to the system, so that repeated
/// allocations of images do not cause page faults. Has no effect with C libraries other than glibc.
void keep_freed_memory();

}  // namespace gladstone::inline base
