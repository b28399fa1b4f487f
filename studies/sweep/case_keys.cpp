#include "studies/sweep/case_keys.h"

#include <fmt/format.h>

#include "render/setup/setup_node.h"
#include "render/setup/toml_text.h"

namespace gladstone::inline sweep {
namespace {

void remove(SetupNode& table, std::string const& key) {
  std::erase_if(table.members, [&key](SetupMember const& member) { return member.key == key; });
}

/// Returns the table of a name, or the first of an array of tables; an empty table if there is none.
SetupNode& table_of(SetupNode& root, std::string const& key) {
  static thread_local SetupNode empty;
  SetupNode* node = root.find(key);
  if (node && node->kind == SetupNode::Kind::array && !node->elements.empty()) node = &node->elements.front();
  return node ? *node : empty = {};
}

}  // namespace

CaseKeys case_keys(CaseSetup const& loaded, std::map<std::string, std::string> const& inputs, RepeatSeeds seeds) {
  SetupNode setup = parse_toml(loaded.document.resolved(), "resolved setup");  // all defaults are explicit
  std::string files;
  for (auto const& [name, hash] : inputs) files += fmt::format("\n{} {}", name, hash);

  CaseKeys keys;
  SetupNode medium = table_of(setup, "medium");
  for (char const* key : {"step_mm", "integrator", "faces"}) remove(medium, key);
  auto const field = inputs.find(loaded.setup.medium.field.file);
  keys.medium = toml_text(medium) + '\n' + (field == inputs.end() ? "" : field->second);

  // The camera's electronics do not affect the light; the first interrogation window matters only through the target's
  // extent.
  SetupNode& camera = table_of(setup, "camera");
  std::string const electronics =
      fmt::format("bits {}, exposure {}, full well {}, {} of photons", loaded.setup.camera.bit_depth,
                  loaded.setup.camera.exposure_e.value_or(0), loaded.setup.camera.noise.full_well_e,
                  loaded.setup.camera.absolute_exposure ? loaded.setup.camera.noise.quantum_efficiency : 0.0);
  for (char const* key : {"noise", "background", "bit_depth", "exposure", "offset_dn"}) remove(camera, key);
  std::optional<std::uint64_t> const rays = loaded.setup.render.rays_per_dot;
  remove(table_of(setup, "render"), "rays_per_dot");
  remove(setup, "correlate");
  if (seeds == RepeatSeeds::left_out) {
    for (char const* const table : {"target", "particles", "render"}) remove(table_of(setup, table), "seed");
  }
  Vec2d const extent = loaded.setup.experiment().sources.on_target ? loaded.setup.target_extent() : Vec2d{};
  keys.scene = fmt::format("{}\nextent {} {}{}", toml_text(setup), extent.x, extent.y, files);
  keys.rays = keys.scene + (rays ? fmt::format("\n{} rays", *rays) : "\nrays for " + electronics);
  return keys;
}

}  // namespace gladstone::inline sweep
