#include "studies/compare/stored_comparison.h"

#include <array>
#include <filesystem>

#include "render/base/error.h"
#include "render/files/hdf5_axes.h"
#include "render/files/hdf5_file.h"
#include "render/files/sha256.h"
#include "studies/case/backend.h"
#include "studies/case/flat_values.h"

namespace gladstone::inline compare {
namespace {

/// Stage of the chain stored as a dataset [N, 2].
struct Link {
  char const* name;
  std::vector<Vec2d>& (*values)(Comparison&);
  char const* description;
};

constexpr std::array<Link, 10> links{{
    {"/vectors/eq9_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.point.eq9_px; }, "Eq. 9 at the vector"},
    {"/vectors/chief_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.point.chief_px; },
     "Eq. 9 with the distance of each slice from the dots as lever arm"},
    {"/vectors/eq9_cone_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.point.eq9_cone_px; },
     "Eq. 9 averaged over the dot and the aperture"},
    {"/vectors/thin_lens_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.thin_lens; },
     "ray truth through an ideal lens in focus"},
    {"/vectors/flow_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.flow_px; }, "displacement of the flow"},
    {"/vectors/ambient_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.ambient_px; },
     "ray truth without the medium"},
    {"/vectors/ray_truth_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.point.displacement_px; },
     "ray truth at the vector"},
    {"/vectors/window_truth_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.window.displacement_px; },
     "truth on the window"},
    {"/vectors/deformed_window_truth_px",
     [](Comparison& c) -> std::vector<Vec2d>& { return c.deformed_window.displacement_px; },
     "truth on the window of the deformed frames"},
    {"/vectors/noise_free_px", [](Comparison& c) -> std::vector<Vec2d>& { return c.noise_free; },
     "measurement on noise-free, unquantised frames"},
}};

}  // namespace

std::string comparison_fingerprint(SourceFiles const& sources, CompareOptions const& options) {
  std::string text = build_text();
  text += options.truth_at == TruthAt::reference ? " reference" : " mid";
  text += " [" + options.conventions.value_or("") + ']';
  for (SourceFiles::Source const& source : sources.all()) text += ' ' + source.name + ':' + source.sha256;
  return text;
}

void write_chain(std::string const& path, Comparison const& comparison, std::string const& errors) {
  Hdf5Writer file(path, {"gladstone comparison", 1, "", 0, "cpu"});
  Hdf5Axes axes(file);
  axes.write_numbers("/vectors/vector", comparison.measured.size(), "number of the vector that counts, from 0");
  axes.write_numbers("/vectors/component", 2, "u to the right, v downwards; of positions column, row");
  axes.write_numbers("/vectors/quantity", 3, "quantity of /vectors/counts");
  Comparison all = comparison;  // copy: links return mutable references
  for (Link const& link : links) {
    std::vector<Vec2d> const& values = link.values(all);
    if (values.empty()) continue;
    file.write(link.name, flat(values), {values.size(), 2}, "px", link.description,
               "vector as in the file of vectors, component (u right, v down)");
    axes.name(link.name, {"/vectors/vector", "/vectors/component"});
  }
  file.write("/vectors/position_px", flat(comparison.measured.position_px), {comparison.measured.size(), 2}, "px",
             "position of the vector", "vector as in the file of vectors, (column, row)");
  axes.name("/vectors/position_px", {"/vectors/vector", "/vectors/component"});
  std::array<std::int64_t, 3> const counts{static_cast<std::int64_t>(comparison.window.left_out),
                                           static_cast<std::int64_t>(comparison.deformed_window.left_out),
                                           comparison.frames_deformed ? 1 : 0};
  file.write("/vectors/counts", std::span<std::int64_t const>(counts), {counts.size()}, "1",
             "vectors with fewer than three dots in their window; the same for deformed frames; 1 if several passes "
             "deform the frames",
             "number");
  axes.name("/vectors/counts", {"/vectors/quantity"});
  axes.attach();
  file.attribute("/", "made_from", comparison.fingerprint);
  Sha256 hash;
  hash.add(errors);
  file.attribute("/", "errors_sha256", hash.finish());
  file.close();
}

bool read_chain(std::string const& folder, std::string const& fingerprint, Comparison& comparison) {
  namespace fs = std::filesystem;
  std::string const path = (fs::path(folder) / case_file::comparison).string(),
                    errors = (fs::path(folder) / case_file::errors).string();
  std::error_code error;
  if (!fs::exists(path, error) || !fs::exists(errors, error)) return false;
  try {
    Hdf5Reader const file(path);
    if (file.attribute("made_from") != fingerprint || file.attribute("errors_sha256") != byte_sha256(errors)) {
      return false;
    }
    Comparison filled = comparison;
    std::size_t const count = comparison.measured.size();
    for (Link const& link : links) {
      if (!file.has(link.name)) continue;
      std::vector<double> const numbers = file.read(link.name);
      if (numbers.size() != 2 * count) return false;
      std::vector<Vec2d>& values = link.values(filled);
      values.resize(count);
      for (std::size_t i = 0; i < count; ++i) values[i] = {numbers[2 * i], numbers[2 * i + 1]};
    }
    std::vector<std::int64_t> const counts = file.read_integers("/vectors/counts");
    if (counts.size() != 3) return false;
    filled.window.left_out = static_cast<std::size_t>(counts[0]);
    filled.deformed_window.left_out = static_cast<std::size_t>(counts[1]);
    filled.frames_deformed = counts[2] != 0;
    comparison = std::move(filled);
    return true;
  } catch (DataError const&) {
    return false;  // a damaged file is recomputed
  }
}

}  // namespace gladstone::inline compare
