#pragma once

#include "cuda/device/device_array.h"
#include "cuda/ideal_images/tile_lists.h"
#include "render/ideal_images/pair_batch.h"

namespace gladstone::cuda::inline ideal_images {

/// Renders batches of pairs on the GPU: seeds the particles, moves, illuminates and draws them, and records the frames,
/// without transfers to the host.
class CudaPairBatches final : public PairBatchRenderer {
 public:
  /// @param models  one or several models with frames of equal size
  /// @throws DeviceError, OutOfDeviceMemory, DataError if the frames differ in size
  explicit CudaPairBatches(std::vector<OwnedPairModel> const& models);

  DeviceBuffer render(std::vector<PairSeeds> const& seeds, LevelType type) override;
  DeviceBuffer displacement() override;
  void copy_to_host(void* to, DeviceBuffer const& from, std::size_t bytes) const override;

 private:
  /// Arrays for a number of pairs that are rendered at the same time.
  struct Workspace {
    std::size_t pairs = 0;
    DeviceArray<ParticleImage> images;
    DeviceArray<double> light;
    DeviceArray<unsigned long long> unit, brightest;
    std::unique_ptr<TileListMemory> lists;
  };
  void prepare_workspace(std::size_t pairs);
  /// Renders pairs `begin` to `begin` + `count` of a batch.
  void render_some(PairSeeds const* seeds, std::size_t begin, std::size_t count, LevelType type, unsigned char* levels);

  /// Table of the scattering of one diameter.
  struct Scattering {
    DeviceArray<std::uint32_t> table_of;
    DeviceArray<MieTable> table;
    DeviceArray<float> coefficients;
  };

  std::vector<DeviceArray<float>> velocities_;  ///< coefficients of velocity files
  std::vector<Scattering> scattering_;          ///< scattering tables of models with Mie scattering
  DeviceArray<PairModel> models_;
  std::size_t model_count_;
  GaussianSpot<double> spot_;  ///< PSF whose footprint is used for all images
  int columns_, rows_;
  std::size_t seeded_ = 0;  ///< largest number of particles of a model
  std::uint32_t capacity_;
  Workspace workspace_;
};

}  // namespace gladstone::cuda::inline ideal_images
