#include "studies/oracles/validate.h"

#include <array>
#include <cmath>

#include "render/base/units.h"
#include "studies/oracles/oracles.h"

namespace gladstone::inline oracles {
namespace {

constexpr auto absolute = ToleranceKind::absolute;
constexpr auto relative = ToleranceKind::relative;

// Table 1 of Rajendran, Bane & Vlachos (2019)
constexpr double f = 0.105, N = 11, Z_A = 0.75, Z_D = 0.25, Z_B = Z_A + Z_D, L_z = 0.01, pitch = 10e-6, lambda = 532e-9;
constexpr double M = f / (Z_B - f), K = 2.26e-4, n_0 = 1 + K * 1.225;

/// One row per oracle.
constexpr std::array oracles{
    Oracle{"linear n^2, one step: x", "Born & Wolf sec. 3.2: parabola", 1.11824088833465, 1e-13, absolute,
           oracle::linear_index_x},
    Oracle{"parabolic rod at z = 20 mm [mm]", "Ghatak & Thyagarajan: r0 cos(w z / p_z)", -0.425287303350492, 1e-10,
           absolute, oracle::rod_position_mm},
    Oracle{"parabolic rod: error ratio per halving", "order 4: 16 (1 + O(h))", 16.25, 1.25, absolute,
           oracle::rod_error_ratio},
    Oracle{"Luneburg sphere: distance from focus", "Luneburg 1944", 0, 1e-12, absolute, oracle::luneburg_focus},
    Oracle{"Luneburg sphere: optical path", "Luneburg 1944: 1 + pi/2", 1 + pi / 2, 1e-11, absolute,
           oracle::luneburg_optical_path},
    Oracle{"Maxwell fish-eye: distance from antipode", "Maxwell 1854", 0, 1e-12, absolute, oracle::fish_eye_miss},
    Oracle{"BOS slab, matched faces [m]", "n = n0 + a x: catenary", -5.64843623091498e-6, 1e-10, relative,
           oracle::slab_matched_m},
    Oracle{"BOS slab, refracting faces [m]", "n = n0 + a x: catenary, Snell", -5.64843623238551e-6, 1e-10, relative,
           oracle::slab_refracting_m},
    Oracle{"BOS slab, 100 times steeper [m]", "n = n0 + a x: catenary, Snell", -5.64845578957805e-4, 1e-10, relative,
           oracle::steep_slab_refracting_m},
    Oracle{"| |T| - n | at the end of a rod", "eikonal equation", 0, 1e-10, absolute, oracle::eikonal_drift},
    Oracle{"time reversal: miss of the start [mm]", "the ray equation is even in t", 0, 1e-10, absolute,
           oracle::reversal_miss_mm},
    Oracle{"spline of a bicubic up to the edge", "not-a-knot B-spline reproduces cubics", 0, 1e-12, absolute,
           oracle::spline_polynomial_error},
    Oracle{"Gaussian plume: peak deflection n0/dn", "Abel pair: sqrt(2 pi / e)", 1.520346901066281, 2e-6, relative,
           oracle::plume_deflection},
    Oracle{"tilted shock over Snell's deflection", "Snell at 60 degrees", 1, 1e-6, relative,
           oracle::tilted_shock_slope},
    Oracle{"normal shock, Mach 2: density ratio", "Rankine-Hugoniot; NACA 1135", 8.0 / 3, 1e-12, relative,
           oracle::shock_ratio_mach_2},
    Oracle{"K at 532 nm, Ciddor [m^3/kg]", "Ciddor 1996", 2.27024e-4, 3e-6, relative, oracle::ciddor_532},
    Oracle{"K at 532 nm, Merzkirch [m^3/kg]", "Merzkirch 1987", 2.25982e-4, 3e-6, relative, oracle::merzkirch_532},
    Oracle{"Table 1: magnification M", "f / (Z_B - f)", M, 1e-12, relative, oracle::magnification},
    Oracle{"Table 1: image distance [m]", "1/z_i = 1/f - 1/Z_B", M* Z_B, 1e-12, relative, oracle::image_distance_m},
    Oracle{"Table 1: cone at the medium [m]", "Raffel 2015: (f/N) Z_D / Z_B", f / N* Z_D / Z_B, 1e-12, relative,
           oracle::cone_diameter_m},
    Oracle{"Table 1: spot to its first zero [px]", "Airy: 2.4393398 lambda N (1 + M)",
           2.439339782532901 * lambda* N*(1 + M) / pitch, 1e-6, relative, oracle::spot_diameter_px},
    Oracle{"Gaussian spot: energy over pixels", "erf integrals", 1, 1e-6, absolute, oracle::spot_energy},
    Oracle{"dot 10 mm off axis: column [px]", "thin lens: 255.5 + M x / p", 255.5 + M * 0.01 / pitch, 1e-9, absolute,
           oracle::off_axis_column_px},
    Oracle{"uniform density: displacement [px]", "no gradient, no displacement", 0, 1e-11, absolute,
           oracle::uniform_density_px},
    Oracle{"Table 1: sensitivity [px per kg/m^4]", "Rajendran et al. eq. 9: M Z_D K L / (n0 p)",
           M* Z_D* K* L_z / (n_0 * pitch), 1e-8, relative, oracle::sensitivity_px},
    Oracle{"average over the light cone / Eq. 9, wave of 4 mm", "2 J1(x)/x, x = pi D_c / wavelength, slices", 0.620565,
           1e-3, relative, oracle::cone_average_4mm},
    Oracle{"average over the light cone / Eq. 9, wave of 8 mm", "2 J1(x)/x, x = pi D_c / wavelength, slices", 0.894131,
           1e-3, relative, oracle::cone_average_8mm},
    Oracle{"spread of a dot's rays, 8 mm, over Eq. 9", "variance of cos over the cone", 0.1039, 2e-4, absolute,
           oracle::ray_spread_8mm},
};

}  // namespace

double OracleResult::error() const {
  return std::abs(oracle.kind == absolute ? measured - oracle.exact : measured / oracle.exact - 1);
}

bool OracleResult::passed() const { return error() <= oracle.tolerance; }

std::vector<OracleResult> run_oracles(Renderer& renderer) {
  std::vector<OracleResult> results;
  for (Oracle const& oracle : oracles) results.push_back({oracle, oracle.measure(renderer)});
  return results;
}

}  // namespace gladstone::inline oracles
