// Compiled code of the kernels in int8_product.h: made by leviosim-measure, not edited by hand.
#pragma once

#include <vector>

#include "platform_models/loader/compiled_code.h"

/// For leviosim::Workload::code.
inline std::vector<leviosim::platform::CodeTable> int8_product_code() {
  return {
      {"rv32imfc", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
multiply_int8,,40.25,1,250.25,137992.00,14221.44,44608.00,6144.00,2046.00,2320.00
)csv"},
      {"rv32imfc_xpulp", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
multiply_int8,,25.50,1,0.00,38546.00,28103.00,10432.00,1024.00,2038.00,2320.00
)csv"},
  };
}
