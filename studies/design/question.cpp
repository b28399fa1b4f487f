#include "studies/design/question.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "render/base/nearest_name.h"
#include "render/base/units.h"
#include "render/files/text_file.h"
#include "studies/design/solve.h"

namespace gladstone::inline design {
namespace {

constexpr std::size_t most_values = 1000;
using unit::mm;

/// Returns the texts of an array; adds a problem at the key if it contains anything else.
std::vector<std::string> texts(SetupDocument& document, std::string const& table, std::string const& key) {
  std::vector<std::string> found;
  SetupTable owner = document.root().table(table);
  owner.mark_as_read(key);
  SetupNode const* const node = document.find({table, key});
  if (!node) return found;
  bool good = node->kind == SetupNode::Kind::array;
  for (SetupNode const& one : node->elements) {
    good = good && one.kind == SetupNode::Kind::text;
    found.push_back(one.text);
  }
  if (!good) {
    owner.problem(key, "must be an array of strings; write [\"...\", \"...\"]");
    found.clear();
  }
  return found;
}

/// Returns the numbers of a requirement's key; empty if it is not given or invalid.
std::vector<double> read_required(SetupTable table, Bound const& bound) {
  if (bound.component() < 0) {
    auto const value = table.optional_number(bound.key(), Range::positive());
    return value ? std::vector{*value} : std::vector<double>{};
  }
  return table.has(bound.key()) ? table.numbers(bound.key(), {100, 100}, 2, Range::positive()) : std::vector<double>{};
}

Requirements read_requirements(SetupTable root) {
  SetupTable table = root.table("requirements");
  Requirements r;
  std::string const word = table.required_word("objective", {objective_words.begin(), objective_words.end()});
  auto const found = std::find(objective_words.begin(), objective_words.end(), word);
  if (found != objective_words.end()) r.objective = static_cast<Objective>(found - objective_words.begin());
  std::vector<double> numbers;  // numbers of the key that was read last
  for (Bound const& bound : requirements()) {
    if (bound.component() <= 0) numbers = read_required(root.table(bound.table()), bound);
    auto const index = static_cast<std::size_t>(std::max(0, bound.component()));
    if (index < numbers.size()) r.limits.push_back({&bound, numbers[index] * bound.unit});
  }
  return r;
}

/// Values or an interval from [limits], or values from [inventory].
struct Allowed {
  std::vector<double> values;
  std::optional<std::pair<double, double>> interval;
};

Allowed read_limit(SetupTable limits, ChoiceKey const& key) {
  Allowed allowed;
  if (limits.is_table(key.limit)) {
    allowed.values = limits.table(key.limit).number_list("values", {}, 1, most_values, Range::positive());
    if (!limits.table(key.limit).has("values")) limits.problem(key.limit, "has no values; write { values = [..] }");
  } else if (limits.has(key.limit)) {
    auto const ends = limits.numbers(key.limit, {1, 2}, 2, Range::positive());
    if (ends.size() == 2 && ends[0] > ends[1]) {
      limits.problem(
          key.limit,
          fmt::format("is empty (lower limit {:.6g} exceeds upper limit {:.6g}); write the smaller number first",
                      ends[0], ends[1]));
    } else if (ends.size() == 2) {
      allowed.interval = {ends[0], ends[1]};
    }
  }
  return allowed;
}

FreeChoice read_free_choice(Choice choice, SetupTable free, SetupTable const& limits, SetupTable inventory) {
  ChoiceKey const& key = choice_key(choice);
  FreeChoice found{choice, {}, 0, 0};
  Allowed allowed = read_limit(limits, key);
  if (key.inventory && inventory.has(key.inventory)) {
    if (inventory.is_array(key.inventory)) {
      allowed.values = inventory.number_list(key.inventory, {}, 1, most_values, Range::positive());
    } else {
      inventory.problem(key.inventory, "must be an array of numbers");
    }
    if (allowed.interval) {
      std::erase_if(allowed.values, [&allowed](double value) {
        return value < allowed.interval->first || value > allowed.interval->second;
      });
      if (allowed.values.empty()) {
        inventory.problem(key.inventory, std::string("has no value within limits.") + key.limit +
                                             " (no choice remains); widen the limit or add a suitable value");
      }
    }
  } else if (!limits.has(key.limit)) {
    free.problem("keys", fmt::format("\"{}\" has no bounds; add limits.{} = [from, to]{}", key.path, key.limit,
                                     key.inventory ? std::string(" or inventory.") + key.inventory : ""));
  }
  for (double const value : allowed.values) found.values.push_back(value * key.unit);
  if (allowed.interval) {
    found.low = allowed.interval->first * key.unit;
    found.high = allowed.interval->second * key.unit;
  }
  return found;
}

/// Reports prescription files listed among focal lengths; returns true if there are any.
bool refuse_prescriptions(SetupDocument& document, SetupTable limits, SetupTable inventory, ChoiceKey const& key) {
  SetupNode const* const node = document.find({"inventory", key.inventory});
  auto const is_text = [](SetupNode const& one) { return one.kind == SetupNode::Kind::text; };
  if (!node || std::none_of(node->elements.begin(), node->elements.end(), is_text)) return false;
  limits.mark_as_read(key.limit);
  inventory.mark_as_read(key.inventory);
  inventory.problem(key.inventory,
                    "must be numbers (focal lengths of ideal lenses, in mm); list prescription files as "
                    "inventory.lenses = [\"...\"]");
  return true;
}

std::vector<FreeChoice> read_free(SetupDocument& document, SetupTable limits, SetupTable inventory) {
  SetupTable free = document.root().table("free");
  std::vector<std::string> const keys = texts(document, "free", "keys");
  std::vector<std::string> known;
  for (ChoiceKey const& key : choice_keys) known.emplace_back(key.path);
  for (auto key = keys.begin(); key != keys.end(); ++key) {
    if (std::find(keys.begin(), key, *key) != key) {
      free.problem("keys", fmt::format("\"{}\" is listed twice; list it once", *key));
    }
  }
  for (std::string const& key : keys) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    auto const nearest = nearest_name(key, known);
    free.problem("keys", fmt::format("\"{}\" cannot be free{}", key,
                                     nearest ? "; did you mean \"" + *nearest + "\"?"
                                             : "; free may contain " + quoted_list(known)));
  }
  if (keys.empty()) {
    free.problem("keys", "contains no valid key (nothing can be varied); free may contain " + quoted_list(known));
  }
  std::vector<FreeChoice> found;
  for (std::size_t i = 0; i < choice_count; ++i) {
    ChoiceKey const& key = choice_keys[i];
    if (std::find(keys.begin(), keys.end(), key.path) != keys.end()) {
      Choice const choice = static_cast<Choice>(i);
      if (choice == Choice::focal_length && refuse_prescriptions(document, limits, inventory, key)) continue;
      found.push_back(read_free_choice(choice, free, limits, inventory));
      continue;
    }
    limits.refuse(key.limit,
                  std::string("limits a key that is not free; add \"") + key.path + "\" to free.keys, or remove it");
    if (key.inventory) {
      inventory.refuse(key.inventory, std::string("lists values of a key that is not free; add \"") + key.path +
                                          "\" to free.keys, or remove it");
    }
  }
  return found;
}

/// Returns the absolute paths of the files at a key of [inventory].
std::vector<std::string> owned_files(SetupDocument& document, std::string const& key) {
  std::vector<std::string> files;
  for (std::string const& name : texts(document, "inventory", key)) {
    std::string const path =
        std::filesystem::absolute(std::filesystem::path(document.folder()) / name).lexically_normal();
    if (!std::filesystem::exists(path)) {
      document.root().table("inventory").problem(key, "there is no file " + path);
    } else {
      files.push_back(path);
    }
  }
  return files;
}

std::vector<InventoryCamera> read_cameras(SetupDocument& document) {
  std::vector<InventoryCamera> cameras;
  for (std::string const& path : owned_files(document, "cameras")) {
    SetupNode const file = parse_toml(read_text_file(path), path);
    SetupNode const* const table = file.find("camera");
    if (!table || table->kind != SetupNode::Kind::table) {
      document.root().table("inventory").problem("cameras", path + " has no table [camera]; add it");
      continue;
    }
    SetupNode camera = *table;
    set_source(camera, std::make_shared<SetupSource const>(
                           SetupSource{path, std::filesystem::path(path).parent_path().string()}));
    cameras.push_back({path, camera});
  }
  return cameras;
}

/// Reports a z_total_max_mm that contradicts the lower limits of the distances.
void check_total(DesignQuestion const& question, SetupTable limits) {
  Bound const& total = requirement("limits.z_total_max_mm");
  double least = 0;
  for (FreeChoice const& free : question.free) {
    if (free.choice != Choice::z_a && free.choice != Choice::z_d) continue;
    least += free.values.empty() ? free.low : *std::min_element(free.values.begin(), free.values.end());
  }
  for (Limit const& limit : question.requirements.limits) {
    if (limit.bound != &total || least <= limit.value * (1 + allowed_excess)) continue;
    limits.problem("z_total_max_mm", fmt::format("conflicts with the other limits (the sum of z_a_mm and z_d_mm is at "
                                                 "least {:.6g} mm); increase it or reduce those",
                                                 least / mm));
  }
}

}  // namespace

std::optional<DesignQuestion> read_design_question(SetupDocument& document) {
  SetupTable root = document.root();
  SetupTable requirements = root.table("requirements"), limits = root.table("limits");
  SetupTable inventory = root.table("inventory"), free = root.table("free");
  if (!requirements.present()) {
    for (char const* const table : {"limits", "inventory", "free"}) {
      root.refuse(table, "requires [requirements] (there is no design problem without them); add them or remove it");
      root.table(table).suppress_unread_keys();
    }
    return std::nullopt;
  }
  DesignQuestion question;
  question.requirements = read_requirements(root);
  question.free = read_free(document, limits, inventory);
  question.cameras = read_cameras(document);
  question.lenses = owned_files(document, "lenses");
  check_total(question, limits);
  return question;
}

}  // namespace gladstone::inline design
