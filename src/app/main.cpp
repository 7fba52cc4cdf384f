#include "app/console/commands.h"

int main(int argc, char** argv) { return obscura::app::main(argc, argv); }
