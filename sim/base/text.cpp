#include "sim/base/text.h"

namespace leviosim::base {}  // namespace leviosim::base

namespace leviosim {}  // namespace leviosim
