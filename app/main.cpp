#include "app/command_line.hpp"

int main(int argc, char** argv) {
  return stillkite::run_command_line(argc, argv, STILLKITE_VERSION);
}
