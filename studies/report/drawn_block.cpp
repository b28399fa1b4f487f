#include "studies/report/drawn_block.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "render/files/text_file.h"
#include "studies/figures/gnuplot.h"
#include "studies/figures/temporary_directory.h"

namespace gladstone {

ReportBlock drawn_block(std::string title, std::string words,
                        std::function<void(std::string const& path)> const& write) {
  try {
    TemporaryDirectory const folder;
    std::string const path = folder.path() + "/figure.png";
    write(path);
    return Picture{std::move(title), std::move(words), read_text_file(path)};
  } catch (GnuplotMissing const& missing) {
    spdlog::warn("{}", missing.what());
    return Paragraph{title + ". " + words};
  }
}

}  // namespace gladstone
