#pragma once

#include <cstdio>
#include <cstdlib>

#include "render/base/host_device.h"

namespace gladstone::inline base::detail {

/// Aborts the program (host) or traps the kernel (device). A violated contract is a bug of gladstone, never an error of
/// the user.
GLADSTONE_HD inline void contract_violated(char const* kind, char const* condition, char const* file, int line) {
#if defined(__CUDA_ARCH__)
  printf("%s violated: %s at %s:%d\n", kind, condition, file, line);
  __trap();
#else
  std::fprintf(stderr, "gladstone: internal error: %s violated: %s at %s:%d\n", kind, condition, file, line);
  std::abort();
#endif
}

}  // namespace gladstone::inline base::detail

/// Checks a precondition of a function, in every build, on host and device. Not for code that runs once per integration
/// step.
#define GLADSTONE_EXPECTS(condition) \
  ((condition) ? (void)0 : ::gladstone::base::detail::contract_violated("precondition", #condition, __FILE__, __LINE__))

/// Checks a postcondition of a function, in every build, on host and device.
#define GLADSTONE_ENSURES(condition) \
  ((condition) ? (void)0             \
               : ::gladstone::base::detail::contract_violated("postcondition", #condition, __FILE__, __LINE__))
