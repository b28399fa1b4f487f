#include <cmath>

#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

/// What README says of the paper's case at one instant: rms per component [px].
struct Said {
  char const* plane;
  double eq9_px, rays_px, correlation;
};

class PaperCase : public Workplace {};

// README's command and README's numbers. Those are means over vectors, these over the dots in view, rendered with fewer
// rays: 64 rays leave 1e-3 of a displacement. The view holds some forty structures of ten nodes, which both sample
// densely, but the vectors leave out half a window, 8 px of 512, at the edges: 6 % of the area, whose mean square may
// differ by half of the whole's, 1.5 % in rms. Correlation is a ratio of such sums that vary together: 1 % of what it
// lacks of one, and a tenth of that for the edges; 0.005 in all.
TEST_F(PaperCase, IsWhatReadmeSays) {
  for (Said const& said : {Said{"kepeak", 0.0736, 0.0621, 0.973}, Said{"late", 0.0051, 0.0043, 0.979}}) {
    std::string const data = GLADSTONE_DATA_DIR;
    render("case",
           {"--set", "medium.field.spacing_mm=[0.519, 0.519, 0.519]", "--set", "render.rays_per_dot=64", "--set",
            "medium.field.file=\"" + data + "/fields/hbdt512_" + said.plane + "_slice.h5\""},
           data + "/../studies/cases/table1.toml");
    Hdf5Reader const truth(in("case/truth.h5").string());
    auto const place = truth.read("/dots/reference_px"), rays = truth.read("/dots/displacement_px"),
               eq9 = truth.read("/dots/eq9_px");
    double count = 0, rays2 = 0, eq92 = 0, product = 0;
    for (std::size_t i = 0; i < place.size(); i += 2) {
      if (!(place[i] >= 0 && place[i] <= 511 && place[i + 1] >= 0 && place[i + 1] <= 511)) continue;
      for (std::size_t c = i; c < i + 2; ++c) {
        count += 1;
        rays2 += rays[c] * rays[c];
        eq92 += eq9[c] * eq9[c];
        product += rays[c] * eq9[c];
      }
    }
    EXPECT_NEAR(std::sqrt(eq92 / count) / said.eq9_px, 1, 0.02) << said.plane;
    EXPECT_NEAR(std::sqrt(rays2 / count) / said.rays_px, 1, 0.02) << said.plane;
    EXPECT_NEAR(product / std::sqrt(eq92 * rays2), said.correlation, 0.005) << said.plane;
  }
}

}  // namespace
}  // namespace gladstone::end_to_end
