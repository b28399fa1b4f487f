#include "studies/design/piv_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/medium/gladstone_dale.h"
#include "studies/case/expected_particles.h"

namespace gladstone::inline design {
namespace {

using unit::mm;
constexpr char const* keane = "Keane & Adrian 1992, Appl. Sci. Res. 49:191";
constexpr char const* olsen = "Olsen & Adrian 2000, Exp. Fluids 29:S166";

/// Largest speeds of the flow in the visible part of the plane Z = 0, in-plane and out-of-plane [m/s].
struct FastestFlow {
  double within = 0, across = 0;
};

FastestFlow fastest_flow(Setup const& setup, double width, double height) {
  constexpr int places = 65;
  FastestFlow fastest;
  for (int row = 0; row < places; ++row) {
    for (int column = 0; column < places; ++column) {
      Vec3d const place{width * (column / (places - 1.0) - 0.5), height * (row / (places - 1.0) - 0.5), 0};
      Vec3d const u = setup.piv->flow.flow(place);
      fastest.within = std::max(fastest.within, std::hypot(u.x, u.y));
      fastest.across = std::max(fastest.across, std::abs(u.z));
    }
  }
  return fastest;
}

void add_imaging(DesignSheet& sheet, Setup const& setup, ExpectedParticles const& expected, double pixel) {
  auto& rows = sheet.rows;
  rows.push_back({"F1", "magnification", "M", "magnification at the sheet", expected.magnification, "", "f / (Z - f)",
                  "Raffel et al. 2018", Margin::none, ""});
  double const ciddor = gladstone_dale_ciddor(setup.medium.wavelength);
  rows.push_back(
      {"F3", "gladstone_dale_m3_kg", "K", "Gladstone-Dale constant", setup.medium.gladstone_dale, "m^3/kg",
       "(n_s - 1) / rho_s", "Ciddor 1996, Appl. Opt. 35:1566",
       setup.medium.gas ? Margin::none : at_most(std::abs(setup.medium.gladstone_dale / ciddor - 1), 0.01, 0.05),
       fmt::format("of the setup; air at this wavelength has {:.5g}", ciddor)});
  rows.push_back({"F16", "field_of_view_mm", "", "field of view in the sheet, width", setup.camera.columns * pixel / mm,
                  "mm", "w / M", "Raffel et al. 2018", Margin::none, ""});
  rows.push_back({"F16", "field_of_view_height_mm", "", "field of view in the sheet, height",
                  setup.camera.rows * pixel / mm, "mm", "h / M", "Raffel et al. 2018", Margin::none, ""});
}

void add_images(DesignSheet& sheet, Setup const& setup, ExpectedParticles const& expected) {
  auto& rows = sheet.rows;
  rows.push_back({"F13", "diffraction_diameter_px", "d_diff", "diffraction image, e^-2 diameter",
                  expected.diffraction_px, "px", "1.682 N (1 + M) lambda / p", adrian, Margin::none, ""});
  double const diameter = expected.image_diameter_px, edge = expected.sheet_edge_diameter_px;
  rows.push_back({"F14", "image_diameter_px", "", "particle image, e^-2 diameter", diameter, "px",
                  "sqrt((M d_p)^2 + d_diff^2 + d_blur^2)", olsen,
                  std::max(at_least(diameter, 2, 1.5), at_most(diameter, 4, 6)),
                  "2 to 3 px for correlation; smaller ones cause peak locking"});
  rows.push_back({"F14", "image_diameter_sheet_edge_px", "", "particle image at the edge of the sheet", edge, "px",
                  "the same, half the sheet's thickness out of focus", olsen, at_most(edge / diameter, 1.2, 2), ""});
  double const depth = expected.depth_of_field, sheet_thickness = setup.piv->laser.thickness;
  rows.push_back({"F17", "depth_of_field_mm", "", "depth of field", depth / mm, "mm", "4.88 ((M + 1) / M)^2 N^2 lambda",
                  "Adrian 1991; Raffel et al. 2018", at_least(depth / sheet_thickness, 1, 0.5),
                  fmt::format("compared with the sheet of {:.4g} mm", sheet_thickness / mm)});
}

void add_density(DesignSheet& sheet, CaseSetup const& loaded, ExpectedParticles const& expected) {
  if (!std::isfinite(expected.per_pixel)) return;  // unknown for particles from a file
  int const window = loaded.correlate.window_px.back();
  double const number = expected.per_pixel * window * window;
  sheet.rows.push_back({"F15", "particles_per_window", "N_I", "particles in a window", number, "", "C N_w^2", keane,
                        at_least(number, 7, 4), fmt::format("of the last pass, {} px", window)});
  sheet.rows.push_back({"F15", "source_density", "N_S", "fraction of the image covered by particles",
                        expected.source_density, "", "C dz pi d^2 / (4 M^2)",
                        "Adrian 1991, Annu. Rev. Fluid Mech. 23:261", at_most(expected.source_density, 0.3, 0.6),
                        "above 1, overlapping images form speckle"});
}

void add_motion(DesignSheet& sheet, CaseSetup const& loaded, double pixel) {
  Setup const& setup = loaded.setup;
  auto& rows = sheet.rows;
  double const dt = setup.piv->flow.dt, quarter = loaded.correlate.window_px.front() / 4.0;
  FastestFlow const flow = fastest_flow(setup, setup.camera.columns * pixel, setup.camera.rows * pixel);
  double const in_plane = quarter * pixel / dt, out_of_plane = setup.piv->laser.thickness / 4 / dt;
  auto const used = [](double speed, double most) { return at_most(speed / most, 0.8, 1.2); };
  rows.push_back({"F6", "displacement_px", "", "displacement of the fastest particles", flow.within * dt / pixel, "px",
                  "M |u| dt / p", "Raffel et al. 2018", Margin::none, "within the view"});
  rows.push_back({"F19", "in_plane_max_m_s", "", "in-plane limit", in_plane, "m/s", "(N_w / 4) p / (M dt)", keane,
                  used(flow.within, in_plane), fmt::format("the flow has {:.4g} m/s", flow.within)});
  rows.push_back({"F19", "out_of_plane_max_m_s", "", "out-of-plane limit", out_of_plane, "m/s", "(dz / 4) / dt", keane,
                  used(flow.across, out_of_plane), fmt::format("the flow has {:.4g} m/s", flow.across)});
}

void add_light(DesignSheet& sheet, Setup const& setup, ExpectedParticles const& expected) {
  NoiseSetup const& noise = setup.camera.noise;
  double const peak = expected.peak_electrons.median;
  sheet.rows.push_back({"F21", "peak_electrons", "n_e", "electrons at the peak", peak, "",
                        "fluence dC/dOmega Omega lambda / (h c) QE, times the fraction at the peak",
                        "Bohren & Huffman 1983", expected.saturated > 0.05 ? Margin::violated : at_least(peak, 500, 30),
                        fmt::format("of a full well of {:.5g}; {:.3g} % of the particles saturate", noise.full_well_e,
                                    100 * expected.saturated)});
  double const read = noise.enabled ? noise.read_noise_e : 0, snr = peak / std::sqrt(peak + read * read);
  sheet.rows.push_back({"F21", "signal_to_noise", "", "signal-to-noise ratio at the peak", snr, "",
                        "n_e / sqrt(n_e + sigma_r^2)", "Rose 1948, J. Opt. Soc. Am. 38:196", at_least(snr, 20, 5), ""});
  sheet.rows.push_back({"F21", "smallest_visible_um", "", "smallest detectable particle",
                        expected.smallest_visible / 1e-6, "um", "peak = 5 times its noise",
                        "Rose 1948, J. Opt. Soc. Am. 38:196", Margin::none, ""});
}

}  // namespace

DesignSheet piv_sheet(CaseSetup const& loaded) {
  ExpectedParticles const expected = expected_particles(loaded.setup);
  double const pixel = loaded.setup.camera.pixel_pitch / expected.magnification;
  DesignSheet sheet;
  add_imaging(sheet, loaded.setup, expected, pixel);
  add_images(sheet, loaded.setup, expected);
  add_density(sheet, loaded, expected);
  add_light(sheet, loaded.setup, expected);
  add_motion(sheet, loaded, pixel);
  return sheet;
}

}  // namespace gladstone::inline design
