#include "cuda/backend.h"

#include <gtest/gtest.h>

#include <string>

#include "render/base/error.h"

namespace gladstone::cuda {
namespace {

/// Whether CUDA is compiled in and whether a device is usable are independent; both are reported in words.
TEST(CudaBackend, SaysWhatItIsAndWhetherItCanRun) {
  EXPECT_EQ(compiled_in(), description().find("not compiled in") == std::string::npos) << description();
  DeviceState const state = device_state();
  EXPECT_FALSE(state.text.empty());
  if (!compiled_in()) {
    EXPECT_FALSE(state.usable);
  }
}

TEST(CudaBackend, RefusesWithoutADeviceWithItsReason) {
  DeviceState const state = device_state();
  if (state.usable) {
    EXPECT_EQ(make_renderer()->device(), "cuda");
    return;
  }
  try {
    make_renderer();
    FAIL() << "a renderer without a device";
  } catch (DeviceError const& error) {
    EXPECT_EQ(std::string(error.what()), state.text);
  }
  EXPECT_THROW(make_correlator({}), DeviceError);
}

/// With and without CUDA, and with CUDA but without a driver.
TEST(CudaBackend, FindsMemoryOfTheHostOnNoDevice) {
  std::string const text = "on the host";
  EXPECT_EQ(device_of_memory(text.data()), -1);
}

}  // namespace
}  // namespace gladstone::cuda
