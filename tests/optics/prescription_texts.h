#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "render/optics/lens.h"
#include "tests/support/expect_error.h"

namespace gladstone {

/// Writes bytes to a temporary file of the tests. @return path of the file
inline std::string file_of(std::string const& name, std::string const& bytes) {
  char const* const given = std::getenv("TEST_TMPDIR");
  std::string const path = std::string(given ? given : testing::TempDir()) + "/prescriptions/" + name;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

/// Writes a prescription and builds its lens with the shipped glasses, at the d line.
inline Lens read_lens(std::string const& name, std::string const& bytes) {
  return build_lens(read_prescription(file_of(name, bytes)), GlassCatalogue::shipped(), spectral_line::d);
}

/// Returns "CODE at PLACE" of the error in a file; empty if the file is accepted.
inline std::string refusal(std::string const& name, std::string const& bytes) {
  return error_of([&] { read_lens(name, bytes); });
}

/// Prescription of a biconvex singlet, R = 50 mm, t = 6 mm, N-BK7, in our format and in the formats of Zemax and CODE
/// V.
inline constexpr char const* toml = R"(schema = 1
title = "singlet"
f_number = 8.0
[[surface]]
radius_mm = 50.0
thickness_mm = 6.0
glass = "N-BK7"
stop = true
[[surface]]
radius_mm = -50.0
thickness_mm = 0.0
)";

inline constexpr char const* zmx = R"(VERS 140730 201 26155
MODE SEQ
NAME a singlet
UNIT MM X W X CM MR CPMM
ENPD 6.0
FTYP 0 0 2 1 0 0 0
YFLN 0 5.0 0 0 0 0
WAVM 1 0.48613270 1
WAVM 2 0.58756180 1
PWAV 2
SURF 0
  TYPE STANDARD
  CURV 0.0 0 0 0 0 ""
  DISZ INFINITY
SURF 1
  STOP
  TYPE STANDARD
  CURV 0.02 0 0 0 0 ""
  DISZ 6.0
  GLAS N-BK7 0 0 1.5 40 0 0 0 0 0 0
  DIAM 8.0 1 0 0 1 ""
SURF 2
  TYPE STANDARD
  CURV -0.02 0 0 0 0 ""
  DISZ 47.0
  DIAM 8.0 1 0 0 1 ""
SURF 3
  TYPE STANDARD
  DISZ 0
)";

inline constexpr char const* seq = R"(RDM;LEN  ! radii
TITLE 'a singlet; with a semicolon'
EPD 6.0
DIM M
WL 486.1 587.5618
REF 2
SO 0.0 1e13
S 50.0 6.0 NBK7_SCHOTT
  STO; CIR 8.0
S -50.0 &
  47.0
SI 0.0 0.0
GO
)";

/// Returns a text with the first occurrence of `from` replaced.
inline std::string changed(std::string text, std::string const& from, std::string const& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}

}  // namespace gladstone
