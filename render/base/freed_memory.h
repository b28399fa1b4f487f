#pragma once

namespace gladstone {

/// Asks the C library to keep what is freed, up to half a gigabyte, instead of giving it back to the system: who makes
/// images again and again then does not wait for their pages. Nothing happens where the library cannot.
void keep_freed_memory();

}  // namespace gladstone
