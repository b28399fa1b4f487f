#include "studies/report/drawn_block.h"

#include <utility>

#include "render/files/text_file.h"
#include "studies/drawing/draw_figure.h"
#include "studies/drawing/temporary_directory.h"
#include "studies/figures/draw_or_warn.h"

namespace gladstone {

ReportBlock drawn_block(std::string title, std::string words, Figure const& figure) {
  TemporaryDirectory const folder;
  std::string const path = folder.path() + "/figure.png";
  if (!draw_or_warn([&] { draw_figure(figure, path); })) return Paragraph{title + ". " + words};
  return Picture{std::move(title), std::move(words), read_text_file(path)};
}

}  // namespace gladstone
