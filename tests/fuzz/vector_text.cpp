#include <cmath>
#include <vector>

#include "analysis/errors/window_truth.h"
#include "analysis/vectors/convention_detection.h"
#include "analysis/vectors/vector_file.h"
#include "analysis/vectors/vector_screening.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

namespace {

/// A displacement that only the right conventions fit.
Vec2d truth(Vec2d c) {
  if (!(c.x >= 0 && c.y >= 0 && c.x <= 127 && c.y <= 127)) return {std::nan(""), std::nan("")};
  return {0.02 * c.x, 0.5 + 0.01 * c.y};
}

}  // namespace

// Reads the input as a text file of vectors of any program, and processes the positions as a comparison does.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  std::string const path = fuzz::file_of(input, "vectors.txt");
  fuzz::read(input, [&] {
    VectorFile file = convert_to_pixels(read_vectors(path), path);
    RejectedVectors const left_out = screen_vectors(file.field, file.conventions.offset_px, 128, 128);
    if (!reason_to_reject_positions(file.field, left_out, 128, 128).empty()) return;
    describe_suspect_positions(file.field, 128, 128);
    if (file.foreign) file.conventions = detect_conventions(file, truth, 128).conventions;
    DisplacementField const field = apply_conventions(std::move(file.field), file.conventions, 128);
    std::vector<Vec2d> const dots{{10, 10}, {14, 10}, {10, 14}, {14, 14}, {100, 90}};
    std::vector<Vec2d> const moved(dots.size(), Vec2d{0.5, 0.25});
    window_truth(dots, moved, {}, field.position_px, correlation_window(WindowWeighting::uniform, 32));
  });
  return 0;
}
