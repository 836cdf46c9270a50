// write_seeds FOLDER: the seeds of each target as files FOLDER/TARGET/seed-N.
#include <filesystem>
#include <fstream>

#include "tests/fuzz/fuzz_target.hpp"

int main(int count, char** arguments) {
  if (count != 2) return 2;
  for (const stillkite::fuzz::Target& target : stillkite::fuzz::targets()) {
    const std::filesystem::path folder = std::filesystem::path(arguments[1]) / target.name;
    std::filesystem::create_directories(folder);
    const std::vector<std::string> seeds = target.seeds();
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      std::ofstream(folder / ("seed-" + std::to_string(i)), std::ios::binary) << seeds[i];
    }
  }
  return 0;
}
