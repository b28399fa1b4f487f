#pragma once

#include <string>
#include <vector>

#include "studies/design/propagation.h"
#include "studies/report/mean_of_repeats.h"
#include "studies/report/measured_gradients.h"
#include "studies/report/report_page.h"
#include "studies/report/simulated_twin.h"

namespace gladstone::inline report {

/// Results of a measurement from which its statements are derived; the displacement is the first input.
struct MeasurementKnown {
  MeasuredGradients const& gradients;
  PropagatedResult const& typical;  ///< result for a vector of typical displacement and uncertainty
  std::vector<MeasurementInput> const& inputs;
  MeanOfRepeats const& mean;
  SimulatedTwin const* twin = nullptr;  ///< simulated twin of the measurement; null: none
  double sensitivity = 1;               ///< displacement per density gradient [px per kg/m^4]

  bool simulated() const { return twin && twin->failed.empty(); }
};

/// Statements in the terms of the GUM (JCGM 100:2008).
struct MeasurementStatements {
  std::string measurand, expanded, displacement, setup, bias;

  std::vector<std::string> all() const;
};
MeasurementStatements measurement_statements(MeasurementKnown const& known);

/// Formats a table of the inputs with their contributions to the uncertainty of the gradient.
TextTable inputs_table(MeasurementKnown const& known);

}  // namespace gladstone::inline report
