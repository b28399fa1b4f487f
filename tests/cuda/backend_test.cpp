#include "cuda/backend.h"

#include <gtest/gtest.h>

#include <string>

namespace gladstone::cuda {
namespace {

/// A toolkit that was seen is not a renderer that can run: the line for --version keeps the two apart.
TEST(CudaBackend, SaysWhichToolkitWasSeenAndThatNoRendererIsThere) {
  EXPECT_FALSE(compiled_in());
  std::string const toolkit = GLADSTONE_CUDA_VERSION;
  std::string const seen = toolkit.empty() ? "not found" : "found (" + toolkit + ")";
  EXPECT_EQ(description(), "CUDA toolkit: " + seen + ", GPU renderer not part of this version");
}

}  // namespace
}  // namespace gladstone::cuda
