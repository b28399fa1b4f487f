#include "python/src/warnings.h"

#include <nanobind/stl/string.h>

#include <string>

namespace gladstone::python {

namespace nb = nanobind;

nb::object warning_text(Warning const& warning) {
  nb::object const type = nb::module_::import_("gladstone._errors").attr("WarningText");
  return type(std::string(warning_code_name(warning.code)), warning.place, warning.text);
}

nb::list warning_texts(Warnings const& warnings) {
  nb::list texts;
  for (Warning const& warning : warnings) texts.append(warning_text(warning));
  return texts;
}

}  // namespace gladstone::python
