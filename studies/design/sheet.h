#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "studies/case/case.h"
#include "studies/case/result_rows.h"
#include "studies/design/design_point.h"

namespace gladstone::inline design {

/// Source of the formulas for the image diameters of dots and particles.
inline constexpr char const* adrian = "Adrian & Yao 1985; Raffel et al. 2018";

/// Rates a value that should be large: green from `good` on, violated below `least`.
Margin at_least(double value, double good, double least);
/// Rates a value that should be small: green up to `good`, violated above `most`.
Margin at_most(double value, double good, double most);

/// Closed-form quantities of a setup, in the order of their numbers.
struct DesignSheet {
  std::vector<ResultRow> rows;

  /// Returns the row of a key.
  /// @pre the row exists
  ResultRow const& row(std::string const& key) const;
  double operator[](std::string const& key) const { return row(key).value; }
};

/// Returns the largest density gradient in the view by a formula, averaged over the thickness [kg/m^4]; 0 without a
/// field, nullopt if the field has to be mapped.
std::optional<double> closed_form_gradient(Setup const& setup);

/// Collects the given properties of a BOS setup, including its largest density gradient.
/// @throws DataError if the field cannot be read
FixedDesignParameters collect_fixed_parameters(CaseSetup const& loaded);
/// Returns the closed-form model of a setup; `given` must outlive it.
DesignPoint<double> make_design_point(Setup const& setup, FixedDesignParameters const& given);

/// Returns warnings for properties of a setup that closed forms neglect: defocused dots, a posed camera, windows.
/// None for calibrations, which have no sheet.
Warnings list_neglected_effects(Setup const& setup);

}  // namespace gladstone::inline design
