// Every command of leviosim, with one more workload: run, record, replay, sweep, whatif, check,
// report …
#include <leviosim/leviosim.h>

#include "exposure.h"

int main(int argc, char** argv) { return leviosim::main_with(argc, argv, {exposure::workload()}); }
