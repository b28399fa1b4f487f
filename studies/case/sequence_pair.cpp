#include "studies/case/sequence_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "render/base/error.h"
#include "render/files/file_pattern.h"
#include "render/scene/experiment.h"
#include "render/setup/setup_node.h"

namespace gladstone::inline cases {
namespace {

/// Value of medium.field.file if the file of the pair cannot be determined: it exists, so that the problem of
/// [sequence] is not followed by another one.
constexpr char const* stand_in = "/";

/// Returns the index of the selected pair, from 0; nullopt if the key `pair` is invalid, which its reader reports.
std::optional<std::size_t> selected_pair(SetupNode const& sequence, std::size_t first) {
  SetupNode const* const pair = sequence.find("pair");
  if (!pair) return 0;
  if (pair->kind != SetupNode::Kind::integer || pair->integer < static_cast<long long>(first)) return std::nullopt;
  return static_cast<std::size_t>(pair->integer) - first;
}

/// Returns true if the medium is the field of a file. The other cases are reported by the check of the setup.
bool has_field_of_file(SetupDocument const& setup) {
  SetupNode const* const kind = setup.find({"medium", "field", "kind"});
  return kind && kind->kind == SetupNode::Kind::text && kind->text == "file";
}

/// Returns the density file of the selected pair; nullopt, with a problem of the setup, if it cannot be determined.
std::optional<std::string> selected_field(SetupDocument& setup, std::size_t first) {
  bool const had_problems = setup.has_problems();
  std::vector<std::string> const files = sequence_fields(setup);
  if (!had_problems && setup.has_problems()) return std::nullopt;
  std::optional<std::size_t> const pair = selected_pair(*setup.find({"sequence"}), first);
  if (!pair || files.empty()) return std::nullopt;
  if (*pair < files.size()) return files[*pair];
  setup.root()
      .table("sequence")
      .problem("pair",
               fmt::format("exceeds the number of sequence.files, {} (pairs are counted from 1); choose a smaller one, "
                           "or add files",
                           files.size()));
  return std::nullopt;
}

}  // namespace

bool describes_sequence(SetupDocument const& setup) {
  return setup.find({"sequence"}) && !setup.find({"sequence", "pair"});
}

std::vector<std::string> sequence_fields(SetupDocument& setup) {
  SetupNode const* const given = setup.find({"sequence", "files"});
  if (!given || given->kind != SetupNode::Kind::array) return {};
  SetupDocument copy = setup.copy();  // reading records the key, which the setup of a pair does not have
  std::vector<std::string> files;
  auto const refuse = [&](ErrorCode code, std::string const& problem) {
    setup.root().table("sequence").problem("files", problem, code);
  };
  for (std::string const& name : copy.root().table("sequence").path_list("files")) {
    if (is_pattern(name)) {
      try {
        std::vector<std::string> matches = expand_pattern(name);
        std::sort(matches.begin(), matches.end(), is_naturally_before);
        files.insert(files.end(), matches.begin(), matches.end());
      } catch (DataError const& error) {
        refuse(error.code(), error.what());
      }
    } else if (std::error_code error; !std::filesystem::exists(name, error)) {
      refuse(ErrorCode::missing_file,
             "file not found: " + name + "; relative names are resolved against the setup file's folder");
    } else {
      files.push_back(name);
    }
  }
  return files;
}

void select_pair(SetupDocument& setup) {
  SetupNode const* const given = setup.find({"sequence", "files"});
  Experiment const& experiment = find_experiment(setup);
  if (!given || !experiment.measures_density || !has_field_of_file(setup)) return;
  if (SetupNode const* const file = setup.find({"medium", "field", "file"})) {
    if (file->text == stand_in) return;  // an earlier call has reported the problem
    setup.root()
        .table("sequence")
        .problem("files", "conflicts with medium.field.file (both name the density files); remove medium.field.file");
    return;
  }
  std::optional<std::string> const selected = selected_field(setup, experiment.first_pair());
  SetupNode file = setup_text(selected.value_or(stand_in));
  file.place = given->place;
  setup.set({"medium", "field", "file"}, file);
  if (!selected) return;
  SetupNode sequence = *setup.find({"sequence"});
  std::erase_if(sequence.members, [](SetupMember const& member) { return member.key == "files"; });
  if (!sequence.find("pair"))
    sequence.members.push_back({"pair", setup_integer(static_cast<long long>(experiment.first_pair()))});
  setup.set({"sequence"}, sequence);
}

}  // namespace gladstone::inline cases
