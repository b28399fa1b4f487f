#include "studies/examples/demo_story.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gladstone::inline examples {
namespace {

/// Formats one part for every instant, joined by "and".
template <class Part>
std::string each(std::vector<DemoInstant> const& instants, Part part) {
  std::string text;
  for (DemoInstant const& instant : instants) text += (text.empty() ? "" : " and ") + part(instant);
  return text;
}

/// Formats a length in px with the given number of significant digits, without exponent.
std::string digits(double px, int significant) {
  int const decimals = px > 0 ? significant - 1 - static_cast<int>(std::floor(std::log10(px))) : significant;
  return fmt::format("{:.{}f}", px, std::max(0, decimals));
}

/// Returns the largest difference of the correlation, and that of the rms ratio, between ray tracing and prediction.
Agreement largest_miss(std::vector<DemoInstant> const& instants) {
  Agreement worst{};
  for (DemoInstant const& instant : instants) {
    for (DemoInstant::Plane const& plane : instant.planes) {
      Agreement const traced = plane.traced.sums.agreement();
      worst.correlation = std::max(worst.correlation, std::abs(traced.correlation - plane.predicted.correlation));
      worst.rms_ratio = std::max(worst.rms_ratio, std::abs(traced.rms_ratio - plane.predicted.rms_ratio));
    }
  }
  return worst;
}

std::string equation(Setup const& setup) {
  double const px_per_gradient = setup.imaging().magnification * setup.z_d * setup.medium.gladstone_dale *
                                 setup.medium.thickness / (setup.ambient_index() * setup.camera.pixel_pitch);
  return fmt::format(
      "```\n"
      "displacement [px] = M Z_D / (n_0 p) * integral of grad n dz = M Z_D K L_z / (n_0 p) * grad rho        (Eq. 9)\n"
      "```\n\n"
      "| symbol | meaning | value |\n"
      "|---|---|---|\n"
      "| M = f / (Z_B - f) | magnification | {:.4f} |\n"
      "| Z_B = Z_A + Z_D | distance from the lens to the dots | {:.2f} m |\n"
      "| Z_D | distance from the mid-plane of the density field to the dots | {:.2f} m |\n"
      "| n_0 | refractive index of the surrounding air | {:.6f} |\n"
      "| p | pixel pitch | {:.0f} um |\n"
      "| K | Gladstone-Dale constant | {:.3g} m^3/kg |\n"
      "| L_z | depth of the density field | {:.0f} mm |\n"
      "| grad rho | density gradient perpendicular to the axis, averaged over L_z | |\n\n"
      "A gradient of 1 kg/m^4 displaces the images of the dots by {:.5f} px against grad rho.\n\n",
      setup.imaging().magnification, setup.z_b(), setup.z_d, setup.ambient_index(), setup.camera.pixel_pitch * 1e6,
      setup.medium.gladstone_dale, setup.medium.thickness * 1e3, px_per_gradient);
}

std::string table(std::vector<DemoInstant> const& instants) {
  std::string rows;
  for (DemoInstant const& instant : instants) {
    auto const& paper = instant.paper;
    AgreementSums const& sums = paper.sums;
    rows += fmt::format("| {} | {} | {} | {} | {:.3f} | {} | {} | {} |\n", instant.time, digits(sums.eq9_px(), 3),
                        digits(sums.cone_px(), 3), digits(sums.rays_px(), 3), sums.agreement().correlation,
                        digits(paper.cone_minus_rays_px, 2), digits(paper.measured_minus_rays_px, 2),
                        digits(paper.measured_minus_window_px, 2));
  }
  return "| 64 nodes, rms per component [px] | Eq. 9 | aperture-averaged Eq. 9 | rays | correlation of Eq. 9 and "
         "rays | aperture-averaged Eq. 9 - rays | measured - rays | measured - window average of the rays |\n"
         "|---|---|---|---|---|---|---|---|\n" +
         rows + "\n";
}

}  // namespace

std::string demo_story(Setup const& setup, std::vector<DemoInstant> const& instants) {
  Agreement const miss = largest_miss(instants);
  std::string const coarse = each(instants, [](DemoInstant const& instant) {
    return fmt::format("{:.3f} at {}", instant.paper.sums.agreement().correlation, instant.time);
  });
  std::string const cone =
      each(instants, [](DemoInstant const& instant) { return digits(instant.paper.cone_minus_rays_px, 1); });
  std::string const measured =
      each(instants, [](DemoInstant const& instant) { return digits(instant.paper.measured_minus_rays_px, 2); });
  std::string const larger = each(instants, [](DemoInstant const& instant) {
    return fmt::format("{:.1f}", 1 / instant.planes.back().traced.sums.agreement().rms_ratio);
  });
  std::string const correlated = each(instants, [](DemoInstant const& instant) {
    return fmt::format("{:.2f}", instant.planes.back().traced.sums.agreement().correlation);
  });
  return "The demo reproduces section 4 of Rajendran, Bane & Vlachos (2019) for two instants of a turbulence "
         "simulation:\n\n"
         "```\n"
         "gladstone demo -o out/demo\n"
         "```\n\n"
         "The set-up follows their Table 1: a 105 mm lens at f/11, Z_A = 0.75 m, Z_D = 0.25 m, pixels of 10 um, and "
         "20 dots per\n"
         "32 x 32 px. The demo compares the displacement of light rays with BOS theory:\n\n" +
         equation(setup) +
         fmt::format(
             "1. **Coarse field.** With 64 nodes across 32.7 mm, as in the authors' sample data, Eq. 9 and the light "
             "rays agree as in\n"
             "   the paper's Figure 4: their correlation is {}.\n"
             "2. **Aperture.** The remaining difference is caused by the aperture: the lens collects a cone of light "
             "that is\n"
             "   (f/N) Z_D / Z_B = {:.2f} mm wide at the medium. Eq. 9 averaged over this cone differs from the\n"
             "   rays by {} px rms.\n"
             "3. **Measurement.** The vectors measured on the rendered images differ from the rays by {} px rms.\n"
             "4. **Fine field.** With {} nodes in the same width the structures are finer than the cone. The rms of\n"
             "   Eq. 9 is then {} times the rms of the rays, and their correlation is {}.\n"
             "5. **Theory of the aperture.** The transfer function of the cone is 2 J1(x) / x with x = pi D_c / "
             "wavelength, where D_c\n"
             "   is the diameter of the cone. Applied to the gradient spectrum of each plane, it predicts the "
             "correlation "
             "to within {:.3f}\n"
             "   and the ratio of the rms values to within {:.3f} for all points of the second figure, without a free "
             "parameter.\n\n",
             coarse, cone_width(setup) * 1e3, cone, measured, instants.front().planes.back().nodes, larger, correlated,
             miss.correlation, miss.rms_ratio) +
         "![density, gradients, Eq. 9, aperture-averaged Eq. 9, light rays](figure4.png)\n\n"
         "*Density, its gradients, and the displacement by Eq. 9, by Eq. 9 averaged over the aperture, and by light "
         "rays: the last\n"
         "two agree.*\n\n"
         "![correlation and rms ratio of rays and Eq. 9 against the size of structures](agreement.png)\n\n"
         "*Correlation of rays and Eq. 9, and ratio of their rms values, against the size of the structures relative "
         "to the\n"
         "diameter of the cone. The labels of the points are the numbers of nodes. Points: ray tracing. Curves: "
         "theory.*\n\n" +
         table(instants) +
         "The first figure uses the 64 x 64 nodes in the middle of the planes (nodes 224 to 287 of 512 along both "
         "axes); the plane\n"
         "continues beyond the view. The set-up of the table is `studies/cases/table1.toml` with\n"
         "`--set medium.field.spacing_mm=\"[0.519, 0.519, 0.519]\"`. The second figure uses whole planes, one view "
         "after the other.\n"
         "`docs/studies/table1.md` gives the errors of the vectors for the finest fields.\n";
}

std::string demo_details(std::vector<DemoInstant> const& instants) {
  std::string text =
      "## Finer fields\n\n"
      "The table compares rays with theory on whole planes, with the number of nodes in 32.7 mm and 96 x 96 dots per "
      "view.\n"
      "The size of the structures is 2 pi times the rms of the gradient over the rms of the derivatives of the "
      "gradient. The\n"
      "correlation is sum(e . r) / sqrt(sum(e . e) sum(r . r)) over the dots, with e from Eq. 9 and r from the rays. "
      "The standard\n"
      "errors estimate how much another plane of the same kind would differ (jackknife over sixteen parts).\n\n"
      "| instant | nodes | size / cone diameter | Eq. 9 [px] | aperture-averaged Eq. 9 [px] | rays [px] | "
      "correlation | theory | rays / Eq. 9 | theory |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (DemoInstant const& instant : instants) {
    for (DemoInstant::Plane const& plane : instant.planes) {
      AgreementSums const& sums = plane.traced.sums;
      Agreement const traced = sums.agreement(), error = plane.traced.error;
      text += fmt::format(
          "| {} | {} | {:.2f} | {:.4f} | {:.4f} | {:.4f} | {:.3f} ± {:.3f} | {:.3f} | {:.3f} ± {:.3f} | {:.3f} "
          "|\n",
          instant.time, plane.nodes, plane.size_over_cone, sums.eq9_px(), sums.cone_px(), sums.rays_px(),
          traced.correlation, error.correlation, plane.predicted.correlation, traced.rms_ratio, error.rms_ratio,
          plane.predicted.rms_ratio);
    }
  }
  text += '\n';
  for (DemoInstant const& instant : instants) {
    text += fmt::format("## Error report with 64 nodes: {}\n\n```\n{}```\n\n", instant.heading, instant.paper.report);
  }
  return text;
}

}  // namespace gladstone::inline examples
