#include <string>

#include "cuda/backend.h"

namespace gladstone::cuda {

bool compiled_in() { return false; }

std::string description() {
  std::string const toolkit = GLADSTONE_CUDA_VERSION;
  return "CUDA toolkit: " + (toolkit.empty() ? "not found" : "found (" + toolkit + ")") +
         ", GPU renderer not part of this version";
}

}  // namespace gladstone::cuda
