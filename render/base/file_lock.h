#pragma once

#include <cstddef>

namespace gladstone {

/// Locks on bytes of an open file (fcntl, F_OFD_SETLK). They belong to the open file: they go with the process, however
/// it ends, and leave nothing behind that could grow stale. NFS and Lustre pass them on between machines; those of
/// flock() stay on one machine there, or need a file that is open for writing, which a folder cannot be.
/// @param count of bytes; 0: to the end, however long
/// @return 0; EAGAIN where another open file holds a lock there; another errno where the file system has no locks
int lock_bytes(int file, std::size_t first, std::size_t count);

/// Gives such a lock back.
void unlock_bytes(int file, std::size_t first, std::size_t count);

/// Looks without locking. @return as lock_bytes()
int find_lock(int file, std::size_t first, std::size_t count);

}  // namespace gladstone
