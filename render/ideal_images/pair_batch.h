#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "render/ideal_images/pair_model.h"

namespace gladstone::inline ideal_images {

/// Type of the grey levels of a batch.
enum class LevelType {
  float32,  ///< grey level over full scale, 0 to 1
  uint8,    ///< grey levels of at most 8 bits
  uint16,   ///< grey levels of at most 16 bits
};

/// Array in the memory of a device.
struct DeviceBuffer {
  void* data = nullptr;
  std::shared_ptr<void> owner;  ///< releases the memory
};

/// Renders batches of pairs of ideal particle images that remain on a device.
class PairBatchRenderer {
 public:
  virtual ~PairBatchRenderer() = default;
  /// Renders one pair per element of `seeds`: of the only model, or pair i of model i.
  /// @return grey levels [pair][frame][row][column], complete when this function returns
  virtual DeviceBuffer render(std::vector<PairSeeds> const& seeds, LevelType type) = 0;
  /// Computes the displacement at every pixel, PairModel::displacement() [px].
  /// @return float32 [model][component][row][column]; components: u to the right, v downwards
  virtual DeviceBuffer displacement() = 0;
  /// Copies the first bytes of a buffer to host memory.
  virtual void copy_to_host(void* to, DeviceBuffer const& from, std::size_t bytes) const = 0;
};

}  // namespace gladstone::inline ideal_images
