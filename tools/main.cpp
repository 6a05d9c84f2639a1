// The leviosim command.
#include "tools/commands/main_with.h"

int main(int argc, char** argv) { return leviosim::main_with(argc, argv); }
