#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gladstone::inline compare {

/// File name divided into its numbers and the text around them: "A_{}_{}" and {"12", "3"}, without leading zeros.
struct NumberedName {
  std::string pattern;
  std::vector<std::string> numbers;
};

/// Divides a text into its numbers and the text around them.
NumberedName split_numbers(std::string const& text);
/// Divides the names of files, without folder and ending.
std::vector<NumberedName> split_names(std::vector<std::string> const& files);
/// Returns true if the names follow one pattern.
bool have_one_pattern(std::vector<NumberedName> const& names);

/// Intervals between the numbers of images in their names, by which a missing image is detected.
class FrameIntervals {
 public:
  /// @param files  names of the images in their order; if they do not differ in one increasing number, all intervals
  /// are unknown
  explicit FrameIntervals(std::vector<std::string> const& files);

  /// Returns true if the interval from an image to the following one is longer than the smallest one. Always false if
  /// less than half of the intervals are the smallest one, since the numbers are then not consecutive.
  bool misses_next(std::size_t image) const { return usual_ > 0 && numbers_[image + 1] - numbers_[image] != usual_; }
  /// Returns the number that the image after this one should have.
  long long next(std::size_t image) const { return numbers_[image] + usual_; }

 private:
  std::vector<long long> numbers_;
  long long usual_ = 0;  ///< smallest interval; 0: unknown
};

}  // namespace gladstone::inline compare
