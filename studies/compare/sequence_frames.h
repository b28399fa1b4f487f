#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "render/files/image_pages.h"

namespace gladstone::inline compare {

/// Selection of the pairs of a sequence.
enum class Pairing {
  pairs,       ///< frame A and frame B of each instant
  reference,   ///< the first image with each of the others (BOS)
  consecutive  ///< each image with the next one
};

/// Returns the pairing of the name "pairs", "reference" or "consecutive"; empty: "pairs".
/// @throws DataError for another name
Pairing parse_pairing(std::string const& name);

/// Image of a sequence: a file, or one of its pages.
struct SequenceFrame {
  std::string path;
  std::size_t page = 0;   ///< index from 0
  std::size_t pages = 1;  ///< pages of the file
  /// located pages of the file, which its frames share; null if the file has not been opened
  std::shared_ptr<ImagePages const> located = nullptr;

  /// Returns "path", or "path (page 3)" for a file of several pages.
  std::string name() const;
};

/// Pair of frames to be correlated.
struct SequencePair {
  SequenceFrame reference;  ///< frame A
  SequenceFrame flow;       ///< frame B
  std::string vectors;      ///< file name of the pair's vectors, e.g. "A_0001.h5"
  std::string problem;      ///< reason why the pair is incomplete, without a partner; empty: complete
};

/// Lists the files of a sequence, in natural order (2 before 10).
/// @param inputs  patterns, folders and files, as on the command line; names of more than two files that follow two
///                patterns, as the shell expands them, are split into two lists if `pairing` is `pairs`
/// @throws DataError if a pattern or folder matches no image, or a list is unsuitable for the pairing
std::vector<std::vector<std::string>> list_sequence_files(std::vector<std::string> const& inputs, Pairing pairing);

/// Forms the pairs of a sequence. Each file contributes all its pages. For Pairing::pairs:
/// - two lists are matched by the numbers in their file names; images without a partner become pairs with a `problem`.
///   Lists of equal length without common numbers are matched in their order.
/// - in one list, images 1 and 2, 3 and 4, ... are pairs.
/// @throws DataError if there are fewer than two images or a file has too many pages, or two lists cannot be matched
std::vector<SequencePair> form_pairs(std::vector<std::vector<std::string>> const& lists, Pairing pairing);

}  // namespace gladstone::inline compare
