// The leviosim command. Exit status: 0 if done, 1 if a limit that the user
// set was not met, 2 for bad input, with one message on stderr, 130
// and 143 where it was interrupted. Faults of leviosim itself abort.
#include "tools/commands/main_with.h"

int main(int argc, char** argv) { return leviosim::main_with(argc, argv); }
