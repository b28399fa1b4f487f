#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/files/fields/readers/nrrd_header.h"

namespace gladstone::inline files {

/// Returns the size of the decoded data [bytes]; text is decoded to doubles.
std::size_t nrrd_decoded_bytes(NrrdHeader const& header);

/// Decodes data in encoding ascii, hex or bzip2.
/// @param stored  the encoded data section, without the bytes to be skipped (bzip2: with them)
/// @return        nrrd_decoded_bytes() bytes: doubles in the byte order of this machine for text, else the values as
///                stored
/// @throws DataError for data that are damaged, cut short, or more than the header says (bzip2 and text)
std::vector<char> decode_nrrd(NrrdHeader const& header, std::string const& stored);

/// Throws a DataError: the data have `there` bytes, fewer than the header says.
[[noreturn]] void refuse_cut_short(NrrdHeader const& header, std::size_t there);
/// Throws a DataError: the data have `there` bytes or more, which exceeds what the header says.
[[noreturn]] void refuse_too_long(NrrdHeader const& header, std::size_t there);

}  // namespace gladstone::inline files
