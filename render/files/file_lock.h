#pragma once

#include <cstddef>
#include <string>

namespace gladstone::inline files {

/// Locks a byte range of an open file exclusively, without waiting (fcntl, F_OFD_SETLK). The lock belongs to the open
/// file description: the system releases it when the process ends for whatever reason, so that no stale locks remain.
/// NFS and Lustre pass such locks on to other machines; locks of flock() are local to one machine there, or require a
/// file that is open for writing, which a directory cannot be.
/// @param count  number of bytes; 0: to the end of the file, also if it grows
/// @return 0; EAGAIN if another open file holds a lock in the range; another errno if the file system has no locks
int lock_bytes(int file, std::size_t first, std::size_t count);

/// Returns whether a path still leads to this open file. A process that locks a file by its name must test this
/// afterwards: others may have removed or replaced the file before it was locked.
bool leads_to(std::string const& path, int file);

/// Releases a lock of lock_bytes().
void unlock_bytes(int file, std::size_t first, std::size_t count);

/// Tests whether lock_bytes() would succeed, without locking.
/// @return as lock_bytes()
int find_lock(int file, std::size_t first, std::size_t count);

}  // namespace gladstone::inline files
