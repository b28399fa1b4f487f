#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace gladstone::inline cases {

/// File and folder names in the output folder of a rendered sequence.
namespace rendered_sequence_file {
inline constexpr char const* setup = "sequence.toml";
inline constexpr char const* summary = "summary.json";
inline constexpr char const* frames = "frames";
/// Returns the name of a frame's image: "frame_0012.tif".
std::string frame(std::size_t number);
/// Returns the name of a pair's CASE folder: "pair_0012".
std::string pair(std::size_t number);
}  // namespace rendered_sequence_file

/// Creates the output folder of a sequence and writes its setup, unless an earlier run of the same setup did.
/// @param setup  setup as written
/// @throws OutputError if the folder contains other files or the sequence of another setup, or cannot be written
void prepare_sequence_folder(std::filesystem::path const& folder, std::string const& setup);

/// Returns the pairs of an earlier run from summary.json, by number; none if it is missing or damaged.
std::map<std::size_t, nlohmann::ordered_json> read_finished_pairs(std::filesystem::path const& folder);

/// Gives a file a second name, atomically: as a hard link, or as a copy where the file system has none.
/// @throws OutputError
void give_second_name(std::filesystem::path const& file, std::filesystem::path const& name);

}  // namespace gladstone::inline cases
