#include "studies/commands/figure_ending.h"

#include <filesystem>

#include "render/base/error.h"

namespace gladstone::inline commands {

void check_figure_ending(std::string const& figure) {
  std::error_code error;
  if (figure.empty() || figure.ends_with(".png") || figure.ends_with(".svg") || figure.ends_with(".pdf") ||
      std::filesystem::exists(figure, error))
    return;
  throw OutputError(figure, "is not the name of a figure: it must end in .png, .svg or .pdf");
}

}  // namespace gladstone::inline commands
