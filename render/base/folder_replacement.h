#pragma once

#include <string>
#include <vector>

#include "render/base/partial.h"

namespace gladstone {

/// Which files of a folder belong together.
struct FolderContent {
  std::string marker;  ///< without it the folder is incomplete: it goes first and comes last
  /// Names of files that make no sense beside new ones, in every folder of it that gets some; one * in a name stands
  /// for any characters.
  std::vector<std::string> derived;
};

/// Whether a file of this name is derived.
bool is_derived(std::string const& name, FolderContent const& content);

/// Inside a partial folder: where the new files are put.
inline constexpr char const* staged_files = "new";

/// Puts the files that stand in PARTIAL/new into a folder that stays itself, with its rights, its owner and all else
/// that it holds, so that no reader takes a mixture for a case and a run that is killed at any moment leaves the old
/// files, or new ones that finish_replacement() completes:
///   1. PARTIAL becomes FOLDER/.replacing, in one rename: from here on the new files are what the folder is to hold.
///   Who
///      finds .replacing waits, completes it, or refuses; two writers come one after the other.
///   2. The marker, then every other file that is replaced or derived, moves to .replacing/old; when all have, old
///      becomes retired.
///   3. The new files move to their places, the marker last.
///   4. .replacing gets its old name again and is cleared away.
/// Where a move fails (a file that is mounted, or another user's) all go back.
/// @param partial of a folder on the folder's disk @param asked the folder, for messages
/// @throws OutputError with the old files in their places
void replace_files(Partial& partial, std::string const& folder, std::string const& asked, FolderContent const& content);

/// Completes a replacement that was broken off; waits, up to five seconds, for one that goes on.
/// @throws OutputError where it goes on still, its writer cannot be asked (another host), or a file cannot be moved
void finish_replacement(std::string const& folder, FolderContent const& content);

/// The same where the folder is a part of the one above it, which is being replaced as a whole.
/// @param content of the folder above
void finish_replacement_above(std::string const& folder, FolderContent const& content);

/// Whether a folder has its marker; waits for a replacement that goes on, and completes one that was broken off.
/// @throws OutputError as finish_replacement
bool is_complete(std::string const& folder, FolderContent const& content);

/// Whether a name in a folder is that of a replacement or of a partial folder for one.
bool belongs_to_replacement(std::string const& name);

}  // namespace gladstone
