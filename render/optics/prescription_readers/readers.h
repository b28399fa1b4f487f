#pragma once

#include <string>

#include "render/optics/prescription.h"

namespace gladstone {

/// Our own format; docs/file-formats.md describes its keys.
Prescription read_toml_prescription(std::string const& path);
/// Zemax, sequential mode: surfaces STANDARD, EVENASPH and COORDBRK; others are refused by name. Zemax's manuals give
/// the keywords; text in any encoding of decoded_text().
Prescription read_zmx_prescription(std::string const& path);
/// CODE V: what lenses of textbooks are written in (S, STO, K, A to H, CIR, decentres); other commands that change what
/// a ray does are refused by name.
Prescription read_seq_prescription(std::string const& path);

}  // namespace gladstone
