#include "studies/figures/draw_or_warn.h"

#include "studies/case/warning_log.h"
#include "studies/drawing/draw_figure.h"

namespace gladstone::inline figures {

bool draw_or_warn(std::function<void()> const& draw) {
  try {
    draw();
    return true;
  } catch (GnuplotMissing const& missing) {
    log_warning({WarningCode::failed, "", missing.what()});
    return false;
  }
}

}  // namespace gladstone::inline figures
