#include "cuda/ideal_images/cuda_pair_batches.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "cuda/ideal_images/pair_kernels.h"
#include "render/ideal_images/host_pair_batches.h"

namespace gladstone::cuda::inline ideal_images {
namespace {

constexpr double workspace_bytes = 512e6;  // memory for pairs that are rendered at the same time

std::size_t bytes_per_level(LevelType type) {
  return type == LevelType::float32 ? sizeof(float) : type == LevelType::uint8 ? 1 : sizeof(std::uint16_t);
}

/// Returns a copy of a flow whose velocity file is in device memory. @param coefficients  null: not from a file
Flow flow_on_device(Flow flow, float const* coefficients) {
  if (!coefficients) return flow;
  flow.kind.visit([&](auto const& held) {
    if constexpr (std::is_same_v<std::decay_t<decltype(held)>, FileFlow>) {
      FileFlow moved = held;
      moved.coefficients = coefficients;
      flow.kind = moved;
    }
  });
  return flow;
}

/// Returns twice the mean number of particle images that overlap a tile, and at least 64.
std::uint32_t expected_capacity(PairModel const& model) {
  double const pixel =
      model.projection.pixel_pitch * (model.projection.lens_z - model.center.z) / model.projection.image_distance;
  double const side = pixel * (tile_size + 2 * model.spot.half_width() + 1);
  double const mean = static_cast<double>(model.seeded) * std::min(1.0, side * side / (model.box.x * model.box.y));
  return static_cast<std::uint32_t>(std::clamp(2 * mean, 64.0, 1e6));
}

}  // namespace

CudaPairBatches::CudaPairBatches(std::vector<OwnedPairModel> const& models)
    : model_count_(models.size()),
      spot_(models.front().model.spot),
      columns_(models.front().model.projection.columns),
      rows_(models.front().model.projection.rows),
      capacity_(0) {
  check_same_frames(models);
  keep_freed_device_memory();
  std::vector<PairModel> held;
  for (OwnedPairModel const& one : models) {
    PairModel model = one.model;
    if (one.velocity) {
      velocities_.emplace_back(one.velocity->data(), one.velocity->size(), "the velocity field");
      model.flow = flow_on_device(model.flow, velocities_.back().data());
    }
    if (one.mie) {
      Scattering const& there = scattering_.emplace_back(
          Scattering{{one.mie->table_of().data(), 1, "the scattering"},
                     {one.mie->tables().data(), one.mie->tables().size(), "the scattering"},
                     {one.mie->coefficients().data(), one.mie->coefficients().size(), "the scattering"}});
      model.mie.table_of = there.table_of.data();
      model.mie.table = there.table.data();
      model.mie.coefficient = there.coefficients.data();
    }
    spot_.sigma = std::max(spot_.sigma, model.spot.sigma);
    seeded_ = std::max<std::size_t>(seeded_, model.seeded);
    capacity_ = std::max(capacity_, expected_capacity(model));
    held.push_back(model);
  }
  for (PairModel& model : held) model.spot = spot_;
  models_ = DeviceArray<PairModel>(held.data(), held.size(), "the models of the pairs");
}

void CudaPairBatches::prepare_workspace(std::size_t pairs) {
  if (workspace_.pairs >= pairs && workspace_.lists) return;
  workspace_ = {};
  std::size_t const frames = 2 * pairs, pixels = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  workspace_.images = DeviceArray<ParticleImage>(frames * seeded_, "the particle images");
  workspace_.light = DeviceArray<double>(frames * pixels, "the images");
  workspace_.unit = DeviceArray<unsigned long long>(pairs, "the images");
  workspace_.brightest = DeviceArray<unsigned long long>(pairs, "the images");
  workspace_.lists = std::make_unique<TileListMemory>(columns_, rows_, frames, capacity_);
  workspace_.pairs = pairs;
}

void CudaPairBatches::render_some(PairSeeds const* seeds, std::size_t begin, std::size_t count, LevelType type,
                                  unsigned char* levels) {
  std::size_t const stride = model_count_ == 1 ? 0 : 1;
  std::size_t const pixels = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  PairsOnDevice const pairs{models_.data() + begin * stride, stride, seeds + begin, count};
  workspace_.unit.zero();
  workspace_.brightest.zero();
  TileLists const lists = workspace_.lists->reset();
  make_particle_images(pairs, seeded_, workspace_.images.data(), workspace_.unit.data(), lists);
  double* const light = workspace_.light.data();
  draw_images({workspace_.images.data(), seeded_, 2 * count, workspace_.unit.data()}, spot_, lists,
              {{light, light + pixels}, 2 * pixels}, workspace_.brightest.data());
  record_pairs(pairs, light, pixels, workspace_.brightest.data(), workspace_.unit.data(), type,
               levels + begin * 2 * pixels * bytes_per_level(type));
}

DeviceBuffer CudaPairBatches::render(std::vector<PairSeeds> const& seeds, LevelType type) {
  check_seed_count(model_count_, seeds.size());
  std::size_t const pixels = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  auto levels = std::make_shared<DeviceArray<unsigned char>>(seeds.size() * 2 * pixels * bytes_per_level(type),
                                                             "the frames of a batch");
  DeviceArray<PairSeeds> const uploaded(seeds.data(), seeds.size(), "the seeds of a batch");
  double const bytes_per_pair =
      16.0 * static_cast<double>(pixels) + 2.0 * sizeof(ParticleImage) * static_cast<double>(seeded_);
  auto const together = std::clamp<std::size_t>(static_cast<std::size_t>(workspace_bytes / bytes_per_pair), 1,
                                                std::max<std::size_t>(seeds.size(), 1));
  prepare_workspace(together);
  do {
    for (std::size_t begin = 0; begin < seeds.size(); begin += together) {
      render_some(uploaded.data(), begin, std::min(together, seeds.size() - begin), type, levels->data());
    }
  } while (!workspace_.lists->complete());
  capacity_ = workspace_.lists->capacity();
  return {levels->data(), levels};
}

void CudaPairBatches::copy_to_host(void* to, DeviceBuffer const& from, std::size_t bytes) const {
  cuda::copy_to_host(to, from.data, bytes);
}

DeviceBuffer CudaPairBatches::displacement() {
  std::size_t const pixels = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  auto const out = std::make_shared<DeviceArray<float>>(model_count_ * 2 * pixels, "the displacements of a batch");
  compute_displacements(models_.data(), model_count_, columns_, rows_, out->data());
  wait_for_device();
  return {out->data(), out};
}

}  // namespace gladstone::cuda::inline ideal_images
