#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/setup_text.h"
#include "render/base/error.h"
#include "studies/case/backend.h"
#include "studies/case/cameras.h"
#include "studies/case/case.h"

namespace gladstone::python {
namespace {

/// Renders batches of pairs of one or several setups on the GPU.
class PairBatches {
 public:
  explicit PairBatches(std::vector<SetupText> const& setups) : count_(setups.size()) {
    std::vector<OwnedPairModel> models;
    for (SetupText const& text : setups) {
      std::vector<CameraCase> cameras = camera_cases(text.document());
      if (cameras.size() != 1)
        throw DataError(ErrorCode::unsupported, text.name,
                        "has several cameras; a batch needs a setup with one camera");
      models.push_back(build_pair_model(load_case_setup(std::move(cameras.front().document)).setup));
    }
    if (models.empty()) throw DataError(ErrorCode::missing_content, "batch", "has no setup; give at least one");
    rows_ = static_cast<std::size_t>(models.front().model.projection.rows);
    columns_ = static_cast<std::size_t>(models.front().model.projection.columns);
    renderer_ = open_pair_batches(models);
  }

  /// Renders one pair per element of `seeds` (particles, noise). @return [pairs, 2, rows, columns] on the GPU
  nb::object render(std::vector<std::pair<std::uint64_t, std::uint64_t>> const& seeds, std::string const& type) {
    std::vector<PairSeeds> given;
    for (auto const& [particles, noise] : seeds) given.push_back({particles, noise});
    LevelType const levels = level_type(type);
    DeviceBuffer const frames = run([&] { return renderer_->render(given, levels); });
    return array(frames, seeds.size(), levels);
  }
  /// @return float32 [setups, 2, rows, columns] on the GPU
  nb::object displacement() {
    return array(run([&] { return renderer_->displacement(); }), count_, LevelType::float32);
  }

 private:
  static LevelType level_type(std::string const& name) {
    if (name == "float32") return LevelType::float32;
    if (name == "uint8") return LevelType::uint8;
    if (name == "uint16") return LevelType::uint16;
    throw DataError(ErrorCode::unknown_choice, "dtype",
                    "is \"" + name + "\"; use \"float32\", \"uint8\" or \"uint16\"");
  }
  nb::object array(DeviceBuffer const& buffer, std::size_t first, LevelType type) const {
    auto* const kept = new std::shared_ptr<void>(buffer.owner);
    nb::capsule const owner(kept, [](void* held) noexcept { delete static_cast<std::shared_ptr<void>*>(held); });
    std::size_t const shape[4] = {first, 2, rows_, columns_};
    auto const of = [&]<class T>(T* data) {
      return nb::cast(
          nb::ndarray<nb::array_api, T>(data, 4, shape, owner, nullptr, nb::dtype<T>(), nb::device::cuda::value, 0));
    };
    if (type == LevelType::uint8) return of(static_cast<std::uint8_t*>(buffer.data));
    if (type == LevelType::uint16) return of(static_cast<std::uint16_t*>(buffer.data));
    return of(static_cast<float*>(buffer.data));
  }

  std::size_t count_, rows_ = 0, columns_ = 0;
  std::unique_ptr<PairBatchRenderer> renderer_;
};

}  // namespace

void bind_batches(nb::module_& module) {
  nb::class_<PairBatches>(module, "PairBatches", "Renders batches of PIV pairs on the GPU, where they remain.")
      .def("__init__",
           [](PairBatches* self, std::vector<SetupText> const& setups) {
             new (self) PairBatches(run([&] { return PairBatches(setups); }));
           })
      .def("render", &PairBatches::render, nb::arg("seeds"), nb::arg("dtype"),
           "Grey levels [pairs, 2, rows, columns] of pairs with the seeds (particles, noise).")
      .def("displacement", &PairBatches::displacement,
           "Displacement at every pixel of frame a, float32 [setups, 2, rows, columns].");
}

}  // namespace gladstone::python
