// What a project with a kernel or a workload of its own includes of the installed library
// (tests/examples/outside).
#pragma once

#include "platform_models/loader/loader.h"
#include "sim/work/machine.h"
#include "sim/work/packed.h"
#include "tools/app/run/workload.h"
#include "tools/commands/main_with.h"
