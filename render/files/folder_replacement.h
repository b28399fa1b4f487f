#pragma once

#include <string>
#include <vector>

#include "render/files/partial.h"

namespace gladstone::inline files {

/// Files of an output directory that belong together and are replaced together.
struct FolderContent {
  std::string marker;  ///< marker file: removed first, written last; a directory without it is incomplete
  /// Names of derived files, which become invalid when new files are written to the same subdirectory and are then
  /// removed; one * in a name matches any characters.
  std::vector<std::string> derived;
};

/// Returns true if a file name matches one of the derived names.
bool is_derived(std::string const& name, FolderContent const& content);

/// Subdirectory of a partial directory that contains the new files.
inline constexpr char const* staged_files = "new";

/// Moves the files of PARTIAL/new into an existing directory, which retains its identity, owner, permissions and other
/// files. Readers never see a mixture of old and new files as complete; after a kill at any moment, the directory has
/// the old files, or complete_replacement() completes the new ones.
/// 1. PARTIAL is renamed to FOLDER/.replacing. From here on, the new files are the valid content: any other process
///    that finds .replacing waits, completes it or reports an error, so that two writers are serialised.
/// 2. The marker, then every other file to be replaced and every derived file, moves to .replacing/old, which is then
///    renamed to .replacing/retired.
/// 3. The new files move to their final places, the marker last.
/// 4. .replacing gets its former name again and is removed.
/// If a move fails (a mounted file, a file of another user), all moves are undone.
/// @param partial  partial directory on the same disk as `folder`
/// @param asked    directory as the user named it, for messages
/// @throws OutputError with the old files restored
void replace_files(Partial& partial, std::string const& folder, std::string const& asked, FolderContent const& content);

/// Completes an interrupted replacement of files. If the writing process is still running, waits up to five seconds for
/// it.
/// @throws OutputError if it is still running then, if its writer is on another host and cannot be checked, or if a
///         file cannot be moved
void complete_replacement(std::string const& folder, FolderContent const& content);

/// Calls complete_replacement() for the parent directory if that is replaced as a whole, with `folder` as one of its
/// parts.
/// @param content  files of the parent directory
void complete_parent_replacement(std::string const& folder, FolderContent const& content);

/// Returns true if a directory has its marker file, after complete_replacement().
/// @throws OutputError as complete_replacement()
bool is_complete(std::string const& folder, FolderContent const& content);

/// Returns true if a directory entry's name is that of a running replacement or of a partial directory for one.
bool belongs_to_replacement(std::string const& name);

}  // namespace gladstone::inline files
