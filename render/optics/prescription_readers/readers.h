#pragma once

#include <string>

#include "render/optics/prescription.h"

namespace gladstone::inline optics {

/// Reads a prescription in TOML format; docs/file-formats.md describes its keys.
Prescription read_toml_prescription(std::string const& path);
/// Reads a Zemax prescription in sequential mode, in any encoding supported by decoded_text(). The keywords are defined
/// in Zemax's manuals; docs/file-formats.md lists those that are read.
Prescription read_zmx_prescription(std::string const& path);
/// Reads a CODE V prescription; docs/file-formats.md lists the commands that are read. Commands that define unsupported
/// surfaces cause a DataError, unknown ones a warning.
Prescription read_seq_prescription(std::string const& path);

}  // namespace gladstone::inline optics
