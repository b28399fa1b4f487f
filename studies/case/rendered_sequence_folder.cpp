#include "studies/case/rendered_sequence_folder.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "render/base/error.h"
#include "render/files/input_guard.h"
#include "render/files/output_destination.h"
#include "render/files/output_file.h"
#include "render/files/text_file.h"
#include "render/files/visible_files.h"

namespace gladstone::inline cases {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t longest_summary = 1 << 30;  // size limit of a summary.json that is read [bytes]

}  // namespace

std::string rendered_sequence_file::frame(std::size_t number) { return fmt::format("frame_{:04}.tif", number); }
std::string rendered_sequence_file::pair(std::size_t number) { return fmt::format("pair_{:04}", number); }

void give_second_name(fs::path const& file, fs::path const& name) {
  OutputDestination const place(name.string());
  fs::path const temporary = name.parent_path() / ('.' + name.filename().string() + ".partial");
  std::error_code error;
  fs::remove(temporary, error);
  fs::create_hard_link(file, temporary, error);
  if (error) fs::copy_file(file, temporary, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(temporary, name, error);
  if (error) place.fail("cannot be written", error.value());
  fs::remove(temporary, error);  // rename() keeps it if both names are of one file
}

void prepare_sequence_folder(fs::path const& folder, std::string const& setup) {
  fs::path const file = folder / rendered_sequence_file::setup;
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw OutputError(folder.string(), "is a file (a sequence is a folder of pairs); name a folder");
  if (fs::exists(file, error)) {
    UnrecordedReading const to_be_retained;
    if (read_text_file(file.string(), "the setup of a sequence", longest_summary) == setup) return;
    throw OutputError(folder.string(),
                      "contains the sequence of another setup (its sequence.toml differs); name another folder, or "
                      "delete this one");
  }
  if (contains_visible_files(folder))
    throw OutputError(folder.string(), "contains other files (it has no sequence.toml); name a new folder");
  fs::create_directories(folder, error);
  if (error) OutputDestination(folder.string()).fail("cannot be created", error.value());
  OutputFile::write_text(file.string(), setup);
}

std::map<std::size_t, Json> read_finished_pairs(fs::path const& folder) {
  fs::path const file = folder / rendered_sequence_file::summary;
  std::map<std::size_t, Json> pairs;
  std::error_code error;
  if (!fs::exists(file, error)) return pairs;
  UnrecordedReading const to_be_replaced;
  try {
    Json const json = Json::parse(read_text_file(file.string(), "a summary", longest_summary));
    for (Json const& pair : json.at("pairs")) pairs[pair.at("pair").get<std::size_t>()] = pair;
  } catch (nlohmann::json::exception const&) {
    pairs.clear();
  } catch (DataError const&) {
    pairs.clear();
  }
  return pairs;
}

}  // namespace gladstone::inline cases
