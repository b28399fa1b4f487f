#pragma once

#include <nanobind/nanobind.h>

#include "render/base/warning.h"

namespace gladstone::python {

/// Returns a warning as an object of gladstone.WarningText. @pre the GIL is held
nanobind::object warning_text(Warning const& warning);
nanobind::list warning_texts(Warnings const& warnings);

}  // namespace gladstone::python
