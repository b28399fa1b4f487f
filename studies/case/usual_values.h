#pragma once

#include "render/base/warning.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline cases {

/// Returns one warning for every value of a setup outside the range usual in laboratories: its key, the range, and the
/// unit that would bring the value into it. Examines only keys written in the file; zero and infinity are accepted.
Warnings unusual_values(SetupDocument& document);

}  // namespace gladstone::inline cases
