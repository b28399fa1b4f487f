#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/src/arrays.h"
#include "python/src/call.h"
#include "python/src/setup_text.h"
#include "render/base/error.h"
#include "studies/case/backend.h"
#include "studies/case/pair_source.h"

namespace gladstone::python {
namespace {

/// Renders batches of pairs of one or several models. Results are on the GPU, or NumPy arrays if the CPU renders.
class PairBatches {
 public:
  PairBatches(PairSource const& source, std::vector<OwnedPairModel> const& models)
      : count_(models.size()),
        rows_(static_cast<std::size_t>(models.front().model.projection.rows)),
        columns_(static_cast<std::size_t>(models.front().model.projection.columns)),
        renderer_(source.open(models)) {}

  /// Renders one pair per element of `seeds` (particles, noise). @return [pairs, 2, rows, columns]
  nb::object render(std::vector<std::pair<std::uint64_t, std::uint64_t>> const& seeds, std::string const& type) {
    std::vector<PairSeeds> given;
    for (auto const& [particles, noise] : seeds) given.push_back({particles, noise});
    LevelType const levels = level_type(type);
    return array([&] { return renderer_->render(given, levels); }, seeds.size(), levels);
  }
  /// Computes the displacement at every pixel. @return float32 [models, 2, rows, columns]
  nb::object displacement() {
    return array([&] { return renderer_->displacement(); }, count_, LevelType::float32);
  }

 private:
  static LevelType level_type(std::string const& name) {
    if (name == "float32") return LevelType::float32;
    if (name == "uint8") return LevelType::uint8;
    if (name == "uint16") return LevelType::uint16;
    throw DataError(ErrorCode::unknown_choice, "dtype",
                    "is \"" + name + "\"; use \"float32\", \"uint8\" or \"uint16\"");
  }

  /// Returns the array that `compute` fills, in the memory of its device.
  template <class Compute>
  nb::object array(Compute const& compute, std::size_t first, LevelType type) const {
    auto const [buffer, gpu] = run([&] {
      DeviceBuffer filled = compute();
      int const place = gpu_of_memory(filled.data);
      return std::pair(std::move(filled), place);
    });
    if (type == LevelType::uint8) return array_of_type<std::uint8_t>(buffer, first, gpu);
    if (type == LevelType::uint16) return array_of_type<std::uint16_t>(buffer, first, gpu);
    return array_of_type<float>(buffer, first, gpu);
  }
  /// @param gpu  index of the GPU of the buffer; -1: host memory
  template <class T>
  nb::object array_of_type(DeviceBuffer const& buffer, std::size_t first, int gpu) const {
    auto* const kept = new std::shared_ptr<void>(buffer.owner);
    nb::capsule const owner(kept, [](void* held) noexcept { delete static_cast<std::shared_ptr<void>*>(held); });
    std::size_t const shape[4] = {first, 2, rows_, columns_};
    T* const data = static_cast<T*>(buffer.data);
    if (gpu < 0) return nb::cast(nb::ndarray<nb::numpy, T>(data, 4, shape, owner));
    return nb::cast(
        nb::ndarray<nb::array_api, T>(data, 4, shape, owner, nullptr, nb::dtype<T>(), nb::device::cuda::value, gpu));
  }

  std::size_t count_, rows_, columns_;
  std::unique_ptr<PairBatchRenderer> renderer_;
};

/// Models of the pairs of a batch.
struct PairModels {
  std::vector<OwnedPairModel> all;
};

}  // namespace

void bind_batches(nb::module_& module) {
  nb::class_<PairModels>(module, "PairModels", "Models of the pairs of a batch.");
  nb::class_<PairBatches>(module, "PairBatches",
                          "Renders batches of PIV pairs on a device; the results remain in its memory.")
      .def("render", &PairBatches::render, nb::arg("seeds"), nb::arg("dtype"),
           "Grey levels [pairs, 2, rows, columns] of pairs with the seeds (particles, noise).")
      .def("displacement", &PairBatches::displacement,
           "Displacement at every pixel of frame a, float32 [models, 2, rows, columns].");
  nb::class_<PairSource>(module, "PairSource", "Setup from which pairs are rendered with replaced values of some keys.")
      .def("__init__",
           [](PairSource* self, SetupText const& setup, std::string const& device) {
             new (self) PairSource(run([&] { return PairSource(setup.document(), setup.name, device); }));
           })
      .def(
          "models",
          [](PairSource const& self, std::vector<PairSource::Changes> const& changes) {
            return run([&] { return PairModels{self.build_models(changes)}; });
          },
          nb::arg("changes"), "Models of pairs: for each pair the replaced keys, as \"key.path=value\".")
      .def(
          "open",
          [](PairSource const& self, PairModels const& models) {
            return run([&] { return PairBatches(self, models.all); });
          },
          nb::arg("models"), "Renderer of pairs with these models.");
}

}  // namespace gladstone::python
