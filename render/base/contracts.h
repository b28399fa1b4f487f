#pragma once

#include <cstdio>
#include <cstdlib>

#include "render/base/host_device.h"

namespace gladstone::detail {

/// Ends the program (host) or the kernel (device): a contract is our own promise, never a user's mistake.
GLADSTONE_HD inline void contract_violated(char const* kind, char const* condition, char const* file, int line) {
#if defined(__CUDA_ARCH__)
  printf("%s violated: %s at %s:%d\n", kind, condition, file, line);
  __trap();
#else
  std::fprintf(stderr, "gladstone: internal error: %s violated: %s at %s:%d\n", kind, condition, file, line);
  std::abort();
#endif
}

}  // namespace gladstone::detail

/// Precondition of a function; checked in every build, on host and device. Keep it out of per-step code.
#define GLADSTONE_EXPECTS(condition) \
  ((condition) ? (void)0 : ::gladstone::detail::contract_violated("precondition", #condition, __FILE__, __LINE__))

/// Postcondition of a function.
#define GLADSTONE_ENSURES(condition) \
  ((condition) ? (void)0 : ::gladstone::detail::contract_violated("postcondition", #condition, __FILE__, __LINE__))
