#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/optics/prescription.h"

namespace gladstone::inline optics {

/// Line of a prescription file, split into words.
struct PrescriptionLine {
  std::string where;  ///< file:line
  std::vector<std::string> words;

  std::size_t size() const { return words.size(); }
  std::string const& operator[](std::size_t i) const { return words[i]; }
  /// Returns word i as a finite number. @throws DataError if it is missing or invalid
  double number(std::size_t i) const;
  /// Like number(), but also accepts INF or INFINITY in any case and with either sign.
  double number_or_infinity(std::size_t i) const;
  /// Returns word i as a number; nullopt if it is missing or not a finite number.
  std::optional<double> optional_number(std::size_t i) const;
  /// Returns word i as an integer. @throws DataError if it is missing or invalid
  int integer(std::size_t i) const;
  /// Returns true if any word after the first is a number other than 0; words that are not numbers are ignored.
  bool has_nonzero_number() const;
};

/// Describes the fault of a wavelength outside 100 nm to 20 um, and suggests the value in the right unit if a power of
/// 1000 brings the wavelength into this range.
/// @param unit       unit of the value [m]
/// @param unit_name  name of the unit in the text
/// @return           empty if the wavelength is in the range
std::string describe_wavelength_fault(double value, double unit, std::string_view unit_name);

/// Wavelength as a file lists it.
struct ListedWavelength {
  double value = 0;   ///< wavelength in the unit of the file
  std::string where;  ///< file:line
};

/// Sets the primary wavelength of a prescription, or warns that the file gives none. Other wavelengths are not checked,
/// since design programs also write unused ones.
/// @param primary    null or a value of 0: the file gives none
/// @param unit       unit of the value [m]
/// @param unit_name  name of the unit in messages
/// @param where      place for the warning if `primary` is null
/// @param commands   commands that would give it, for the warning
/// @throws DataError for a wavelength outside 100 nm to 20 um
void set_primary_wavelength(Prescription& lens, ListedWavelength const* primary, double unit,
                            std::string_view unit_name, std::string const& where, char const* commands);

/// Replaces the decimal commas of numbers ("1,5168") by points, in all words but the first.
/// @return the first number with a comma, as it was; empty: there is none
std::string replace_decimal_commas(std::vector<std::string>& words);

/// Returns true if a number can be the index of a medium relative to air. The lower limit is slightly below the index
/// of vacuum, which is 0.99973 at 587.6 nm and 0.99967 at 190 nm; the upper limit is 5.
bool is_index_relative_to_air(double n);

/// Converts a text to upper case (ASCII).
std::string upper_case(std::string text);

/// Parses a numeric glass code: MIL-G-174's six digits (517642: nd 1.517, Vd 64.2), the same with more digits
/// (516800641667), digits separated by a point (517.642, 516800.641667), or both values separated by a colon
/// (1.5168:64.17). A Vd of 0 or an nd up to 1 denotes an index without dispersion.
/// @return nullopt for other words
std::optional<PrescribedMedium> read_glass_code(std::string_view word);

/// Splits a line at blanks. Text in single or double quotes is one word, without the quotes.
std::vector<std::string> quoted_words(std::string_view line);

}  // namespace gladstone::inline optics
