// Compiled code of the kernels in exposure_scenes.h: made by leviosim-measure, not edited by hand.
#pragma once

#include <vector>

#include "platform_models/loader/compiled_code.h"

/// For leviosim::Workload::code.
inline std::vector<leviosim::platform::CodeTable> exposure_code() {
  return {
      {"rv32imfc", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
exposure_row_sum,,2.00,40,0.00,642.00,707.80,160.00,0.00,318.00,320.00
)csv"},
      {"rv32imfc_xpulp", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
exposure_row_sum,,2.00,40,0.00,482.00,654.00,160.00,160.00,159.00,320.00
)csv"},
      {"thumb2", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
exposure_row_sum,,2.00,40,0.00,642.00,645.00,160.00,0.00,318.00,320.00
)csv"},
      {"armv6", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
exposure_row_sum,,2.25,40,0.00,562.50,574.00,160.00,0.00,238.50,240.00
)csv"},
  };
}
