#include "studies/case/cameras.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "render/base/nearest_name.h"
#include "render/base/random.h"
#include "render/setup/setup_node.h"
#include "render/setup/toml_text.h"
#include "studies/case/case.h"
#include "studies/case/case_kind.h"

namespace gladstone::inline cases {
namespace {

using Kind = SetupNode::Kind;

/// Returns the array of cameras of a setup with several cameras; null for a setup with one camera.
SetupNode const* several_cameras(SetupDocument const& setup) {
  SetupNode const* const cameras = setup.find({"camera"});
  if (!cameras || cameras->kind != Kind::array || cameras->elements.size() < 2) return nullptr;
  bool const tables = std::all_of(cameras->elements.begin(), cameras->elements.end(),
                                  [](SetupNode const& camera) { return camera.kind == Kind::table; });
  return tables ? cameras : nullptr;  // the readers report the error
}

/// Removes a key from a table.
/// @return its value; nullopt if the key does not exist
std::optional<SetupNode> take(SetupNode& table, std::string const& key) {
  auto const found = std::find_if(table.members.begin(), table.members.end(),
                                  [&key](SetupMember const& member) { return member.key == key; });
  if (found == table.members.end()) return std::nullopt;
  SetupNode taken = std::move(found->value);
  table.members.erase(found);
  return taken;
}

/// Tables of optical elements with the key `cameras`.
constexpr char const* element_keys[] = {"window", "element"};

/// Retains only the optical elements that a camera looks through, and removes their key `cameras`.
/// @param key    name of their table
/// @param names  names of all cameras
void keep_own_elements(SetupDocument& document, std::string const& key, std::string const& camera,
                       std::vector<std::string> const& names) {
  SetupNode const* const all = document.find({key});
  if (!all || (all->kind != Kind::array && all->kind != Kind::table)) return;
  std::vector<SetupNode> elements = all->kind == Kind::array ? all->elements : std::vector{*all};
  // used to locate errors; querying `document` itself would add keys to its resolved text
  SetupDocument places = document.copy();
  SetupNode kept = *all;
  kept.kind = Kind::array;
  kept.members.clear();
  kept.elements.clear();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    std::optional<SetupNode> const seen_by = take(elements[i], "cameras");
    bool seen = !seen_by || (seen_by->kind == Kind::array && seen_by->elements.empty());
    auto const problem = [&](std::string const& message) {
      std::vector<SetupTable> tables = places.root().tables(key);
      document.add_problem(
          i < tables.size() ? tables[i].where("cameras") : key,
          std::string(key).append("[").append(std::to_string(i)).append("].cameras: ").append(message));
    };
    if (seen_by && seen_by->kind != Kind::array) {
      problem("must be an array of camera names; write [\"left\", \"right\"]");
    } else if (seen_by) {
      for (SetupNode const& name : seen_by->elements) {
        seen = seen || (name.kind == Kind::text && name.text == camera);
        if (name.kind == Kind::text && std::find(names.begin(), names.end(), name.text) != names.end()) continue;
        problem(toml_text(name) + " is not the name of a camera; " +
                (names.empty() ? "give camera.name" : "cameras are " + quoted_list(names)));
      }
    }
    if (seen) kept.elements.push_back(elements[i]);
  }
  document.set({key}, kept);
}

/// Retains one camera of a setup, with its own lens and optical elements.
void keep_camera(SetupDocument& document, SetupNode camera, std::vector<std::string> const& names) {
  SetupNode const* const name = camera.find("name");
  std::string const own = name && name->kind == Kind::text ? name->text : "";
  if (std::optional<SetupNode> const lens = take(camera, "lens")) document.set({"lens"}, *lens);
  document.set({"camera"}, camera);
  for (char const* key : element_keys) keep_own_elements(document, key, own, names);
}

void check_name(SetupTable camera, std::string const& name, std::set<std::string>& others) {
  if (name.empty()) {
    camera.problem("name", "is missing (it names the folder of the camera); give each of several cameras a name",
                   ErrorCode::missing_key);
    return;
  }
  bool const plain = std::all_of(name.begin(), name.end(),
                                 [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
  if (!plain) camera.problem("name", "is not valid as the name of a folder; use letters, digits, _ and -");
  if (!others.insert(name).second)
    camera.problem("name", "is also the name of another camera; give each a different name");
}

/// Gives camera `index` a noise seed that makes its noise independent of the other cameras' noise.
void give_own_noise(SetupDocument& document, std::size_t index) {
  SetupNode const* const noise = document.find({"camera", "noise"});
  if (!noise || noise->kind != Kind::table || index == 0) return;
  SetupNode const* const seed = noise->find("seed");
  if (seed && (seed->kind != Kind::integer || seed->integer < 0)) return;  // the reader reports the error
  std::uint64_t const given = seed ? static_cast<std::uint64_t>(seed->integer) : 1;
  SetupNode own = setup_integer(static_cast<long long>(repeat_seed(given, index) >> 1));
  if (seed) own.place = seed->place;
  document.set({"camera", "noise", "seed"}, own);
}

/// Removes the camera distances of [geometry], which apply only to cameras without a pose.
void leave_place_to_others(SetupDocument& document) {
  for (char const* const key : {"z_a_mm", "z_front_mm", "z_sensor_mm"}) document.remove({"geometry", key});
}

/// Splits a setup into one setup per camera. A setup with one camera is returned unchanged, without a name.
std::vector<std::pair<std::string, SetupDocument>> split_cameras(SetupDocument const& setup) {
  std::vector<std::pair<std::string, SetupDocument>> split;
  SetupNode const* const cameras = several_cameras(setup);
  if (!cameras) {
    split.emplace_back("", setup.copy());
    return split;
  }
  std::vector<SetupNode> const& all = cameras->elements;
  std::vector<std::string> const names = camera_names(setup);
  auto const has = [&all](char const* table) {
    return std::count_if(all.begin(), all.end(), [&](SetupNode const& camera) { return camera.find(table); });
  };
  auto const count = static_cast<std::ptrdiff_t>(all.size()), posed = has("pose");
  bool const lens_unused = has("lens") == count && setup.find({"lens"});
  std::set<std::string> others;
  for (std::size_t i = 0; i < all.size(); ++i) {
    SetupDocument document = setup.copy();
    if (lens_unused) {
      document.root().problem("lens", "is not used (each camera has its own lens); remove it");
    }
    keep_camera(document, all[i], names);
    check_name(document.root().table("camera"), names[i], others);
    give_own_noise(document, i);
    if (posed < count && all[i].find("pose")) leave_place_to_others(document);
    split.emplace_back(names[i], std::move(document));
  }
  return split;
}

/// Calls a function with the name and the setup of each camera.
/// @throws SetupError with the problems of all cameras
template <class Function>
void for_each_camera(SetupDocument const& setup, Function const& call) {
  std::vector<SetupProblem> problems;
  std::size_t more = 0;
  for (auto& [name, document] : split_cameras(setup)) {
    try {
      call(name, std::move(document));
    } catch (SetupError const& error) {
      for (SetupProblem const& problem : error.problems()) {
        bool const told = std::any_of(problems.begin(), problems.end(), [&problem](SetupProblem const& other) {
          return other.where == problem.where && other.message == problem.message;
        });
        if (!told) problems.push_back(problem);
      }
      more = std::max(more, error.more());
    }
  }
  if (!problems.empty()) throw SetupError(problems, more);
}

}  // namespace

std::vector<std::string> camera_names(SetupDocument const& setup) {
  std::vector<std::string> names;
  SetupNode const* const cameras = several_cameras(setup);
  if (!cameras) return names;
  for (SetupNode const& camera : cameras->elements) {
    SetupNode const* const name = camera.find("name");
    names.push_back(name && name->kind == Kind::text ? name->text : "");
  }
  return names;
}

SetupDocument with_own_lens(SetupDocument setup) {
  SetupNode const* node = setup.find({"camera"});
  if (several_cameras(setup)) return setup;
  if (node && node->kind == Kind::array && node->elements.size() == 1) node = &node->elements.front();
  SetupNode const camera = node ? *node : SetupNode{};
  bool const chosen = std::any_of(std::begin(element_keys), std::end(element_keys), [&setup](char const* key) {
    SetupNode const* const found = setup.find({key});
    return found && (found->find("cameras") || std::any_of(found->elements.begin(), found->elements.end(),
                                                           [](SetupNode const& one) { return one.find("cameras"); }));
  });
  if (camera.kind != Kind::table || (!camera.find("lens") && !chosen)) return setup;
  if (camera.find("lens") && setup.find({"lens"})) {
    setup.root().problem("lens", "conflicts with the camera's own lens (camera.lens); remove one of them");
  }
  SetupNode const* const name = camera.find("name");
  keep_camera(setup, camera, name && name->kind == Kind::text ? std::vector{name->text} : std::vector<std::string>{});
  return setup;
}

std::vector<CameraCase> load_cameras(SetupDocument const& setup) {
  std::vector<CameraCase> cameras;
  for_each_camera(setup, [&cameras](std::string const& name, SetupDocument document) {
    cameras.push_back({name, load_case_setup(std::move(document))});
  });
  if (cameras.size() < 2) return cameras;
  case_kind(cameras.front().loaded.setup).share_sources(cameras);
  for (CameraCase& one : cameras) check_case_setup(one.loaded);
  return cameras;
}

void check_camera_keys(SetupDocument const& setup) {
  for_each_camera(setup,
                  [](std::string const& /*name*/, SetupDocument document) { check_setup_keys(std::move(document)); });
}

std::string written_setup(SetupDocument document, std::vector<CameraCase> const& cameras) {
  SetupNode const* const all = document.find({"camera"});
  std::vector<std::vector<std::string>> keys;
  if (SetupNode const* const files = document.find({"sequence", "files"})) {
    for (std::size_t i = 0; i < files->elements.size(); ++i) {
      keys.push_back({"sequence", "files", '[' + std::to_string(i) + ']'});
    }
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    bool const own_lens = cameras.size() > 1 && all->elements[i].find("lens") != nullptr;
    for (std::vector<std::string> key : cameras[i].loaded.document.file_keys()) {
      if (own_lens && key.front() == "lens") key.insert(key.begin(), {"camera", '[' + std::to_string(i) + ']'});
      keys.push_back(std::move(key));
    }
  }
  document.name_files(keys);
  return document.written();
}

}  // namespace gladstone::inline cases
