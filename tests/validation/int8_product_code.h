// Compiled code of the kernels in int8_product.h: made by leviosim-measure, not edited by hand.
#pragma once

#include <vector>

#include "platform_models/loader/compiled_code.h"

/// For leviosim::Workload::code.
inline std::vector<leviosim::platform::CodeTable> int8_product_code() {
  return {
      {"rv32imfc", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
multiply_int8,,49.25,1,4677.00,160290.00,17521.28,43568.00,4096.00,2046.00,2336.00
)csv"},
      {"rv32imfc_xpulp", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
multiply_int8,,31.25,1,0.00,42326.00,28671.00,16944.00,0.00,2030.00,2336.00
)csv"},
  };
}
