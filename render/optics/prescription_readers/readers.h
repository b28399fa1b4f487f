#pragma once

#include <string>

#include "render/optics/prescription.h"

namespace gladstone {

/// Our own format; docs/file-formats.md describes its keys.
Prescription read_toml_prescription(std::string const& path);
/// Zemax, sequential mode. Zemax's manuals give the keywords; docs/file-formats.md lists what is read; text in any
/// encoding of decoded_text().
Prescription read_zmx_prescription(std::string const& path);
/// CODE V; docs/file-formats.md lists what is read. Commands that make a surface one that is not traced are refused by
/// name, others that are not known are noted.
Prescription read_seq_prescription(std::string const& path);

}  // namespace gladstone
