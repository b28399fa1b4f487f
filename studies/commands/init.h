#pragma once

#include <string>
#include <vector>

namespace gladstone::inline commands {

/// Keys of a template: the most important ones with a value, or all of them, commented out, with their defaults.
enum class TemplateKeys { important, all };

/// Returns the kinds of files that `gladstone init` writes: "bos", "piv", ...
std::vector<std::string> template_kinds();

/// Returns a commented setup, study or request of a design. @throws DataError for an unknown kind
std::string template_text(std::string const& kind, TemplateKeys keys);

/// Writes template_text() into a new file, whose name replaces that in the commands of its comment.
/// @return the text
/// @throws OutputError if the file exists or cannot be written; DataError for an unknown kind
std::string write_template(std::string const& path, std::string const& kind, TemplateKeys keys);

}  // namespace gladstone::inline commands
