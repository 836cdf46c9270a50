// Writes sample reports of a synthetic flight and synthetic trials. Usage: report_sample FOLDER
#include <exception>
#include <filesystem>
#include <iostream>

#include "tests/browser/synthetic_flight.hpp"
#include "tests/browser/synthetic_trials.hpp"

namespace {

void write_samples(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const auto flight = stillkite::synthetic_flight(3750);
  auto summary = synthetic_summary(flight);
  write_report(folder / "with_truth.html", flight.content("flight.mp4", true), summary);
  summary.erase("evaluation");
  write_report(folder / "without_truth.html", flight.content("flight.mp4", false), summary);
  const auto long_flight = stillkite::synthetic_flight(90000);
  write_report(folder / "long.html", long_flight.content("long_flight.mp4", true),
               synthetic_summary(long_flight));
  const auto trials = stillkite::synthetic_trials();
  write_hover_report(folder / "hover.html", trials.content("trials_paper.yaml"),
                     synthetic_hover_summary(trials));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) {
      std::cerr << "usage: report_sample FOLDER\n";
      return 2;
    }
    write_samples(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
