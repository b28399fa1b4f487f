#pragma once

#include "analysis/correlation/correlation_settings.h"
#include "render/setup/setup_table.h"
#include "studies/case/preparation_setup.h"

namespace gladstone::inline cases {

/// Reads the table [correlate] of a setup; problems are collected in its document.
/// @param set  frames to which the masks and preprocessing steps apply
CorrelationSettings read_correlation_settings(SetupTable table, PreparedSet set = PreparedSet::pair);

}  // namespace gladstone::inline cases
