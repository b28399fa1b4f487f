#include "studies/compare/sequence_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/file_pattern.h"
#include "studies/compare/frame_numbers.h"

namespace gladstone::inline compare {
namespace {

namespace fs = std::filesystem;

/// Map whose keys are in natural order (2 before 10).
template <class Value>
using NaturalMap = std::map<std::string, Value, decltype(&is_naturally_before)>;

/// Returns true if the name has the ending of an image file.
bool has_image_ending(fs::path const& path) {
  static constexpr std::array endings{".tif", ".tiff", ".png", ".bmp", ".jpg", ".jpeg", ".pgm", ".exr", ".jp2"};
  return std::find(endings.begin(), endings.end(), lower_case(path.extension().string())) != endings.end();
}

/// Lists the images in a folder, in any order.
std::vector<std::string> list_folder(std::string const& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && has_image_ending(entry->path()) &&
        !entry->path().filename().string().starts_with('.'))
      files.push_back(entry->path().string());
  }
  if (error)
    throw DataError(ErrorCode::unreadable_file, folder,
                    "cannot be listed (" + error.message() + "); check its permissions");
  if (files.empty())
    throw DataError(ErrorCode::missing_file, folder,
                    "contains no image (.tif, .png, .jpg, ...); name another folder, or give a pattern such as '" +
                        folder + "/*.dat'");
  return files;
}

/// Splits files whose names follow exactly two patterns, such as A_{}.tif and B_{}.tif, into two lists in the order of
/// their first files; other lists are returned whole.
std::vector<std::vector<std::string>> split_by_name(std::vector<std::string> const& files) {
  std::vector<std::string> patterns;
  std::vector<std::vector<std::string>> lists;
  for (std::string const& file : files) {
    std::string const pattern = split_numbers(fs::path(file).filename().string()).pattern;
    auto const known = std::find(patterns.begin(), patterns.end(), pattern);
    std::size_t const list = static_cast<std::size_t>(known - patterns.begin());
    if (known == patterns.end()) {
      if (patterns.size() == 2) return {files};
      patterns.push_back(pattern);
      lists.emplace_back();
    }
    lists[list].push_back(file);
  }
  return lists;
}

/// Returns for each name those of its numbers that differ within one of the two lists: the number of the instant,
/// without that of a camera. nullopt if the names do not determine the instant.
std::optional<std::vector<std::string>> find_instants(std::vector<NumberedName> const& names,
                                                      std::vector<NumberedName> const& others) {
  std::size_t const count = names.front().numbers.size();
  if (!have_one_pattern(names) || !have_one_pattern(others) || others.front().numbers.size() != count)
    return std::nullopt;
  auto const varies = [](std::vector<NumberedName> const& list, std::size_t k) {
    return std::any_of(list.begin(), list.end(),
                       [&](NumberedName const& name) { return name.numbers[k] != list.front().numbers[k]; });
  };
  std::vector<std::string> instants(names.size());
  for (std::size_t k = 0; k < count; ++k) {
    if (!varies(names, k) && !varies(others, k)) continue;
    for (std::size_t i = 0; i < names.size(); ++i) instants[i] += names[i].numbers[k] + '/';
  }
  std::set<std::string> const distinct(instants.begin(), instants.end());
  if (distinct.size() != instants.size()) return std::nullopt;
  return instants;
}

/// Returns all pages of the files. An unreadable file counts as one page, so that its pair reports the reason.
/// @throws DataError if a file has too many pages, or if the only file is unreadable
std::vector<SequenceFrame> list_frames(std::vector<std::string> const& files) {
  std::vector<SequenceFrame> frames;
  for (std::string const& file : files) {
    std::shared_ptr<ImagePages const> located;
    try {
      located = std::make_shared<ImagePages>(file);
    } catch (DataError const& error) {
      if (error.code() == ErrorCode::out_of_range || files.size() == 1) throw;
    }
    std::size_t const pages = located ? located->count() : 1;
    for (std::size_t page = 0; page < pages; ++page) frames.push_back({file, page, pages, located});
  }
  return frames;
}

constexpr char const* no_partner = "has no partner";

/// Matches two lists by the numbers in their names, or in their order.
std::vector<SequencePair> match_lists(std::vector<std::string> const& a, std::vector<std::string> const& b) {
  std::vector<NumberedName> const names_a = split_names(a), names_b = split_names(b);
  auto const keys_a = find_instants(names_a, names_b), keys_b = find_instants(names_b, names_a);
  NaturalMap<std::string> partners(is_naturally_before);
  if (keys_a && keys_b)
    for (std::size_t k = 0; k < b.size(); ++k) partners[(*keys_b)[k]] = b[k];
  bool const by_number =
      a.size() + b.size() > 2 && keys_a &&
      std::any_of(keys_a->begin(), keys_a->end(), [&](std::string const& key) { return partners.contains(key); });
  std::vector<SequencePair> pairs;
  if (by_number) {
    NaturalMap<SequencePair> matched(is_naturally_before);
    for (std::size_t k = 0; k < a.size(); ++k) {
      SequencePair& pair = matched[(*keys_a)[k]];
      pair.reference.path = a[k];
      pair.problem = fmt::format("{}: {} (no second image has its number); add it", a[k], no_partner);
    }
    for (auto const& [key, file] : partners) {
      SequencePair& pair = matched[key];
      pair.problem = pair.reference.path.empty()
                         ? fmt::format("{}: {} (no first image has its number); add it", file, no_partner)
                         : "";
      pair.flow.path = file;
    }
    for (auto& [key, pair] : matched) pairs.push_back(std::move(pair));
    return pairs;
  }
  std::vector<SequenceFrame> const first = list_frames(a), second = list_frames(b);
  if (first.size() != second.size())
    throw DataError(ErrorCode::inconsistent, a.front(),
                    fmt::format("the first list has {} images and the second {} (their numbers differ, so "
                                "that they are matched in their order); give equally many",
                                first.size(), second.size()));
  for (std::size_t k = 0; k < first.size(); ++k) pairs.push_back({first[k], second[k], {}, {}});
  return pairs;
}

/// Returns an incomplete pair, of an image whose partner is missing.
SequencePair without_partner(SequenceFrame const& frame, std::string const& why) {
  return {frame, {}, {}, fmt::format("{}: {} ({})", frame.name(), no_partner, why)};
}

/// Pairs image 1 with 2, 3 with 4, and so on. An image before a gap in the numbers has no partner.
std::vector<SequencePair> pair_by_twos(std::vector<SequenceFrame> const& frames, FrameIntervals const& intervals) {
  std::vector<SequencePair> pairs;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (k + 1 == frames.size()) {
      pairs.push_back(without_partner(frames[k], "the number of images is odd"));
    } else if (intervals.misses_next(k)) {
      pairs.push_back(without_partner(frames[k], fmt::format("no image has the number {}", intervals.next(k))));
    } else {
      pairs.push_back({frames[k], frames[k + 1], {}, {}});
      ++k;
    }
  }
  return pairs;
}

/// Pairs every image with the next one. A pair across a gap in the numbers has a `problem`.
std::vector<SequencePair> pair_consecutive(std::vector<SequenceFrame> const& frames, FrameIntervals const& intervals) {
  std::vector<SequencePair> pairs;
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
    SequencePair& pair = pairs.emplace_back(SequencePair{frames[k], frames[k + 1], {}, {}});
    if (intervals.misses_next(k))
      pair.problem = fmt::format("{}: the next image is missing (no image has the number {}); add it", frames[k].name(),
                                 intervals.next(k));
  }
  return pairs;
}

/// Gives every pair a distinct file name, from its frame A, or with one reference from its frame B.
void name_vectors(std::vector<SequencePair>& pairs, Pairing pairing) {
  std::map<std::string, int> uses{{"statistics", 1}};
  for (SequencePair& pair : pairs) {
    SequenceFrame const& frame =
        pairing == Pairing::reference || pair.reference.path.empty() ? pair.flow : pair.reference;
    pair.vectors = fs::path(frame.path).stem().string();
    if (frame.pages > 1) pair.vectors += fmt::format("_p{:04}", frame.page + 1);
    ++uses[pair.vectors];
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    std::string& name = pairs[k].vectors;
    if (uses[name] > 1) name = fmt::format("pair{:05}_{}", k + 1, name);
    name += ".h5";
  }
}

}  // namespace

std::string SequenceFrame::name() const { return pages > 1 ? fmt::format("{} (page {})", path, page + 1) : path; }

Pairing parse_pairing(std::string const& name) {
  if (name.empty() || name == "pairs") return Pairing::pairs;
  if (name == "reference") return Pairing::reference;
  if (name == "consecutive") return Pairing::consecutive;
  throw DataError(ErrorCode::arguments, "--pairing",
                  "\"" + name + "\" is not a pairing; choose \"pairs\", \"reference\" or \"consecutive\"");
}

std::vector<std::vector<std::string>> list_sequence_files(std::vector<std::string> const& inputs, Pairing pairing) {
  std::vector<std::vector<std::string>> lists;
  bool names_only = true;
  for (std::string const& input : inputs) {
    std::error_code error;
    if (is_pattern(input)) {
      lists.push_back(expand_pattern(input));
      names_only = false;
    } else if (fs::is_directory(input, error)) {
      lists.push_back(list_folder(input));
      names_only = false;
    } else {
      lists.push_back({input});
    }
  }
  if (names_only && inputs.size() > 2) lists = {inputs};
  bool const keeps_first = pairing == Pairing::reference && names_only;
  for (std::vector<std::string>& list : lists) {
    if (list.size() > 1) std::sort(list.begin() + (keeps_first ? 1 : 0), list.end(), is_naturally_before);
  }
  if (pairing == Pairing::pairs && lists.size() == 1) lists = split_by_name(lists.front());
  if (pairing == Pairing::pairs && lists.size() > 2)
    throw DataError(ErrorCode::arguments, "images",
                    fmt::format("got {} lists of images (pairs have a first and a second image); give two "
                                "patterns, or one folder or file with all images",
                                lists.size()));
  return lists;
}

std::vector<SequencePair> form_pairs(std::vector<std::vector<std::string>> const& lists, Pairing pairing) {
  std::vector<SequencePair> pairs;
  if (pairing == Pairing::pairs && lists.size() == 2) {
    pairs = match_lists(lists[0], lists[1]);
    name_vectors(pairs, pairing);
    return pairs;
  }
  std::vector<std::string> files;
  for (std::vector<std::string> const& list : lists) files.insert(files.end(), list.begin(), list.end());
  if (files.empty())
    throw DataError(ErrorCode::arguments, "images",
                    "no image is given; give a pattern, a folder, or a file of several pages");
  std::vector<SequenceFrame> const frames = list_frames(files);
  if (frames.size() < 2)
    throw DataError(ErrorCode::arguments, files.front(),
                    "is a single image (a sequence has at least two); give a pattern, a folder, or a file of several "
                    "pages");
  bool const one_each = frames.size() == files.size();  // no file of several pages
  FrameIntervals const intervals(one_each ? files : std::vector<std::string>{});
  switch (pairing) {
    case Pairing::pairs:
      pairs = pair_by_twos(frames, intervals);
      break;
    case Pairing::reference:
      for (std::size_t k = 1; k < frames.size(); ++k) pairs.push_back({frames[0], frames[k], {}, {}});
      break;
    case Pairing::consecutive:
      pairs = pair_consecutive(frames, intervals);
      break;
  }
  name_vectors(pairs, pairing);
  return pairs;
}

}  // namespace gladstone::inline compare
