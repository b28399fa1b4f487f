#include "studies/examples/demo_story.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gladstone {
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

/// Returns the largest differences between traced and predicted agreement.
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
      "M = f / (Z_B - f) = {:.4f} is the magnification; Z_B = Z_A + Z_D = {:.2f} m the distance from the lens to the "
      "dots, of which Z_D =\n"
      "{:.2f} m lies behind the middle of the density field; n_0 = {:.6f} the index of the surrounding air; p = {:.0f} "
      "um the pixel pitch; K =\n"
      "{:.3g} m^3/kg the Gladstone-Dale constant; grad rho the density gradient across the axis, averaged over the "
      "field's depth L_z = {:.0f} mm:\n"
      "{:.5f} px per kg/m^4. Dots appear displaced against grad rho.\n\n",
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
  return "| 64 nodes, rms in px per component | Eq. 9 | cone-averaged Eq. 9 | rays | correlation of Eq. 9 and rays | "
         "cone-averaged Eq. 9 - rays | measured - rays | measured - rays on the window |\n"
         "|---|---|---|---|---|---|---|---|\n" +
         rows + "\n";
}

}  // namespace

std::string demo_story(Setup const& setup, std::vector<DemoInstant> const& instants) {
  Agreement const miss = largest_miss(instants);
  std::string const coarse = each(instants, [](DemoInstant const& instant) {
    auto const& sums = instant.paper.sums;
    return fmt::format("{} against {} px rms, correlation {:.3f}, at {}", digits(sums.eq9_px(), 3),
                       digits(sums.rays_px(), 3), sums.agreement().correlation, instant.time);
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
  return "The paper's section 4 on two instants of a turbulence simulation: Table 1's bench (105 mm, f/11, Z_A 0.75 m, "
         "Z_D "
         "0.25 m, 10 um pixels,\n"
         "20 dots in 32 x 32 px), and the displacement of light rays beside that of BOS theory,\n\n" +
         equation(setup) +
         fmt::format(
             "1. On a field as coarse as the authors' own sample, 64 nodes in 32.7 mm, Eq. 9 and the light rays agree "
             "as "
             "in the paper's Figure 4:\n"
             "   {}.\n"
             "2. What is left between them is the cone of light that the stop takes from a dot, (f/N) Z_D / Z_B = "
             "{:.2f} "
             "mm wide at the medium: rays\n"
             "   are Eq. 9 averaged over it, to {} px.\n"
             "3. Vectors measured on the rendered images follow the rays to {} px.\n"
             "4. With {} nodes in the same width structures are finer than the cone, and Eq. 9 is {} times as large as "
             "the rays and hardly\n"
             "   correlated with them ({}).\n"
             "5. The cone's transfer function, 2 J1(x) / x with x = pi cone / wavelength, applied to the plane's own "
             "spectrum of gradients, foretells\n"
             "   all that without a free parameter: to {:.3f} in correlation and {:.3f} in the ratio of rms, at every "
             "point of the second figure.\n\n",
             coarse, cone_width(setup) * 1e3, cone, measured, instants.front().planes.back().nodes, larger, correlated,
             miss.correlation, miss.rms_ratio) +
         "![Figure 4: density, gradients, Eq. 9, cone-averaged Eq. 9, light rays](figure4.png)\n"
         "![correlation and rms ratio of rays and Eq. 9 against the size of structures over the cone's width]"
         "(agreement.png)\n\n" +
         table(instants) +
         "The first figure's fields are 64 x 64 nodes in the middle of the planes (224 to 287 of 512 along both axes; "
         "the "
         "plane goes on around the\n"
         "view): `studies/cases/table1.toml` with `--set medium.field.spacing_mm=\"[0.519, 0.519, 0.519]\"`. The "
         "second's are "
         "whole planes, a view at a\n"
         "time; what vectors are worth on the finest ones stands in `docs/studies/table1.md`.\n";
}

std::string demo_details(std::vector<DemoInstant> const& instants) {
  std::string text =
      "## Finer fields\n\n"
      "Whole planes, so many of their nodes in 32.7 mm; 96 x 96 dots. Size: 2 pi times the rms of the gradient over "
      "the rms of its "
      "own "
      "gradient. Correlation:\n"
      "sum of e . r over the root of (sum of e . e) (sum of r . r), e Eq. 9 and r rays, over dots. Standard errors: "
      "how "
      "much another plane of\n"
      "the same kind would differ (jackknife over sixteen pieces).\n\n"
      "| instant | nodes | size / cone | Eq. 9 [px] | cone-averaged Eq. 9 [px] | rays [px] | correlation | "
      "theory | "
      "rays / Eq. 9 | theory |\n"
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
    text += fmt::format("## Error report of the 64 nodes: {}\n\n```\n{}```\n\n", instant.heading, instant.paper.report);
  }
  return text;
}

}  // namespace gladstone
