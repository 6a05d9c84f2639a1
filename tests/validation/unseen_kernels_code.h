// Compiled code of the kernels in unseen_scenes.h: made by leviosim-measure, not edited by hand.
#pragma once

#include <vector>

#include "platform_models/loader/compiled_code.h"

/// For leviosim::Workload::code.
inline std::vector<leviosim::platform::CodeTable> unseen_kernels_code() {
  return {
      {"rv32imfc", R"csv(
function,after,lines,visits,refetches,executed,priced,loads,used_at_once,executed_loops,priced_loops
unseen_biquads,,7.50,2,0.00,48649.50,53480.60,18560.00,0.00,5118.00,6400.00
unseen_cholesky_solve,,23.00,250,0.00,374.40,316.06,67.60,0.00,36.00,80.00
unseen_crc32,,4.50,2,0.00,25607.00,26460.80,5120.00,2561.00,5118.00,5120.00
unseen_dense_u8,,9.00,2,0.00,46956.50,45057.88,10288.00,0.00,10238.00,10336.00
unseen_fft_radix2,,20.75,2,0.00,96045.00,86524.16,19664.00,0.00,8040.00,8718.00
unseen_histogram,,4.50,2,0.00,22555.50,28767.24,5376.00,2560.00,5796.30,6144.00
unseen_label_components,,28.75,2,0.00,55630.00,43415.15,8545.00,7323.50,12088.68,12504.00
unseen_median,,22.12,2,0.00,341172.00,341201.50,44292.50,276.50,2668.00,2668.00
unseen_product,,6.75,320,0.00,582.00,498.52,128.00,1.00,96.00,168.00
unseen_range_decode,,11.50,2,0.00,59839.00,68995.65,9349.00,1000.00,2000.00,2000.00
)csv"},
  };
}
