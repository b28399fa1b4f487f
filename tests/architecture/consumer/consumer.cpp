// Renders a BOS pair through a uniform density gradient, correlates it and compares the vectors with the rays.
#include <algorithm>
#include <iostream>
#include <vector>

#include "analysis/correlation/correlator.h"
#include "analysis/errors/error_summary.h"
#include "render/base/version.h"
#include "render/render.h"
#include "render/scene/read_setup.h"
#include "render/scene/scene.h"

namespace {

constexpr char const* setup_text = R"(schema = 1
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

[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [100.0, 50.0, 0.0]

[target]
dots_per_32px_window = 10.0
)";

}  // namespace

int main() {
  using namespace gladstone;
  SetupDocument document = SetupDocument::from_text(setup_text, "consumer");
  Scene const scene = build_scene(read_setup(document.root()));
  document.finish();
  Device device = cpu();
  Rendering const rendering = render(scene, device);

  // A uniform gradient deflects all rays equally, by 0.7 px here: small-angle theory (Eq. 9) holds to 1 % of this.
  GroundTruth const& truth = rendering.truth;
  double displacement = 0, off_theory = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    displacement = std::max(displacement, length(truth.displacement_px[i]));
    off_theory = std::max(off_theory, length(truth.displacement_px[i] - truth.eq9_px[i]));
  }

  CorrelationSettings settings;
  settings.window_px = {32, 32};
  DisplacementField const vectors =
      make_correlator(settings)->correlate(rendering.light.reference, rendering.light.flow);
  std::vector<Vec2d> const expected(vectors.size(), truth.displacement_px.front());
  double const rms_px = summarize_errors(vectors.displacement_px, expected, {})["rms_px"];

  std::cout << "gladstone " << version << ": " << rendering.light.flow.columns() << " x " << rendering.light.flow.rows()
            << " px; theory " << (displacement > 0 && off_theory < 0.01 * displacement ? "follows" : "misses")
            << " the rays, correlation " << (rms_px < 0.2 * displacement ? "follows" : "misses") << " them\n";
}
