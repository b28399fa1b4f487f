#include "render/scene/sequence_setup.h"

#include <fmt/format.h>

#include <utility>

#include "render/base/units.h"
#include "render/scene/setup.h"

namespace gladstone {
namespace {

constexpr long long most_frames = 1'000'000;

SequenceSetup read_particle_sequence(SetupTable table) {
  SequenceSetup setup;
  setup.frames = static_cast<std::size_t>(table.required_integer("frames", 2, most_frames));
  setup.dt = table.required_number("dt_us", Range::positive(1e12)) * unit::microsecond;
  setup.pair = static_cast<std::size_t>(table.integer("pair", 0, 0, most_frames));
  table.refuse("files", "applies to BOS only (the particles of PIV move along [flow]); remove it");
  if (setup.pair + 1 >= setup.frames) {
    table.problem("pair", fmt::format("exceeds the last pair, {}, of {} frames (pairs are counted from 0); choose a "
                                      "smaller one, or more frames",
                                      setup.frames - 2, setup.frames));
  }
  return setup;
}

SequenceSetup read_field_sequence(SetupTable table) {
  SequenceSetup setup;
  setup.pair = static_cast<std::size_t>(table.integer("pair", 1, 1, most_frames));
  // The files were replaced by the one of the pair if the case was selected by select_pair().
  if (!table.has("files") && !table.has("pair")) {
    table.problem("files", "is missing (density files, one for each frame); add it, files = [\"rho_*.h5\"]",
                  ErrorCode::missing_key);
  }
  table.path_list("files", 1);
  for (char const* const key : {"frames", "dt_us"}) {
    table.refuse(key, "applies to PIV only (a BOS sequence has one frame for each of sequence.files); remove it");
  }
  return setup;
}

}  // namespace

std::optional<SequenceSetup> read_sequence_setup(SetupTable root, bool piv) {
  SetupTable table = root.table("sequence");
  if (!table.present()) return std::nullopt;
  return piv ? read_particle_sequence(table) : read_field_sequence(table);
}

void check_sequence(Setup const& setup, SetupTable root) {
  if (!setup.sequence) return;
  if (!setup.piv) {
    if (setup.medium.field.kind != FieldKind::file) {
      root.table("sequence")
          .problem("files",
                   "requires [medium.field] with kind = \"file\", whose other keys apply to every file; add it");
    }
    return;
  }
  if (setup.medium.second_field) {
    root.table("medium").problem("second_field",
                                 "conflicts with [sequence] (in which every frame is the second of one pair and the "
                                 "first of the next); remove one");
  }
  LaserSetup const& laser = setup.piv->laser;
  for (auto const& [key, values] : {std::pair("offset_mm", laser.offset), std::pair("tilt_deg", laser.tilt)}) {
    if (values[0] == values[1]) continue;
    root.table("laser").problem(key,
                                "differs between the pulses, which [sequence] excludes (every frame is the second of "
                                "one pair and the first of the next); give one value twice");
  }
}

}  // namespace gladstone
