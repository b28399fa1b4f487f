#include "render/scene/read_setup.h"
#include "render/scene/scene.h"
#include "studies/case/ray_file.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

namespace {

/// A gradient between lens and target.
Scene gradient_scene() {
  SetupDocument document = SetupDocument::from_text(R"(schema = 1
experiment = "bos"
[camera]
pixels = [64, 64]
pixel_pitch_um = 10.0
[lens]
focal_length_mm = 105.0
f_number = 11.0
[geometry]
z_a_mm = 750.0
z_d_mm = 250.0
[medium]
[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [20.0, 10.0, 0.0]
[target]
dots_per_32px_window = 1.0
)",
                                                    "setup.toml");
  return build_scene(read_setup(document.root()));
}

}  // namespace

// Rays as a table, followed to the sensor.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  static Scene const scene = gradient_scene();
  std::string const path = fuzz::file_of(input, "rays.csv");
  fuzz::read(input, [&] {
    traced_rays_csv(trace_rays(scene, 2e-3, read_rays(path, scene.setup.max_off_axis_distance()), Through::all));
  });
  return 0;
}
