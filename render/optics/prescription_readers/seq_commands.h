#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "render/optics/glass.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone::inline optics {

/// Splits a CODE V file into commands. Line ends and ";" separate commands, "&" joins lines, "!" starts a comment;
/// within quotes ";", "!" and quotes of the other kind are literal.
void for_each_command(std::string_view text, std::function<void(std::string const& command, int line)> const& take);

/// Returns true if a command (in upper case) does not affect rays: weights, variables, names, and solves whose values
/// are in the file.
bool is_ignored_command(std::string const& command);

/// Returns true if a command (in upper case) defines an unsupported surface: gratings, holograms, toroids, splines,
/// non-sequential parts, and coordinate frames that return to another surface.
bool is_unsupported_command(std::string const& command);

/// Glasses defined in the file itself, between PRV and END: indices at the wavelengths of PWL [nm], or the coefficients
/// of Laurent's series (LAU), which is identical to Schott's formula.
class PrivateGlasses {
 public:
  /// Reads a command between PRV and END. @throws DataError
  void read(PrescriptionLine const& line);
  /// Returns the glass with a name in upper case, or null.
  Glass const* find(std::string const& name) const;

 private:
  std::vector<double> wavelengths_;  // [m]
  std::map<std::string, Glass> glasses_;
};

}  // namespace gladstone::inline optics
