#pragma once

namespace gladstone::inline medium {

/// Returns the Gladstone-Dale constant of dry air from Ciddor's dispersion formula: K = (n_s - 1) / rho_s at 15 C,
/// 101325 Pa, 450 ppm CO2, rho_s = 1.225458 kg/m^3 (Ciddor, Appl. Opt. 35 (1996) 1566). Valid for 0.23 to 1.69 um.
/// @param wavelength  vacuum wavelength [m]
/// @return K [m^3/kg]
constexpr double gladstone_dale_ciddor(double wavelength) {
  double const sigma = 1e-6 / wavelength;  // [1/um]
  double const sigma2 = sigma * sigma;
  double const refractivity = 1e-8 * (5792105.0 / (238.0185 - sigma2) + 167917.0 / (57.362 - sigma2));
  return refractivity / 1.225458;
}

/// Returns the Gladstone-Dale constant of air by the fit K = 2.2244e-4 [1 + (6.7132e-8 / lambda)^2] m^3/kg (Merzkirch,
/// Flow Visualization, 1987), which is 0.3 to 0.6 % below Ciddor's value in the visible range.
constexpr double gladstone_dale_merzkirch(double wavelength) {
  double const ratio = 6.7132e-8 / wavelength;
  return 2.2244e-4 * (1 + ratio * ratio);
}

}  // namespace gladstone::inline medium
