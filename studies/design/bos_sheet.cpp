#include "studies/design/bos_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/medium/gladstone_dale.h"

namespace gladstone::inline design {
namespace {

using unit::mm;
using unit::um;
constexpr double gradient_without_field = 10;  // [kg/m^4]
constexpr double good_dot_px = 3;              // recommended maximum of the diffraction-limited dot diameter, F13
// ratio of the first-zero diameter to the e^-2 diameter of a diffraction-limited PSF
constexpr double zero_over_e2 = 2.44 / 1.644922989562259;
constexpr double deforming_strain = 0.1;  // maximum strain that deforming interrogation windows follow, F19

constexpr double binding = 1e-3;  // tolerance by which a design may exceed an active limit

constexpr double good_signal = 20;  // recommended signal-to-noise ratio, F21

constexpr char const* raffel = "Raffel 2015, Exp. Fluids 56:60";
constexpr char const* seed = "Rajendran, Bane & Vlachos";
constexpr char const* derived = "derived in docs/design.md";

void add_imaging(DesignSheet& sheet, Setup const& setup, DesignPoint<double> const& b) {
  CameraSetup const& camera = b.given->camera;
  auto& rows = sheet.rows;
  rows.push_back({"F1", "image_distance_mm", "z_i", "image distance", b.image_distance() / mm, "mm",
                  "1 / (1/f - 1/Z_B)", raffel, Margin::none, ""});
  rows.push_back({"F1", "magnification", "M", "magnification of the dots", b.magnification(), "", "f / (Z_B - f)",
                  raffel, Margin::none, ""});
  rows.push_back({"F1", "magnification_at_medium", "M_A", "magnification of the medium", b.magnification_at_medium(),
                  "", "M Z_B / Z_A", raffel, Margin::none, ""});
  rows.push_back({"F2", "refractivity", "n0 - 1", "refractive index of the ambient gas minus 1",
                  setup.medium.ambient_refractivity(), "", "K rho", seed, Margin::none, ""});
  double const ciddor = gladstone_dale_ciddor(b.given->wavelength), own = b.given->gladstone_dale;
  rows.push_back({"F3", "gladstone_dale_m3_kg", "K", "Gladstone-Dale constant", own, "m^3/kg", "(n_s - 1) / rho_s",
                  "Ciddor 1996, Appl. Opt. 35:1566",
                  setup.medium.gas ? Margin::none : at_most(std::abs(own / ciddor - 1), 0.01, 0.05),
                  fmt::format("of the setup; air at this wavelength has {:.5g} (Ciddor), {:.5g} (Merzkirch 1987)",
                              ciddor, gladstone_dale_merzkirch(b.given->wavelength))});
  rows.push_back({"F4", "optical_direction", "|T|", "norm of the direction vector n dr/ds of a ray",
                  b.given->ambient_index, "", "d/ds (n dr/ds) = grad n, |T| = n",
                  "Sharma, Kumar & Ghatak 1982, Appl. Opt. 21:984", Margin::none,
                  "outside the medium; conserved along the ray"});
  rows.push_back({"F16", "field_of_view_mm", "", "field of view in the medium, width",
                  camera.columns * b.pixel_at_medium() / mm, "mm", "w Z_A / z_i", raffel, Margin::none, ""});
  rows.push_back({"F16", "field_of_view_height_mm", "", "field of view in the medium, height",
                  camera.rows * b.pixel_at_medium() / mm, "mm", "h Z_A / z_i", raffel, Margin::none, ""});
  rows.push_back({"F16", "field_of_view_at_dots_mm", "", "field of view on the dots, width",
                  camera.columns * b.pixel_at_dots() / mm, "mm", "w / M", raffel, Margin::none,
                  "minimum size of the target"});
}

void add_sensitivity(DesignSheet& sheet, DesignPoint<double> const& b) {
  auto& rows = sheet.rows;
  double const gradient = sheet_gradient(*b.given), quarter = b.given->first_window_px / 4.0;
  std::string const of = fmt::format("of {:.4g} kg/m^4{}", gradient,
                                     b.given->largest_gradient > 0 ? ", the largest in the setup's view" : "");
  rows.push_back({"F5", "deflection_urad", "eps", "deflection", gradient * b.deflection() * 1e6, "urad",
                  "(1/n0) integral of grad n dz", "Goldhahn & Seume 2007, Exp. Fluids 43:241", Margin::none, of});
  rows.push_back(
      {"F6", "displacement_px", "", "displacement", gradient * b.sensitivity(), "px", "M Z_D K L_z grad rho / (n0 p)",
       seed, b.given->largest_gradient > 0 ? at_most(gradient * b.sensitivity(), 0.5 * quarter, quarter) : Margin::none,
       of});
  rows.push_back({"F7", "angular_sensitivity_mm_rad", "", "sensitivity to deflection", b.angular_sensitivity() / mm,
                  "mm/rad", "M Z_D", "Gojani et al. 2013, J. Vis. 16:201", Margin::none, ""});
  rows.push_back({"F7", "sensitivity_px_per_kg_m4", "S", "sensitivity to density gradients", b.sensitivity(),
                  "px per kg/m^4", "M Z_D K L_z / (n0 p)", "Gojani et al. 2013, J. Vis. 16:201", Margin::none, ""});
  rows.push_back({"F8", "share_of_sensitivity", "", "sensitivity relative to its upper limit", b.z_d / b.z_b(), "",
                  "Z_D / (Z_A + Z_D)", derived, Margin::none, "for this field of view; half at Z_D = Z_A"});
  rows.push_back(
      {"F18", "gradient_min_kg_m4", "", "smallest detectable gradient", b.smallest_gradient(), "kg/m^4",
       "2 sigma p n0 / (M Z_D K L_z)", "Westerweel 1997, Meas. Sci. Technol. 8:1379",
       b.given->largest_gradient > 0 ? at_most(b.smallest_gradient(), 0.1 * gradient, gradient) : Margin::none,
       "two standard deviations of F26"});
  rows.push_back(
      {"F19", "gradient_max_kg_m4", "", "largest gradient of the first pass", b.gradient_from_displacement(quarter),
       "kg/m^4", "(N_w / 4) / sensitivity", "Keane & Adrian 1992, Appl. Sci. Res. 49:191",
       b.given->largest_gradient > 0 ? at_least(b.gradient_from_displacement(quarter), 2 * gradient, gradient)
                                     : Margin::none,
       fmt::format("a quarter of the window of {} px", b.given->first_window_px)});
  double const lever = b.z_a * b.z_d / b.z_b();
  rows.push_back({"F19", "curvature_max_kg_m5", "", "largest second derivative of density",
                  deforming_strain / (lever * b.deflection()), "kg/m^5", "0.1 n0 / (K L_z Z_A Z_D / Z_B)", derived,
                  Margin::none, "strain of 0.1 in the image; rays cross at ten times that value"});
  rows.push_back({"F20", "dynamic_range", "", "dynamic range of displacement", quarter / b.random_error(), "",
                  "(N_w / 4) / sigma", "Adrian 1997, Meas. Sci. Technol. 8:1393",
                  at_least(quarter / b.random_error(), 100, 20), ""});
}

std::string resolution_limit(double window, double cone, double pixels) {
  return window >= std::max(cone, pixels) ? "the window" : cone >= pixels ? "the cone" : "two pixels";
}

void add_blur(DesignSheet& sheet, DesignPoint<double> const& b) {
  auto& rows = sheet.rows;
  double const cone = b.cone_diameter(), window = b.window_width(), pixels = 2 * b.pixel_at_medium();
  double const smallest = std::max({window, cone, pixels}), resolved = resolved_wavelength(b);
  rows.push_back(
      {"F9", "cone_diameter_mm", "D_c", "diameter of the light cone in the mid-plane", cone / mm, "mm",
       "(f / N) Z_D / Z_B", raffel, at_most(cone / window, 1, 2),
       fmt::format("{:.4f} px at the scale of the dots, {:.4f} px at the scale of the medium; compared with the window",
                   cone / b.pixel_at_dots(), cone / b.pixel_at_medium())});
  rows.push_back({"F10", "cone_wavelength_mm", "", "wavelength that the cone transmits at 1/sqrt(2)",
                  cone / 0.51450 / mm, "mm", "D_c / 0.51450", derived, Margin::none,
                  fmt::format("half at {:.4g} mm, zero at {:.4g} mm", cone / 0.70508 / mm, cone / 1.21967 / mm)});
  rows.push_back({"F11", "window_width_mm", "W_o", "window in the medium", window / mm, "mm", "N_w p / M_A",
                  "Scarano & Riethmuller 1999, Exp. Fluids 26:513", Margin::none,
                  fmt::format("of the last pass, {} px", b.given->window.window_px())});
  rows.push_back({"F12", "smallest_structure_mm", "", "smallest structure", smallest / mm, "mm",
                  "max(window, cone, 2 px)", raffel, Margin::none,
                  "limited by " + resolution_limit(window, cone, pixels)});
  rows.push_back({"F12", "resolution_mm", "", "wavelength that the chain transmits at 1/sqrt(2)", resolved / mm, "mm",
                  "H_cone H_dot H_window = 1/sqrt(2)", derived, Margin::none,
                  fmt::format("cone {:.3f}, dot {:.3f}, window {:.3f} there",
                              cone_transfer(b.pupil(), b.z_b(), b.z_d, b.given->thickness, resolved),
                              disc_transfer(b.dot_diameter * b.z_a / b.z_b(), resolved),
                              b.given->window.share(b.pixel_at_medium() / resolved))});
  rows.push_back(
      {"F13", "diffraction_diameter_px", "d_diff", "diffraction image, diameter of the first zero", b.diffraction_px(),
       "px", "2.44 N (1 + M) lambda / p", adrian,
       at_most(b.diffraction_px(), good_dot_px, zero_over_e2 * random_error_range.most_image),
       fmt::format("{:.6g} um; FWHM {:.4g} um, e^-2 {:.4g} um; small dots up to {:g} px, and up to {:.3g} px "
                   "the random error is known (e^-2 {:g} px)",
                   2.44 * b.spot_scale() / um, 1.0289939699621886 * b.spot_scale() / um,
                   1.644922989562259 * b.spot_scale() / um, good_dot_px, zero_over_e2 * random_error_range.most_image,
                   random_error_range.most_image)});
  double const dot = b.dot_image_px();
  rows.push_back(
      {"F14", "dot_diameter_px", "", "dot image, e^-2 diameter", dot, "px", "sqrt((M d / p)^2 + (4 s)^2)", adrian,
       std::max(at_least(dot, min_image_px, 1.5), at_most(dot, random_error_range.most_image, 7)),
       fmt::format(
           "of dots {:.4g} mm wide, s = 0.4206 N (1 + M) lambda / p = {:.3g} px; 2 to 3 px for correlation, 3 to "
           "5 px for tracking",
           b.dot_diameter / mm, b.spot_sigma_px())});
  rows.push_back({"F15", "dots_per_window", "N_I", "dots in a window", b.dots_in_window(), "", "C N_w^2",
                  "Keane & Adrian 1992, Appl. Sci. Res. 49:191", at_least(b.dots_in_window(), 8, 5),
                  fmt::format("they cover {:.3g} % of the target", 100 * b.coverage())});
  double const m = b.magnification(), ratio = (m + 1) / m * b.f_number;
  double const depth = 4.88 * ratio * ratio * b.given->wavelength;
  rows.push_back({"F17", "depth_of_field_mm", "", "depth of field about the dots", depth / mm, "mm",
                  "4.88 ((M + 1) / M)^2 N^2 lambda", "Adrian 1991; Raffel et al. 2018", Margin::none,
                  depth / 2 > b.z_d
                      ? "includes the medium"
                      : "excludes the medium: the dots are sharp, the field is averaged over the light cone"});
}

/// Returns the peak charge that equals q times its noise: n / sqrt(n + sigma_r^2) = q, with sigma_r^2 the variance
/// without shot noise [e].
double peak_of_signal(DesignPoint<double> const& b, double q) {
  double const n = b.peak_electrons(), variance = std::pow(b.noise() * n, 2);
  NoiseSetup const& noise = b.given->camera.noise;
  double const shot = noise.enabled && noise.shot_noise ? 1 : 0;
  return 0.5 * q * (shot * q + std::sqrt(shot * q * q + 4 * (variance - shot * n)));
}

/// Returns the largest f-number at which the dot images are within the recommended size; 0 if the geometric image alone
/// exceeds it.
double widest_images_stop(DesignPoint<double> const& b) {
  double const most = random_error_range.most_image, geometric = b.geometric_dot_px();
  return b.f_number * std::sqrt(std::max(0.0, most * most - geometric * geometric)) / (4 * b.spot_sigma_px());
}

/// Returns the largest f-number with sufficiently bright peaks, assuming the peak share of the present f-number;
/// infinite if the light is not specified.
double brightest_stop(DesignPoint<double> const& b) {
  if (!b.given->light) return HUGE_VAL;
  return b.f_number * std::sqrt(b.peak_electrons() / peak_of_signal(b, good_signal));
}

void add_light(DesignSheet& sheet, DesignPoint<double> const& b) {
  auto& rows = sheet.rows;
  CameraSetup const& camera = b.given->camera;
  double const peak = b.peak_electrons(), full = camera.noise.full_well_e;
  std::string const from = b.given->light      ? "by [light]"
                           : camera.exposure_e ? "by camera.exposure"
                                               : "by exposure = \"auto\", with as much light as that requires";
  rows.push_back({"F21", "peak_electrons", "n_e", "electrons at a dot's peak", peak, "",
                  "pi L t p^2 QE lambda / (4 h c N^2 (1 + M)^2), times the fraction at the peak", "camera equation",
                  peak > full ? Margin::violated : at_least(peak / full, 0.2, 0.02),
                  fmt::format("{:.3g} % of the full well, {}; {:.5g} in a fully lit pixel", 100 * peak / full, from,
                              b.lit_electrons())});
  rows.push_back({"F21", "signal_to_noise", "", "signal-to-noise ratio at the peak", 1 / b.noise(), "",
                  "n_e / sqrt(n_e + sigma_r^2)", "Rose 1948, J. Opt. Soc. Am. 38:196",
                  at_least(1 / b.noise(), good_signal, 5), ""});
  double const floor = b.focal_length * b.z_d / (b.z_b() * b.window_width());
  double const sharp = widest_images_stop(b);
  double const bright = brightest_stop(b), most = std::fmin(sharp, bright);
  double const cone = b.focal_length * b.z_d / (b.z_b() * most);
  std::string closed =
      fmt::format("no f-number satisfies all limits: the largest, f/{:.3g}, has a cone of {:.4g} mm", most, cone / mm);
  closed += "; a cone wider than the window counts in the resolution, F12";
  if (bright < floor)
    closed += fmt::format("; the smallest requires {:.3g} times the light", std::pow(floor / bright, 2));
  rows.push_back({"F22", "f_number_floor", "", "smallest f-number: cone no wider than the window", floor, "",
                  "f Z_D / (Z_B W_o)", derived, at_least(b.f_number / floor, 1, 0.5), floor <= most ? "" : closed});
  double const widest = random_error_range.most_image;
  rows.push_back({"F22", "f_number_ceiling", "", fmt::format("largest f-number: dot images within {:g} px", widest),
                  sharp, "", fmt::format("sqrt({:g}^2 - (M d / p)^2) p / (1.682 (1 + M) lambda)", widest), derived,
                  at_most(b.f_number / sharp, 1 + binding, 7 / widest),
                  sharp > 0 ? "limit of the recommendation" : "the geometric images of the dots alone are wider"});
  if (!b.given->light) return;
  rows.push_back({"F22", "f_number_light", "", "largest f-number: peaks of 20 times their noise", bright, "",
                  "N sqrt(n_e / n_min), n_min = (q^2 + sqrt(q^4 + 4 q^2 sigma_r^2)) / 2, q = 20", derived,
                  at_most(b.f_number / bright, 1, std::sqrt(peak_of_signal(b, good_signal) / peak_of_signal(b, 5))),
                  fmt::format("{:.4g} electrons at the peak, {:.3g} of those in a fully lit pixel",
                              peak_of_signal(b, good_signal), b.peak_share())});
}

}  // namespace

std::string beyond_study(DesignPoint<double> const& b) {
  RandomErrorRange const& range = random_error_range;
  std::string text;
  auto const check = [&text](char const* what, double value, double low, double high, double unit, char const* name) {
    constexpr double slack = 5e-3;  // tolerance for the rounded limits of the study's range, relative to them
    bool const below = value < low * (1 - slack);
    if (below || value > high * (1 + slack))
      text += fmt::format("{}{} {} {:.3g}{}", text.empty() ? "" : ", ", what, below ? "below" : "above",
                          (below ? low : high) / unit, name);
  };
  check("dots", b.geometric_dot_px(), range.least_dot, HUGE_VAL, 1, " px");
  check("images", b.dot_image_px(), 0, range.most_image, 1, " px");
  check("spots", b.spot_sigma_px(), range.narrowest_spot, range.widest_spot, 1, " px");
  check("noise", b.noise(), range.least_noise, range.most_noise, 0.01, " %");
  check("a number of dots", b.dots_in_window(), range.fewest_dots, range.most_dots, 1, " in a window");
  return text;
}

namespace {

void add_errors(DesignSheet& sheet, Setup const& setup, DesignPoint<double> const& b) {
  auto& rows = sheet.rows;
  double const sigma = b.random_error(), pitch = b.given->camera.pixel_pitch, q = b.noise();
  std::string const beyond = beyond_study(b);
  rows.push_back({"F23", "uncertainty_product_nm", "", "error of the deflection times the cone diameter",
                  sigma * pitch / (b.f_number * (1 + b.magnification())) / unit::nanometre, "nm rad",
                  "sigma p / (N (1 + M)) = sigma_eps D_c", derived, Margin::none,
                  "equal at every distance; a smaller product requires a smaller sigma or a larger f-number"});
  rows.push_back({"F24", "dot_position_bound_px", "", "lower bound of the position error of a dot",
                  std::sqrt(2 / pi) * q, "px", "sqrt(2/pi) sigma_n / A",
                  "Rajendran, Bane & Vlachos 2020, Exp. Fluids 61:139", Margin::none,
                  "Cramer-Rao bound of an isolated dot"});
  rows.push_back({"F25", "blur_px_per_kg_m5", "", "blur of a dot per second derivative of density",
                  b.angular_sensitivity() * b.deflection() * b.cone_diameter() / (4 * pitch), "px per kg/m^5",
                  "M Z_D K L_z D_c / (4 n0 p)", "Rajendran, Bane & Vlachos 2020 (1/12 there, 1/16 for a round stop)",
                  Margin::none, "standard deviation"});
  rows.push_back({"F26", "random_error_px", "sigma", "random error of a vector", sigma, "px",
                  "sqrt(pattern^2 (20 / N_I)^0.48 + (0.287 q (1 + 1.6 s^2) d^-0.737)^2 20 / N_I)",
                  "data/estimators/random_error.csv",
                  std::max(at_most(sigma, 0.05, 0.1), beyond.empty() ? Margin::none : Margin::marginal),
                  fmt::format("along the displacement, and 0.3 to 1.1 times as much across it; dots of {:.3g} px, PSF "
                              "of {:.3g} px, noise {:.3g} % of the peak, {:.3g} dots in a window{}",
                              b.geometric_dot_px(), b.spot_sigma_px(), 100 * q, b.dots_in_window(),
                              beyond.empty() ? "" : "; outside the range of the study: " + beyond)});
  double const epsilon = sheet_gradient(*b.given) * b.deflection(), slab = b.given->thickness / b.z_d;
  double const theta = b.given->camera.columns * pitch / 2 / b.image_distance();
  bool const matched = setup.medium.faces == Faces::matched;
  double const on_axis = epsilon * epsilon * (matched ? 1.0 / 6 + slab / 24 : 2.0 / 3 + 7 * slab / 24);
  double const off_axis = theta * theta * (matched ? 1 : 2 - b.z_a / b.z_d);
  rows.push_back({"F27", "small_angle_on_axis", "", "error of Eq. 9 on the axis", on_axis, "",
                  matched ? "eps^2 (1/6 + L_z / (24 Z_D))" : "eps^2 (2/3 + 7 L_z / (24 Z_D))", derived,
                  at_most(on_axis, 1e-3, 1e-2), "for a slab of uniform gradient"});
  rows.push_back({"F27", "small_angle_at_edge", "", "error of Eq. 9 at the edge of the view", off_axis, "",
                  matched ? "theta^2" : "(2 - Z_A / Z_D) theta^2", derived, at_most(std::abs(off_axis), 1e-2, 5e-2),
                  fmt::format("theta = {:.4g} rad", theta)});
  double const fresnel = std::sqrt(b.given->wavelength * b.z_a * b.z_d / b.z_b());
  rows.push_back({"", "fresnel_scale_mm", "", "Fresnel scale", fresnel / mm, "mm", "sqrt(lambda Z_A Z_D / Z_B)",
                  "Born & Wolf", at_most(fresnel / resolved_wavelength(b), 0.5, 1),
                  "geometric optics does not describe finer features"});
}

}  // namespace

double sheet_gradient(FixedDesignParameters const& given) {
  return given.largest_gradient > 0 ? given.largest_gradient : gradient_without_field;
}

DesignSheet bos_sheet(Setup const& setup, DesignPoint<double> const& bench) {
  DesignSheet sheet;
  add_imaging(sheet, setup, bench);
  add_sensitivity(sheet, bench);
  add_blur(sheet, bench);
  add_light(sheet, bench);
  add_errors(sheet, setup, bench);
  auto const number = [](ResultRow const& row) { return row.id.empty() ? 99 : std::stoi(row.id.substr(1)); };
  std::stable_sort(sheet.rows.begin(), sheet.rows.end(),
                   [&](ResultRow const& a, ResultRow const& b) { return number(a) < number(b); });
  return sheet;
}

}  // namespace gladstone::inline design
