#include "render/ideal_images/host_pair_batches.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/freed_memory.h"
#include "render/base/parallel.h"
#include "render/ideal_images/draw_light.h"

namespace gladstone::inline ideal_images {
namespace {

constexpr std::size_t grain = 4096;  // particles or pixels that one task processes

/// Returns memory for `count` values of a type.
template <class T>
DeviceBuffer allocate(std::size_t count) {
  auto const values = std::make_shared<std::vector<T>>(count);
  return {values->data(), values};
}

class HostPairBatches final : public PairBatchRenderer {
 public:
  explicit HostPairBatches(std::vector<OwnedPairModel> models)
      : models_(std::move(models)),
        columns_(models_.front().model.projection.columns),
        rows_(models_.front().model.projection.rows),
        pixels_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    double widest = 0;
    for (OwnedPairModel const& one : models_) widest = std::max(widest, one.model.spot.sigma);
    for (OwnedPairModel& one : models_) one.model.spot.sigma = widest;
  }

  DeviceBuffer render(std::vector<PairSeeds> const& seeds, LevelType type) override {
    check_seed_count(models_.size(), seeds.size());
    keep_freed_memory();
    if (type == LevelType::uint8) return render_as<std::uint8_t>(seeds);
    if (type == LevelType::uint16) return render_as<std::uint16_t>(seeds);
    return render_as<float>(seeds);
  }

  DeviceBuffer displacement() override {
    DeviceBuffer buffer = allocate<float>(models_.size() * 2 * pixels_);
    auto* out = static_cast<float*>(buffer.data);
    for (OwnedPairModel const& one : models_) {
      parallel_chunks(pixels_, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
          std::size_t const column = pixel % static_cast<std::size_t>(columns_);
          std::size_t const row = pixel / static_cast<std::size_t>(columns_);
          Vec2d const moved = one.model.displacement({static_cast<double>(column), static_cast<double>(row)});
          out[pixel] = static_cast<float>(moved.x);
          out[pixels_ + pixel] = static_cast<float>(moved.y);
        }
      });
      out += 2 * pixels_;
    }
    return buffer;
  }

  void copy_to_host(void* to, DeviceBuffer const& from, std::size_t bytes) const override {
    std::memcpy(to, from.data, bytes);
  }

 private:
  template <class Level>
  DeviceBuffer render_as(std::vector<PairSeeds> const& seeds) const {
    DeviceBuffer buffer = allocate<Level>(seeds.size() * 2 * pixels_);
    auto* const levels = static_cast<Level*>(buffer.data);
    for (std::size_t pair = 0; pair < seeds.size(); ++pair) {
      render_pair(models_[models_.size() == 1 ? 0 : pair].model, seeds[pair], levels + 2 * pair * pixels_);
    }
    return buffer;
  }

  /// Renders one pair into its grey levels [frame][row][column].
  template <class Level>
  void render_pair(PairModel const& model, PairSeeds seeds, Level* levels) const {
    std::vector<ParticleImage> images[2];
    for (auto& frame : images) frame.resize(model.seeded);
    parallel_chunks(model.seeded, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t particle = begin; particle < end; ++particle) {
        ParticleImage both[2];
        model.images(seeds.particles, particle, both);
        for (int frame = 0; frame < 2; ++frame) images[frame][particle] = both[frame];
      }
    });
    double unit = 0, brightest = 0;
    for (auto const& frame : images) {
      for (ParticleImage const& image : frame) unit = std::max(unit, image.light);
    }
    Image<double> light[2];
    for (int frame = 0; frame < 2; ++frame) {
      if (unit > 0) {
        for (ParticleImage& image : images[frame]) image.light /= unit;
      }
      light[frame] = draw_light(images[frame], model.spot, columns_, rows_);
      brightest = std::max(brightest, *std::max_element(light[frame].begin(), light[frame].end()));
    }
    PixelDetector detector = model.detector;
    detector.seed = seeds.noise;
    detector.electrons = model.exposure.electrons(brightest, unit > 0 ? unit : 1);
    for (std::size_t frame = 0; frame < 2; ++frame) {
      RandomStream const noise = frame == 0 ? RandomStream::noise_reference : RandomStream::noise_flow;
      parallel_chunks(pixels_, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
          double const level = detector.record(light[frame].data()[pixel], noise, pixel).level;
          bool const share = std::is_same_v<Level, float>;
          levels[frame * pixels_ + pixel] = static_cast<Level>(share ? level / detector.full_scale : level);
        }
      });
    }
  }

  std::vector<OwnedPairModel> models_;
  int columns_, rows_;
  std::size_t pixels_;
};

}  // namespace

void check_same_frames(std::vector<OwnedPairModel> const& models) {
  PairModel const& first = models.front().model;
  for (OwnedPairModel const& one : models) {
    if (one.model.projection.columns != first.projection.columns || one.model.projection.rows != first.projection.rows)
      throw DataError(ErrorCode::inconsistent, KeyPath{"camera.pixels"},
                      "differs between the pairs of a batch; render them in several batches");
  }
}

void check_seed_count(std::size_t models, std::size_t seeds) {
  if (models != 1 && models != seeds)
    throw DataError(ErrorCode::wrong_shape, "batch",
                    "has another number of seeds than of setups; give one seed per setup");
}

std::unique_ptr<PairBatchRenderer> make_host_pair_batches(std::vector<OwnedPairModel> models) {
  GLADSTONE_EXPECTS(!models.empty());
  check_same_frames(models);
  return std::make_unique<HostPairBatches>(std::move(models));
}

}  // namespace gladstone::inline ideal_images
